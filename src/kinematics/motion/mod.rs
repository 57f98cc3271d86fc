//! The motion along the drive: samples, path tracking, events, limit positions, feasible inputs.

pub mod continuation;
pub mod feasible;
mod input_reversals;
pub mod limits;
pub mod proved;
pub mod sampling;
pub mod tracker;
mod value_roundings;
