//! Exact distances of a triangle from a segment, a triangle, a box, and of boxes from segments: closed forms.
//!
//! Two triangles are nearest at two edges, or at a corner and a face, or they cut each other. Where the slab between the
//! nearest points of two edges has both triangles outside of it, it proves them to be the nearest of all.

use super::primitive::BoxCore;
use super::primitive_pair::CorePair;
use glam::DVec3;

/// A triangle.
type TriangleCorners = [DVec3; 3];

/// Lines with a smaller sine between them are treated as parallel: the ends are tried in addition to the crossing.
const PARALLEL: f64 = 1e-6;

/// A vector this short compared with its end points is rounding, and its direction means nothing.
const NOISE: f64 = 1e-14;

/// The edges of a triangle, each with the corner that is not on it.
const EDGES: [[usize; 3]; 3] = [[0, 1, 2], [1, 2, 0], [2, 0, 1]];

/// Two points and the square of their distance.
#[derive(Clone, Copy)]
struct NearestFeature {
    square: f64,
    points: [DVec3; 2],
}

impl NearestFeature {
    const FAR: Self = Self {
        square: f64::INFINITY,
        points: [DVec3::ZERO; 2],
    };

    /// A pair of equal points.
    const fn cut(point: DVec3) -> Self {
        Self {
            square: 0.0,
            points: [point; 2],
        }
    }

    fn of(p: DVec3, q: DVec3) -> Self {
        Self {
            square: p.distance_squared(q),
            points: [p, q],
        }
    }

    fn nearer(self, other: Self) -> Self {
        if other.square < self.square {
            other
        } else {
            self
        }
    }

    fn swapped(self) -> Self {
        let [p, q] = self.points;
        Self {
            points: [q, p],
            ..self
        }
    }

    fn pair(self) -> CorePair {
        let span = self.points[1] - self.points[0];
        let distance = span.length();
        CorePair {
            distance,
            points: self.points,
            normal: if distance > 0.0 {
                span / distance
            } else {
                DVec3::ZERO
            },
            missed: 0.0,
        }
    }
}

/// Nearest points of two segments.
fn of_segments([a, a_end]: [DVec3; 2], [b, b_end]: [DVec3; 2]) -> NearestFeature {
    let (u, v, w) = (a_end - a, b_end - b, b - a);
    let across = u.cross(v);
    let sine = across.length_squared();
    let [uu, vv] = [u.length_squared(), v.length_squared()];
    // Inside both: the cross product gives it without cancellation, and the foot stays on the other line.
    let s = w.cross(v).dot(across) / sine;
    let t = w.cross(u).dot(across) / sine;
    let mut best = NearestFeature::FAR;
    if (0.0..=1.0).contains(&s) && (0.0..=1.0).contains(&t) {
        let on_first = a + u * s;
        let foot = (v.dot(on_first - b) / vv).clamp(0.0, 1.0);
        best = NearestFeature::of(on_first, b + v * foot);
        if sine > PARALLEL * PARALLEL * uu * vv {
            return best;
        }
    }
    let share = |along: f64, square: f64| {
        if square > 0.0 {
            (along / square).clamp(0.0, 1.0)
        } else {
            0.0
        }
    };
    for (end, t) in [(a, -v.dot(w)), (a_end, v.dot(u - w))] {
        best = best.nearer(NearestFeature::of(end, b + v * share(t, vv)));
    }
    for (end, s) in [(b, u.dot(w)), (b_end, u.dot(w + v))] {
        best = best.nearer(NearestFeature::of(a + u * share(s, uu), end));
    }
    best
}

/// The nearest points of a point and the inside of a triangle; none outside of the prism over it.
fn over_face(corners: &TriangleCorners, normal: DVec3, point: DVec3) -> Option<NearestFeature> {
    let [a, b, c] = *corners;
    let within = |p: DVec3, q: DVec3| normal.dot((q - p).cross(point - p)) >= 0.0;
    let size = normal.length_squared();
    (size > 0.0 && within(a, b) && within(b, c) && within(c, a)).then(|| {
        let foot = point - normal * (normal.dot(point - a) / size);
        NearestFeature::of(foot, point)
    })
}

/// Where a segment passes through a triangle: rounding would leave a distance.
fn plane_crossing(corners: &TriangleCorners, normal: DVec3, ends: [DVec3; 2]) -> Option<DVec3> {
    let [a, b, c] = *corners;
    let [from, to] = ends.map(|p| normal.dot(p - a));
    if from * to > 0.0 || from == to {
        return None;
    }
    let point = ends[0] + (ends[1] - ends[0]) * (from / (from - to));
    let within = |p: DVec3, q: DVec3| normal.dot((q - p).cross(point - p)) >= 0.0;
    (within(a, b) && within(b, c) && within(c, a)).then_some(point)
}

fn normal_of([a, b, c]: &TriangleCorners) -> DVec3 {
    (*b - *a).cross(*c - *a)
}

/// Nearest points of a triangle and a segment.
pub fn to_segment(corners: &TriangleCorners, ends: &[DVec3; 2]) -> CorePair {
    let normal = normal_of(corners);
    if let Some(point) = plane_crossing(corners, normal, *ends) {
        return NearestFeature::cut(point).pair();
    }
    let mut best = NearestFeature::FAR;
    for [i, j, _] in EDGES {
        best = best.nearer(of_segments([corners[i], corners[j]], *ends));
    }
    for end in ends {
        best = best.nearer(over_face(corners, normal, *end).unwrap_or(NearestFeature::FAR));
    }
    best.pair()
}

/// Nearest points of two triangles.
pub fn to_triangle(a: &TriangleCorners, b: &TriangleCorners) -> CorePair {
    let mut best = NearestFeature::FAR;
    // Edge against edge; where the third corners lie beyond the two planes, this is the nearest pair.
    for [i, j, third] in EDGES {
        for [k, l, other] in EDGES {
            let near = of_segments([a[i], a[j]], [b[k], b[l]]);
            if near.square >= best.square {
                continue;
            }
            best = near;
            let [p, q] = near.points;
            let span = q - p;
            let is_noise =
                near.square <= (NOISE * NOISE) * (p.length_squared() + q.length_squared());
            if !is_noise && span.dot(a[third] - p) <= 0.0 && span.dot(b[other] - q) >= 0.0 {
                return best.pair();
            }
        }
    }
    // An edge through the other triangle: they intersect.
    let normals = [normal_of(a), normal_of(b)];
    let cut = |of: &TriangleCorners, normal: DVec3, other: &TriangleCorners| {
        let edges = EDGES.map(|[i, j, _]| [other[i], other[j]]);
        edges
            .into_iter()
            .find_map(|edge| plane_crossing(of, normal, edge))
    };
    if let Some(point) = cut(a, normals[0], b).or_else(|| cut(b, normals[1], a)) {
        return NearestFeature::cut(point).pair();
    }
    // Corner over face, both ways.
    for k in 0..3 {
        best = best.nearer(over_face(a, normals[0], b[k]).unwrap_or(NearestFeature::FAR));
        let back = over_face(b, normals[1], a[k]).unwrap_or(NearestFeature::FAR);
        best = best.nearer(back.swapped());
    }
    best.pair()
}

/// Nearest points of a triangle and a box; a common point at no distance where they overlap.
pub fn to_box(corners: &TriangleCorners, block: &BoxCore) -> CorePair {
    let from_box = block.from_box;
    let back = from_box.inverse();
    let local = corners.map(|p| back.transform_point(p));
    let found = to_centred_box(&local, block.half);
    CorePair {
        points: found.points.map(|p| from_box.transform_point(p)),
        normal: from_box.transform_vector(found.normal),
        ..found
    }
}

/// Nearest points of a box and a segment that does not touch it.
pub fn box_to_segment(block: &BoxCore, ends: &[DVec3; 2]) -> Option<CorePair> {
    let from_box = block.from_box;
    let back = from_box.inverse();
    let [from, to] = ends.map(|p| back.transform_point(p));
    if inside_box(from, to, block.half).is_some() {
        return None;
    }
    let point = on_edge(from, to, block.half);
    let found = NearestFeature::of(point.clamp(-block.half, block.half), point).pair();
    (found.distance > 0.0).then(|| CorePair {
        points: found.points.map(|p| from_box.transform_point(p)),
        normal: from_box.transform_vector(found.normal),
        ..found
    })
}

/// The same for a box about the origin, aligned with the axes.
fn to_centred_box(corners: &TriangleCorners, half: DVec3) -> CorePair {
    let mut best = NearestFeature::FAR;
    for [i, j, _] in EDGES {
        if let Some(point) = inside_box(corners[i], corners[j], half) {
            return NearestFeature::cut(point).pair();
        }
        let point = on_edge(corners[i], corners[j], half);
        best = best.nearer(NearestFeature::of(point, point.clamp(-half, half)));
    }
    // The face: the corners of the box that lie farthest on either side of its plane.
    let normal = normal_of(corners);
    let sign = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    let corner = half * DVec3::new(sign(normal.x), sign(normal.y), sign(normal.z));
    if let Some(point) = plane_crossing(corners, normal, [corner, -corner]) {
        return NearestFeature::cut(point).pair();
    }
    for corner in [corner, -corner] {
        best = best.nearer(over_face(corners, normal, corner).unwrap_or(NearestFeature::FAR));
    }
    best.pair()
}

/// A point of an edge in a box about the origin, from where the edge enters and leaves the slabs of the box.
fn inside_box(from: DVec3, to: DVec3, half: DVec3) -> Option<DVec3> {
    let span = to - from;
    let (mut enters, mut leaves) = (0.0_f64, 1.0_f64);
    for k in 0..3 {
        if span[k] == 0.0 {
            if from[k].abs() > half[k] {
                return None;
            }
            continue;
        }
        let [s, t] = [-half[k], half[k]].map(|side| (side - from[k]) / span[k]);
        enters = enters.max(s.min(t));
        leaves = leaves.min(s.max(t));
    }
    (enters <= leaves).then(|| from + span * (0.5 * (enters + leaves)))
}

/// The point of an edge nearest to a box about the origin. The square of the distance is a parabola between the places
/// where a coordinate enters or leaves the box; its slope increases along the whole edge.
fn on_edge(from: DVec3, to: DVec3, half: DVec3) -> DVec3 {
    let span = to - from;
    // Half the derivative of the squared distance to the box: piecewise linear and rising.
    let slope = |t: f64| {
        let point = from + span * t;
        (point - point.clamp(-half, half)).dot(span)
    };
    let (mut low, mut high) = ((0.0, slope(0.0)), (1.0, slope(1.0)));
    if low.1 >= 0.0 {
        return from;
    }
    if high.1 <= 0.0 {
        return to;
    }
    // Its kinks are where the edge crosses the planes of the sides; the zero lies between two of them.
    for k in 0..3 {
        for side in [-half[k], half[k]] {
            let t = (side - from[k]) / span[k];
            if t > low.0 && t < high.0 {
                let here = (t, slope(t));
                if here.1 < 0.0 {
                    low = here;
                } else {
                    high = here;
                }
            }
        }
    }
    let t = low.0 + (high.0 - low.0) * (low.1 / (low.1 - high.1));
    from + span * t
}
