//! The text of a scene, read once and resolved as often as its values change.

use super::file::{SceneFile, read_scene};
use super::loaded::Scene;
use super::overrides::{Overrides, apply_overrides};
use super::resolve::resolve_scene;
use crate::diag::{Diagnostics, SceneError, Source};

/// A text with everything that is read from it before values are replaced and names resolved.
#[derive(Clone, Debug)]
pub struct SceneText {
    source: Source,
    file: SceneFile,
    diagnostics: Diagnostics,
}

impl SceneText {
    /// Reads a text; mistakes are told with those found later.
    pub fn read(source: Source) -> Self {
        let mut diagnostics = Diagnostics::default();
        Self {
            file: read_scene(&source, &mut diagnostics),
            source,
            diagnostics,
        }
    }

    /// The text and its name.
    pub fn source(&self) -> &Source {
        &self.source
    }

    /// The scene with some values replaced.
    ///
    /// # Errors
    /// All mistakes, of the text and of the values.
    pub fn resolved(&self, overrides: &Overrides) -> Result<Scene, SceneError> {
        let mut diagnostics = self.diagnostics.clone();
        // After any other error enough is left to continue, so that one run reports all errors.
        if self.file.lacks_sections {
            return Err(self.mistaken(diagnostics));
        }
        let mut file = self.file.clone();
        apply_overrides(overrides, &mut file, &mut diagnostics);
        let scene = resolve_scene(&file, overrides, &mut diagnostics);
        match scene {
            Some(mut scene) if !diagnostics.has_errors() => {
                scene.warnings = diagnostics;
                if let Some(other) = &overrides.drives {
                    other.replace_in(&mut scene.actuation);
                }
                Ok(scene)
            }
            _ => Err(self.mistaken(diagnostics)),
        }
    }

    fn mistaken(&self, diagnostics: Diagnostics) -> SceneError {
        SceneError {
            source_text: self.source.clone(),
            diagnostics,
        }
    }
}
