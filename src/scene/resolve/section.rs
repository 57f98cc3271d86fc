//! The plane of `[view]` at which bodies are cut.

use super::super::views::ViewFile;
use super::bodies::body_index;
use super::body_constants::BodyConstants;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::mechanism::Body;
use crate::model::section::{Section, SectionPlane};

/// Resolves it; errors are reported and leave no section.
pub fn resolve_section(
    view: &ViewFile,
    constants: &BodyConstants,
    bodies: &[Body],
    diagnostics: &mut Diagnostics,
) -> Option<Section> {
    let section = view.section.as_ref()?;
    // All errors are found: nothing is left out because of an earlier one.
    let chosen = section.bodies.as_ref().map(|names| {
        let names = names.iter();
        let indices =
            names.filter_map(|name| body_index(&name.value, &name.span, bodies, diagnostics));
        indices.collect()
    });
    let [point, normal] = [&section.point, &section.normal].map(|texts| {
        let texts = texts.as_ref()?;
        constants.vector(texts, diagnostics)
    });
    let plane = SectionPlane::new(point?, normal?);
    if plane.is_none() {
        let places = section.normal.iter().flatten();
        let diagnostic = Diagnostic::error("the normal of a section has no direction");
        diagnostics.push(match places.map(|text| text.span.clone()).next() {
            Some(span) => diagnostic.at(span),
            None => diagnostic,
        });
    }
    Some(Section {
        plane: plane?,
        bodies: chosen,
    })
}
