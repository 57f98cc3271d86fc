//! Numbers, and what counts as one: the trait all formulas are written in: Taylor series, hyper-dual numbers, intervals, double-doubles.

pub mod double_double;
pub mod hyper_dual;
pub mod interval;
pub mod rounding;
pub mod scalar;
pub mod series;
pub mod sin_cos;
