//! The neighbourhood of a pose in which derivatives are bounded, and rotations are told apart.

/// Radius (radians, mechanism sizes) in which the second derivatives are bounded: larger ones prove no more in
/// practice, and the reach of sliders grows with it.
pub const BALL: f64 = 0.25;

/// The trace of a rotation, after what it can change within the error bound, below which it could belong to a half-turn
/// (trace -1) as well as to the identity (trace 3).
pub const LEAST_TRACE: f64 = 1e-6;
