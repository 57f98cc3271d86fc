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
}

impl CorePair {
    /// Nothing found yet.
    pub const FAR: Self = Self {
        distance: f64::INFINITY,
        points: [DVec3::ZERO; 2],
        normal: DVec3::ZERO,
    };

    /// A point of the second core near the first core.
    pub(crate) fn onto_first(point: DVec3, hit: PointHit) -> Self {
        Self {
            distance: hit.distance,
            points: [hit.nearest, point],
            normal: hit.normal,
        }
    }

    /// The nearer of the two.
    pub(crate) fn take(&mut self, other: Self) {
        if other.distance < self.distance {
            *self = other;
        }
    }

    /// The same from the other core's side.
    pub fn swapped(self) -> Self {
        Self {
            distance: self.distance,
            points: [self.points[1], self.points[0]],
            normal: -self.normal,
        }
    }
}
