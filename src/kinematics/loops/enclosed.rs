//! Proves that a loop is open for all values of its coordinates.

use crate::model::chain::ArgumentValue;
use crate::model::mechanism::{Closes, Loop};
use crate::model::walk::WalkFrame;
use crate::numbers::interval::Interval;

/// Whether the loop is proved to be open for all values of its arguments in these intervals.
pub fn is_open_throughout(item: &Loop, arguments: &[ArgumentValue<Interval>]) -> bool {
    let end = WalkFrame::at_end_of(&item.chain.steps, arguments);
    // Closed means the identity: nine entries of the rotation and the origin.
    let is_turned = (0..3).any(|i| {
        (0..3).any(|j| {
            let wanted = if i == j {
                Interval::ONE
            } else {
                Interval::ZERO
            };
            !(end.axes[i][j] - wanted).holds_zero()
        })
    });
    let is_apart = end.origin.iter().any(|c| !c.holds_zero());
    is_apart || item.closes == Closes::Frame && is_turned
}
