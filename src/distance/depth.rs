//! The depth of overlap of two convex cores: the shortest translation that separates them.
//!
//! For a direction n the separating translation is known from the support functions; the depth is the least of these.
//! It is attained at the flat faces of the Minkowski difference (normals of faces, cross products of edges), or where
//! an edge of one solid, or the straight side of a cylinder or cone, meets a rim or corner of the other: then n varies
//! on a circle of directions, which is searched as a whole. The remaining case is two rims, which meet on a surface
//! that is curved in both directions: its point nearest to the origin is a minimum of the distance of the two circles,
//! and all of these are tried.

use super::primitive::{Frustum, Primitive};
use super::primitive_distance::nearest_cores;
use super::primitive_pair::CorePair;
use super::rims::rim_directions;
use super::search::{CurveSpot, MOST_SPOTS, Nearness, least_on_circle, lowest_of_bent};
use crate::math::{Pose, sin_cos};
use glam::DVec3;

/// Cores farther apart than this, relative to their size, are disjoint in spite of rounding.
const SEEN_APART: f64 = 1e-10;

/// A separating translation may be missed if it is shorter by at most this fraction of the extent: rounding.
const MISSED: f64 = 1e-12;

/// Bends are computed to within this factor.
const BEND_ROUNDING: f64 = 1.0 + 1e-9;

/// A direction and the length of the separating translation along it.
#[derive(Clone, Copy)]
struct Exit {
    way: f64,
    n: DVec3,
}

impl Exit {
    /// Tries both signs of a direction of any length.
    fn take(&mut self, a: &Primitive, b: &Primitive, n: DVec3) {
        if let Some(n) = n.try_normalize() {
            for n in [n, -n] {
                let found = exit_along(a, b, n);
                if found.way < self.way {
                    *self = found;
                }
            }
        }
    }
}

impl Exit {
    /// Tries the best direction of a ring.
    fn take_from(&mut self, a: &Primitive, b: &Primitive, ring: &DepthRing, bends: [f64; 2]) {
        let n = ring_direction([a, b], ring, bends, self.way);
        self.take(a, b, n);
    }
}

/// Directions n = (u cos φ + v sin φ) cos β + w sin β.
struct DepthRing {
    u: DVec3,
    v: DVec3,
    lift: DVec3,
}

impl DepthRing {
    /// All directions at right angles to `axis`, tilted towards it by an angle with this sine.
    fn about(axis: DVec3, sine: f64) -> Self {
        let (u, v) = axis.any_orthonormal_pair();
        let cosine = (1.0 - sine * sine).max(0.0).sqrt();
        Self {
            u: u * cosine,
            v: v * cosine,
            lift: axis * sine,
        }
    }
}

/// Normals of flat faces.
fn face_normals(core: &Primitive) -> Vec<DVec3> {
    match core {
        Primitive::Box(block) => {
            let r = block.from_box.rotation;
            vec![r.x_axis, r.y_axis, r.z_axis]
        }
        Primitive::Frustum(frustum) => vec![frustum.axis],
        Primitive::Triangle([a, b, c]) => vec![(*b - *a).cross(*c - *a).normalize_or_zero()],
        _ => Vec::new(),
    }
}

/// Directions of straight edges, the sides of a cylinder among them.
fn edge_directions(core: &Primitive) -> Vec<DVec3> {
    match core {
        Primitive::Segment([a, b]) => vec![(*b - *a).normalize_or_zero()],
        Primitive::Box(_) => face_normals(core),
        Primitive::Frustum(f) if f.radii[0] == f.radii[1] => vec![f.axis],
        Primitive::Triangle([a, b, c]) => [*b - *a, *c - *b, *a - *c]
            .map(DVec3::normalize_or_zero)
            .to_vec(),
        _ => Vec::new(),
    }
}

/// Sine of the angle by which the normals of the side are tilted towards the axis.
fn side_lean(f: &Frustum) -> f64 {
    let fall = f.radii[0] - f.radii[1];
    fall / libm::hypot(fall, f.length)
}

/// The point of the difference a - b that lies farthest along n.
fn farthest_direction(a: &Primitive, b: &Primitive, n: DVec3) -> Option<DVec3> {
    Some(a.support_point(n)? - b.support_point(-n)?)
}

fn exit_along(a: &Primitive, b: &Primitive, n: DVec3) -> Exit {
    let way = match (a.support(n), b.support(-n)) {
        (Some(a), Some(b)) => a + b,
        _ => f64::INFINITY,
    };
    Exit { way, n }
}

/// The shortest translation that separates two convex cores; `near` is the pair of points that showed the overlap. A depth
/// of at most `least` is not determined: then the result may be any between it and `least`, with other points.
pub fn overlap_depth(a: &Primitive, b: &Primitive, near: CorePair, least: f64) -> CorePair {
    let mut best = Exit {
        way: f64::INFINITY,
        n: DVec3::Z,
    };
    let mut take = |n: DVec3| best.take(a, b, n);
    let (first, second) = (edge_directions(a), edge_directions(b));
    face_normals(a).into_iter().for_each(&mut take);
    face_normals(b).into_iter().for_each(&mut take);
    for u in &first {
        second.iter().for_each(|v| take(u.cross(*v)));
    }
    take(near.normal);
    // What is no deeper than this needs no search.
    if best.way <= least {
        return CorePair {
            distance: -best.way.max(0.0),
            normal: best.n,
            missed: 0.0,
            ..near
        };
    }
    for (round, other, edges) in [(a, b, &second), (b, a, &first)] {
        if let Primitive::Frustum(f) = round {
            // The edges of the other one on the rims, and the side of this one on the corners and rims of the other.
            let sign = if std::ptr::eq(round, a) { 1.0 } else { -1.0 };
            let side = DepthRing::about(f.axis, sign * side_lean(f));
            let [(p, r), (q, s)] = [a.bounds(), b.bounds()];
            let steepest = p.distance(q) + r + s;
            match other {
                // The edge of another cylinder is its own side.
                Primitive::Frustum(g) => {
                    let bend = bend_of_rims(f, g, &side).min(steepest);
                    best.take_from(a, b, &side, [bend, steepest]);
                }
                _ => {
                    let lines = edges.iter().map(|e| DepthRing::about(*e, 0.0));
                    for ring in lines.chain([side]) {
                        best.take_from(a, b, &ring, [steepest; 2]);
                    }
                }
            }
        }
    }
    if let (Primitive::Frustum(f), Primitive::Frustum(g)) = (a, b) {
        for rim in f.rims() {
            for other in g.rims() {
                for n in rim_directions(&rim, &other, best.way) {
                    best.take(a, b, n);
                }
            }
        }
    }
    let way = best.way.max(0.0);
    CorePair {
        distance: -way,
        points: touching_points(a, b, best.n * way, best.n).unwrap_or(near.points),
        normal: best.n,
        missed: 0.0,
    }
}

/// The contact of two cores after the separating translation `way` along `n`, in the original position: the second core
/// is moved twice as far along `n`, which does not change the nearest points.
fn touching_points(a: &Primitive, b: &Primitive, way: DVec3, n: DVec3) -> Option<[DVec3; 2]> {
    let least = SEEN_APART * a.bounds().1.max(b.bounds().1);
    let farther = way + n * way.length().max(least);
    let parted = nearest_cores(a, &b.moved(&Pose::from_translation(farther)));
    (parted.distance > 0.0).then(|| [parted.points[0], parted.points[1] - farther])
}

/// How much the way out, as a function of the angle on the ring of the sides of `f`, may be bent downwards: minus its least
/// second derivative. The support of `f` itself is that of a point there, up to a constant; that of `g` is the larger of its
/// two rims: each the support of its centre, which is bent by its distance from the axis of `f`, and R √(1 - y²), where
/// y = n · axis of `g` = y₀ + A cos φ. The second derivative of that is at least -R (A²/F³ + |y| A/F) with F = √(1 - y²).
fn bend_of_rims(f: &Frustum, g: &Frustum, ring: &DepthRing) -> f64 {
    let cosine = ring.u.length();
    let along = f.axis.cross(g.axis).length() * cosine;
    let highest = (ring.lift.dot(g.axis).abs() + along).min(1.0);
    let least = (1.0 - highest * highest).sqrt();
    let of_unit = along * (along / (least * least) + highest) / least;
    let bends = g.rims().map(|rim| {
        let from_axis = f.axis.cross(rim.centre - f.from).length();
        from_axis * cosine + rim.radius * of_unit
    });
    // Where a rim is seen edge on there is no such bound.
    bends[0].max(bends[1]) * BEND_ROUNDING
}

/// The best direction on a ring, on which the way out is bent by at most `bend` and changes by at most `steepest`; any one if
/// none has a way shorter than `least`.
fn ring_direction(
    [a, b]: [&Primitive; 2],
    ring: &DepthRing,
    [bend, steepest]: [f64; 2],
    least: f64,
) -> DVec3 {
    let at = |(sin, cos): (f64, f64)| ring.u * cos + ring.v * sin + ring.lift;
    // Supports are convex functions of the direction.
    let lowest = |a: &CurveSpot, b: &CurveSpot| lowest_of_bent(bend, a, b);
    let nearness = Nearness {
        tolerance: MISSED * steepest,
        enough: least,
        most: MOST_SPOTS,
    };
    let best = least_on_circle(lowest, nearness, |angle, (sin, cos)| {
        let n = at((sin, cos));
        farthest_direction(a, b, n).map_or(CurveSpot::default(), |x| CurveSpot {
            at: angle,
            value: n.dot(x),
            slope: x.dot(ring.v * cos - ring.u * sin),
        })
    });
    at(sin_cos(best.spot.at))
}
