//! The public API: scenes, motions, poses with their proofs, checks, studies and films.

mod assembly;
mod check;
mod derivatives;
mod enclosure;
mod error;
mod film;
mod loaded;
mod motion;
mod optimum;
mod pose;
mod rows;
mod scene;
mod sensitivity;
mod study;
mod tolerance;

pub use assembly::Assembly;
pub use check::{Check, CheckOptions, PairClearance};
pub use enclosure::Enclosure;
pub use error::{Error, ErrorKind};
pub use film::Film;
pub use motion::{Motion, Samples};
pub use optimum::{OptimiseOptions, Optimum};
pub use pose::Pose;
pub use scene::{Quantity, Scene};
pub use sensitivity::Sensitivity;
pub use study::Study;
pub use tolerance::{MeasureScatter, Tolerance, ToleranceOptions};
