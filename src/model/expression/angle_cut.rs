//! The cut of `atan2`, the negative x axis, where an angle jumps by a whole turn.

use super::pieces::{Ranges, value_range};
use super::{Function, Op};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::Series;

impl Ranges {
    /// On which side of the cut, the negative x axis, an angle is between the ends, if it comes to the cut there: above it (zero)
    /// half a turn more than the opposite angle, below it (one) less. And at which ends it passes the cut.
    pub(super) fn half_turns(&self, operands: [usize; 2]) -> Option<(f64, [Option<f64>; 2])> {
        let of = |values: &[Series<Interval, 1>]| operands.map(|k| value_range(values, k));
        let core = of(&self.core)[0];
        let side = match (core.lo > 0.0, core.hi < 0.0) {
            (true, _) => 0.0,
            (_, true) => 1.0,
            _ => return None,
        };
        if !meets_cut(of(&self.all)) {
            return None;
        }
        let mut here = [None; 2];
        for (end, (here, values)) in here.iter_mut().zip(&self.ends).enumerate() {
            let [y, x] = operands.map(|k| *values[k].coefficients());
            if !meets_cut([y[0], x[0]]) {
                continue;
            }
            let is_once = y[1].is_finite() && (y[1].lo >= 0.0 || y[1].hi <= 0.0);
            if !is_once {
                return None;
            }
            // What begins on the cut has not passed it.
            *here = (end == 1 || !self.is_first).then_some(0.0);
        }
        Some((side, here))
    }
}

/// The operands of an angle: y, then x.
pub(super) fn cut_of(op: Op) -> Option<[usize; 2]> {
    match op {
        Op::Call(Function::Atan2, y, x) => Some([y, x]),
        _ => None,
    }
}

/// Whether a point may be on the negative x axis, or in the origin.
pub(super) fn meets_cut([y, x]: [Interval; 2]) -> bool {
    // What has no number may be anywhere.
    let is_off = x.lo > 0.0 || y.lo > 0.0 || y.hi < 0.0;
    !is_off
}
