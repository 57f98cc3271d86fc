//! Dimensions in pictures: names of bodies become indices, formulas values.

use super::super::shown_dimensions::{PlaceFile, ShownDimensionFile};
use super::bodies::{body_index, trace_index};
use super::body_constants::BodyConstants;
use super::choices::MOST_LABELS;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::mechanism::{Body, Trace};
use crate::model::shown_dimension::{DimensionEnd, DimensionKind, PlaceOf, ShownDimension};
use crate::scene::values::FormulaText;
use glam::DVec3;

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
        let ends = file.ends.each_ref();
        let [from, to] = ends.map(|end| end.as_ref().and_then(|end| self.end(end)));
        let kind = match &file.at {
            None => self.length(file),
            Some(at) => self.angle(file, at),
        };
        let digits = file.digits.as_ref().map(|text| self.digits(text));
        if digits == Some(None) {
            return None;
        }
        Some(ShownDimension {
            kind: kind?,
            ends: [from?, to?],
            text: file.text.as_ref().map(|text| text.value.clone()),
            digits: digits.flatten(),
            colour: file.colour,
        })
    }

    fn length(&mut self, file: &ShownDimensionFile) -> Option<DimensionKind> {
        let axis = file.axis.as_ref().map(|axis| &axis[0]);
        let of_angle = [("axis", axis), ("radius", file.radius.as_ref())];
        let mut is_sound = true;
        for (key, text) in of_angle {
            let Some(text) = text else { continue };
            let message = format!("`{key}` belongs to an angle");
            self.refuse(
                text,
                &message,
                "an angle has a place `at` where its arms meet",
            );
            is_sound = false;
        }
        let offset = self
            .constants
            .vector_or_zero(&file.offset, self.diagnostics);
        let offset = offset.filter(|_| is_sound)?;
        Some(DimensionKind::Length { offset })
    }

    fn angle(&mut self, file: &ShownDimensionFile, at: &PlaceFile) -> Option<DimensionKind> {
        let is_sound = file.offset.is_none();
        if let Some([x, ..]) = &file.offset {
            let hint = "`radius` sets how far from `at` its arc is";
            self.refuse(x, "an angle has no `offset`", hint);
        }
        let at = self.end(at);
        let radius = file.radius.as_ref();
        let radius = radius.map(|text| self.constants.positive("radius", text, self.diagnostics));
        let axis = file.axis.as_ref().map(|texts| self.axis(texts));
        // What is given and could not be read has been reported.
        if !is_sound || axis == Some(None) || radius == Some(None) {
            return None;
        }
        Some(DimensionKind::Angle {
            at: at?,
            axis: axis.flatten(),
            radius: radius.flatten(),
        })
    }

    fn axis(&mut self, texts: &[FormulaText; 3]) -> Option<DVec3> {
        let vector = self.constants.vector(texts, self.diagnostics)?;
        let axis = vector.try_normalize();
        if axis.is_none() {
            let hint = "the direction about which the angle is measured, such as [0, 0, 1]";
            self.refuse(&texts[0], "the axis of an angle must not be zero", hint);
        }
        axis
    }

    fn end(&mut self, file: &PlaceFile) -> Option<DimensionEnd> {
        let point = self.constants.vector_or_zero(&file.point, self.diagnostics);
        let of = self.place(file);
        Some(DimensionEnd {
            of: of?,
            point: point?,
        })
    }

    fn place(&mut self, file: &PlaceFile) -> Option<PlaceOf> {
        match (&file.body, &file.trace) {
            (Some(body), None) => {
                let index = body_index(&body.value, &body.span, self.bodies, self.diagnostics);
                index.map(PlaceOf::Body)
            }
            (None, Some(trace)) => {
                let names = self.constants.names;
                let index = trace_index(trace, names, self.traces, self.diagnostics);
                index.map(PlaceOf::Trace)
            }
            (None, None) => Some(PlaceOf::World),
            (Some(_), Some(trace)) => {
                let message = "a place is on a `body` or on a `trace`, not on both";
                let diagnostic = Diagnostic::error(message).at(trace.span.clone());
                let hint = "a trace is on its body already: leave one of them out";
                self.diagnostics.push(diagnostic.hint(hint));
                None
            }
        }
    }

    fn digits(&mut self, text: &FormulaText) -> Option<usize> {
        let value = self.constants.value(text, self.diagnostics)?;
        if (0.0..=MOST_DIGITS).contains(&value) && value.fract() == 0.0 {
            return Some(value as usize);
        }
        let message = format!("digits must be a whole number from 0 to {MOST_DIGITS}");
        self.refuse(text, &message, "digits behind the decimal point");
        None
    }

    fn refuse(&mut self, at: &FormulaText, message: &str, hint: &str) {
        let diagnostic = Diagnostic::error(message).at(at.span.clone());
        self.diagnostics.push(diagnostic.hint(hint));
    }
}
