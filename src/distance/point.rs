//! Distance of a point from a core: closed forms with sign, nearest point and outward direction.

use super::primitive::{BoxCore, Circle, Frustum, HalfSpace, Primitive};
use crate::math::{Pose, square_to};
use glam::{DVec2, DVec3};

/// Position of a point relative to a core.
#[derive(Clone, Copy, Debug)]
pub struct PointHit {
    /// Negative inside a solid core.
    pub distance: f64,
    /// Nearest point of the core's surface.
    pub nearest: DVec3,
    /// Gradient of the distance: unit, away from the core; zero on a line core itself.
    pub normal: DVec3,
}

impl PointHit {
    /// The result for a core without an inside, from its nearest point.
    fn outside(point: DVec3, nearest: DVec3) -> Self {
        let span = point - nearest;
        let distance = span.length();
        Self {
            distance,
            nearest,
            normal: if distance > 0.0 {
                span / distance
            } else {
                DVec3::ZERO
            },
        }
    }
}

/// Distance of `point` from a core; `None` for meshes.
pub fn point_to(core: &Primitive, point: DVec3) -> Option<PointHit> {
    Some(match core {
        Primitive::Point(p) => PointHit::outside(point, *p),
        Primitive::Segment(ends) => to_segment(ends, point),
        Primitive::Circle(circle) => to_circle(circle, point),
        Primitive::Box(block) => to_box(block, point),
        Primitive::Frustum(frustum) => to_frustum(frustum, point),
        Primitive::Triangle(corners) => PointHit::outside(point, on_triangle(corners, point)),
        Primitive::HalfSpace(half) => to_half_space(half, point),
        Primitive::Mesh(..) => return None,
    })
}

/// Distance from a segment. Close to its line the direction is mostly rounding, but is still perpendicular to it.
pub fn to_segment(ends: &[DVec3; 2], point: DVec3) -> PointHit {
    let share = share_along(ends, point);
    let span = ends[1] - ends[0];
    let hit = PointHit::outside(point, ends[0] + span * share);
    if share <= 0.0 || share >= 1.0 {
        return hit;
    }
    PointHit {
        normal: square_to(span.normalize_or_zero(), hit.normal),
        ..hit
    }
}

/// Parameter of the nearest point of a segment, from 0 to 1.
fn share_along(ends: &[DVec3; 2], point: DVec3) -> f64 {
    let span = ends[1] - ends[0];
    let length_squared = span.length_squared();
    if length_squared == 0.0 {
        return 0.0;
    }
    ((point - ends[0]).dot(span) / length_squared).clamp(0.0, 1.0)
}

/// Nearest point of a segment.
pub fn on_segment(ends: &[DVec3; 2], point: DVec3) -> DVec3 {
    ends[0] + (ends[1] - ends[0]) * share_along(ends, point)
}

/// Distance from a circle.
pub fn to_circle(circle: &Circle, point: DVec3) -> PointHit {
    beside_circle(circle, point).0
}

/// Distance from a circle, and from its axis.
pub fn beside_circle(circle: &Circle, point: DVec3) -> (PointHit, f64) {
    let offset = point - circle.centre;
    let height = offset.dot(circle.axis);
    let across = offset - circle.axis * height;
    let rho = across.length();
    let outward = match square_to(circle.axis, across) {
        // All points of the circle are equally near: any of them will do.
        DVec3::ZERO => circle.directions()[0],
        outward => outward,
    };
    let nearest = circle.centre + outward * circle.radius;
    // Lengths are far from overflow: a root is faster than `hypot` and as exact.
    let distance = DVec2::new(rho - circle.radius, height).length();
    let normal = if distance > 0.0 {
        (outward * (rho - circle.radius) + circle.axis * height) / distance
    } else {
        DVec3::ZERO
    };
    let hit = PointHit {
        distance,
        nearest,
        normal,
    };
    (hit, rho)
}

/// Distance from a half-space.
pub fn to_half_space(half: &HalfSpace, point: DVec3) -> PointHit {
    let distance = half.normal.dot(point - half.point);
    PointHit {
        distance,
        nearest: point - half.normal * distance,
        normal: half.normal,
    }
}

/// Distance from the disc that a circle bounds, which has no inside.
pub fn to_disc(circle: &Circle, point: DVec3) -> PointHit {
    let offset = point - circle.centre;
    let height = offset.dot(circle.axis);
    let across = offset - circle.axis * height;
    if across.length_squared() >= circle.radius * circle.radius {
        return to_circle(circle, point);
    }
    PointHit::outside(point, point - circle.axis * height)
}

fn to_box(block: &BoxCore, point: DVec3) -> PointHit {
    let Pose {
        rotation,
        translation,
    } = block.from_box;
    let local = rotation.transpose() * (point - translation);
    // Outside: the nearest point is the clamped one.
    let clamped = local.clamp(-block.half, block.half);
    let out = local - clamped;
    let distance = out.length();
    if distance > 0.0 {
        return PointHit {
            distance,
            nearest: rotation * clamped + translation,
            normal: rotation * (out / distance),
        };
    }
    // Inside: the nearest face gives the depth and the normal.
    let gaps = block.half - local.abs();
    let axis = (0..3).fold(0, |best, k| if gaps[k] < gaps[best] { k } else { best });
    let sign = if local[axis] < 0.0 { -1.0 } else { 1.0 };
    let mut nearest = local;
    nearest[axis] = sign * block.half[axis];
    PointHit {
        distance: -gaps[axis],
        nearest: rotation * nearest + translation,
        normal: rotation.col(axis) * sign,
    }
}

/// Farther off the axis than this fraction of the height, the rounding of the direction is no larger than that of
/// numbers.
const FAR_OUT: f64 = 0.5;

fn to_frustum(frustum: &Frustum, point: DVec3) -> PointHit {
    let offset = point - frustum.from;
    let height = offset.dot(frustum.axis);
    let across = offset - frustum.axis * height;
    let rho = across.length();
    // The remaining offset from the axis is exact unless it is short compared with the distance along it.
    let outward = if rho > height.abs() * FAR_OUT {
        across / rho
    } else {
        match square_to(frustum.axis, across) {
            DVec3::ZERO => Pose::from_z_axis(frustum.axis).rotation.x_axis,
            outward => outward,
        }
    };
    let (distance, nearest, normal) = to_profile(frustum, DVec2::new(rho, height));
    let space = |v: DVec2| outward * v.x + frustum.axis * v.y;
    PointHit {
        distance,
        nearest: frustum.from + space(nearest),
        normal: space(normal),
    }
}

/// Signed distance, nearest point and normal in the half plane (radius, height).
fn to_profile(frustum: &Frustum, p: DVec2) -> (f64, DVec2, DVec2) {
    let [low, high] = frustum.radii;
    let top = frustum.length;
    if low == high {
        return to_rectangle(DVec2::new(low, top), p);
    }
    let corners = [
        DVec2::ZERO,
        DVec2::new(low, 0.0),
        DVec2::new(high, top),
        DVec2::new(0.0, top),
    ];
    let mut inside = true;
    let mut best = (f64::INFINITY, DVec2::ZERO, DVec2::ZERO);
    for k in 0..3 {
        let (a, b) = (corners[k], corners[k + 1]);
        let span = b - a;
        // The outward side of the edge is on the right of its direction.
        let outward = DVec2::new(span.y, -span.x).normalize_or_zero();
        inside &= outward.dot(p - a) <= 0.0;
        let length_squared = span.length_squared();
        let t = if length_squared > 0.0 {
            ((p - a).dot(span) / length_squared).clamp(0.0, 1.0)
        } else {
            0.0
        };
        let nearest = a + span * t;
        let distance = p.distance(nearest);
        // A face of no width (the apex of a cone) has no outward side.
        if distance < best.0 && (length_squared > 0.0 || !inside) {
            best = (distance, nearest, outward);
        }
    }
    let (distance, nearest, outward) = best;
    if inside {
        return (-distance, nearest, outward);
    }
    let normal = if distance > 0.0 {
        (p - nearest) / distance
    } else {
        outward
    };
    (distance, nearest, normal)
}

/// The same of a cylinder, whose profile is a rectangle.
fn to_rectangle(corner: DVec2, p: DVec2) -> (f64, DVec2, DVec2) {
    let clamped = DVec2::new(p.x.min(corner.x), p.y.clamp(0.0, corner.y));
    let out = p - clamped;
    let distance = out.length();
    if distance > 0.0 {
        return (distance, clamped, out / distance);
    }
    // Inside: through the nearest of its side and its ends.
    let exits = [
        (p.y, DVec2::new(p.x, 0.0), DVec2::NEG_Y),
        (corner.x - p.x, DVec2::new(corner.x, p.y), DVec2::X),
        (corner.y - p.y, DVec2::new(p.x, corner.y), DVec2::Y),
    ];
    let nearer = |best: (f64, DVec2, DVec2), next: (f64, DVec2, DVec2)| match next.0 < best.0 {
        true => next,
        false => best,
    };
    let (depth, nearest, normal) = exits[1..].iter().copied().fold(exits[0], nearer);
    (-depth, nearest, normal)
}

/// Nearest point of a triangle: the foot in its plane if it lies inside, else the nearest point of its edges.
pub fn on_triangle(corners: &[DVec3; 3], point: DVec3) -> DVec3 {
    let [a, b, c] = *corners;
    let normal = (b - a).cross(c - a);
    let size = normal.length_squared();
    if size > 0.0 {
        let within = |p: DVec3, q: DVec3| normal.dot((q - p).cross(point - p)) >= 0.0;
        if within(a, b) && within(b, c) && within(c, a) {
            return point - normal * (normal.dot(point - a) / size);
        }
    }
    let feet = [[a, b], [b, c], [c, a]].map(|edge| on_segment(&edge, point));
    feet.into_iter().fold(feet[0], |best, foot| {
        if foot.distance_squared(point) < best.distance_squared(point) {
            foot
        } else {
            best
        }
    })
}
