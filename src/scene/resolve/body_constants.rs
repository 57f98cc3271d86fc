//! Numbers and points of bodies, which are constants of the scene.

use super::super::formula::compile::constant_node;
use super::super::formula::kinds::{dimension_of, to_radians};
use super::super::formula::node::FormulaNode;
use super::names::Names;
use super::parsing::parsed_expression;
use super::range::{in_range, within_range};
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::dimension::PhysicalDimension;
use crate::model::mechanism::Kind;
use crate::numbers::constant::Constant;
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
        self.value_of(&node, text, diagnostics)
    }

    fn value_of(
        &self,
        node: &FormulaNode,
        text: &FormulaText,
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let value = constant_node(node, &|n, s| self.names.constant(n, s));
        let computable = |value: f64| within_range(value, &text.span).map(|()| value);
        diagnostics.taken(value.and_then(computable))
    }

    /// The number at `what`, if there is one and it is in its range.
    pub fn within(
        &self,
        what: &str,
        text: &Option<FormulaText>,
        range: [f64; 2],
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let text = text.as_ref()?;
        let value = self.value(text, diagnostics)?;
        diagnostics.taken(in_range(what, value, range, &text.span))
    }

    /// The angle at `what` in radians, if there is one and it is in its range of degrees. Numbers are degrees whatever the unit of
    /// the scene is, alone and beside an angle; what is an angle is that angle.
    pub fn angle_within(
        &self,
        what: &str,
        text: &Option<FormulaText>,
        degrees: [f64; 2],
        diagnostics: &mut Diagnostics,
    ) -> Option<f64> {
        let text = text.as_ref()?;
        let node = parsed_expression(text, diagnostics)?;
        let of_name = |name: &str| self.names.dimension(name);
        // Numbers beside angles are degrees here, too.
        let degree = Constant::PI / Constant::exact(180.0);
        let is_angle = dimension_of(&node, &of_name) == PhysicalDimension::of(Kind::Angle);
        let value = match is_angle {
            true => {
                let node = to_radians(node, Some(Kind::Angle), degree, &of_name);
                self.value_of(&node, text, diagnostics)?.to_degrees()
            }
            false => self.value(text, diagnostics)?,
        };
        let value = diagnostics.taken(in_range(what, value, degrees, &text.span))?;
        Some(value.to_radians())
    }

    /// Three numbers.
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
