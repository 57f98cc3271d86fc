//! Synthesis from a table of targets: dimensions for paths and motions, with or without prescribed timing, from many
//! starts.

mod asked;
mod fit;
mod phases;
mod search;
mod verify;

pub use asked::{FreeInput, Target, TargetColumn, TargetRow, slot_of};
pub use fit::Fit;
pub use search::{StartResult, TargetSearch, TargetSynthesis, fit_target};
pub use verify::{VerifiedRows, verify_target};
