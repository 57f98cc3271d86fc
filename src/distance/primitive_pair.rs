//! The result for two cores: their distance and nearest points.

use super::point::PointHit;
use glam::DVec3;

/// The nearest points found of two cores.
#[derive(Clone, Copy, Debug)]
pub struct CorePair {
    /// Their distance; negative or zero where a point of one lies in the other.
    pub distance: f64,
    /// A point of the first and one of the second.
    pub points: [DVec3; 2],
    /// Unit vector from the first to the second; zero if unknown.
    pub normal: DVec3,
    /// Nothing is nearer by more than this: zero, unless a search ended before it was known.
    pub missed: f64,
}

impl CorePair {
    /// Nothing found yet.
    pub const FAR: Self = Self {
        distance: f64::INFINITY,
        points: [DVec3::ZERO; 2],
        normal: DVec3::ZERO,
        missed: 0.0,
    };

    /// Nothing is nearer.
    pub fn lowest(&self) -> f64 {
        self.distance - self.missed
    }

    /// A point of the second core near the first core.
    pub(crate) fn onto_first(point: DVec3, hit: PointHit) -> Self {
        Self {
            distance: hit.distance,
            points: [hit.nearest, point],
            normal: hit.normal,
            missed: 0.0,
        }
    }

    /// The nearer of the two.
    pub(crate) fn take(&mut self, other: Self) {
        let lowest = self.lowest().min(other.lowest());
        if other.distance < self.distance {
            *self = other;
        }
        // The difference of infinite distances is no number.
        self.missed = (self.distance - lowest).max(0.0);
    }

    /// The same from the other core's side.
    pub fn swapped(self) -> Self {
        Self {
            distance: self.distance,
            points: [self.points[1], self.points[0]],
            normal: -self.normal,
            missed: self.missed,
        }
    }
}
