//! Planes that cut, and coordinates in them.

use glam::{DVec2, DVec3};

/// A plane in space. Its normal points to the side that is removed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CutPlane {
    /// A point of it.
    pub point: DVec3,
    /// Unit normal.
    pub normal: DVec3,
}

impl CutPlane {
    /// Height of a point above the plane, on the removed side.
    pub fn height(&self, point: DVec3) -> f64 {
        (point - self.point).dot(self.normal)
    }
}

/// Coordinates in a plane. Seen from the tip of the normal, a turn from the first axis to the second is counter-clockwise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlaneFrame {
    /// Where both coordinates are zero.
    pub origin: DVec3,
    /// Unit vectors of both coordinates.
    pub axes: [DVec3; 2],
}

impl PlaneFrame {
    /// Coordinates of the projection of a point.
    pub fn flat(&self, point: DVec3) -> DVec2 {
        let from = point - self.origin;
        DVec2::new(from.dot(self.axes[0]), from.dot(self.axes[1]))
    }

    /// The same frame with its axes turned by an angle in radians.
    pub fn turned(&self, angle: f64) -> Self {
        let (sin, cos) = crate::math::sin_cos(angle);
        let [first, second] = self.axes;
        Self {
            axes: [first * cos + second * sin, second * cos - first * sin],
            ..*self
        }
    }
}
