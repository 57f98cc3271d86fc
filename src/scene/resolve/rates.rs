//! Derivatives in formulas of poses: each becomes a slot after those of the pose, with its formula and order of
//! differentiation.

use super::super::formula::node::{DerivativeNode, FormulaNode, NodeKind};
use super::outputs::{ExtraSlot, Scope};
use crate::diag::{Diagnostic, Span};
use crate::model::dimension::PhysicalDimension;
use crate::model::expression::Expression;
use crate::model::rate::{Per, RateOrder, RatedFormula};

/// Names of time as a variable of differentiation, and on an axis.
pub const TIME: [&str; 2] = ["time", "t"];

/// The rates that formulas contain, with their kinds.
#[derive(Default)]
pub struct FoundRates {
    /// Formulas and which of their rates.
    pub list: Vec<(Expression, RateOrder)>,
    extra: Vec<ExtraSlot>,
}

impl Scope<'_> {
    /// A formula that may contain derivatives, and its kind.
    pub fn compile_rated(
        &self,
        node: &FormulaNode,
    ) -> Result<(RatedFormula, PhysicalDimension), Diagnostic> {
        let mut found = FoundRates::default();
        let (expression, dimension) = self.compile_beside(node, &mut found)?;
        let formula = RatedFormula {
            expression,
            first: self.slot_count(),
            rates: found.list,
        };
        Ok((formula, dimension))
    }

    /// The same for one of several formulas that share their rates.
    pub fn compile_beside(
        &self,
        node: &FormulaNode,
        found: &mut FoundRates,
    ) -> Result<(Expression, PhysicalDimension), Diagnostic> {
        let mut node = node.clone();
        self.take_rates(&mut node, found)?;
        self.compile_with(&node, &found.extra)
    }

    /// The parts of a derivative: the formula, the requested rate, and the formula's kind.
    pub fn rate(
        &self,
        parts: &DerivativeNode,
    ) -> Result<(Expression, RateOrder, PhysicalDimension), Diagnostic> {
        let (formula, dimension) = self.compile(&parts.of)?;
        if formula.slots().iter().any(|slot| self.is_rated(*slot)) {
            let message = "a derivative cannot contain another derivative";
            return Err(Diagnostic::error(message)
                .at(parts.of.span.clone())
                .hint("a derivative of higher order is written `d(quantity, input, order)`"));
        }
        let rate = RateOrder {
            per: self.per(&parts.by, &parts.by_span)?,
            order: parts.order,
        };
        Ok((formula, rate, dimension))
    }

    /// The kind of the variable of differentiation.
    pub fn dimension_of_per(&self, per: Per) -> PhysicalDimension {
        match per {
            Per::Time => PhysicalDimension::TIME,
            Per::Input(k) => PhysicalDimension::of(self.names.inputs[k].kind),
        }
    }

    /// Replaces every derivative by the name of its slot.
    fn take_rates(&self, node: &mut FormulaNode, found: &mut FoundRates) -> Result<(), Diagnostic> {
        match &mut node.kind {
            NodeKind::Number(_) | NodeKind::Radians(_) | NodeKind::Name(_) => {}
            NodeKind::Negate(inner) | NodeKind::Of(_, inner) => self.take_rates(inner, found)?,
            NodeKind::Binary(_, a, b) => {
                self.take_rates(a, found)?;
                self.take_rates(b, found)?;
            }
            NodeKind::Call(_, args) => {
                for arg in args {
                    self.take_rates(arg, found)?;
                }
            }
            NodeKind::Derivative(parts) => {
                let (formula, rate, whole) = self.rate(parts)?;
                let below = self.dimension_of_per(rate.per) * rate.order as i32;
                // Names in scenes contain no parentheses, so this one is unique.
                let name = format!("d({})", found.list.len());
                found.extra.push(ExtraSlot {
                    name: name.clone(),
                    slot: self.slot_count() + found.list.len(),
                    dimension: whole - below,
                });
                found.list.push((formula, rate));
                node.kind = NodeKind::Name(name);
            }
        }
        Ok(())
    }

    /// The variable of a derivative.
    fn per(&self, name: &str, span: &Span) -> Result<Per, Diagnostic> {
        let inputs = &self.names.inputs;
        if let Some(index) = inputs.iter().position(|c| c.name == name) {
            return Ok(Per::Input(index));
        }
        if TIME.contains(&name) {
            return Ok(Per::Time);
        }
        let names = inputs.iter().map(|c| c.name.as_str());
        Err(Diagnostic::error(format!("`{name}` is not an input"))
            .at(span.clone())
            .label("derivatives are taken by an input, or by `t`")
            .suggest(name, names))
    }
}

/// The first derivative in a formula that satisfies `wanted`.
pub fn find_derivative<'n>(
    node: &'n FormulaNode,
    wanted: &dyn Fn(&DerivativeNode) -> bool,
) -> Option<&'n FormulaNode> {
    match &node.kind {
        NodeKind::Number(_) | NodeKind::Radians(_) | NodeKind::Name(_) => None,
        NodeKind::Negate(inner) | NodeKind::Of(_, inner) => find_derivative(inner, wanted),
        NodeKind::Binary(_, a, b) => {
            find_derivative(a, wanted).or_else(|| find_derivative(b, wanted))
        }
        NodeKind::Call(_, args) => args.iter().find_map(|arg| find_derivative(arg, wanted)),
        NodeKind::Derivative(parts) => wanted(parts).then_some(node),
    }
}
