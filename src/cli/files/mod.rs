//! Picture files: sinks, and the verbs that take pictures as they are.

pub mod chart;
pub mod diff;
pub mod encode;
pub mod new_scene;
pub mod sinks;
pub mod snapshot;
