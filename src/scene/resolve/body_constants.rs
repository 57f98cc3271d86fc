//! Numbers and points of bodies, which are constants of the scene.

use super::super::formula::compile::constant_node;
use super::names::Names;
use super::parsing::parsed_expression;
use super::range::within_range;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::mechanism::Kind;
use crate::scene::values::FormulaText;
use glam::DVec3;

/// Constant formulas of shapes and views, with their messages.
pub struct BodyConstants<'a> {
    /// Parameters and their values.
    pub names: &'a Names,
}

impl BodyConstants<'_> {
    /// The value of a formula of parameters.
    pub fn value(&self, text: &FormulaText, diagnostics: &mut Diagnostics) -> Option<f64> {
        let node = parsed_expression(text, diagnostics)?;
        let node = self.names.in_radians(node, Some(Kind::Number));
        let value = constant_node(&node, &|n, s| self.names.constant(n, s));
        let in_range = |value: f64| within_range(value, &text.span).map(|()| value);
        match value.and_then(in_range) {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                diagnostics.push(diagnostic);
                None
            }
        }
    }

    /// Three of them.
    pub fn vector(&self, texts: &[FormulaText; 3], diagnostics: &mut Diagnostics) -> Option<DVec3> {
        let [x, y, z] = texts.each_ref().map(|text| self.value(text, diagnostics));
        Some(DVec3::new(x?, y?, z?))
    }

    /// A vector that may be absent.
    pub fn vector_or_zero(
        &self,
        texts: &Option<[FormulaText; 3]>,
        diagnostics: &mut Diagnostics,
    ) -> Option<DVec3> {
        texts
            .as_ref()
            .map_or(Some(DVec3::ZERO), |texts| self.vector(texts, diagnostics))
    }

    /// A value that must be positive.
    pub fn positive(
        &self,
        what: &str,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let value = self.value(text, diagnostics)?;
        if value > 0.0 {
            return Some(value);
        }
        diagnostics.push(
            Diagnostic::error(format!(
                "{what} must be positive, found {}",
                shown_number(value)
            ))
            .at(text.span.clone()),
        );
        None
    }
}
