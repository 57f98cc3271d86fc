//! Following a motion on one assembly branch: prediction, correction, trust, and steps that halve. It knows samples and
//! events only as a watcher that it calls.

pub mod arc_length;
mod bounded_formulas;
mod flat;
mod joining;
pub mod jump_sites;
pub mod jumps;
pub mod path_tracker;
pub mod regularity;
pub mod singular;
mod step_bounds;
pub mod steps;
mod strays;
