//! Pictures composed by the verbs.

pub mod clearance;
pub mod paths;
pub mod sensitivity_bars;
pub mod tolerance_cloud;
