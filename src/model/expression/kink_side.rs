//! On which side of its kink or jump a function is over a piece of time.

use super::{Expression, Function, Op};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// What a function is on a piece.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum KinkSide {
    /// As it is written.
    Plain,
    /// One of its operands, negated or not, and some number of an interval.
    Operand(usize, bool, Interval),
    /// The whole number that `floor` gives, of a quotient in `mod`; of `atan2` one below its cut, zero above.
    Whole(f64),
}

impl KinkSide {
    pub(super) fn whole(self) -> Option<f64> {
        match self {
            Self::Whole(whole) => Some(whole),
            _ => None,
        }
    }
}

/// The side of a function with a kink that the values of its operands are on, mostly.
pub(super) fn kink_side(op: Op, range: impl Fn(usize) -> Interval) -> KinkSide {
    let Op::Call(function, a, b) = op else {
        return KinkSide::Plain;
    };
    let x = match function {
        Function::Abs => range(a),
        Function::Min | Function::Max => range(a) - range(b),
        _ => return KinkSide::Plain,
    };
    if !x.is_finite() {
        return KinkSide::Plain;
    }
    // How far the range reaches to either side of the kink: the smaller reach bounds the error of using one side only.
    let (below, above) = ((-x.lo).max(0.0), x.hi.max(0.0));
    let is_above = above >= below;
    let off = above.min(below);
    match function {
        Function::Abs => KinkSide::Operand(a, !is_above, Interval::new(0.0, 2.0 * off)),
        Function::Min => KinkSide::Operand(
            if is_above { b } else { a },
            false,
            Interval::new(-off, 0.0),
        ),
        _ => KinkSide::Operand(if is_above { a } else { b }, false, Interval::new(0.0, off)),
    }
}

impl Expression {
    /// Whether the operand of a kink changes its sign from one place to another.
    pub fn passes_kink(&self, places: [&[f64]; 2]) -> bool {
        let [a, b] = places.map(|slots| {
            let mut values = Vec::with_capacity(self.ops().len());
            self.value_with(slots, &mut values);
            values
        });
        let is_past = |operand: &dyn Fn(&[f64]) -> f64| operand(&a) * operand(&b) < 0.0;
        self.ops().iter().any(|op| match *op {
            Op::Call(Function::Abs, x, _) => is_past(&|v| v[x]),
            Op::Call(Function::Min | Function::Max, x, y) => is_past(&|v| v[x] - v[y]),
            _ => false,
        })
    }
}
