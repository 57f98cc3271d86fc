//! Limits on the closure errors of redundant equations at a proved pose.

use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;

/// Largest meaningful bound on the closure error of a redundant equation at a pose or in a tube, in radians and sizes; in
/// a tube per turn of its largest angle if that exceeds one. Below it the solver itself calls a loop closed; above it the
/// pose is too close to a singular one. Rounding of dimensions and inputs explains a thousandth to a fifth of it.
pub const LARGEST_GAP: f64 = CLOSURE_TOLERANCE;
