//! A formula on either side of its jumps: every operation with the whole numbers of one side, and the difference to the value
//! on the other side.
//!
//! The difference is exactly zero where nothing in an operation jumps, so that a tiny jump is not lost in a large value.

use super::angle_cut::cut_of;
use super::instants::quotient_of;
use super::{Expression, Function, Op, ZERO, apply_op};
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// A quotient this close to a jump, relative to itself or to one, may reach it by rounding alone: a clamped quotient stays
/// there.
const NEAR_JUMP: f64 = 1e-12;

/// The behaviour of a formula on the straight line between two points.
#[derive(Clone, Copy, Debug)]
pub enum WayJump {
    /// It jumps by this much, evaluated at the first and at the second point.
    By([Constant; 2]),
    /// It may jump and jump back; only a shorter line decides.
    Open,
}

/// The whole number of every operation on one side of an instant; `None` if it has none, or if it is unknown.
pub(super) type SideNumbers = Vec<Option<f64>>;

/// A value on one side, and its increase to the other.
#[derive(Clone, Copy)]
pub(super) struct JumpStep {
    /// The value on one side.
    pub here: Constant,
    /// Its increase to the other side.
    pub more: Constant,
}

impl JumpStep {
    fn there(self) -> Constant {
        match self.more == ZERO {
            true => self.here,
            false => self.here + self.more,
        }
    }
}

impl Expression {
    /// All operations with the whole numbers of one side, and their increases to the other.
    pub(super) fn steps(&self, sides: [&SideNumbers; 2], slots: &[Constant]) -> Vec<JumpStep> {
        let mut steps: Vec<JumpStep> = Vec::with_capacity(self.ops().len());
        for (k, op) in self.ops().iter().enumerate() {
            let step = stepped(*op, [sides[0][k], sides[1][k]], &steps, slots);
            steps.push(step);
        }
        steps
    }

    /// The jump of a formula on the straight line between two points, evaluated at each of them; `None` if nothing in it jumps.
    pub fn jump_on_way(&self, from: &[f64], to: &[f64]) -> Option<WayJump> {
        let places = [from, to];
        let sides = places.map(|slots| self.side_of(slots, places));
        if sides[0] == sides[1] {
            return self
                .may_jump_within(places, &sides[0])
                .then_some(WayJump::Open);
        }
        // The two sides evaluated at the same place: their difference is the jump.
        let jump = |slots: &[f64]| {
            let slots: Vec<Constant> = slots.iter().map(|v| Constant::exact(*v)).collect();
            let steps = self.steps([&sides[0], &sides[1]], &slots);
            steps.last().map_or(ZERO, |last| last.more)
        };
        let changed = sides[0].iter().zip(&sides[1]).filter(|(a, b)| a != b);
        // Two that jump may cancel here, and yet jump at different places.
        let sizes = places.map(jump);
        let cancel = sizes.iter().any(|size| size.number().abs() <= size.error());
        Some(match changed.count() > 1 && cancel {
            true => WayJump::Open,
            false => WayJump::By(sizes),
        })
    }

    /// The whole numbers and the sides of cuts at a place on the way between two.
    fn side_of(&self, slots: &[f64], ends: [&[f64]; 2]) -> SideNumbers {
        let values = |slots: &[f64]| {
            let mut values = Vec::with_capacity(self.ops().len());
            self.value_with(slots, &mut values);
            values
        };
        let (here, ends) = (values(slots), ends.map(values));
        let side = self.ops().iter().map(|op| match cut_of(*op) {
            Some([y, x]) => {
                let is_left = ends.iter().all(|v| v[x] < 0.0);
                is_left.then(|| f64::from(here[y] < 0.0))
            }
            None => quotient_of(*op, &here).map(f64::floor),
        });
        side.collect()
    }

    /// Whether something may jump between two places at which it has the same side, by more than rounding: over the box that
    /// they span.
    fn may_jump_within(&self, [from, to]: [&[f64]; 2], side: &SideNumbers) -> bool {
        let ends = from.iter().zip(to);
        let all: Vec<Interval> = ends
            .map(|(a, b)| Interval::new(a.min(*b), a.max(*b)))
            .collect();
        let mut values = Vec::with_capacity(self.ops().len());
        self.value_with(&all, &mut values);
        let mut ops = self.ops().iter().zip(side);
        ops.any(|(op, side)| match (cut_of(*op), side) {
            (Some([y, x]), Some(below)) => {
                let rounding = NEAR_JUMP * values[y].magnitude();
                let passes = match *below > 0.0 {
                    true => values[y].hi > rounding,
                    false => values[y].lo < -rounding,
                };
                passes && values[x].lo < 0.0
            }
            (None, Some(whole)) => quotient_of(*op, &values).is_some_and(|quotient| {
                let rounding = NEAR_JUMP * quotient.magnitude().max(1.0);
                quotient.lo < whole - rounding || quotient.hi >= whole + 1.0 + rounding
            }),
            _ => false,
        })
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
fn stepped(op: Op, wholes: [Option<f64>; 2], steps: &[JumpStep], slots: &[Constant]) -> JumpStep {
    let side = |pick: fn(JumpStep) -> Constant, whole: Option<f64>| {
        let values: Vec<Constant> = steps.iter().map(|step| pick(*step)).collect();
        on_one_side(op, whole, &values, slots)
    };
    let here = side(|step| step.here, wholes[0]);
    let apart = || side(JumpStep::there, wholes[1]) - here;
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
    JumpStep { here, more }
}
