//! Arguments of joints that are formulas of inputs alone, with kinks or jumps, as functions of the time: an indexing drive
//! `Rz(pi/2*floor(u))` jumps when its input passes a whole number.

use super::actuation::Actuation;
use super::chain::{Argument, ElementaryMotion};
use super::drive::{Drive, Ease};
use super::expression::continuity::Jumps;
use super::expression::{Expression, Op};
use super::mechanism::Mechanism;
use crate::numbers::constant::Constant;
use crate::sorting::sort_by_number;

/// Inputs with more keys than this are not followed piece by piece.
const MOST_PIECES: usize = 1000;

/// An argument as a function of the time.
#[derive(Clone, Debug)]
pub struct TimedArgument {
    /// Formulas of the time, each from its instant up to the next one's. The first one has no begin.
    pieces: Vec<(f64, Expression)>,
}

impl TimedArgument {
    /// Of every argument; `None` for those without kinks and jumps, and those that the inputs alone do not tell. An angle that jumps
    /// by whole turns does not jump.
    pub fn of_all(mechanism: &Mechanism, actuation: &Actuation) -> Vec<Option<Self>> {
        let first = mechanism.unknowns.len();
        let of = |(k, argument): (usize, &Argument)| {
            let Argument::Formula(formula) = argument else {
                return None;
            };
            let turns_on = || formula.turned().is_some() && only_turns(mechanism, k);
            let is_timed = formula.has_kinks() || (formula.has_jumps() && !turns_on());
            is_timed
                .then(|| Self::of_formula(formula, first, actuation))
                .flatten()
        };
        mechanism.arguments.iter().enumerate().map(of).collect()
    }

    fn of_formula(formula: &Expression, first: usize, actuation: &Actuation) -> Option<Self> {
        let slots = formula.slots();
        let drive = |slot: usize| actuation.drives.get(slot.checked_sub(first)?);
        let mut keys = vec![f64::NEG_INFINITY];
        for slot in &slots {
            keys.extend(drive(*slot)?.keys());
        }
        sort_by_number(&mut keys, |number| *number);
        keys.dedup();
        if keys.len() > MOST_PIECES {
            return None;
        }
        let pieces = keys.into_iter().map(|begin| {
            let inputs: Vec<Option<Expression>> = (0..first + actuation.drives.len())
                .map(|slot| drive(slot).filter(|_| slots.contains(&slot)))
                .map(|drive| Some(formula_from(drive?, begin)))
                .collect();
            let whole = formula.with_formulas(|slot| inputs.get(slot)?.as_ref())?;
            Some((begin, whole))
        });
        let pieces: Option<Vec<_>> = pieces.collect();
        pieces.map(|pieces| Self { pieces })
    }

    /// The formula of the time about an instant.
    pub fn piece(&self, time: f64) -> &Expression {
        let next = self.pieces.partition_point(|(begin, _)| *begin <= time);
        &self.pieces[next.saturating_sub(1)].1
    }

    /// The value at an instant, with all that jumps there.
    pub fn value(&self, time: f64) -> f64 {
        self.piece(time).value_at_instant(time)
    }

    /// Whether it may jump.
    pub fn may_jump(&self) -> bool {
        self.pieces.iter().any(|(_, formula)| formula.has_jumps())
    }

    /// Times strictly between two others at which it is not smooth, ascending.
    pub fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        let mut breaks = Vec::new();
        for (k, (begin, formula)) in self.pieces.iter().enumerate() {
            let end = self.pieces.get(k + 1).map_or(f64::INFINITY, |next| next.0);
            let (start, end) = (begin.max(from), end.min(to));
            if start < end {
                breaks.extend((from < *begin).then_some(*begin));
                breaks.extend(formula.breaks(start, end));
            }
        }
        breaks
    }

    /// Where it jumps between two instants without a key between them, both included.
    pub fn jumps_between(&self, from: f64, to: f64) -> Jumps {
        self.piece(0.5 * from + 0.5 * to).jumps_between(from, to)
    }
}

/// Whether an argument moves rotations only.
pub fn only_turns(mechanism: &Mechanism, argument: usize) -> bool {
    let bodies = mechanism.bodies.iter().map(|body| &body.world_from_body);
    let loops = mechanism.loops.iter().flat_map(|l| [&l.base, &l.chain]);
    let mut joints = bodies
        .chain(loops)
        .flat_map(|chain| chain.steps.iter().filter_map(|step| step.joint()));
    joints.all(|j| j.argument != argument || j.motion == ElementaryMotion::Rotation)
}

/// What a drive is from an instant up to its next key, as a formula of the time.
fn formula_from(drive: &Drive, begin: f64) -> Expression {
    let (times, values, ease) = match drive {
        Drive::Formula(formula) => return formula.clone(),
        Drive::Keys {
            times,
            values,
            ease,
        } => (times, values, *ease),
    };
    let value = |k: usize| values.get(k).map_or(0.0, |v| *v);
    let next = times.partition_point(|t| *t <= begin);
    let is_held = next == 0 || next == times.len() || ease == Ease::Step;
    let last = value(next.saturating_sub(1));
    if is_held || last == value(next) {
        return Expression::constant(Constant::rounded(last));
    }
    // How far the time is from one key to the next, and the value there.
    let [from, to] = [times[next - 1], times[next]].map(Constant::exact);
    let [a, b] = [last, value(next)].map(Constant::rounded);
    let mut ops = vec![
        Op::Slot(0),
        Op::Constant(from),
        Op::Subtract(0, 1),
        Op::Constant(to - from),
        Op::Divide(2, 3),
    ];
    let progress = add_progress(&mut ops, ease);
    let way = ops.len();
    ops.extend([
        Op::Constant(b - a),
        Op::Multiply(way, progress),
        Op::Constant(a),
        Op::Add(way + 2, way + 1),
    ]);
    Expression::new(ops)
}

/// Adds the progress of the value for the progress of the time, which is the last operation; its place.
fn add_progress(ops: &mut Vec<Op>, ease: Ease) -> usize {
    let s = ops.len() - 1;
    let number = |value: f64| Op::Constant(Constant::exact(value));
    match ease {
        Ease::Linear | Ease::Step => {}
        // s² (3 - 2 s)
        Ease::Smooth => ops.extend([
            Op::Multiply(s, s),
            number(2.0),
            Op::Multiply(s + 2, s),
            number(3.0),
            Op::Subtract(s + 4, s + 3),
            Op::Multiply(s + 1, s + 5),
        ]),
        // s² s (10 + s (6 s - 15))
        Ease::Smoother => ops.extend([
            Op::Multiply(s, s),
            Op::Multiply(s + 1, s),
            number(6.0),
            Op::Multiply(s + 3, s),
            number(15.0),
            Op::Subtract(s + 4, s + 5),
            Op::Multiply(s, s + 6),
            number(10.0),
            Op::Add(s + 8, s + 7),
            Op::Multiply(s + 2, s + 9),
        ]),
    }
    ops.len() - 1
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The formula of every piece is the drive there.
    #[test]
    fn keys_are_formulas_between_them() {
        for (_, ease) in Ease::NAMES {
            let drive = Drive::Keys {
                times: vec![0.3, 1.0, 1.7],
                values: vec![0.4, -1.1, 2.3],
                ease,
            };
            for (begin, end) in [(f64::NEG_INFINITY, 0.3), (0.3, 1.0), (1.0, 1.7), (1.7, 2.5)] {
                let formula = formula_from(&drive, begin);
                for share in [0.0, 0.2, 0.5, 0.99] {
                    let time = f64::max(begin, 0.0) * (1.0 - share) + end * share;
                    let off = formula.value_at_instant(time) - drive.value(time);
                    assert!(off.abs() < 1e-14, "{ease:?} at {time}: {off:e}");
                }
            }
        }
    }
}
