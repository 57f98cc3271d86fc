//! Closed poses: assembly from start values, Newton corrections, prediction, branches.

pub mod along_drive;
pub mod assembly;
pub mod between;
pub mod branch;
pub mod closure;
mod descent;
pub mod iterates;
pub mod linearisation;
pub mod newton;
pub mod pose_check;
pub mod pose_solver;
pub mod predictor;
pub mod random_starts;
pub mod settled_roots;
pub(crate) mod turns;
pub mod wishes;
