//! The curvature of the distance from a core along a circle or an ellipse that goes around it, or lies on one of its faces.
//!
//! A distance f is often the length of a vector of parts that are no less than zero (beyond the faces of a box, beyond the end and the side
//! of a cylinder, across and along the axis of a ring). Then f f'' is at least the sum of the products of the parts and their second
//! derivatives: a part that is small beside f bends it little, however much it is bent itself.
//!
//! Along c + x cos φ + y sin φ the square of the distance from a line is a trigonometric polynomial of second degree, and the distance
//! from a plane one of first degree. Where the curve goes around the line nearly coaxially, or lies nearly flat on the plane, their
//! coefficients nearly vanish, and so does the curvature of the distance, however far the curve bends away from its tangents. Beyond an end
//! of a segment the square of the excess is added, whose slope has no jump.
//!
//! With g = f² the second derivative of f is g'' / (2 f) - g'² / (4 f³).

use super::primitive::{BoxCore, Frustum, Primitive};
use super::search::CurveSpot;
use crate::math::Pose;
use crate::numbers::rounding::SUMS;
use glam::DVec3;
use libm::hypot;

/// What is known of the distance along the whole curve.
#[derive(Clone, Copy, Debug)]
pub enum DistanceAlong {
    /// From a point, a segment or the side of a cylinder.
    Axis(AxisDistance),
    /// From a box or from beyond the end of a cylinder: for each part of the distance its greatest value, if that is more than zero,
    /// and how much it may be bent.
    Parts {
        parts: [[f64; 2]; 3],
        /// No place of the curve is nearer.
        least: f64,
    },
    /// From another circle: the distance from its axis, and how far the curve sways along that.
    Ring(AxisDistance, f64),
}

/// Bounds of the derivatives of g; that of the first is no more than those of the second.
#[derive(Clone, Copy, Debug)]
pub struct AxisDistance {
    /// The surface is this far from the axis.
    inset: f64,
    /// -g'' is at most this, ...
    falls: f64,
    /// ... and g'' this, which is no less.
    rises: f64,
}

/// The largest |x cos φ + y sin φ|.
fn widest([x, y]: [DVec3; 2]) -> f64 {
    let [p, q] = [x, y].map(DVec3::length_squared);
    (0.5 * (p + q) + hypot(0.5 * (p - q), x.dot(y))).sqrt()
}

/// The largest component of x cos φ + y sin φ.
fn sway_of([x, y]: [DVec3; 2], axis: DVec3) -> f64 {
    hypot(x.dot(axis), y.dot(axis))
}

impl DistanceAlong {
    /// Along centre + x cos φ + y sin φ; `None` for other cores, and where the curve may be nearer to an edge.
    pub fn new(core: &Primitive, centre: DVec3, axes: [DVec3; 2]) -> Option<Self> {
        match core {
            Primitive::Point(point) => {
                let around = AxisDistance::of_squares(centre - *point, axes);
                Some(Self::Axis(around))
            }
            Primitive::Segment(ends) => {
                Some(Self::Axis(AxisDistance::of_segment(ends, centre, axes)))
            }
            Primitive::Frustum(frustum) => Self::of_cylinder(frustum, centre, axes),
            Primitive::Box(block) => Some(Self::of_box(block, centre, axes)),
            Primitive::Circle(ring) => {
                let around =
                    AxisDistance::of_line(centre - ring.centre, axes, ring.axis, f64::INFINITY);
                Some(Self::Ring(around, sway_of(axes, ring.axis)))
            }
            _ => None,
        }
    }

    /// From a cylinder, or from beyond an end of a frustum.
    fn of_cylinder(frustum: &Frustum, centre: DVec3, axes: [DVec3; 2]) -> Option<Self> {
        let Frustum {
            from,
            axis,
            length,
            radii,
        } = *frustum;
        let along = (centre - from).dot(axis);
        let sway = sway_of(axes, axis);
        let [first, second] = radii;
        if along - sway >= 0.0 && along + sway <= length && first == second {
            let around = AxisDistance::of_line(centre - from, axes, axis, f64::INFINITY);
            return Some(Self::Axis(AxisDistance {
                inset: first,
                ..around
            }));
        }
        let across = |v: DVec3| v - axis * v.dot(axis);
        let widest = widest(axes.map(across));
        let reach = across(centre - from).length() + widest;
        let end = [
            (sway - along).max(along + sway - length),
            sway + SUMS * reach,
        ];
        let least = (-along).max(along - length) - sway;
        if first == second && first > 0.0 {
            let around = AxisDistance::of_line(centre - from, axes, axis, f64::INFINITY);
            let speed = 0.5 * around.rises / first;
            let bent = (speed + speed * speed / first).min(widest);
            let side = [reach - first, bent];
            return Some(Self::Parts {
                parts: [end, side, [0.0; 2]],
                least,
            });
        }
        // A cone's side leans: the whole curve must be beyond one end, and within its rim.
        let is_above = |beyond: f64, radius: f64| beyond >= sway && reach <= radius;
        let is_above = is_above(-along, first) || is_above(along - length, second);
        is_above.then_some(Self::Parts {
            parts: [end, [0.0; 2], [0.0; 2]],
            least,
        })
    }

    /// From a box.
    fn of_box(block: &BoxCore, centre: DVec3, axes: [DVec3; 2]) -> Self {
        let Pose {
            rotation,
            translation,
        } = block.from_box;
        let inside = |v: DVec3| rotation.transpose() * v;
        let (offset, [x, y]) = (inside(centre - translation).abs(), axes.map(inside));
        let rounding = SUMS * (offset.length() + x.length() + y.length());
        let sway = [0, 1, 2].map(|k| hypot(x[k], y[k]));
        let least = [0, 1, 2].map(|k| offset[k] - sway[k] - block.half[k]);
        Self::Parts {
            parts: [0, 1, 2].map(|k| [offset[k] + sway[k] - block.half[k], sway[k] + rounding]),
            least: least.into_iter().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    /// Bound on the downward second derivative of the distance between two places of the curve, which has at most this speed; `None`
    /// where that may vanish.
    pub fn bends(&self, spots: [&CurveSpot; 2], speed: f64) -> Option<f64> {
        match self {
            Self::Axis(around) => around.bends(spots, speed),
            Self::Parts { parts, least } => {
                let [a, b] = spots;
                let near = least.max(0.5 * (a.value + b.value - speed * (b.at - a.at)));
                let bends = parts.map(|[most, bent]| bent * (most / near).clamp(0.0, 1.0));
                (near > 0.0).then(|| bends.iter().sum())
            }
            Self::Ring(..) => None,
        }
    }

    /// The same of the distance f from a circle of radius R, whose axis is at least `near` away: f is the length of (ρ - R, z), with ρ
    /// across and z along the axis, so that f'' is at least -|(ρ'', z'')|.
    pub fn bends_of_ring(&self, near: f64) -> Option<f64> {
        let Self::Ring(around, sway) = self else {
            return None;
        };
        let speed = 0.5 * around.rises / near;
        let bends = hypot(speed + speed * speed / near, *sway);
        (near > 0.0).then_some(bends)
    }
}

impl AxisDistance {
    fn of_segment([from, to]: &[DVec3; 2], centre: DVec3, axes: [DVec3; 2]) -> Self {
        match (*to - *from).try_normalize() {
            None => Self::of_squares(centre - *from, axes),
            Some(axis) => {
                let offset = centre - from.midpoint(*to);
                Self::of_line(offset, axes, axis, 0.5 * from.distance(*to))
            }
        }
    }

    /// From the line through the middle of a segment, half as long as `half`.
    fn of_line(offset: DVec3, [x, y]: [DVec3; 2], axis: DVec3, half: f64) -> Self {
        let across = |v: DVec3| v - axis * v.dot(axis);
        let around = Self::of_squares(across(offset), [across(x), across(y)]);
        let sway = sway_of([x, y], axis);
        let beyond = (offset.dot(axis).abs() + sway - half).max(0.0);
        let bent = 2.0 * beyond * sway;
        Self {
            falls: around.falls + bent,
            rises: around.rises + bent + if beyond > 0.0 { 2.0 * sway * sway } else { 0.0 },
            ..around
        }
    }

    /// From |offset + x cos φ + y sin φ|².
    fn of_squares(offset: DVec3, [x, y]: [DVec3; 2]) -> Self {
        let once = 2.0 * hypot(offset.dot(x), offset.dot(y));
        let twice = 4.0 * hypot(0.5 * (x.length_squared() - y.length_squared()), x.dot(y));
        let size = (offset.length() + x.length() + y.length()).powi(2);
        let bends = once + twice + SUMS * size;
        Self {
            inset: 0.0,
            falls: bends,
            rises: bends,
        }
    }

    fn bends(&self, [a, b]: [&CurveSpot; 2], speed: f64) -> Option<f64> {
        let wide = b.at - a.at;
        let [first, second] = [a, b].map(|spot| spot.value + self.inset);
        // g is above its chord but for what it bends up.
        let square = first.min(second).powi(2) - 0.125 * self.rises * wide * wide;
        let steep = 0.5 * (first + second - speed * wide);
        let near = square.max(0.0).sqrt().max(steep);
        // In a cylinder the distance may be that of an end.
        if near.is_nan() || near <= self.inset {
            return None;
        }
        let slope = (first * a.slope).abs().max((second * b.slope).abs());
        let steepest = 2.0 * slope + 0.5 * self.rises * wide;
        Some(0.5 * self.falls / near + 0.25 * steepest * steepest / near.powi(3))
    }
}

#[cfg(test)]
mod tests {
    use super::super::primitive::Circle;
    use super::*;
    use glam::DMat3;

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
            Primitive::Circle(ring) => {
                let offset = point - ring.centre;
                let along = offset.dot(ring.axis);
                hypot((offset - ring.axis * along).length() - ring.radius, along)
            }
            Primitive::Box(block) => {
                let offset = (block.from_box.rotation.transpose()
                    * (point - block.from_box.translation))
                    .abs()
                    - block.half;
                let inside = offset.max_element().min(0.0);
                offset.max(DVec3::ZERO).length() + inside
            }
            Primitive::Frustum(frustum) => {
                let offset = point - frustum.from;
                let along = offset.dot(frustum.axis);
                let aside = (offset - frustum.axis * along).length() - frustum.radii[0];
                let beyond = (-along).max(along - frustum.length);
                match aside.max(beyond) < 0.0 {
                    true => aside.max(beyond),
                    false => hypot(aside.max(0.0), beyond.max(0.0)),
                }
            }
            _ => f64::NAN,
        }
    }

    fn cores(random: &mut Random) -> [Primitive; 6] {
        let (from, axis) = (random.vector(1.0), random.vector(1.0).normalize());
        let length = 0.1 + 3.0 * random.next().abs();
        let radius = 0.2 * random.next().abs();
        let cylinder = |radius: f64| {
            Primitive::Frustum(Frustum {
                from,
                axis,
                length,
                radii: [radius; 2],
            })
        };
        let (x, y) = axis.any_orthonormal_pair();
        let block = BoxCore {
            from_box: Pose {
                rotation: DMat3::from_cols(x, y, axis),
                translation: from,
            },
            half: DVec3::new(1.1, 3.0, 0.5),
        };
        [
            Primitive::Point(from),
            Primitive::Segment([from, from + axis * length]),
            cylinder(radius),
            cylinder(1.2),
            Primitive::Box(block),
            Primitive::Circle(Circle {
                centre: from,
                axis,
                radius: 0.3 + 0.9 * random.next().abs(),
            }),
        ]
    }

    /// Everywhere between two places the function is above its chord by no more than the bound allows.
    #[test]
    fn distances_bend_no_more_than_bounded() {
        let (mut random, mut looks) = (Random(0xa_7151), 0);
        for _ in 0..20_000 {
            // From far aside to nearly coaxial.
            let aside = libm::exp(-9.0 * random.next().abs());
            for core in cores(&mut random) {
                let (middle, axis) = middle_and_axis(&core);
                let (p, q) = axis.any_orthonormal_pair();
                let centre = middle + random.vector(aside);
                let [x, y] = [p, q].map(|v| v + random.vector(aside));
                let Some(known) = DistanceAlong::new(&core, centre, [x, y]) else {
                    continue;
                };
                let speed = (x.length_squared() + y.length_squared()).sqrt();
                let place = |t: f64| {
                    let (sin, cos) = crate::math::sin_cos(t);
                    centre + x * cos + y * sin
                };
                let f = |t: f64| distance(&core, place(t));
                let spot = |t: f64| CurveSpot {
                    at: t,
                    value: f(t),
                    slope: (f(t + 1e-6) - f(t - 1e-6)) / 2e-6,
                };
                let at = 3.0 * random.next();
                let wide = 0.01 + random.next().abs();
                let inside = (0..=64).map(|k| at + wide * f64::from(k) / 64.0);
                let bends = match &core {
                    Primitive::Circle(ring) => {
                        // As near as the curve comes to the axis, with room for what lies between these places.
                        let axis = Primitive::Segment([
                            ring.centre - ring.axis * 99.0,
                            ring.centre + ring.axis * 99.0,
                        ]);
                        let near = inside.map(|t| distance(&axis, place(t)));
                        let near = near.fold(f64::INFINITY, f64::min);
                        known.bends_of_ring(near - speed * wide / 128.0)
                    }
                    _ => known.bends([&spot(at), &spot(at + wide)], speed),
                };
                let Some(bends) = bends else {
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
        assert!(looks > 50_000, "{looks}");
    }

    fn middle_and_axis(core: &Primitive) -> (DVec3, DVec3) {
        match core {
            Primitive::Point(point) => (*point, DVec3::Z),
            Primitive::Segment([from, to]) => (from.midpoint(*to), (*to - *from).normalize()),
            // Around a thin cylinder, above the end of a thick one and above a box.
            Primitive::Frustum(f) if f.radii[0] < 1.0 => {
                (f.from + f.axis * (0.5 * f.length), f.axis)
            }
            Primitive::Frustum(f) => (f.from - f.axis * 0.3, f.axis),
            Primitive::Box(block) => {
                let axis = block.from_box.rotation.col(2);
                (block.from_box.translation + axis * 0.8, axis)
            }
            Primitive::Circle(ring) => (ring.centre + ring.axis * 0.4, ring.axis),
            _ => (DVec3::NAN, DVec3::NAN),
        }
    }

    /// Around its axis nothing bends, though the circle leaves its tangents.
    #[test]
    fn a_coaxial_circle_is_flat() {
        let core = Primitive::Segment([DVec3::NEG_Z, DVec3::Z]);
        let known = DistanceAlong::new(&core, DVec3::ZERO, [DVec3::X, DVec3::Y]);
        let spot = |at: f64| CurveSpot {
            at,
            value: 1.0,
            slope: 0.0,
        };
        let bends = known.and_then(|known| known.bends([&spot(0.0), &spot(0.8)], 1.0));
        assert!(bends.is_some_and(|bends| bends < 1e-11), "{bends:?}");
    }
}
