//! Signed distance of two elements with the points where it is met.
//!
//! Positive: the least distance of the surfaces. Negative: the depth. Of two convex elements the depth is the shortest
//! translation that parts them; of a torus it is how far its tube reaches into the other element at the deepest point of
//! its centre circle, whatever it would take to unhook the two. Meshes have no depth: they touch (zero) or do not, but
//! for half-spaces, in which everything has one.

use super::curve_bend::CurveBend;
use super::depth::overlap_depth;
use super::half_space;
use super::mesh;
use super::point::point_to;
use super::primitive::{Element, Primitive};
use super::primitive_distance::nearest_cores;
use super::primitive_pair::CorePair;
use super::search::{CurveSpot, least_between, least_on_circle};
use glam::DVec3;
use std::cmp::Ordering;

/// The nearest points of two elements, or the deepest ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proximity {
    /// Signed distance in the scene's unit.
    pub distance: f64,
    /// The point of each element's surface. Where a torus is deepest below an edge of what two sides of a solid are
    /// equally far from, its own point lies within the tube.
    pub points: [DVec3; 2],
    /// Unit vector from the first element to the second; zero where it is not known.
    pub normal: DVec3,
    /// No points are nearer, or deeper, by more than this: zero, unless the search along a circle ended before that was
    /// known.
    pub missed: f64,
}

impl Proximity {
    /// No points are nearer.
    pub fn lowest(&self) -> f64 {
        self.distance - self.missed
    }

    /// The same from the other element's side.
    fn swapped(self) -> Self {
        Self {
            distance: self.distance,
            points: [self.points[1], self.points[0]],
            normal: -self.normal,
            missed: self.missed,
        }
    }
}

/// Signed distance of two elements in one frame. Their order does not change a single bit of it.
pub fn signed_distance(a: &Element, b: &Element) -> Proximity {
    signed_distance_below(a, b, f64::INFINITY)
}

/// Signed distance of two elements, if it is below `limit`; otherwise any number from `limit` to it, with some points.
pub fn signed_distance_below(a: &Element, b: &Element, limit: f64) -> Proximity {
    if a.core.order(&b.core) == Ordering::Greater {
        return in_order(b, a, limit).swapped();
    }
    in_order(a, b, limit)
}

fn in_order(a: &Element, b: &Element, limit: f64) -> Proximity {
    // Radii inflate the cores.
    let radii = a.radius + b.radius;
    let cores = match (&a.core, &b.core) {
        (Primitive::HalfSpace(half), other) => half_space::nearest_to_half_space(half, other),
        (other, Primitive::HalfSpace(half)) => {
            half_space::nearest_to_half_space(half, other).swapped()
        }
        (Primitive::Mesh(tree, pose), other) => mesh::nearest_to_mesh(&tree.tree, pose, other),
        (other, Primitive::Mesh(tree, pose)) => {
            mesh::nearest_to_mesh(&tree.tree, pose, other).swapped()
        }
        (first, second) => signed_cores(first, second, -(limit + radii)),
    };
    // Overlapping meshes have no depth.
    let distance = cores.distance - radii;
    let is_mesh = |e: &Element| matches!(e.core, Primitive::Mesh(..));
    let is_flat = |e: &Element| matches!(e.core, Primitive::HalfSpace(_));
    Proximity {
        distance: if (is_mesh(a) || is_mesh(b)) && !is_flat(a) && !is_flat(b) {
            distance.max(0.0)
        } else {
            distance
        },
        points: [
            cores.points[0] + cores.normal * a.radius,
            cores.points[1] - cores.normal * b.radius,
        ],
        normal: cores.normal,
        missed: cores.missed,
    }
}

/// Depths of at most `least` are not determined.
fn signed_cores(a: &Primitive, b: &Primitive, least: f64) -> CorePair {
    let cores = nearest_cores(a, b);
    match cores.distance <= 0.0 && is_deep(a, b) {
        true => overlap_depth(a, b, cores, least),
        false => cores,
    }
}

/// Whether the depth of two cores that overlap is searched for.
fn is_deep(a: &Primitive, b: &Primitive) -> bool {
    use Primitive::{Box, Frustum, Segment, Triangle};
    let is_solid = |core: &Primitive| matches!(core, Box(_) | Frustum(_));
    let has_extent = |core: &Primitive| is_solid(core) || matches!(core, Segment(_) | Triangle(_));
    has_extent(a) && has_extent(b) && (is_solid(a) || is_solid(b))
}

/// Whether `a` lies completely inside `b`. Never reported for meshes, and for solids in a torus.
pub fn is_inside(a: &Element, b: &Element) -> bool {
    if let Primitive::HalfSpace(half) = &b.core {
        return half_space::encloses_core(half, &a.core, a.radius);
    }
    // The farthest point of the first from the second's core decides.
    let farthest = match (&a.core, &b.core) {
        (Primitive::HalfSpace(_), _) | (_, Primitive::HalfSpace(_)) => return false,
        (_, Primitive::Mesh(..)) | (Primitive::Mesh(..), _) => return false,
        (Primitive::Point(p), _) => farthest_reach(&b.core, &[*p]),
        (
            Primitive::Box(block),
            Primitive::Box(_) | Primitive::Frustum(_) | Primitive::Point(_) | Primitive::Segment(_),
        ) => farthest_reach(&b.core, &block.corners()),
        (
            Primitive::Frustum(f),
            Primitive::Box(_) | Primitive::Frustum(_) | Primitive::Point(_) | Primitive::Segment(_),
        ) => {
            let rims = f.rims().map(|rim| farthest_of_circle(&b.core, &rim));
            rims[0].max(rims[1])
        }
        (Primitive::Segment(ends), Primitive::Circle(_)) => {
            let span = ends[1] - ends[0];
            let bend = CurveBend::of_segment(b.core.circle(), span.length());
            let lowest = |p: &CurveSpot, q: &CurveSpot| lowest_backward(&bend, p, q);
            let found = least_between([0.0, 1.0], lowest, bend.missed(ends[0]), |t| {
                backward_spot(&b.core, t, ends[0] + span * t, span)
            });
            found.missed() - found.spot.value
        }
        (Primitive::Segment(ends), _) => farthest_reach(&b.core, ends),
        (Primitive::Triangle(corners), Primitive::Box(_) | Primitive::Frustum(_)) => {
            farthest_reach(&b.core, corners)
        }
        (Primitive::Circle(circle), _) => farthest_of_circle(&b.core, circle),
        (Primitive::Box(_) | Primitive::Frustum(_) | Primitive::Triangle(_), _) => return false,
    };
    farthest + a.radius <= b.radius
}

fn farthest_reach(core: &Primitive, points: &[DVec3]) -> f64 {
    let distances = points.iter().filter_map(|p| point_to(core, *p));
    distances
        .map(|hit| hit.distance)
        .fold(f64::NEG_INFINITY, f64::max)
}

fn backward_spot(core: &Primitive, at: f64, point: DVec3, tangent: DVec3) -> CurveSpot {
    point_to(core, point).map_or(CurveSpot::default(), |hit| CurveSpot {
        at,
        value: -hit.distance,
        slope: -hit.normal.dot(tangent),
    })
}

/// The pair with the opposite sign of the distance.
fn lowest_backward(bend: &CurveBend, p: &CurveSpot, q: &CurveSpot) -> f64 {
    let opposite = |spot: &CurveSpot| CurveSpot {
        value: -spot.value,
        ..*spot
    };
    -bend.highest_between(&opposite(p), &opposite(q))
}

fn farthest_of_circle(core: &Primitive, circle: &super::primitive::Circle) -> f64 {
    if circle.radius <= 0.0 {
        return farthest_reach(core, &[circle.centre]);
    }
    let [x, y] = circle.directions().map(|d| d * circle.radius);
    let bend = CurveBend::of_circle(core.circle(), circle).beside(core, circle.centre, [x, y]);
    let lowest = |p: &CurveSpot, q: &CurveSpot| lowest_backward(&bend, p, q);
    let found = least_on_circle(lowest, bend.missed(circle.centre), |angle, (sin, cos)| {
        let point = circle.centre + x * cos + y * sin;
        backward_spot(core, angle, point, y * cos - x * sin)
    });
    found.missed() - found.spot.value
}
