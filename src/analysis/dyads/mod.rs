//! A planar linkage as a sequence of dyads, read from a solved mechanism, and trials with random directions of its
//! bars.

mod not_dyads;
mod plane;
mod points;
mod trials;

pub use not_dyads::NotDyads;
pub use points::{PlanarRow, planar_row};
pub use trials::{NoTrials, TrialOptions, Trials, run_trials};
