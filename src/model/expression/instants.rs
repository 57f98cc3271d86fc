//! A formula of time at one instant: on which side of its jumps the instant lies, with more digits than f64 has.
//!
//! A time is an f64 and represents all instants that round to it: if one of them is the instant of a jump, the time counts as
//! that of the jump. So everything that jumps at 0.3 s has jumped at the time 0.3, although 0.3/0.1 < 3 in f64, and no two
//! formulas that jump together are ever evaluated on different sides.

use super::{Expression, Function, Op, apply_op};
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;
use smallvec::SmallVec;

/// A number this close to a whole one, relative to itself or to one, is evaluated with more digits: rounding in f64 is far
/// smaller, and unnecessary digits only cost time.
const NEAR_WHOLE: f64 = 1e-6;

/// Number of operations of a drive up to which its evaluation, at every step of a motion, needs no heap memory.
const FEW: usize = 16;

/// For every operation with jumps its whole number, if it is known: the value of a floor, the quotient of a mod.
pub(super) type WholeNumbers = Vec<Option<f64>>;

impl Expression {
    /// The value of a formula of time at an instant, seconds; not finite where it is undefined. Sums and products are computed with 31
    /// digits, so that `sqrt(0.3 - 0.1*t)` is the root of zero at t = 3.
    pub fn value_at_instant(&self, time: f64) -> f64 {
        let mut values = SmallVec::<[f64; FEW]>::new();
        let mut digits = SmallVec::<[Option<Constant>; FEW]>::new();
        for op in self.ops() {
            if is_near_whole(*op, &values) {
                return self.on_sides_of(time, time);
            }
            let known = with_digits(*op, &digits, time);
            let plain = || apply_op(*op, &values, &[time]);
            let value = known.map_or_else(plain, Scalar::nominal);
            values.push(value);
            digits.push(known);
        }
        values.pop().unwrap_or(0.0)
    }

    /// The same at a time of any kind, on the sides of all jumps on which it is at the instant `place`.
    pub fn on_sides_of<S: Scalar>(&self, place: f64, time: S) -> S {
        let wholes = match self.is_near_jump(place) {
            true => self.whole_numbers(place),
            false => return self.value(&[time]),
        };
        let mut values = Vec::with_capacity(self.ops().len());
        for (op, whole) in self.ops().iter().zip(wholes) {
            let value = with_whole(*op, whole, &values, time);
            values.push(value);
        }
        values.pop().unwrap_or(S::number(0.0))
    }

    /// Whether plain numbers may not tell on which side of a jump it is.
    fn is_near_jump(&self, time: f64) -> bool {
        let mut values = SmallVec::<[f64; FEW]>::new();
        self.ops().iter().any(|op| {
            let is_near = is_near_whole(*op, &values);
            values.push(apply_op(*op, &values, &[time]));
            is_near
        })
    }

    /// Whether some function jumps at an instant.
    pub fn jumps_at(&self, time: f64) -> bool {
        let mut jumps = false;
        self.look_around(time, |below, above| jumps |= below != above);
        jumps
    }

    /// The whole numbers of all functions that jump, at an instant.
    pub(super) fn whole_numbers(&self, time: f64) -> WholeNumbers {
        self.look_around(time, |_, _| {})
    }

    /// The same; `seen` hears of the whole numbers between which a function may jump at the instant.
    ///
    /// What a whole number is taken of is followed at the time, and at the first and the last instant that are rounded to it, with
    /// the same whole numbers of what it is of: a whole number that lies between is passed there, and reached.
    fn look_around(&self, time: f64, mut seen: impl FnMut(f64, f64)) -> WholeNumbers {
        let half = |next: f64| Constant::exact(0.5 * (next - time));
        let here = Constant::exact(time);
        let times = [
            here,
            here + half(time.next_down()),
            here + half(time.next_up()),
        ];
        let mut tracks: [Vec<Constant>; 3] = Default::default();
        let mut wholes = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            let own = tracks.each_ref().map(|values| quotient_of(*op, values));
            let whole = match own {
                [Some(here), Some(before), Some(behind)] => {
                    let ends = [before, behind].map(|quotient| quotient.floor().number());
                    // What may be a whole number to all its digits is one.
                    let reached = [here, before, behind].map(|q| {
                        let error = Constant::exact(q.error());
                        (q + error).floor().number()
                    });
                    let most = reached.into_iter().fold(f64::NEG_INFINITY, f64::max);
                    seen(ends[0].min(ends[1]), most);
                    most.is_finite().then_some(most)
                }
                _ => None,
            };
            for (values, time) in tracks.iter_mut().zip(times) {
                let value = with_whole(*op, whole, values, time);
                values.push(value);
            }
            wholes.push(whole);
        }
        wholes
    }
}

/// What a jumping function takes the whole number of.
pub(super) fn quotient_of<S: Scalar>(op: Op, values: &[S]) -> Option<S> {
    match op {
        Op::Call(Function::Floor, a, _) => Some(values[a]),
        Op::Call(Function::Mod, a, b) => Some(values[a] / values[b]),
        _ => None,
    }
}

/// Whether plain numbers may not tell the whole number of a function.
fn is_near_whole(op: Op, values: &[f64]) -> bool {
    quotient_of(op, values).is_some_and(|x| (x - x.round()).abs() <= NEAR_WHOLE * x.abs().max(1.0))
}

/// An operation whose whole number may be known.
pub(super) fn with_whole<S: Scalar>(op: Op, whole: Option<f64>, values: &[S], time: S) -> S {
    match (op, whole) {
        (Op::Call(Function::Floor, ..), Some(whole)) => S::number(whole),
        (Op::Call(Function::Mod, a, b), Some(whole)) => {
            let rest = values[a] - values[b].scale(whole);
            // At a jump to zero what is rounded may be on the other side of it.
            match rest.nominal() * values[b].nominal() < 0.0 {
                true => rest - S::number(rest.nominal()),
                false => rest,
            }
        }
        _ => apply_op(op, values, &[time]),
    }
}

/// The value of a sum, a product or a choice of numbers whose digits are known: zero where it differs from that by rounding alone.
/// `None` of another operation, and where there is no value.
fn with_digits(op: Op, digits: &[Option<Constant>], time: f64) -> Option<Constant> {
    let value = match op {
        Op::Constant(value) => value,
        Op::Slot(_) => Constant::exact(time),
        Op::Negate(a) => -digits[a]?,
        Op::Add(a, b) => digits[a]? + digits[b]?,
        Op::Subtract(a, b) => digits[a]? - digits[b]?,
        Op::Multiply(a, b) => digits[a]? * digits[b]?,
        Op::Divide(a, b) => digits[a]? / digits[b]?,
        Op::Power(a, b) => {
            let exponent = digits[b]?;
            let is_whole = exponent.as_number().is_some_and(|e| e.fract() == 0.0);
            is_whole.then_some(())?;
            digits[a]?.power(exponent)
        }
        Op::Call(Function::Abs, a, _) => match digits[a]? {
            value if value.nominal() < 0.0 => -value,
            value => value,
        },
        Op::Call(function @ (Function::Min | Function::Max), a, b) => {
            let (a, b) = (digits[a]?, digits[b]?);
            match (a.nominal() < b.nominal()) == (function == Function::Min) {
                true => a,
                false => b,
            }
        }
        Op::Call(..) => return None,
    };
    match value.may_be_zero() {
        true => Some(Constant::exact(0.0)),
        false => Some(value).filter(|value| Scalar::is_finite(*value)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// `floor(a t / b)`, and `mod(a t, b)`.
    fn formulas(a: f64, b: f64) -> [Expression; 2] {
        let head = [
            Op::Slot(0),
            Op::Constant(Constant::exact(a)),
            Op::Multiply(0, 1),
            Op::Constant(Constant::exact(b)),
        ];
        let floor = [Op::Divide(2, 3), Op::Call(Function::Floor, 4, 4)];
        let modulo = [Op::Call(Function::Mod, 2, 3)];
        [&floor[..], &modulo].map(|tail| Expression::new([&head, tail].concat()))
    }

    #[test]
    fn a_time_is_that_of_a_jump_which_is_rounded_to_it() {
        for (a, b, whole) in [
            (3.0, 1.0, 1.0),
            (-3.0, 1.0, -2.0),
            (7.0, 0.5, 9.0),
            (49.0, 1.0, 30.0),
        ] {
            let time = whole * b / a;
            let [floor, modulo] = formulas(a, b);
            assert!(floor.jumps_at(time) && modulo.jumps_at(time), "{a} {b}");
            assert_eq!(floor.value_at_instant(time), whole, "{a} {b}");
            let rest = modulo.value_at_instant(time);
            assert!((0.0..1e-14).contains(&rest), "{a} {b}: {rest}");
            let sign = f64::signum(a);
            for (off, known) in [(1, whole), (-1, whole - 1.0)] {
                let beside = match f64::from(off) * sign > 0.0 {
                    true => time.next_up(),
                    false => time.next_down(),
                };
                assert!(!floor.jumps_at(beside), "{a} {b} {off}");
                assert_eq!(floor.value_at_instant(beside), known, "{a} {b} {off}");
                let share = modulo.value_at_instant(beside) / b;
                let expected = if off > 0 { 0.0 } else { 1.0 };
                assert!((share - expected).abs() < 1e-13, "{a} {b} {off}: {share}");
            }
        }
    }
}
