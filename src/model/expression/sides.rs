//! A formula on either side of its jumps: every operation with the whole numbers of one side, and the difference to the value
//! on the other side.
//!
//! The difference is exactly zero where nothing in an operation jumps, so that a tiny jump is not lost in a large value.

use super::instants::quotient_of;
use super::{Expression, Function, Op, ZERO, apply_op};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;

/// The whole number of every operation on one side of an instant; `None` if it has none, or if it is unknown.
pub(super) type Side = Vec<Option<f64>>;

/// A value on one side, and its increase to the other.
#[derive(Clone, Copy)]
pub(super) struct Step {
    /// The value on one side.
    pub here: Constant,
    /// Its increase to the other side.
    pub more: Constant,
}

impl Step {
    fn there(self) -> Constant {
        match self.more == ZERO {
            true => self.here,
            false => self.here + self.more,
        }
    }
}

impl Expression {
    /// All operations with the whole numbers of one side, and their increases to the other.
    pub(super) fn steps(&self, sides: [&Side; 2], slots: &[Constant]) -> Vec<Step> {
        let mut steps: Vec<Step> = Vec::with_capacity(self.ops().len());
        for (k, op) in self.ops().iter().enumerate() {
            let step = stepped(*op, [sides[0][k], sides[1][k]], &steps, slots);
            steps.push(step);
        }
        steps
    }

    /// The jump of a formula between two nearby points, evaluated at each of them; `None` if nothing
    /// in it jumps between them.
    pub fn jump_on_way(&self, from: &[f64], to: &[f64]) -> Option<[Constant; 2]> {
        let places = [from, to];
        let values = places.map(|slots| {
            let mut values = Vec::with_capacity(self.ops().len());
            self.value_with(slots, &mut values);
            values
        });
        // The whole numbers of ⌊⌋ and mod, and the half-plane of every `atan2`, at both places.
        let mut sides = [Side::new(), Side::new()];
        for op in self.ops() {
            let wholes = match *op {
                Op::Call(Function::Atan2, y, x) => {
                    let is_left = values.iter().all(|v| v[x] < 0.0);
                    values
                        .each_ref()
                        .map(|v| is_left.then(|| f64::from(v[y] < 0.0)))
                }
                op => values
                    .each_ref()
                    .map(|v| quotient_of(op, v).map(f64::floor)),
            };
            for (side, whole) in sides.iter_mut().zip(wholes) {
                side.push(whole);
            }
        }
        if sides[0] == sides[1] {
            return None;
        }
        // The two sides evaluated at the same place: their difference is the jump.
        let jump = |slots: &[f64]| {
            let slots: Vec<Constant> = slots.iter().map(|v| Constant::exact(*v)).collect();
            let steps = self.steps([&sides[0], &sides[1]], &slots);
            steps.last().map_or(ZERO, |last| last.more)
        };
        Some(places.map(jump))
    }

    /// Whether it may jump where it has a value: whole numbers, and the cut of `atan2`.
    pub fn has_jumps(&self) -> bool {
        let is_cut = |op: &Op| matches!(op, Op::Call(Function::Atan2, ..));
        self.ops().iter().any(|op| takes_whole(*op) || is_cut(op))
    }
}

/// Whether it takes a whole number of its operands.
pub(super) fn takes_whole(op: Op) -> bool {
    matches!(op, Op::Call(Function::Floor | Function::Mod, ..))
}

/// A value with the whole number of one side. About a kink it is that of either of its sides, which is no farther from it than
/// what is unknown of its operands.
pub(super) fn on_one_side(
    op: Op,
    whole: Option<f64>,
    values: &[Constant],
    slots: &[Constant],
) -> Constant {
    let flip = |a: Constant| if a.number() < 0.0 { -a } else { a };
    // With the whole number given, floor and mod have no jump, and `atan2` differs from its value by whole turns.
    match (op, whole) {
        (Op::Call(Function::Floor, ..), Some(whole)) => Constant::exact(whole),
        (Op::Call(Function::Mod, a, b), Some(whole)) => {
            values[a] - values[b] * Constant::exact(whole)
        }
        (Op::Call(Function::Atan2, y, _), Some(whole)) => {
            let turns = f64::from(values[y].number() < 0.0) - whole;
            apply_op(op, values, slots) + Constant::PI * Constant::exact(2.0 * turns)
        }
        (Op::Call(Function::Abs, a, _), _) => flip(values[a]),
        (Op::Call(Function::Min, a, b), _) => lesser(values[a], values[b]),
        (Op::Call(Function::Max, a, b), _) => -lesser(-values[a], -values[b]),
        _ => apply_op(op, values, slots),
    }
}

fn lesser(a: Constant, b: Constant) -> Constant {
    let (less, other) = if a.number() <= b.number() {
        (a, b)
    } else {
        (b, a)
    };
    less + Constant::within(0.0, (other.error() - less.error()).max(0.0))
}

/// An operation with the whole numbers that it has on either side.
fn stepped(op: Op, wholes: [Option<f64>; 2], steps: &[Step], slots: &[Constant]) -> Step {
    let side = |pick: fn(Step) -> Constant, whole: Option<f64>| {
        let values: Vec<Constant> = steps.iter().map(|step| pick(*step)).collect();
        on_one_side(op, whole, &values, slots)
    };
    let here = side(|step| step.here, wholes[0]);
    let apart = || side(Step::there, wholes[1]) - here;
    let times = |more: Constant, by: Constant| match more == ZERO {
        true => ZERO,
        false => more * by,
    };
    let is_still = |k: usize| steps[k].more == ZERO;
    let more = match op {
        Op::Constant(_) | Op::Slot(_) => ZERO,
        Op::Negate(a) => -steps[a].more,
        Op::Add(a, b) => steps[a].more + steps[b].more,
        Op::Subtract(a, b) => steps[a].more - steps[b].more,
        Op::Multiply(a, b) => {
            times(steps[a].more, steps[b].there()) + times(steps[b].more, steps[a].here)
        }
        Op::Divide(a, b) if is_still(b) && !is_still(a) => steps[a].more / steps[b].here,
        Op::Divide(a, b) | Op::Power(a, b) if is_still(a) && is_still(b) => ZERO,
        Op::Divide(..) | Op::Power(..) => apart(),
        Op::Call(Function::Floor, ..) => match wholes {
            [Some(p), Some(q)] => Constant::exact(q - p),
            _ => Constant::exact(f64::NAN),
        },
        Op::Call(Function::Mod, a, b) => match wholes {
            // Where the quotient passes a whole number the remainder is zero on one side, and the divisor on the other.
            [Some(p), Some(q)] if is_still(a) && is_still(b) => match p == q {
                true => ZERO,
                false => -steps[b].here * Constant::exact(q - p),
            },
            _ => apart(),
        },
        Op::Call(Function::Atan2, ..) if wholes[0] != wholes[1] => match wholes {
            // From above the cut to below it the angle loses a turn.
            [Some(p), Some(q)] => Constant::PI * Constant::exact(2.0 * (p - q)),
            _ => Constant::exact(f64::NAN),
        },
        Op::Call(_, a, b) if is_still(a) && is_still(b) => ZERO,
        Op::Call(Function::Abs, a, _) => {
            let signs = [steps[a].here, steps[a].there()].map(Scalar::is_below_zero);
            match signs {
                [Some(false), Some(false)] => steps[a].more,
                [Some(true), Some(true)] => -steps[a].more,
                _ => apart(),
            }
        }
        Op::Call(..) => apart(),
    };
    let passes = match (op, wholes) {
        (Op::Call(Function::Mod, a, b), [Some(p), Some(q)]) if p != q => {
            (is_still(a) && is_still(b) && (q - p).abs() == 1.0).then_some((p < q, steps[b].here))
        }
        _ => None,
    };
    let here = match passes {
        Some((true, divisor)) => divisor,
        Some((false, _)) => ZERO,
        None => here,
    };
    Step { here, more }
}
