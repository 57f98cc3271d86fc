//! Picture files: sinks, and the verbs on existing pictures.

pub mod chart;
pub mod diff;
pub mod encode;
pub mod new_scene;
pub mod sinks;
pub mod snapshot;
