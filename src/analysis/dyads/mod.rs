//! A planar linkage as a row of dyads: read from a solved mechanism, and what random directions of its bars lead to.

mod points;
mod trials;

pub use points::{NotDyads, PlanarRow, planar_row};
pub use trials::{Trials, TrialsAsked, run_trials};
