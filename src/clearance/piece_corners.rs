//! Corners of solids, and their positions when the dimensions move the points of the solid.

use super::relative::WIDER;
use crate::distance::primitive::{Circle, Element, Frustum, Primitive};
use crate::math::{Pose, sin_cos};
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Corners of the polygon that replaces a circle whose plane is nearly perpendicular to the normal.
const CORNERS: usize = 32;

/// Sine of the angle below which it is replaced.
const NEARLY_FLAT: f64 = 0.05;

/// A corner of an element.
pub(super) struct Corner {
    /// Vectors of the shape that it moves with, and its shares in them.
    pub(super) on: [(usize, f64); 2],
    /// Its position from the ends of these vectors, in their directions.
    pub(super) offset: DVec3,
}

/// Points one of which is farthest along `n` for rotations of the circle up to this one, to within a length.
pub(super) fn rim_corners(circle: &Circle, n: DVec3, turned: f64) -> (Vec<DVec3>, f64) {
    let (centre, radius) = (circle.centre, circle.radius);
    let across = (n - circle.axis * n.dot(circle.axis)).length();
    if across >= NEARLY_FLAT && turned <= across {
        // b beside the farthest point b*: n (b - b*) = -2 r |Pn| s² with s the sine of half the angle between them, and turning adds no
        // more than 2 r τ s: together at most r τ² / (2 |Pn|).
        let lost = radius * turned * turned / (2.0 * across);
        return (vec![centre + circle.outward(n) * radius], lost);
    }
    let [x, y] = circle.directions();
    let corner = |k: usize| {
        let (sin, cos) = sin_cos(TAU * k as f64 / CORNERS as f64);
        centre + (x * cos + y * sin) * radius
    };
    let (_, cos) = sin_cos(PI / CORNERS as f64);
    let above = radius * (1.0 - cos) * (across + turned).min(1.0);
    ((0..CORNERS).map(corner).collect(), above * WIDER)
}

/// A corner as it is carried by the nearest line between two neighbours of the points at `ends`.
pub(super) fn carried_corner(ends: &[Pose], place: DVec3) -> Corner {
    let mut best = ([(0, 1.0), (0, 0.0)], f64::INFINITY, ends[0].translation);
    for (k, pair) in ends.windows(2).enumerate() {
        let [p, q] = [pair[0].translation, pair[1].translation];
        let span = q - p;
        // Foot of the perpendicular on this side of the polygon.
        let share = (place - p).dot(span) / span.length_squared();
        let share = if share.is_finite() {
            share.clamp(0.0, 1.0)
        } else {
            0.0
        };
        let on = p + span * share;
        let off = place.distance_squared(on);
        if off < best.1 {
            best = ([(k, 1.0 - share), (k + 1, share)], off, on);
        }
    }
    Corner {
        on: best.0,
        offset: ends[0].rotation.transpose() * (place - best.2),
    }
}

/// An element whose points go with the ends of ways from where they were.
pub(super) fn carried_element(element: &Element, before: &[Pose], after: &[Pose]) -> Element {
    // A point moves with the two ends of its nearest line, in the shares of its foot on that line.
    let moved = |place: DVec3| {
        let corner = carried_corner(before, place);
        let ends = corner.on.iter();
        ends.map(|(k, share)| *share * after[*k].transform_point(corner.offset))
            .sum::<DVec3>()
    };
    // A core that points determine follows these points, ...
    let core = match &element.core {
        Primitive::Point(p) => Primitive::Point(moved(*p)),
        Primitive::Segment(ends) => Primitive::Segment(ends.map(moved)),
        Primitive::Triangle(corners) => Primitive::Triangle(corners.map(moved)),
        // ... a frustum follows the ends of its spine; its radii stay, ...
        Primitive::Frustum(frustum) => {
            let [from, to] = frustum.spine().map(moved);
            Primitive::Frustum(Frustum {
                from,
                axis: (to - from).normalize_or(frustum.axis),
                length: from.distance(to),
                radii: frustum.radii,
            })
        }
        // ... and all others move with the first end as rigid bodies.
        other => other.moved(&(after[0] * before[0].inverse())),
    };
    Element {
        core,
        ..element.clone()
    }
}
