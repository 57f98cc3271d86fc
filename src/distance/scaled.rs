//! Elements made smaller about their centres.

use super::primitive::{BoxCore, Circle, Element, Frustum, HalfSpace, Primitive};
use crate::math::Pose;
use glam::DVec3;
use std::sync::Arc;

impl Primitive {
    /// The same core with all distances from `centre` multiplied by `factor`.
    fn scaled(&self, centre: DVec3, factor: f64) -> Self {
        let point = |p: &DVec3| centre + (*p - centre) * factor;
        let pose = |pose: &Pose| Pose {
            translation: point(&pose.translation),
            ..*pose
        };
        match self {
            Self::Point(p) => Self::Point(point(p)),
            Self::Segment(ends) => Self::Segment(ends.each_ref().map(point)),
            Self::Triangle(corners) => Self::Triangle(corners.each_ref().map(point)),
            Self::Circle(c) => Self::Circle(Circle {
                centre: point(&c.centre),
                radius: c.radius * factor,
                ..*c
            }),
            Self::Box(b) => Self::Box(BoxCore {
                from_box: pose(&b.from_box),
                half: b.half * factor,
            }),
            Self::Frustum(f) => Self::Frustum(Frustum {
                from: point(&f.from),
                length: f.length * factor,
                radii: f.radii.map(|radius| radius * factor),
                ..*f
            }),
            Self::HalfSpace(h) => Self::HalfSpace(HalfSpace {
                point: point(&h.point),
                ..*h
            }),
            Self::Mesh(tree, placed) => Self::Mesh(Arc::new(tree.scaled(factor)), pose(placed)),
        }
    }
}

impl Element {
    /// The same element made smaller about its centre, so that no point moves farther than a length; as it is if it has no end, or
    /// is no larger than that.
    pub fn smaller(&self, by: f64) -> Self {
        let (centre, radius) = self.bounds();
        if !radius.is_finite() || by >= radius {
            return self.clone();
        }
        let factor = 1.0 - by / radius;
        Self {
            core: self.core.scaled(centre, factor),
            radius: self.radius * factor,
            ..*self
        }
    }
}
