//! Limits on the closure errors of redundant equations at a proved pose.

use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;

/// Largest meaningful bound on the closure error of a redundant equation at a pose, in radians and sizes: below it the
/// solver itself calls a loop closed; above it the pose is too close to a singular one. Rounding and digits of the
/// dimensions explain a thousandth of it, unless dimensions are many times the mechanism's size.
pub const LARGEST_GAP: f64 = CLOSURE_TOLERANCE;

/// The same for a tube, per turn of its largest angle if that exceeds one: a coarser one is halved, so that its truncation error
/// hides little.
pub const LARGEST_GAP_OF_TUBE: f64 = 0.1 * LARGEST_GAP;
