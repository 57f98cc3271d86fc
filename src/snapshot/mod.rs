//! Golden pictures: a list of pictures of scenes, and the files to which they must be equal.

pub mod golden;
pub mod keys;
pub mod manifest;
pub mod picture;

pub use crate::compare::film::AllowedDifference;
pub use golden::{EXACT, GoldenVerdict, Update, judge_picture};
pub use manifest::{MANIFEST, Manifest};
pub use picture::{DrawError, OpenRenderer, draw_picture, draw_with};
