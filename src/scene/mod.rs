//! From the text of a scene to a mechanism and its view. After this nothing is looked up by name.
// A message is large, and made once for each mistake of a file: boxing it would save nothing.
#![allow(clippy::result_large_err)]

pub mod builtin;
pub mod clearance;
pub mod contacts;
pub mod edit;
pub mod file;
pub mod formula;
pub mod measures;
pub mod plots;
pub mod reader;
pub mod resolve;
pub mod shapes;
pub mod studies;
pub mod values;
pub mod views;

use crate::diag::{Diagnostics, SceneError, Source};
use crate::model::actuation::Actuation;
use crate::model::clearance::ClearanceRules;
use crate::model::drive::Drive;
use crate::model::measure::Measures;
use crate::model::mechanism::Mechanism;
use crate::model::plot::Plot;
use crate::model::study::Study;
use crate::model::view::View;
use std::path::PathBuf;
use std::sync::Arc;

/// A scene ready to be solved and drawn.
#[derive(Clone, Debug)]
pub struct Scene {
    /// One line for lists.
    pub description: String,
    /// The mechanism.
    pub mechanism: Arc<Mechanism>,
    /// What drives it, and where the search for a first pose starts.
    pub actuation: Actuation,
    /// What is measured of its motion.
    pub measures: Measures,
    /// How it wants to be seen.
    pub view: View,
    /// Which clearances it asks for, if any.
    pub clearance: Option<ClearanceRules>,
    /// What of its motion it wants to be plotted.
    pub plots: Vec<Plot>,
    /// What may be varied in it, and what is asked of it.
    pub study: Option<Study>,
    /// Lengths and angles that the file gives as numbers: what else could be varied.
    pub dimensions: Vec<String>,
    /// What is odd but usable.
    pub warnings: Diagnostics,
}

/// Values given on the command line instead of the file's.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// `--param NAME=FORMULA`
    pub parameters: Vec<(String, String)>,
    /// `--input NAME=FORMULA`
    pub inputs: Vec<(String, String)>,
    /// `--guess NAME=FORMULA`
    pub guess: Vec<(String, String)>,
    /// `plot --y …`: drawn in place of the scene's own plots.
    pub plot: Option<PlotText>,
    /// Folder that relative file names in the scene start from.
    pub folder: PathBuf,
    /// Parameters that are to be inputs, behind the scene's own: what a study varies.
    pub vary: Vec<String>,
    /// Characteristic length in place of the mechanism's own: what a study compares with its scene keeps the scene's.
    pub size: Option<f64>,
    /// `--inputs`: other drives of the scene's own inputs.
    pub drives: Option<OtherDrives>,
}

/// Drives in place of those of the file.
#[derive(Clone, Debug)]
pub struct OtherDrives {
    /// One for each of the scene's own inputs.
    pub drives: Vec<Drive>,
    /// Length of the motion in seconds.
    pub duration: f64,
}

/// A plot asked for on the command line: formulas as in the scene's `[[plots]]`.
#[derive(Clone, Debug, Default)]
pub struct PlotText {
    /// `--x`
    pub x: Option<String>,
    /// `--y`
    pub y: Vec<String>,
    /// `--equal`
    pub equal: bool,
}

/// Reads and resolves `source`; all mistakes found are in the error.
pub fn load(source: &Source, overrides: &Overrides) -> Result<Scene, SceneError> {
    let mut diagnostics = Diagnostics::default();
    let mut file = file::read(source, &mut diagnostics);
    // All other mistakes leave enough to go on with, so that one run names everything that is wrong.
    if file.lacks_sections {
        return Err(SceneError {
            source_text: source.clone(),
            diagnostics,
        });
    }
    resolve::apply_overrides(&mut file, overrides, &mut diagnostics);
    let vary = &overrides.vary;
    let scene = resolve::resolve(
        &file,
        &overrides.folder,
        vary,
        overrides.size,
        &mut diagnostics,
    );
    match scene {
        Some(mut scene) if !diagnostics.has_errors() => {
            scene.warnings = diagnostics;
            if let Some(other) = &overrides.drives {
                scene.actuation.duration = other.duration;
                let own = scene.actuation.drives.iter_mut().zip(&other.drives);
                own.for_each(|(drive, other)| *drive = other.clone());
            }
            Ok(scene)
        }
        _ => Err(SceneError {
            source_text: source.clone(),
            diagnostics,
        }),
    }
}
