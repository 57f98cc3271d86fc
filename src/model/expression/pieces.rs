//! Formulas of time with kinks and jumps (abs, min, max, floor, mod, atan2): where their smooth pieces meet, and enclosures of
//! one piece.
//!
//! A kink is crossed on either of its sides, plus a bound on the difference. A jump cannot be crossed: a piece is the formula
//! up to the jump, extended beyond it by the uncertainty of its time.

use super::angle_cut::{cut_of, meets_cut, side_of_cut};
use super::instants::with_whole;
use super::jumps::{Jump, LineInTime, are_one, instant_of, line_of};
use super::kink_side::{KinkSide, kink_side};
use super::{Expression, Function, Op, apply_op};
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};
use crate::numbers::series::Series;
use std::f64::consts::PI;

/// Relative uncertainty of the time of a jump (at least of one second): much more than its rounding, much less than
/// intervals last. It depends on the time alone, so that the pieces on both sides use the same jumps.
const SLIVER: f64 = 1e-12;

/// Breaks are bisected down to this fraction of the time, or of a second, the resolution of f64.
const NARROWEST: f64 = 1e-13;

/// A break wider than this many narrowest parts is not at a single time.
const MOST_NARROW: f64 = 8.0;

/// Maximum number of parts examined together: beyond it the search for breaks ends.
const MOST_PARTS: usize = 10_000;

/// A formula of time over a stretch without jumps inside.
#[derive(Clone, Debug)]
pub struct TimePiece {
    pub(super) sides: Vec<KinkSide>,
    /// What jumps at the start, and at the end.
    pub jumps: [Option<Jump>; 2],
}

/// Values of all operations over a stretch, without its ends, and about its ends with their rates.
struct Ranges {
    /// It begins where the motion does.
    is_first: bool,
    all: Vec<Series<Interval, 1>>,
    core: Vec<Series<Interval, 1>>,
    ends: [Vec<Series<Interval, 2>>; 2],
}

/// The times about one, seconds, at which a jump may be that is looked for there.
pub fn around_instant(time: f64) -> Interval {
    let by = SLIVER * time.abs().max(1.0);
    Interval::new(time - by, time + by)
}

impl Expression {
    /// Whether it has functions with kinks or jumps.
    pub fn has_pieces(&self) -> bool {
        self.has_kinks() || self.ops().iter().any(|op| cut_of(*op).is_some())
    }

    /// The same but for angles, whose jumps by a whole turn are none of a joint that turns.
    pub fn has_kinks(&self) -> bool {
        self.ops().iter().any(|op| is_broken(*op))
    }

    /// The formula of time over `all`, as what it is between two `ends`, seconds.
    pub fn piece(&self, all: Interval, ends: [f64; 2]) -> TimePiece {
        let mut abouts = ends.map(around_instant);
        // Nothing is before the beginning.
        if ends[0] == 0.0 {
            abouts[0].lo = 0.0;
        }
        let core = match abouts[0].hi <= abouts[1].lo {
            true => Interval::new(abouts[0].hi, abouts[1].lo),
            false => Interval::point(0.5 * ends[0] + 0.5 * ends[1]),
        };
        let clocks = [all, core].map(Series::constant);
        let end_clocks = abouts.map(|about| Series::linear(about, Interval::ONE, 1));
        let canonical = self.canonical_operations();
        let mut r = Ranges {
            is_first: ends[0] == 0.0,
            all: Vec::new(),
            core: Vec::new(),
            ends: [Vec::new(), Vec::new()],
        };
        let mut jumps: [Option<(Op, Option<Constant>)>; 2] = [None; 2];
        let mut lines: Vec<Option<LineInTime>> = Vec::with_capacity(self.ops().len());
        let mut sides = Vec::with_capacity(self.ops().len());
        for (k, op) in self.ops().iter().enumerate() {
            let mut side = kink_side(*op, |a| value_range(&r.all, a));
            if let Some((whole, here)) = r.whole(*op) {
                let own = jumping(&canonical, k);
                // Whole numbers between which it jumps at either end.
                let passed = here.map(|passed| passed.map(|n| (own, instant_of(*op, &lines, n))));
                // Of two jumps about the same time, but not at one, it is not known which one comes first.
                let is_alone = |(jump, own): (&Option<(Op, _)>, &Option<(Op, _)>)| match (jump, own)
                {
                    (Some((other, at)), Some((own, time))) => other == own || are_one(*at, *time),
                    _ => true,
                };
                if jumps.iter().zip(&passed).all(is_alone) {
                    side = KinkSide::Whole(whole);
                    for (jump, own) in jumps.iter_mut().zip(passed) {
                        *jump = jump.or(own);
                    }
                }
            }
            r.all.push(within(*op, side, &r.all, clocks[0]));
            r.core.push(within(*op, side, &r.core, clocks[1]));
            for (values, clock) in r.ends.iter_mut().zip(end_clocks) {
                let value = within(*op, side, values, clock);
                values.push(value);
            }
            lines.push(line_of(*op, &lines, side.whole()));
            sides.push(side);
        }
        let with_operands = |(op, time): (Op, Option<Constant>)| Jump {
            of: operation_tree(&canonical, op),
            time,
        };
        TimePiece {
            sides,
            jumps: jumps.map(|jump| jump.map(with_operands)),
        }
    }

    /// The formula on a piece of it.
    pub fn on_piece<const N: usize>(
        &self,
        piece: &TimePiece,
        time: Series<Interval, N>,
    ) -> Series<Interval, N> {
        let mut values = Vec::with_capacity(self.ops().len());
        for (op, side) in self.ops().iter().zip(&piece.sides) {
            let value = on_side(*op, *side, &values, time);
            values.push(value);
        }
        values.pop().unwrap_or(Series::number(0.0))
    }

    /// Times between `from` and `to` where a kink or a jump is, to rounding, ascending. Where the formula has no value, or
    /// touches a kink without passing it, those between which that is so. Nothing is missed but what is too many.
    pub fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        if !self.has_pieces() {
            return Vec::new();
        }
        let narrowest = NARROWEST * from.abs().max(to.abs()).max(1.0);
        let is_open = |[a, b]: &[f64; 2]| self.is_open(Interval::new(*a, *b));
        let (mut parts, mut met) = (vec![[from, to]], Vec::new());
        parts.retain(is_open);
        // Bisection: halves on which the formula certainly has no kink or jump are dropped.
        loop {
            let width = parts.first().map_or(0.0, |[a, b]| b - a);
            if width <= narrowest || 2 * parts.len() > MOST_PARTS {
                break;
            }
            let mut open = Vec::with_capacity(2 * parts.len());
            for [a, b] in parts {
                let middle = 0.5 * a + 0.5 * b;
                let halves = [[a, middle], [middle, b]];
                let before = open.len();
                open.extend(halves.into_iter().filter(is_open));
                // Of two halves that meet at a kink neither has it inside.
                if open.len() == before {
                    let beside = [middle.next_down(), middle.next_up()];
                    self.add_changes(beside.map(|t| (t, self.jump_state(t))), &mut met);
                }
            }
            parts = open;
        }
        // What remains around one place is that break; a wider part, where the formula touches a kink, gives both of
        // its ends.
        let places = join_intervals(&parts).into_iter().flat_map(|[a, b]| {
            let is_one = b - a <= MOST_NARROW * narrowest;
            if is_one {
                self.changes(a, b)
            } else {
                vec![a, b]
            }
        });
        let inside = places.chain(met).filter(|t| from < *t && *t < to);
        let mut places: Vec<f64> = inside.collect();
        places.sort_by(f64::total_cmp);
        // The same place may be found as a middle, and beside it by the sides.
        places.dedup_by(|b, a| *b <= a.next_up());
        places
    }

    /// Whether some function may be on either side of a kink or a jump.
    fn is_open(&self, time: Interval) -> bool {
        let mut values: Vec<Series<Interval, 1>> = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            if cut_of(*op).is_some_and(|[y, x]| meets_cut([y, x].map(|k| value_range(&values, k))))
            {
                return true;
            }
            let side = match (
                step_argument(*op, &values),
                kink_side(*op, |a| value_range(&values, a)),
            ) {
                (Some(x), _) if x.lo.floor() == x.hi.floor() => KinkSide::Whole(x.lo.floor()),
                (Some(_), _) => return true,
                (None, KinkSide::Operand(_, _, off)) if off != Interval::ZERO => return true,
                (None, KinkSide::Plain) if is_broken(*op) => return true,
                (None, side) => side,
            };
            values.push(within(*op, side, &values, Series::constant(time)));
        }
        false
    }

    /// The numbers from `from` to `to` at which functions change their sides, each the first one on new sides; `to` if they are the
    /// same at both.
    fn changes(&self, from: f64, to: f64) -> Vec<f64> {
        let mut places = Vec::new();
        let ends = [from, to].map(|time| (time, self.jump_state(time)));
        self.add_changes(ends, &mut places);
        // A single number on sides of its own is one place.
        places.dedup_by(|b, a| *b == a.next_up());
        if places.is_empty() {
            places.push(to);
        }
        places
    }

    fn add_changes(&self, [low, high]: [(f64, Vec<f64>); 2], places: &mut Vec<f64>) {
        if low.1 == high.1 {
            return;
        }
        let middle = 0.5 * low.0 + 0.5 * high.0;
        if middle <= low.0 || middle >= high.0 {
            places.push(high.0);
            return;
        }
        let middle = (middle, self.jump_state(middle));
        self.add_changes([low, middle.clone()], places);
        self.add_changes([middle, high], places);
    }

    /// On which sides the functions are.
    fn jump_state(&self, time: f64) -> Vec<f64> {
        let mut values: Vec<f64> = Vec::with_capacity(self.ops().len());
        let mut state = Vec::new();
        for (op, whole) in self.ops().iter().zip(self.whole_numbers(time)) {
            if let Op::Call(function, a, b) = *op {
                let (x, y) = (values[a], values[b]);
                match function {
                    Function::Abs => state.push(f64::from(x < 0.0)),
                    Function::Min | Function::Max => state.push(f64::from(x < y)),
                    Function::Floor | Function::Mod => state.push(whole.unwrap_or(f64::INFINITY)),
                    Function::Atan2 => state.push(f64::from(x.is_sign_negative() && y < 0.0)),
                    _ => {}
                }
            }
            values.push(with_whole(*op, whole, &values, time));
        }
        state
    }

    /// Every operation, identified by the first one equal to it.
    fn canonical_operations(&self) -> Vec<Op> {
        let mut list: Vec<Op> = Vec::with_capacity(self.ops().len());
        let mut first: Vec<usize> = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            let own = op.mapped(|k| first[k]);
            let known = list.iter().position(|other| *other == own);
            first.push(known.unwrap_or(list.len()));
            list.push(own);
        }
        list
    }
}

/// A function that jumps, by what it jumps with: `floor(a/b)` does with `mod(a, b)`.
fn jumping(canonical: &[Op], k: usize) -> Op {
    match canonical[k] {
        Op::Call(Function::Floor, x, _) => match canonical[x] {
            Op::Divide(a, b) => Op::Call(Function::Mod, a, b),
            _ => canonical[k],
        },
        own => own,
    }
}

/// An operation with all that it is of, operands first: the same for the same written elsewhere.
fn operation_tree(ops: &[Op], root: Op) -> Vec<Op> {
    let (mut places, mut list) = (vec![None; ops.len()], Vec::new());
    let op = root.mapped(|operand| add_operation(ops, operand, &mut places, &mut list));
    list.push(op);
    list
}

/// Adds an operation once; its place.
fn add_operation(ops: &[Op], k: usize, places: &mut [Option<usize>], list: &mut Vec<Op>) -> usize {
    if let Some(known) = places[k] {
        return known;
    }
    let op = ops[k].mapped(|operand| add_operation(ops, operand, places, list));
    list.push(op);
    places[k] = Some(list.len() - 1);
    list.len() - 1
}

impl Ranges {
    /// The whole number that a jumping function gives between the ends, and which one its quotient passes at either end;
    /// `None` for other functions, and where that is open.
    fn whole(&self, op: Op) -> Option<(f64, [Option<f64>; 2])> {
        if let Some(operands) = cut_of(op) {
            let of = |values: &[Series<Interval, 1>]| operands.map(|k| value_range(values, k));
            let of_end =
                |values: &Vec<Series<Interval, 2>>| operands.map(|k| *values[k].coefficients());
            let ends = self.ends.each_ref().map(of_end);
            return side_of_cut(of(&self.core)[0], of(&self.all), ends, self.is_first);
        }
        let core = step_argument(op, &self.core)?;
        let whole = core.lo.floor();
        if core.hi.floor() != whole {
            return None;
        }
        let mut here = [None; 2];
        for (end, (here, values)) in here.iter_mut().zip(&self.ends).enumerate() {
            let series = match op {
                Op::Call(Function::Mod, a, b) => values[a] / values[b],
                Op::Call(_, a, _) => values[a],
                _ => return None,
            };
            let [value, rate] = *series.coefficients();
            if value.lo.floor() == whole && value.hi.floor() == whole {
                continue;
            }
            // What falls from a whole number at the very beginning is below it at all later times.
            let falls = value.hi <= whole + 1.0 && rate.hi < 0.0;
            if end == 0 && self.is_first && falls && value.lo.floor() == whole {
                continue;
            }
            // It passes one whole number, and once, though it may rest there.
            let is_one = value.hi.floor() - value.lo.floor() == 1.0;
            let is_next = value.lo.floor() == whole || value.hi.floor() == whole;
            let is_once = rate.is_finite() && (rate.lo >= 0.0 || rate.hi <= 0.0);
            if !is_one || !is_next || !is_once {
                return None;
            }
            *here = Some(value.hi.floor());
        }
        Some((whole, here))
    }
}

fn is_broken(op: Op) -> bool {
    use Function::{Abs, Floor, Max, Min, Mod};
    matches!(op, Op::Call(Abs | Min | Max | Floor | Mod, ..))
}

/// What a jumping function takes the floor of.
fn step_argument(op: Op, values: &[Series<Interval, 1>]) -> Option<Interval> {
    match op {
        Op::Call(Function::Floor, a, _) => Some(value_range(values, a)),
        Op::Call(Function::Mod, a, b) => Some(value_range(values, a) / value_range(values, b)),
        _ => None,
    }
}

fn value_range(values: &[Series<Interval, 1>], k: usize) -> Interval {
    values[k].coefficients()[0]
}

fn on_side<const N: usize>(
    op: Op,
    side: KinkSide,
    values: &[Series<Interval, N>],
    time: Series<Interval, N>,
) -> Series<Interval, N> {
    match (op, side) {
        // What is off must itself go on: a pole or a cut on the other side would be a jump.
        (Op::Call(Function::Min | Function::Max, a, b), KinkSide::Operand(_, _, off))
            if off != Interval::ZERO && !(values[a].is_finite() && values[b].is_finite()) =>
        {
            Series::undefined()
        }
        (_, KinkSide::Operand(k, is_negated, off)) => {
            let value = if is_negated { -values[k] } else { values[k] };
            value + Series::constant(off)
        }
        (Op::Call(Function::Mod, a, b), KinkSide::Whole(n)) => values[a] - values[b].scale(n),
        (Op::Call(Function::Atan2, y, x), KinkSide::Whole(n)) => {
            let half = Interval::new(PI, PI.next_up());
            (-values[y]).atan2(-values[x]) + Series::constant(half * Interval::point(1.0 - 2.0 * n))
        }
        (_, KinkSide::Whole(n)) => Series::number(n),
        _ => apply_op(op, values, &[time]),
    }
}

/// All values that an operation may have, and all its rates: about a kink those of both sides.
pub(super) fn within<const N: usize>(
    op: Op,
    side: KinkSide,
    values: &[Series<Interval, N>],
    time: Series<Interval, N>,
) -> Series<Interval, N> {
    match op {
        Op::Call(Function::Abs, a, _) => {
            let mut size = greater(values[a], -values[a]);
            let Interval { lo, hi } = size.coefficients()[0];
            // What may have no value is no magnitude.
            if values[a].is_finite() {
                size.set(0, Interval::new(lo.max(0.0), hi));
            }
            size
        }
        Op::Call(Function::Max, a, b) => greater(values[a], values[b]),
        Op::Call(Function::Min, a, b) => -greater(-values[a], -values[b]),
        _ => on_side(op, side, values, time),
    }
}

/// The greater one of two values, with the rates that it may have.
fn greater<const N: usize>(a: Series<Interval, N>, b: Series<Interval, N>) -> Series<Interval, N> {
    let ([x, y], length) = ([a.coefficients()[0], b.coefficients()[0]], N - 1);
    if !x.is_finite() || !y.is_finite() {
        return Series::constant(Interval::ENTIRE);
    }
    if x.lo >= y.hi {
        return a;
    }
    if y.lo >= x.hi {
        return b;
    }
    let value = Interval::new(x.lo.max(y.lo), x.hi.max(y.hi));
    let rate = match (a.coefficients().get(1), b.coefficients().get(1)) {
        (Some(p), Some(q)) => Interval::new(p.lo.min(q.lo), p.hi.max(q.hi)),
        _ => Interval::ZERO,
    };
    Series::linear(value, rate, length)
}

/// Parts side by side as one.
fn join_intervals(parts: &[[f64; 2]]) -> Vec<[f64; 2]> {
    let mut list: Vec<[f64; 2]> = Vec::new();
    for part in parts {
        match list.last_mut() {
            Some(last) if last[1] == part[0] => last[1] = part[1],
            _ => list.push(*part),
        }
    }
    list
}
