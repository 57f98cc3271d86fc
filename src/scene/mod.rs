//! Translates the text of a scene into a mechanism and its view. Beyond this room, nothing is looked up by name.
// An error is large, but there is only one per message: boxing it would save nothing.
#![allow(clippy::result_large_err)]

pub mod bars;
pub mod bodies;
pub mod builtin;
pub mod clearance;
pub mod columns;
pub mod contacts;
pub mod edit;
pub mod file;
pub mod formula;
pub mod keys;
mod loaded;
pub mod machine_parts;
pub mod measures;
mod overrides;
pub mod plots;
pub mod reader;
pub mod resolve;
pub mod shapes;
pub mod shown_dimensions;
pub mod solids;
pub mod source;
pub mod studies;
pub mod syntax;
pub mod template;
pub mod text;
pub mod values;
pub mod views;

use crate::diag::{SceneError, Source};
pub use loaded::{KeptIn, KeptParameter, Scene};
pub use overrides::{OtherDrives, Overrides, PlotText};
use text::SceneText;

/// Reads and resolves `source`; the error contains all messages.
pub fn load_scene(source: &Source, overrides: &Overrides) -> Result<Scene, SceneError> {
    SceneText::read(source.clone()).resolved(overrides)
}
