//! Points carried by rotations: their coordinates become unknowns, determined by loops.

use super::super::super::formula::expansion::Factor;
use super::super::super::formula::node::{FormulaNode, NodeKind};
use super::ends::shift_along;
use crate::diag::Span;
use crate::model::actuation::Actuation;
use crate::model::chain::ElementaryMotion;
use crate::model::mechanism::Mechanism;

/// The unknown coordinates of a point that rotations carry.
pub struct ParsedPin {
    /// Of its loop.
    pub name: String,
    /// Axes and names.
    pub unknowns: Vec<(usize, String)>,
    /// From the world to the point, by its coordinates.
    pub base: Vec<Factor>,
    /// From there back to the point, by its chain.
    pub closing: Vec<Factor>,
    /// As written in the bars.
    pub carrier: Vec<Factor>,
    /// Its coordinates.
    pub place: [FormulaNode; 3],
}

impl ParsedPin {
    /// `plain` marks the coordinates that are sums of displacements along their axes.
    pub fn new(name: String, carrier: &[Factor], plain: [bool; 3], span: &Span) -> Self {
        let mut unknowns = Vec::new();
        let place = [0, 1, 2].map(|axis| {
            if plain[axis] {
                return shift_along(carrier, axis, span);
            }
            let unknown = format!("{name}.{}", ["x", "y", "z"][axis]);
            unknowns.push((axis, unknown.clone()));
            let kind = NodeKind::Name(unknown);
            let span = span.clone();
            FormulaNode { kind, span }
        });
        let motion = ElementaryMotion::Translation;
        let shift =
            |(axis, _): &(usize, String)| Factor::Elementary(motion, *axis, place[*axis].clone());
        let base: Vec<Factor> = unknowns.iter().map(shift).collect();
        let back = base.iter().rev().cloned().map(Factor::inverse);
        // Displacements along the axis of all rotations do not affect the other coordinates.
        let across = carrier.iter().filter(|factor| match factor {
            Factor::Elementary(ElementaryMotion::Translation, axis, _) => !plain[*axis],
            _ => true,
        });
        Self {
            closing: back.chain(across.cloned()).collect(),
            base,
            name,
            unknowns,
            carrier: carrier.to_vec(),
            place,
        }
    }

    /// Fills in missing start values of its coordinates from its chain at the start values of all other unknowns.
    pub fn start(&self, mechanism: &Mechanism, actuation: &mut Actuation) {
        let place = |name: &str| mechanism.unknowns.iter().position(|u| u.name == name);
        let slots = self.unknowns.iter();
        let slots = slots.filter_map(|(axis, name)| Some((*axis, place(name)?)));
        let free: Vec<(usize, usize)> = slots.filter(|(_, slot)| !actuation.named[*slot]).collect();
        let Some(item) = mechanism.loops.iter().find(|item| item.name == self.name) else {
            return;
        };
        // With zero coordinates the closure error of the loop is exactly their values.
        let mut start = actuation.start_at(0.0);
        free.iter().for_each(|(_, slot)| start[*slot] = 0.0);
        let open = item
            .chain
            .pose(&mechanism.argument_values(&start))
            .translation;
        for (axis, slot) in free.into_iter().filter(|(axis, _)| open[*axis].is_finite()) {
            actuation.guess[slot] = open[axis];
        }
    }
}
