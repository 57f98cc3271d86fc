//! Dimensions in pictures: names of bodies become indices, formulas values.

use super::super::shown_dimensions::{PlaceFile, ShownDimensionFile};
use super::bodies::{body_index, trace_index};
use super::body_constants::BodyConstants;
use super::choices::MOST_LABELS;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::mechanism::{Body, Trace};
use crate::model::shown_dimension::{DimensionEnd, DimensionKind, PlaceOf, ShownDimension};
use crate::scene::values::FormulaText;

/// More digits are meaningless in a picture.
const MOST_DIGITS: f64 = 9.0;

/// Resolves all of them; errors are reported and skipped.
pub fn resolve_dimensions(
    list: &[ShownDimensionFile],
    constants: &BodyConstants,
    (bodies, traces): (&[Body], &[Trace]),
    diagnostics: &mut Diagnostics,
) -> Vec<ShownDimension> {
    if let Some(beyond) = list.get(MOST_LABELS) {
        let message = format!("at most {MOST_LABELS} dimensions");
        diagnostics.push(Diagnostic::error(message).at(beyond.span.clone()));
    }
    let mut reader = DimensionReader {
        constants,
        bodies,
        traces,
        diagnostics,
    };
    list.iter()
        .filter_map(|file| reader.dimension(file))
        .collect()
}

struct DimensionReader<'a, 'n> {
    constants: &'a BodyConstants<'n>,
    bodies: &'a [Body],
    traces: &'a [Trace],
    diagnostics: &'a mut Diagnostics,
}

impl DimensionReader<'_, '_> {
    fn dimension(&mut self, file: &ShownDimensionFile) -> Option<ShownDimension> {
        let [from, to] = file.ends.each_ref().map(|end| self.end(end));
        let kind = match &file.at {
            None => self.length(file),
            Some(at) => self.angle(file, at),
        };
        let digits = match &file.digits {
            None => None,
            Some(text) => Some(self.digits(text)?),
        };
        Some(ShownDimension {
            kind: kind?,
            ends: [from?, to?],
            text: file.text.as_ref().map(|text| text.value.clone()),
            digits,
            colour: file.colour,
        })
    }

    fn length(&mut self, file: &ShownDimensionFile) -> Option<DimensionKind> {
        if file.axis.is_some() || file.radius.is_some() {
            self.refuse(
                file,
                "`axis` and `radius` belong to an angle, which needs `at`",
            );
            return None;
        }
        let offset = self
            .constants
            .vector_or_zero(&file.offset, self.diagnostics)?;
        Some(DimensionKind::Length { offset })
    }

    fn angle(&mut self, file: &ShownDimensionFile, at: &PlaceFile) -> Option<DimensionKind> {
        if file.offset.is_some() {
            self.refuse(file, "an angle has no `offset`");
            return None;
        }
        let at = self.end(at);
        let radius = match &file.radius {
            None => None,
            Some(text) => Some(self.constants.positive("radius", text, self.diagnostics)?),
        };
        let axis = match &file.axis {
            None => None,
            Some(texts) => {
                let axis = self
                    .constants
                    .vector(texts, self.diagnostics)?
                    .try_normalize();
                if axis.is_none() {
                    self.refuse(file, "the axis of an angle must not be zero");
                    return None;
                }
                axis
            }
        };
        Some(DimensionKind::Angle {
            at: at?,
            axis,
            radius,
        })
    }

    fn end(&mut self, file: &PlaceFile) -> Option<DimensionEnd> {
        let point = self.constants.vector_or_zero(&file.point, self.diagnostics);
        let of = match (&file.body, &file.trace) {
            (Some(body), None) => PlaceOf::Body(body_index(
                &body.value,
                &body.span,
                self.bodies,
                self.diagnostics,
            )?),
            (None, Some(trace)) => {
                let names = self.constants.names;
                PlaceOf::Trace(trace_index(trace, names, self.traces, self.diagnostics)?)
            }
            (None, None) => PlaceOf::World,
            (Some(_), Some(_)) => {
                let message = "a place is on a `body` or on a `trace`, not on both";
                self.diagnostics
                    .push(Diagnostic::error(message).at(file.span.clone()));
                return None;
            }
        };
        Some(DimensionEnd { of, point: point? })
    }

    fn digits(&mut self, text: &FormulaText) -> Option<usize> {
        let value = self.constants.value(text, self.diagnostics)?;
        if (0.0..=MOST_DIGITS).contains(&value) && value.fract() == 0.0 {
            return Some(value as usize);
        }
        let message = format!("digits must be a whole number from 0 to {MOST_DIGITS}");
        self.diagnostics
            .push(Diagnostic::error(message).at(text.span.clone()));
        None
    }

    fn refuse(&mut self, file: &ShownDimensionFile, message: &str) {
        self.diagnostics
            .push(Diagnostic::error(message).at(file.span.clone()));
    }
}
