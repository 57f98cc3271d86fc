//! The cut of `atan2`, the negative x axis, where an angle jumps by a whole turn.

use super::{Function, Op};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// The operands of an angle: y, then x.
pub(super) fn cut_of(op: Op) -> Option<[usize; 2]> {
    match op {
        Op::Call(Function::Atan2, y, x) => Some([y, x]),
        _ => None,
    }
}

/// Whether a point may be on the negative x axis, or in the origin. What has no number may be anywhere.
pub(super) fn meets_cut([y, x]: [Interval; 2]) -> bool {
    let is_off = x.lo > 0.0 || y.lo > 0.0 || y.hi < 0.0;
    !is_off
}

/// On which side of the cut an angle is over a piece that comes to it: half a turn more than the opposite angle, or less. And at
/// which ends it passes the cut. `None` where that is open, and where it stays away from the cut.
///
/// Of y and x all values over the piece are given, those of y without the ends, and at both ends y, x and the rate of y.
pub(super) fn half_turns(
    all: [Interval; 2],
    core: Interval,
    ends: [[Interval; 3]; 2],
    is_first: bool,
) -> Option<(f64, [Option<f64>; 2])> {
    let side = match (core.lo > 0.0, core.hi < 0.0) {
        (true, _) => 1.0,
        (_, true) => -1.0,
        _ => return None,
    };
    if !meets_cut(all) {
        return None;
    }
    let mut here = [None; 2];
    for (end, (here, [y, x, rate])) in here.iter_mut().zip(ends).enumerate() {
        if !meets_cut([y, x]) {
            continue;
        }
        let is_once = rate.is_finite() && (rate.lo >= 0.0 || rate.hi <= 0.0);
        if !is_once {
            return None;
        }
        // What begins on the cut has not passed it.
        *here = (end == 1 || !is_first).then_some(0.0);
    }
    Some((side, here))
}
