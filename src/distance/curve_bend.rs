//! Bounds on the downward curvature of the distance from a core along a segment or a circle, between two places.
//!
//! A circle curves away from any plane by its radius per squared radian. The signed distance from a convex core adds
//! nothing to that, because planes support it. The distance f from another circle curves downwards only where ρ, the
//! distance from its axis, is less than its radius R, by (R - ρ) / (ρ f) per squared length; there f is at least R - ρ.

use super::distance_along::DistanceAlong;
use super::primitive::{Circle, Primitive};
use super::search::{CurveSpot, lowest_of_bent, lowest_of_steep};
use glam::DVec3;

/// Error allowed in a search along a curve, in its speeds and in lengths of its position: far below the error of poses,
/// and above rounding.
const MISSED: [f64; 2] = [1e-11, 1e-15];

/// Bounds of the distance from a core along a curve.
#[derive(Clone, Copy, Debug)]
pub struct CurveBend {
    /// The speed of the curve, per unit of its variable, ...
    speed: f64,
    /// ... and its own curvature.
    own: f64,
    /// R; nothing for convex cores, and for circles that no point of the curve is inside of.
    ring: Option<f64>,
    /// No point of the curve is nearer to the axis of that circle.
    off_axis: f64,
    /// If the core has an axis that the curve may go around, or a face that it may lie on.
    along: Option<DistanceAlong>,
}

/// Bound on the downward curvature of the distance from a circle of radius `ring`, at least `near` from its axis (more than zero) and
/// `apart` from itself.
pub fn ring_bends(ring: f64, near: f64, apart: f64) -> f64 {
    let share = match apart > 0.0 {
        true => ((ring - near).max(0.0) / apart).min(1.0),
        false => 1.0,
    };
    share / near
}

impl CurveBend {
    /// Along a circle, whose variable is an angle; `ring` is the core if that is a circle, all others are convex.
    pub fn of_circle(ring: Option<&Circle>, circle: &Circle) -> Self {
        let off_axis = ring.map_or(0.0, |ring| {
            let offset = circle.centre - ring.centre;
            (offset - ring.axis * offset.dot(ring.axis)).length() - circle.radius
        });
        Self {
            speed: circle.radius,
            own: circle.radius,
            ring: ring.map(|ring| ring.radius).filter(|r| off_axis < *r),
            off_axis,
            along: None,
        }
    }

    /// Along a segment of this length, whose variable goes from 0 to 1.
    pub fn of_segment(ring: Option<&Circle>, length: f64) -> Self {
        Self {
            speed: length,
            own: 0.0,
            ring: ring.map(|ring| ring.radius),
            off_axis: 0.0,
            along: None,
        }
    }

    /// Along the same curve after an affine map that stretches lengths by at most this factor and moves no point by more
    /// than `way`.
    pub fn elsewhere(ring: Option<&Circle>, curve: &Self, stretched: f64, way: f64) -> Self {
        let off_axis = curve.off_axis - way;
        Self {
            speed: curve.speed * stretched,
            own: curve.own * stretched,
            ring: ring.map(|ring| ring.radius).filter(|r| off_axis < *r),
            off_axis,
            along: None,
        }
    }

    /// The same along centre + x cos φ + y sin φ, beside this core.
    pub fn beside(self, core: &Primitive, centre: DVec3, directions: [DVec3; 2]) -> Self {
        let along = DistanceAlong::new(core, centre, directions);
        Self { along, ..self }
    }

    /// Error allowed in a search on a curve about `centre`.
    pub fn missed(&self, centre: DVec3) -> f64 {
        MISSED[0] * self.speed + MISSED[1] * centre.length()
    }

    /// The same between two places of the curve, where this far from the axis of the circle.
    pub fn beside_axis(&self, [a, b]: [f64; 2], wide: f64) -> Self {
        let off_axis = 0.5 * (a + b - self.speed * wide);
        Self {
            off_axis: self.off_axis.max(off_axis),
            ..*self
        }
    }

    /// Bound on the downward second derivative between two places; `None` if unknown.
    pub fn between(&self, a: &CurveSpot, b: &CurveSpot) -> Option<f64> {
        let Some(ring) = self.ring else {
            let beside = self.along.and_then(|known| known.bends([a, b], self.speed));
            return Some(beside.map_or(self.own, |bends| bends.min(self.own)));
        };
        let (sum, way) = (a.value + b.value, self.speed * (b.at - a.at));
        let [nearest, farthest] = [0.5 * (sum - way), 0.5 * (sum + way)];
        let near = self.off_axis.max(ring - farthest);
        let beside = self.along.and_then(|known| known.bends_of_ring(near));
        (near > 0.0).then(|| {
            let bends = self.own + self.speed * self.speed * ring_bends(ring, near, nearest);
            beside.map_or(bends, |beside| beside.min(bends))
        })
    }

    /// Whether the slope keeps its sign between two places, so that no minimum lies there: it can neither fall from a rise
    /// at the first to zero, nor from zero to the fall at the second.
    pub fn has_no_minimum_between(&self, a: &CurveSpot, b: &CurveSpot) -> bool {
        let falls = self
            .between(a, b)
            .map_or(f64::INFINITY, |bends| bends * (b.at - a.at));
        a.slope > falls || b.slope < -falls
    }

    /// The distance is nowhere between two spots lower.
    pub fn lowest_between(&self, a: &CurveSpot, b: &CurveSpot) -> f64 {
        let steep = lowest_of_steep(self.speed, a, b);
        let bent = self.between(a, b);
        bent.map_or(steep, |bends| steep.max(lowest_of_bent(bends, a, b)))
    }

    /// Between two places the distance is below its chord plus the effect of downward curvature.
    pub fn highest_between(&self, a: &CurveSpot, b: &CurveSpot) -> f64 {
        let wide = b.at - a.at;
        let steep = 0.5 * (a.value + b.value + self.speed * wide);
        let bent = self.between(a, b);
        bent.map_or(steep, |bends| {
            steep.min(a.value.max(b.value) + 0.125 * bends * wide * wide)
        })
    }
}
