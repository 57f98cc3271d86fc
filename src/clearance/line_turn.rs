//! The rotation of the line between the nearest points of two solids while one of them moves.
//!
//! The nearest points rest on corners, slide along edges and faces, and roll around round parts. To first
//! order the farthest point of a convex core along n shifts by S t if n rotates by t, where S is zero at a corner, the
//! radius across an axis, and infinite along an edge or a face. For a plane that rotates with the line the error is
//! quadratic in the time.

use super::meeting::Meeting;
use crate::distance::primitive::{Circle, Primitive};
use glam::{DMat2, DVec2, DVec3};

/// A point is inside an edge or a face if it is farther from the ends than this fraction of its length.
const WITHIN: f64 = 1e-9;

/// Replaces an infinite radius, in distances and radii of a pair.
const ENDLESS: f64 = 1e6;

/// Two directions count as perpendicular up to this cosine.
const SQUARE: f64 = 1e-6;

/// Directions across the normal along which a point shifts, with the shift per radian of rotation; infinite along straight
/// lines.
type Shifts = [Option<(DVec3, f64)>; 3];

/// The shift of the farthest point of a core along `n`, now `point`, if `n` rotates.
fn shifts_of(core: &Primitive, point: DVec3, n: DVec3) -> Shifts {
    const FLAT: f64 = f64::INFINITY;
    match core {
        Primitive::Segment(ends) => [within([ends[0], ends[1]], point), None, None],
        Primitive::Box(block) => {
            let local = block.from_box.inverse().transform_point(point);
            [0, 1, 2].map(|k| {
                let is_inside = local[k].abs() < block.half[k] * (1.0 - WITHIN);
                is_inside.then(|| (block.from_box.rotation.col(k), FLAT))
            })
        }
        Primitive::Triangle([a, b, c]) => {
            let normal = (*b - *a).cross(*c - *a);
            let part = |p: DVec3, q: DVec3| (q - p).cross(point - p).dot(normal);
            let least = WITHIN * normal.length_squared();
            // The corners that have a share in the point.
            let has = [part(*b, *c), part(*c, *a), part(*a, *b)].map(|share| share > least);
            let edge = |p: &DVec3, q: &DVec3| (*q - *p).try_normalize().map(|e| (e, FLAT));
            match has {
                [true, true, true] => {
                    let along = (*b - *a).normalize_or_zero();
                    let across = normal.cross(along).normalize_or_zero();
                    [Some((along, FLAT)), Some((across, FLAT)), None]
                }
                [true, true, false] => [edge(a, b), None, None],
                [false, true, true] => [edge(b, c), None, None],
                [true, false, true] => [edge(c, a), None, None],
                _ => [None; 3],
            }
        }
        // The ring's own point follows the direction around.
        Primitive::Circle(circle) => [rolled(circle, circle.radius, n), None, None],
        Primitive::Frustum(f) => {
            let height = (point - f.from).dot(f.axis);
            let share = (height / f.length).clamp(0.0, 1.0);
            let radius = f.radii[0] + share * (f.radii[1] - f.radii[0]);
            let out = point - f.from - f.axis * height;
            let rim = Circle {
                centre: f.from + f.axis * height,
                axis: f.axis,
                radius,
            };
            // On the side, at a rim, or on a lid.
            let is_side = share > WITHIN && share < 1.0 - WITHIN;
            if is_side {
                let along = f.axis * f.length + rim.outward(out) * (f.radii[1] - f.radii[0]);
                let along = along.try_normalize().map(|along| (along, FLAT));
                [along, rolled(&rim, radius, n), None]
            } else if out.length() < radius * (1.0 - WITHIN) {
                let [x, y] = rim.directions();
                [Some((x, FLAT)), Some((y, FLAT)), None]
            } else {
                [rolled(&rim, radius, n), None, None]
            }
        }
        Primitive::HalfSpace(half) => {
            let [x, y] = Circle {
                centre: half.point,
                axis: half.normal,
                radius: 0.0,
            }
            .directions();
            [Some((x, FLAT)), Some((y, FLAT)), None]
        }
        Primitive::Point(_) | Primitive::Mesh(..) => [None; 3],
    }
}

/// Along a segment, from a point within it.
fn within([a, b]: [DVec3; 2], point: DVec3) -> Option<(DVec3, f64)> {
    let span = b - a;
    let share = (point - a).dot(span) / span.length_squared();
    let is_inside = share > WITHIN && share < 1.0 - WITHIN;
    is_inside.then(|| (span.normalize_or_zero(), f64::INFINITY))
}

/// Around a circle: the more, the more nearly the direction is that of its axis.
fn rolled(circle: &Circle, radius: f64, n: DVec3) -> Option<(DVec3, f64)> {
    let across = (n - circle.axis * n.dot(circle.axis)).length();
    let along = circle.axis.cross(circle.outward(n));
    (across > SQUARE).then(|| (along, radius / across))
}

impl Meeting<'_> {
    /// How far the unit vector along the line between the nearest points of the cores turns, to first order; `None` where that
    /// is not known.
    pub(super) fn line_turn(&self) -> Option<DVec3> {
        let n = self.found.normal;
        let apart = self.found.distance + self.radii();
        if apart <= 0.0 || n == DVec3::ZERO {
            return None;
        }
        let [from, to] = self.core_points();
        let x = n.any_orthonormal_vector();
        let y = n.cross(x);
        // Coordinates across the line.
        let flat = |v: DVec3| DVec2::new(v.dot(x), v.dot(y));
        let sizes = apart + self.a.core.bounds().1.min(self.b.core.bounds().1);
        // By how much the nearest point of a core shifts for a turn of the line.
        let bend = |core: &Primitive, point: DVec3, n: DVec3| {
            let all = shifts_of(core, point, n).into_iter().flatten();
            all.fold(DMat2::ZERO, |sum, (along, by)| {
                let (e, by) = (flat(along), by.min(ENDLESS * sizes));
                sum + DMat2::from_cols(e * (e.x * by), e * (e.y * by))
            })
        };
        // (apart + Sa + Sb) t = X + Sb (spin × n), since b sees the line turn by t - spin × n.
        let mine = bend(&self.a.core, from, n);
        let theirs = bend(&self.b.core, to, -n);
        let all = DMat2::from_diagonal(DVec2::splat(apart)) + mine + theirs;
        // How fast one point leaves the other across the line.
        let rate = flat(self.moved.rate(to)) + theirs * flat(self.moved.spin.cross(n));
        let turn = all.inverse() * rate;
        turn.is_finite().then(|| x * turn.x + y * turn.y)
    }
}
