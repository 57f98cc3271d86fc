//! Names that may not be what they are: unknowns that other things are called, and undefined ones.

use super::super::file::SceneFile;
use super::names::{Names, visit_factor};
use super::parsed::Parsed;
use super::words::{TIME, taken_by_tables};
use crate::diag::{Diagnostic, Diagnostics};

impl Names {
    /// The name of the time is no unknown: who writes it into a loop or an equation means a drive.
    pub(super) fn refuse_time(&self, diagnostics: &mut Diagnostics) {
        let places = self.unknowns.iter().zip(&self.unknown_places);
        for (_, place) in places.filter(|(unknown, _)| unknown.name == TIME) {
            let message = format!("the time `{TIME}` can be used in drives only");
            let diagnostic = Diagnostic::error(message).at(place.clone());
            diagnostics.push(diagnostic.hint(format!(
                "give an input the formula, such as `phi = \"360*{TIME}\"` under [inputs], and use the input here"
            )));
        }
    }

    /// An unknown is a column of every table, which nothing else may be.
    pub(super) fn refuse_taken_unknowns(&self, file: &SceneFile, diagnostics: &mut Diagnostics) {
        let outputs = file.outputs.iter().map(|(name, _)| name);
        let outputs: Vec<_> = outputs
            .chain(file.distances.iter().map(|d| &d.name))
            .collect();
        for (unknown, place) in self.unknowns.iter().zip(&self.unknown_places) {
            if let Some(taken) = taken_by_tables(&unknown.name, place) {
                diagnostics.push(taken);
            }
            if let Some(output) = outputs.iter().find(|name| name.value == unknown.name) {
                let name = &unknown.name;
                diagnostics.push(
                    Diagnostic::error(format!(
                        "`{name}` is defined twice: as an unknown and as output"
                    ))
                    .at(output.span.clone())
                    .with_related(place.clone(), "an unknown here"),
                );
            }
        }
    }

    /// A name in a body's frame that no loop determines is probably misspelled.
    pub(super) fn refuse_undefined_in_frames(
        &self,
        parsed: &Parsed,
        diagnostics: &mut Diagnostics,
    ) {
        for factor in parsed.frames.iter().flatten() {
            visit_factor(factor, &mut |name, span| {
                if let Err(diagnostic) = self.coordinate(name, span) {
                    diagnostics.push(diagnostic);
                }
            });
        }
    }
}
