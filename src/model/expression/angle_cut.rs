//! The cut of `atan2`, the negative x axis, where an angle jumps by a whole turn.

use super::{Function, Op};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;

/// On which side of the cut an angle is over a piece, if it comes to the cut there: above it (zero) half a turn more than the
/// opposite angle, below it (one) less. And at which ends it passes the cut.
///
/// `core` is y between the ends, `all` are y and x over the piece, `ends` are y and x at either end, each with its rate.
pub(super) fn side_of_cut(
    core: Interval,
    all: [Interval; 2],
    ends: [[[Interval; 2]; 2]; 2],
    is_first: bool,
) -> Option<(f64, [Option<f64>; 2])> {
    let side = match (core.lo > 0.0, core.hi < 0.0) {
        (true, _) => 0.0,
        (_, true) => 1.0,
        _ => return None,
    };
    if !meets_cut(all) {
        return None;
    }
    let mut here = [None; 2];
    for (end, (here, [y, x])) in here.iter_mut().zip(ends).enumerate() {
        if !meets_cut([y[0], x[0]]) {
            continue;
        }
        // It passes once.
        if !y[1].is_finite() || (y[1].lo < 0.0 && y[1].hi > 0.0) {
            return None;
        }
        // What begins on the cut has not passed it.
        *here = (end == 1 || !is_first).then_some(0.0);
    }
    Some((side, here))
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
