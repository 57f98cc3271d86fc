//! The size of the neighbourhood in which derivatives are bounded.

/// Radius (radians, mechanism sizes) in which the second derivatives are bounded: larger ones prove no more in
/// practice, and the reach of sliders grows with it.
pub const BALL: f64 = 0.25;
