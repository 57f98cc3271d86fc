//! A plane between two hulls that move for a short time, and the gap that it leaves.

use glam::DVec3;

/// A bound along a direction n + u t for two hulls of which only their supports are needed.
///
/// The points x of b are at x + u X + u² Y. Of the least of (n + u t) · (x + u X + u² Y) over all x, less what a reaches
/// along n + u t and less both radii times its length, the terms up to u² are a concave function of a curve
/// of second order in u. Such a curve lies in the hull of three control points, so that the function is nowhere less than
/// the least of its values there. With D the distance in the middle, or any other that is not below zero, D u² t²/2 is taken
/// off before, because the length of n + u t grows by no more than that: a gap of D along it stays one.
pub(super) struct Slab {
    pub(super) controls: [Control; 3],
    /// No gap is said to be larger: D.
    pub(super) most: f64,
    /// What the terms that are left out may take away.
    pub(super) lost: f64,
}

/// One of the three points.
pub(super) struct Control {
    /// Directions in which the supports of a and b are needed, in a's frame.
    pub(super) directions: [DVec3; 2],
    /// The rest of the value.
    pub(super) rest: f64,
}

impl Slab {
    /// Lower bound of the distance of two hulls, whose supports are given in two directions together.
    pub(super) fn gap(&self, supports: impl Fn([DVec3; 2]) -> Option<f64>) -> Option<f64> {
        let mut gap = self.most;
        for control in &self.controls {
            gap = gap.min(control.rest - supports(control.directions)?);
        }
        Some(gap - self.lost)
    }
}
