//! The inputs over a time interval as series.

use super::taylor_model::{TERMS, TaylorEnclosure, TaylorModel};
use crate::model::drive::Drive;
use crate::model::expression::Expression;
use crate::model::expression::jumps::Jump;
use crate::model::expression::pieces::around_instant;
use crate::numbers::interval::Interval;
use crate::sorting::sort_by_number;

/// A time interval, mapped to -1 to 1 in `s`.
#[derive(Clone, Copy, Debug)]
pub struct DriveInterval {
    /// Time at s = 0, seconds.
    pub middle: f64,
    /// Half the length, rounded up so that both ends are inside.
    pub half: f64,
    all: Interval,
    /// Where its piece of a drive begins and ends, to rounding.
    ends: [f64; 2],
}

impl DriveInterval {
    /// From `start` to `end`.
    pub fn new(start: f64, end: f64) -> Self {
        let middle = 0.5 * start + 0.5 * end;
        let half = (end - middle).max(middle - start).next_up();
        Self {
            middle,
            half,
            all: Interval::new(start, end),
            ends: [start, end],
        }
    }

    /// The position of a time in it.
    pub fn place(&self, time: f64) -> Interval {
        (Interval::point(time) - Interval::point(self.middle)) / Interval::point(self.half)
    }

    /// The same, extended a little if a drive jumps at its ends: a tube continues beyond the jump as far as its time is
    /// uncertain. `None` if the order of two jumping drives is undecided.
    /// `placed` are formulas of the time that place bodies and are no inputs.
    pub fn over_jumps(self, drives: &[Drive], placed: &[&Expression]) -> Option<Self> {
        let ends = self.ends;
        let mut jumping: [Option<Jump>; 2] = [None, None];
        let of_inputs = drives.iter().filter_map(|drive| match drive {
            Drive::Formula(formula) if formula.has_pieces() => Some(formula),
            _ => None,
        });
        for formula in of_inputs.chain(placed.iter().copied()) {
            let jumps = formula.piece(self.all, ends).jumps;
            for (known, jump) in jumping.iter_mut().zip(jumps) {
                match (&known, jump) {
                    // Two drives that jump by different formulas may jump one after the other.
                    (Some(other), Some(jump)) if !other.is_with(&jump) => return None,
                    (None, Some(jump)) => *known = Some(jump),
                    _ => {}
                }
            }
        }
        let mut over = ends;
        for (k, (end, jump)) in ends.iter().zip(&jumping).enumerate() {
            let Some(jump) = jump else {
                continue;
            };
            let about = around_instant(*end);
            let is_apart = |time: f64| !jump.is_at(time);
            if drives
                .iter()
                .any(|drive| drive.keys_in(about).any(is_apart))
            {
                return None;
            }
            over[k] = [about.lo, about.hi][k];
        }
        let [start, end] = over;
        Some(Self {
            ends,
            ..Self::new(start, end)
        })
    }

    /// An input over an interval without breaks inside, as a series about s = 0, and about every place at once.
    pub fn input(&self, drive: &Drive) -> [TaylorEnclosure; 2] {
        match drive {
            Drive::Formula(formula) if formula.has_pieces() => self.formula(formula),
            _ => self
                .clocks()
                .map(|time| drive.value_beside(time, self.middle)),
        }
    }

    /// The same of a formula of the time with kinks or jumps.
    pub fn formula(&self, formula: &Expression) -> [TaylorEnclosure; 2] {
        let piece = formula.piece(self.all, self.ends);
        self.clocks().map(|time| formula.on_piece(&piece, time))
    }

    /// The time about the middle, and about every place at once.
    fn clocks(&self) -> [TaylorEnclosure; 2] {
        let clock = |start| TaylorEnclosure::linear(start, Interval::point(self.half), TERMS - 1);
        [Interval::point(self.middle), self.all].map(clock)
    }
}

/// All values of a drive between two instants without a break between them; not finite where that is open.
pub fn input_range(drive: &Drive, start: f64, end: f64) -> Interval {
    let stretch = DriveInterval::new(start, end);
    match stretch.over_jumps(std::slice::from_ref(drive), &[]) {
        Some(over) => {
            let [middle, everywhere] = over.input(drive);
            TaylorModel::of(middle, &everywhere).range()
        }
        None => Interval::ENTIRE,
    }
}

/// Times strictly between two others at which a drive has no single series, ascending, without duplicates up to
/// rounding.
pub fn keys_between(drives: &[Drive], start: f64, end: f64) -> Vec<f64> {
    let breaks = |drive: &Drive| drive.breaks(start, end);
    distinct_between(drives.iter().flat_map(breaks).collect(), start, end)
}

/// Those of these times that are strictly between two others, ascending, without duplicates up to rounding.
pub fn distinct_between(mut keys: Vec<f64>, start: f64, end: f64) -> Vec<f64> {
    let [first, last] = [start, end].map(around_instant);
    keys.retain(|t| first.hi < *t && *t < last.lo);
    sort_by_number(&mut keys, |number| *number);
    keys.dedup_by(|b, a| *b <= around_instant(*a).hi);
    keys
}

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;
    use crate::model::drive::Ease;
    use crate::model::expression::{Function, Op};
    use crate::numbers::constant::Constant;

    /// t, then t + 1.3, and a function of both; `Floor` and `Mod` are smooth where the test looks.
    fn formula(function: Function) -> Expression {
        let arguments = match function {
            Function::Asin | Function::Acos => {
                vec![Op::Constant(Constant::rounded(0.3)), Op::Multiply(0, 1)]
            }
            Function::Floor => vec![Op::Constant(Constant::rounded(0.01)), Op::Multiply(0, 1)],
            _ => vec![Op::Constant(Constant::rounded(1.3)), Op::Add(0, 1)],
        };
        let (a, b) = if function.accepts(2) { (0, 2) } else { (2, 2) };
        let mut ops = vec![Op::Slot(0)];
        ops.extend(arguments);
        ops.push(Op::Call(function, a, b));
        Expression::new(ops)
    }

    fn drives() -> Vec<Drive> {
        let mut drives: Vec<Drive> = Function::ALL.map(|f| Drive::Formula(formula(f))).into();
        for ops in [
            vec![
                Op::Slot(0),
                Op::Constant(Constant::rounded(-3.0)),
                Op::Power(0, 1),
            ],
            vec![
                Op::Slot(0),
                Op::Constant(Constant::rounded(4.0)),
                Op::Power(0, 1),
            ],
            vec![
                Op::Slot(0),
                Op::Constant(Constant::rounded(0.7)),
                Op::Power(0, 1),
            ],
            vec![
                Op::Constant(Constant::rounded(0.7)),
                Op::Slot(0),
                Op::Power(0, 1),
            ],
            vec![
                Op::Slot(0),
                Op::Multiply(0, 0),
                Op::Divide(0, 1),
                Op::Negate(2),
            ],
        ] {
            drives.push(Drive::Formula(Expression::new(ops)));
        }
        for (_, ease) in Ease::NAMES {
            let (times, values) = (vec![0.1, 1.9], vec![-0.7, 1.1]);
            drives.push(Drive::Keys {
                times,
                values,
                ease,
            });
        }
        drives
    }

    /// Coefficients about any place of the stretch, computed in f64, lie within the enclosures; so does the value.
    #[test]
    fn enclosures_hold_what_f64_finds_at_every_place() {
        for drive in drives() {
            let stretch = DriveInterval::new(0.62, 0.64);
            let [middle, everywhere] = stretch.input(&drive);
            for share in [-1.0, -0.4, 0.0, 0.3, 1.0] {
                let time = (stretch.middle + share * stretch.half).clamp(0.62, 0.64);
                let numbers = drive.series(time, TERMS - 1);
                let mut scale = 1.0;
                for (k, c) in numbers.coefficients()[..TERMS].iter().enumerate() {
                    let (c, all) = (c * scale, everywhere.coefficients()[k]);
                    let slack = 1e-13 * (1e-3 + c.abs());
                    let holds = all.lo <= c + slack && c <= all.hi + slack;
                    assert!(holds, "{drive:?}: {k} {c} {all:?}");
                    if share == 0.0 {
                        let off = middle.coefficients()[k].distance(c);
                        assert!(off <= 10.0 * slack, "{drive:?}: {k} {off:e}");
                    }
                    scale *= stretch.half;
                }
                let whole = middle.with_remainder_of(&everywhere);
                let value = whole.value_at(stretch.place(time));
                let exact = drive.value(time);
                assert!(
                    value.lo <= exact && exact <= value.hi && value.distance(exact) < 1e-3,
                    "{drive:?}: {exact} {value:?}"
                );
            }
        }
    }

    #[test]
    fn keys_part_the_time() {
        let key = |times: &[f64]| Drive::Keys {
            times: times.to_vec(),
            values: vec![0.0; times.len()],
            ease: Ease::Linear,
        };
        let drives = [key(&[0.0, 1.0, 2.0, 3.0]), key(&[1.5, 2.0])];
        assert_eq!(keys_between(&drives, 0.0, 2.0), [1.0, 1.5]);
        assert_eq!(keys_between(&drives, 0.2, 2.5), [1.0, 1.5, 2.0]);
    }
}
