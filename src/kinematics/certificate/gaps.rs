//! How far a redundant equation may be open at a pose that is proved.

use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;

/// A redundant equation that may be open by more at a pose, in radians and sizes, has no bound worth the name: the solver
/// itself calls a loop closed below that, and the pose is too near a singular one. Rounding and digits explain a
/// thousandth of it, unless dimensions are many times the mechanism's size.
pub const LARGEST_GAP: f64 = CLOSURE_TOLERANCE;

/// The same over a tube: one that is too coarse is halved, so that little is hidden in what it cuts off.
pub const LARGEST_GAP_OF_TUBE: f64 = 0.1 * LARGEST_GAP;
