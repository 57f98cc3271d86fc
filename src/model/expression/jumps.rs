//! When a formula of time jumps: two that jump at the same instant do so together.

use super::{Function, ONE, Op, ZERO};
use crate::numbers::constant::Constant;

/// Instants that are known to this part of themselves, or of a second, and do not differ by more than what is unknown of
/// them are one: numbers as they are written differ by far more.
pub(super) const KNOWN: f64 = 1e-24;

/// A `floor`, `mod` or `atan2` that jumps.
#[derive(Clone, Debug)]
pub struct Jump {
    /// With all that it is of, operands first.
    pub(super) of: Vec<Op>,
    /// When, seconds, where the jumping quotient is a line over the time.
    pub(super) time: Option<Constant>,
}

impl Jump {
    /// Whether two jump at once, not one after the other.
    pub fn is_with(&self, other: &Self) -> bool {
        self.of == other.of || are_one(self.time, other.time)
    }

    /// Whether it is at a time given as the nearest number.
    pub fn is_at(&self, time: f64) -> bool {
        self.time
            .is_some_and(|jump| is_known(jump) && jump.number() == time)
    }
}

/// Whether two instants are one.
pub(super) fn are_one(a: Option<Constant>, b: Option<Constant>) -> bool {
    let (Some(a), Some(b)) = (a, b) else {
        return false;
    };
    let apart = a - b;
    is_known(a) && is_known(b) && apart.number().abs() <= apart.error()
}

fn is_known(time: Constant) -> bool {
    time.error() <= KNOWN * time.number().abs().max(1.0)
}

/// A line over the time: its value at zero, and its slope.
pub(super) type LineInTime = [Constant; 2];

/// The line that an operation is, whose operands are these lines and which gives a whole number, or takes that often its
/// divisor away, if it jumps.
pub(super) fn line_of(
    op: Op,
    lines: &[Option<LineInTime>],
    whole: Option<f64>,
) -> Option<LineInTime> {
    let both = |a: usize, b: usize| Some((lines[a]?, lines[b]?));
    let is_level = |line: &LineInTime| line[1] == ZERO;
    match op {
        Op::Constant(c) => Some([c, ZERO]),
        Op::Slot(_) => Some([ZERO, ONE]),
        Op::Negate(a) => lines[a].map(|line| line.map(|c| -c)),
        Op::Add(a, b) => both(a, b).map(|([p, q], [r, s])| [p + r, q + s]),
        Op::Subtract(a, b) => both(a, b).map(|([p, q], [r, s])| [p - r, q - s]),
        // A product is a line if one factor is level.
        Op::Multiply(a, b) => {
            let (p, q) = both(a, b)?;
            let (line, by) = if is_level(&q) { (p, q) } else { (q, p) };
            is_level(&by).then(|| line.map(|c| c * by[0]))
        }
        Op::Divide(a, b) => {
            let (line, by) = both(a, b)?;
            let is_number = is_level(&by) && by[0].number() != 0.0;
            is_number.then(|| line.map(|c| c / by[0]))
        }
        Op::Call(Function::Floor, ..) => whole.map(|whole| [Constant::exact(whole), ZERO]),
        // a mod b = a - b ⌊a/b⌋, with the given whole number.
        Op::Call(Function::Mod, a, b) => {
            let (([p, q], [r, s]), whole) = (both(a, b)?, Constant::exact(whole?));
            Some([p - r * whole, q - s * whole])
        }
        _ => None,
    }
}

/// When the quotient that a function takes the floor of comes to a whole number.
pub(super) fn instant_of(op: Op, lines: &[Option<LineInTime>], whole: f64) -> Option<Constant> {
    let quotient = match op {
        Op::Call(Function::Mod, a, b) => line_of(Op::Divide(a, b), lines, None)?,
        // An angle jumps where y comes to zero.
        Op::Call(Function::Floor | Function::Atan2, a, _) => lines[a]?,
        _ => return None,
    };
    let [value, slope] = quotient;
    (slope.number() != 0.0).then(|| (Constant::exact(whole) - value) / slope)
}
