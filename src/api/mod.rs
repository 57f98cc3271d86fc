//! The library's face: a scene, its motion, what is known of every pose, checks and films.

mod assembly;
mod check;
mod column;
mod derivatives;
mod error;
mod film;
mod loaded;
mod motion;
mod pose;
mod rows;
mod scene;

pub use assembly::Assembly;
pub use check::{Check, CheckOptions, PairClearance};
pub use error::{Error, ErrorKind};
pub use film::{Film, FilmFile};
pub use motion::{Motion, Samples};
pub use pose::{Placement, Pose};
pub use scene::{Quantity, Scene};
