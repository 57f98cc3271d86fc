//! Derivatives of closed poses: rates of any order by time or by an input, and mixed second derivatives.

mod coefficients;
pub mod columns;
mod fold;
pub mod higher_order;
pub mod rated;
mod regular;
pub mod variation;

use crate::kinematics::loops::residual::residual_of;
use crate::model::walk::WalkFrame;

/// A derivative of a loop's residual, from that of its product: if all lower ones vanish it is skew, and its three
/// entries are the derivative of the rotation vector.
fn residual_part(end: WalkFrame<f64>, size: f64) -> [f64; 6] {
    let [x, y, z] = end.axes;
    let turn = [y[2] - z[1], z[0] - x[2], x[1] - y[0]].map(|v| 0.5 * v);
    residual_of(turn.into(), end.origin.into(), size)
}
