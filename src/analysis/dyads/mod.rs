//! A planar linkage as a row of dyads: read from a solved mechanism, and what random directions of its bars lead to.

mod bar_ends;
mod not_dyads;
mod plane;
mod points;
mod trials;

pub use not_dyads::NotDyads;
pub use points::{PlanarRow, planar_row};
pub use trials::{Trials, TrialsAsked, run_trials};
