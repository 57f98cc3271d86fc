//! The curvature of the distance from a point, a segment or the side of a cylinder, along a circle or an ellipse around it.
//!
//! The square of the distance from a line is a trigonometric polynomial of second degree along c + x cos φ + y sin φ. Where the
//! curve goes around the line nearly coaxially its coefficients nearly vanish, and so does the curvature of the distance, however far the
//! curve bends away from its tangents. Beyond an end of a segment the square of the excess is added, whose slope has no jump.
//!
//! With g = f² the second derivative of f is g'' / (2 f) - g'² / (4 f³).

use super::primitive::{Frustum, Primitive};
use super::search::CurveSpot;
use crate::numbers::rounding::SUMS;
use glam::DVec3;

/// Bounds of the derivatives of g along the whole curve.
#[derive(Clone, Copy, Debug)]
pub struct AxisDistance {
    /// The surface is this far from the axis.
    inset: f64,
    /// -g'' is at most this, ...
    falls: f64,
    /// ... and g'' this, which is no less.
    rises: f64,
}

impl AxisDistance {
    /// Along centre + x cos φ + y sin φ; `None` for cores without an axis, and where the curve may be nearer to the end of a
    /// cylinder than to its side.
    pub fn along(core: &Primitive, centre: DVec3, [x, y]: [DVec3; 2]) -> Option<Self> {
        match core {
            Primitive::Point(point) => Some(Self::of_squares(centre - *point, [x, y], 0.0)),
            Primitive::Segment([from, to]) => {
                let length = from.distance(*to);
                let axis = (*to - *from).try_normalize();
                axis.map_or_else(
                    || Some(Self::of_squares(centre - *from, [x, y], 0.0)),
                    |axis| {
                        let offset = centre - from.midpoint(*to);
                        Some(Self::of_line(offset, [x, y], axis, 0.5 * length))
                    },
                )
            }
            Primitive::Frustum(frustum) => Self::of_cylinder(frustum, centre, [x, y]),
            _ => None,
        }
    }

    /// From the line through the middle of a segment, half as long as `half`.
    fn of_line(offset: DVec3, [x, y]: [DVec3; 2], axis: DVec3, half: f64) -> Self {
        let across = |v: DVec3| v - axis * v.dot(axis);
        let around = Self::of_squares(across(offset), [across(x), across(y)], 0.0);
        let sway = x.dot(axis).hypot(y.dot(axis));
        let beyond = (offset.dot(axis).abs() + sway - half).max(0.0);
        let bent = 2.0 * beyond * sway;
        Self {
            falls: around.falls + bent,
            rises: around.rises + bent + if beyond > 0.0 { 2.0 * sway * sway } else { 0.0 },
            ..around
        }
    }

    /// From the side of a cylinder, if the whole curve is beside it.
    fn of_cylinder(frustum: &Frustum, centre: DVec3, [x, y]: [DVec3; 2]) -> Option<Self> {
        let Frustum {
            from,
            axis,
            length,
            radii: [radius, other],
        } = *frustum;
        let along = (centre - from).dot(axis);
        let sway = x.dot(axis).hypot(y.dot(axis));
        let is_beside = along - sway >= 0.0 && along + sway <= length;
        (is_beside && radius == other).then(|| Self {
            inset: radius,
            ..Self::of_line(centre - from, [x, y], axis, f64::INFINITY)
        })
    }

    /// From |offset + x cos φ + y sin φ|².
    fn of_squares(offset: DVec3, [x, y]: [DVec3; 2], inset: f64) -> Self {
        let once = 2.0 * offset.dot(x).hypot(offset.dot(y));
        let twice = 4.0 * (0.5 * (x.length_squared() - y.length_squared())).hypot(x.dot(y));
        let size = (offset.length() + x.length() + y.length()).powi(2);
        let bends = once + twice + SUMS * size;
        Self {
            inset,
            falls: bends,
            rises: bends,
        }
    }

    /// Bound on the downward second derivative of f between two places of the curve, which has at most this speed; `None` where f may
    /// vanish.
    pub fn bends(&self, [a, b]: [&CurveSpot; 2], speed: f64) -> Option<f64> {
        let wide = b.at - a.at;
        let [first, second] = [a, b].map(|spot| spot.value + self.inset);
        // g is above its chord but for what it bends up.
        let square = first.min(second).powi(2) - 0.125 * self.rises * wide * wide;
        let steep = 0.5 * (first + second - speed * wide);
        let near = square.max(0.0).sqrt().max(steep);
        // In a cylinder the distance may be that of an end.
        if !(near > self.inset) {
            return None;
        }
        let slope = (first * a.slope).abs().max((second * b.slope).abs());
        let steepest = 2.0 * slope + 0.5 * self.rises * wide;
        Some(0.5 * self.falls / near + 0.25 * steepest * steepest / near.powi(3))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    struct Random(u64);

    impl Random {
        fn next(&mut self) -> f64 {
            self.0 ^= self.0 << 13;
            self.0 ^= self.0 >> 7;
            self.0 ^= self.0 << 17;
            (self.0 >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        }

        fn vector(&mut self, size: f64) -> DVec3 {
            DVec3::from_array([(); 3].map(|()| self.next() * size))
        }
    }

    /// The distance of a point from a core, from its definition.
    fn distance(core: &Primitive, point: DVec3) -> f64 {
        match core {
            Primitive::Point(centre) => point.distance(*centre),
            Primitive::Segment([from, to]) => {
                let way = *to - *from;
                let along = (point - *from).dot(way) / way.length_squared();
                point.distance(*from + way * along.clamp(0.0, 1.0))
            }
            Primitive::Frustum(frustum) => {
                let offset = point - frustum.from;
                let along = offset.dot(frustum.axis);
                let aside = (offset - frustum.axis * along).length() - frustum.radii[0];
                let beyond = (-along).max(along - frustum.length);
                match aside.max(beyond) < 0.0 {
                    true => aside.max(beyond),
                    false => aside.max(0.0).hypot(beyond.max(0.0)),
                }
            }
            _ => f64::NAN,
        }
    }

    fn cores(random: &mut Random) -> [Primitive; 3] {
        let (from, axis) = (random.vector(1.0), random.vector(1.0).normalize());
        let length = 0.1 + 3.0 * random.next().abs();
        let radius = 0.2 * random.next().abs();
        [
            Primitive::Point(from),
            Primitive::Segment([from, from + axis * length]),
            Primitive::Frustum(Frustum {
                from,
                axis,
                length,
                radii: [radius; 2],
            }),
        ]
    }

    /// Everywhere between two places the function is above its chord by no more than the bound allows.
    #[test]
    fn distances_bend_no_more_than_bounded() {
        let (mut random, mut looks) = (Random(0xa_7151), 0);
        for _ in 0..20_000 {
            // From far aside to nearly coaxial.
            let aside = 10.0_f64.powf(-4.0 * random.next().abs());
            for core in cores(&mut random) {
                let (middle, axis) = middle_and_axis(&core);
                let (p, q) = axis.any_orthonormal_pair();
                let centre = middle + random.vector(aside);
                let [x, y] = [p, q].map(|v| v + random.vector(aside));
                let Some(known) = AxisDistance::along(&core, centre, [x, y]) else {
                    continue;
                };
                let speed = (x.length_squared() + y.length_squared()).sqrt();
                let f = |t: f64| {
                    let (sin, cos) = crate::math::sin_cos(t);
                    distance(&core, centre + x * cos + y * sin)
                };
                let spot = |t: f64| CurveSpot {
                    at: t,
                    value: f(t),
                    slope: (f(t + 1e-6) - f(t - 1e-6)) / 2e-6,
                };
                let at = 3.0 * random.next();
                let wide = 0.01 + random.next().abs();
                let Some(bends) = known.bends([&spot(at), &spot(at + wide)], speed) else {
                    continue;
                };
                looks += 1;
                for _ in 0..8 {
                    let [s, t] = [(); 2].map(|()| at + wide * 0.5 * (random.next() + 1.0));
                    let over = f(0.5 * (s + t)) - 0.5 * (f(s) + f(t));
                    let allowed = 0.125 * bends * (t - s).powi(2) * (1.0 + 1e-6) + 1e-12;
                    assert!(
                        over <= allowed,
                        "{core:?} {centre} {x} {y} {at} {wide}: {over} {allowed}"
                    );
                }
            }
        }
        assert!(looks > 20_000, "{looks}");
    }

    fn middle_and_axis(core: &Primitive) -> (DVec3, DVec3) {
        match core {
            Primitive::Point(point) => (*point, DVec3::Z),
            Primitive::Segment([from, to]) => (from.midpoint(*to), (*to - *from).normalize()),
            Primitive::Frustum(f) => (f.from + f.axis * (0.5 * f.length), f.axis),
            _ => (DVec3::NAN, DVec3::NAN),
        }
    }

    /// Around its axis nothing bends, though the circle leaves its tangents.
    #[test]
    fn a_coaxial_circle_is_flat() {
        let core = Primitive::Segment([DVec3::NEG_Z, DVec3::Z]);
        let known = AxisDistance::along(&core, DVec3::ZERO, [DVec3::X, DVec3::Y]).unwrap();
        let spot = |at: f64| CurveSpot {
            at,
            value: 1.0,
            slope: 0.0,
        };
        let bends = known.bends([&spot(0.0), &spot(0.8)], 1.0).unwrap();
        assert!(bends < 1e-11, "{bends}");
    }
}
