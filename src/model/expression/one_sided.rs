//! Operations on one side of an instant: values with the whole numbers that hold there, and what the other side is more.

use super::{Function, Op, ZERO, apply_op};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;

/// A value on one side, and what it is more on the other.
#[derive(Clone, Copy)]
pub(super) struct Step {
    pub(super) here: Constant,
    pub(super) more: Constant,
}

impl Step {
    pub(super) fn there(self) -> Constant {
        match self.more == ZERO {
            true => self.here,
            false => self.here + self.more,
        }
    }
}

/// Whether a function takes the whole number of something.
pub(super) fn takes_whole(op: Op) -> bool {
    matches!(op, Op::Call(Function::Floor | Function::Mod, ..))
}

/// What a function takes the whole number of.
pub(super) fn quotient_of<S: Scalar>(op: Op, values: &[S]) -> Option<S> {
    match op {
        Op::Call(Function::Floor, a, _) => Some(values[a]),
        Op::Call(Function::Mod, a, b) => Some(values[a] / values[b]),
        _ => None,
    }
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
pub(super) fn step_of(
    op: Op,
    wholes: [Option<f64>; 2],
    steps: &[Step],
    slots: &[Constant],
) -> Step {
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
