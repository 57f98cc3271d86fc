//! Whether a formula of time is continuous at an instant: its limits on both sides are compared.
//!
//! The size of a change is no criterion. `t + 1e-9*floor(t)` jumps; `floor(t)*(t - 1)` does not at 1 s, nor does the wave
//! `abs(mod(t, 2) - 1)`.

use super::angle_cut::cut_of;
use super::instants::{quotient_of, with_whole};
use super::jumps::{KNOWN, LineInTime, instant_of, line_of};
use super::pieces::{TimePiece, around_instant, within};
use super::sides::{SideNumbers, on_one_side, takes_whole};
use super::{Expression, Op, ZERO};
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::Series;
use crate::sorting::sort_by_number;

/// Newton steps that refine the time of a jump from f64 to all digits.
const STEPS: usize = 3;

/// Where an input jumps in a time interval, or where it may jump.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Jumps {
    /// Right after the start: the limit from the right differs from the value there.
    pub at_start: bool,
    /// The first one between start and end, seconds.
    pub inside: Option<f64>,
    /// To the value at the end.
    pub at_end: bool,
}

impl Jumps {
    /// Whether there is one.
    pub fn is_any(&self) -> bool {
        self.at_start || self.at_end || self.inside.is_some()
    }

    /// Those of two inputs.
    pub fn and(self, other: Self) -> Self {
        let inside = [self.inside, other.inside].into_iter().flatten();
        Self {
            at_start: self.at_start || other.at_start,
            inside: inside.min_by(f64::total_cmp),
            at_end: self.at_end || other.at_end,
        }
    }
}

impl Expression {
    /// Where it jumps from the instant `from` to the instant `to`, both included.
    pub fn jumps_between(&self, from: f64, to: f64) -> Jumps {
        let mut jumps = Jumps::default();
        if !self.has_jumps() || from >= to {
            return jumps;
        }
        let mut stops = self.breaks(from, to);
        // What is at the ends but for rounding is at the ends. A single instant may have a value of its own there, too.
        let [first, last] = [from, to].map(around_instant);
        let beside = |end: f64| {
            let near = stops.iter().copied().chain([end]);
            let about = around_instant(end);
            let near = near.filter(|t| about.lo <= *t && *t <= about.hi);
            let all = near.flat_map(|t| [t.next_down(), t, t.next_up()]);
            let mut all: Vec<f64> = all.filter(|t| from <= *t && *t <= to).collect();
            sort_by_number(&mut all, |number| *number);
            all
        };
        let [starts, ends] = [from, to].map(beside);
        stops.retain(|t| first.hi < *t && *t < last.lo);
        stops.dedup_by(|b, a| *b <= around_instant(*a).hi);
        stops.insert(0, from);
        stops.push(to);
        let pieces = stops.windows(2).map(|ends| {
            let all = Interval::new(ends[0], ends[1]);
            self.piece(all, [ends[0], ends[1]])
        });
        let pieces: Vec<TimePiece> = pieces.collect();
        let sides: Vec<SideNumbers> = (pieces.iter())
            .map(|piece| piece.sides.iter().map(|side| side.whole()).collect())
            .collect();
        let at = |time: f64| self.side_at(time);
        let start: Vec<SideNumbers> = starts.into_iter().map(at).collect();
        let way = [&start, &sides[..1]].concat();
        jumps.at_start = self.may_differ(&pieces[0], &way, from);
        for (k, time) in stops[1..stops.len() - 1].iter().enumerate() {
            let here = [time.next_down(), *time, time.next_up()].map(at);
            let way = [&sides[k..=k], &here, &sides[k + 1..k + 2]].concat();
            if self.may_differ(&pieces[k], &way, *time) {
                jumps.inside = Some(*time);
                break;
            }
        }
        let last = pieces.len() - 1;
        let end: Vec<SideNumbers> = ends.into_iter().map(at).collect();
        let way = [&sides[last..], &end].concat();
        jumps.at_end = self.may_differ(&pieces[last], &way, to);
        jumps
    }

    /// Whether the values with the whole numbers of neighbouring sides of an instant, at an end of a piece, are not known to be
    /// the same.
    fn may_differ(&self, piece: &TimePiece, sides: &[SideNumbers], about: f64) -> bool {
        let differs = |pair: &[SideNumbers]| self.may_step(piece, [&pair[0], &pair[1]], about);
        sides.windows(2).any(differs)
    }

    fn may_step(&self, piece: &TimePiece, sides: [&SideNumbers; 2], about: f64) -> bool {
        let mut instant = None;
        for (k, op) in self.ops().iter().enumerate() {
            let is_angle = cut_of(*op).is_some();
            match (sides[0][k], sides[1][k]) {
                _ if !is_angle && !takes_whole(*op) => {}
                (Some(a), Some(b)) if a == b => {}
                // An angle jumps where y comes to zero.
                (Some(_), Some(_)) if is_angle => instant = instant.or(Some((k, 0.0))),
                (Some(a), Some(b)) => instant = instant.or(Some((k, a.max(b)))),
                // On a piece where the angle does not reach its cut, it has no side.
                _ if is_angle => {}
                _ => return true,
            }
        }
        let Some((jumping, passed)) = instant else {
            return false;
        };
        let time = self.instant(piece, jumping, passed, about);
        let steps = self.steps(sides, &[time]);
        let more = steps.last().map_or(ZERO, |last| last.more);
        let sizes = steps.iter().map(|step| step.here.number().abs());
        let size = sizes.filter(|size| size.is_finite()).fold(1.0, f64::max);
        let is_same = more.number().abs() <= more.error() && more.error() <= KNOWN * size;
        more != ZERO && !is_same
    }

    /// The whole numbers at an instant, and the sides of cuts.
    fn side_at(&self, time: f64) -> SideNumbers {
        let mut side = self.whole_numbers(time);
        let mut values: Vec<f64> = Vec::with_capacity(self.ops().len());
        for (op, whole) in self.ops().iter().zip(&mut side) {
            if let Some([y, x]) = cut_of(*op) {
                let is_left = values[x] < 0.0;
                *whole = is_left.then(|| f64::from(values[y].is_sign_negative()));
            }
            let value = with_whole(*op, *whole, &values, time);
            values.push(value);
        }
        side
    }

    /// When the quotient of an operation comes to a whole number, about a place that is known in f64.
    fn instant(&self, piece: &TimePiece, jumping: usize, passed: f64, about: f64) -> Constant {
        let whole = |k: usize| piece.sides[k].whole();
        let mut lines: Vec<Option<LineInTime>> = Vec::with_capacity(jumping);
        for (k, op) in self.ops()[..jumping].iter().enumerate() {
            lines.push(line_of(*op, &lines, whole(k)));
        }
        if let Some(time) = instant_of(self.ops()[jumping], &lines, passed) {
            return time;
        }
        // Newton's method, with a bound of the slope about the place.
        let around = around_instant(about);
        let mut rates: Vec<Series<Interval, 2>> = Vec::with_capacity(jumping);
        for (op, side) in self.ops()[..jumping].iter().zip(&piece.sides) {
            let clock = Series::linear(around, Interval::ONE, 1);
            rates.push(within(*op, *side, &rates, clock));
        }
        let slope = crossing_of(self.ops()[jumping], &rates).map(|q| q.coefficients()[1]);
        let unknown = Constant::within(about, around.hi - about);
        let Some(slope) = slope.filter(|s| s.is_finite() && !s.holds_zero()) else {
            return unknown;
        };
        let off = |time: Constant| {
            let mut values: Vec<Constant> = Vec::with_capacity(jumping);
            for (k, op) in self.ops()[..jumping].iter().enumerate() {
                values.push(on_one_side(*op, whole(k), &values, &[time]));
            }
            crossing_of(self.ops()[jumping], &values).map(|q| q - Constant::exact(passed))
        };
        let mut time = Constant::exact(about);
        for _ in 0..STEPS {
            let Some(off) = off(time).filter(|off| off.is_finite()) else {
                return unknown;
            };
            let step = off / Constant::exact(slope.middle());
            time = without_error(time - step);
        }
        let least = slope.lo.abs().min(slope.hi.abs());
        match off(without_error(time)) {
            Some(off) if off.is_finite() => {
                let radius = off.largest() / least * GROW;
                without_error(time) + Constant::within(0.0, radius)
            }
            _ => unknown,
        }
    }
}

/// What comes to a whole number where an operation jumps.
fn crossing_of<S: Scalar>(op: Op, values: &[S]) -> Option<S> {
    match cut_of(op) {
        Some([y, _]) => Some(values[y]),
        None => quotient_of(op, values),
    }
}

fn without_error(value: Constant) -> Constant {
    let digits = value.value();
    Constant::exact(digits.hi) + Constant::exact(digits.lo)
}

#[cfg(test)]
mod tests {
    use super::super::Function;
    use super::*;
    const T: Op = Op::Slot(0);

    fn number(value: f64) -> Op {
        Op::Constant(Constant::exact(value))
    }

    const FLOOR: Function = Function::Floor;
    const MOD: Function = Function::Mod;

    /// Formulas, and whether they jump at 1 s.
    fn cases() -> Vec<(&'static str, Vec<Op>, bool)> {
        let floor = |k: usize| Op::Call(FLOOR, k, k);
        vec![
            ("floor(t)", vec![T, floor(0)], true),
            (
                "t + 1e-40*floor(t)",
                vec![
                    T,
                    floor(0),
                    number(1e-40),
                    Op::Multiply(1, 2),
                    Op::Add(0, 3),
                ],
                true,
            ),
            (
                "floor(t)*(t-1)",
                vec![
                    T,
                    floor(0),
                    number(1.0),
                    Op::Subtract(0, 2),
                    Op::Multiply(1, 3),
                ],
                false,
            ),
            (
                "floor(t)*(t-1.0000001)",
                vec![
                    T,
                    floor(0),
                    number(1.000_000_1),
                    Op::Subtract(0, 2),
                    Op::Multiply(1, 3),
                ],
                true,
            ),
            (
                "abs(mod(t,1)-0.5)",
                vec![
                    T,
                    number(1.0),
                    Op::Call(MOD, 0, 1),
                    number(0.5),
                    Op::Subtract(2, 3),
                    Op::Call(Function::Abs, 4, 4),
                ],
                false,
            ),
            (
                "abs(mod(t,1)-0.4999999999999)",
                vec![
                    T,
                    number(1.0),
                    Op::Call(MOD, 0, 1),
                    number(0.499_999_999_999_9),
                    Op::Subtract(2, 3),
                    Op::Call(Function::Abs, 4, 4),
                ],
                true,
            ),
            (
                "t - floor(t) - mod(t,1)",
                vec![
                    T,
                    floor(0),
                    number(1.0),
                    Op::Call(MOD, 0, 2),
                    Op::Subtract(0, 1),
                    Op::Subtract(4, 3),
                ],
                false,
            ),
            // At 1 s itself it is zero, on both sides -1.
            (
                "floor(t) + floor(-t)",
                vec![T, floor(0), Op::Negate(0), floor(2), Op::Add(1, 3)],
                true,
            ),
            // The square root of two is no number of f64.
            (
                "floor(2*t^2)*(t^2-1)",
                vec![
                    T,
                    Op::Multiply(0, 0),
                    number(2.0),
                    Op::Multiply(1, 2),
                    floor(3),
                    number(1.0),
                    Op::Subtract(1, 5),
                    Op::Multiply(4, 6),
                ],
                false,
            ),
        ]
    }

    #[test]
    fn jumps_are_told_from_kinks_by_both_sides() {
        for (name, ops, jumps) in cases() {
            let formula = Expression::new(ops);
            let found = formula.jumps_between(0.8, 1.2);
            assert_eq!(found.inside.is_some(), jumps, "{name}: {found:?}");
            assert!(!found.at_start && !found.at_end, "{name}: {found:?}");
            assert!(
                found.inside.is_none_or(|t| (t - 1.0).abs() < 1e-9),
                "{name}"
            );
            let up_to = formula.jumps_between(0.8, 1.0);
            let after = formula.jumps_between(1.0, 1.2);
            assert_eq!(
                up_to.at_end || after.at_start,
                jumps,
                "{name}: {up_to:?} {after:?}"
            );
            assert!(!up_to.at_start && !after.at_end, "{name}");
            assert_eq!((up_to.inside, after.inside), (None, None), "{name}");
        }
    }
}
