//! Joints of loops whose arguments are formulas, such as the lift of a cam: how far a step may take them.

use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;
use std::f64::consts::FRAC_PI_8;

/// A step turns nothing that is driven farther than this, radians: linkages flatten at every half turn, and several inputs may
/// leave their reach together.
pub(super) const FARTHEST_TURN: f64 = FRAC_PI_8;

/// A step slides it no farther than this, in sizes of the mechanism.
pub(super) const FARTHEST_SLIDE: f64 = 0.125;

/// A formula may leave the range between its values at the ends of a step by this much, radians or mechanism sizes, over all
/// values that its coordinates may have between them together.
const STRAY: f64 = 0.1;

/// A joint of a loop whose argument is no affine form.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct BentArgument {
    argument: usize,
    is_angle: bool,
}

impl BentArgument {
    /// Those of a mechanism; what may jump is left to rules of its own.
    pub fn all(mechanism: &Mechanism) -> Vec<Self> {
        let mut all = Vec::new();
        for step in mechanism.loops.iter().flat_map(|item| &item.chain.steps) {
            let ChainStep::Joint {
                motion, argument, ..
            } = step
            else {
                continue;
            };
            let found = Self {
                argument: *argument,
                is_angle: *motion == ElementaryMotion::Rotation,
            };
            let is_bent =
                matches!(&mechanism.arguments[*argument], Argument::Formula(f) if !f.has_jumps());
            if is_bent && !all.contains(&found) {
                all.push(found);
            }
        }
        all
    }

    /// Whether it goes too far between two places, or leaves the range between its values there.
    pub fn strays(self, mechanism: &Mechanism, ends: [&[f64]; 2], between: &[Interval]) -> bool {
        let Argument::Formula(formula) = &mechanism.arguments[self.argument] else {
            return false;
        };
        let (unit, farthest) = match self.is_angle {
            true => (1.0, FARTHEST_TURN),
            false => (mechanism.size, FARTHEST_SLIDE * mechanism.size),
        };
        let [a, b] = ends.map(|slots| formula.value(slots));
        let allowed =
            Interval::point(a).hull(Interval::point(b)) + Interval::around_zero(STRAY * unit);
        let range = formula.range(between);
        (b - a).abs() > farthest
            || range.is_some_and(|range| range.lo < allowed.lo || allowed.hi < range.hi)
    }
}
