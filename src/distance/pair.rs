//! Signed distance of two elements with the points where it is met.
//!
//! Positive: the least distance of the surfaces. Negative: the depth. Of two convex elements the depth is the shortest
//! translation that parts them; of a torus it is how far its tube reaches into the other element at the deepest point of
//! its centre circle, whatever it would take to unhook the two. Meshes have no depth: they touch (zero) or do not, but
//! for half-spaces, in which everything has one.

use super::core::{Core, Element};
use super::core_pair::CorePair;
use super::cores::nearest;
use super::depth::overlap;
use super::half_space;
use super::mesh;
use super::point::point_to;
use super::search::{Spot, least, least_on_circle};
use glam::DVec3;
use std::cmp::Ordering;

/// Where two elements are nearest, or deepest in each other.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Proximity {
    /// Signed distance in the scene's unit.
    pub distance: f64,
    /// The point of each element's surface. Where a torus is deepest below an edge of what two sides of a solid are
    /// equally far from, its own point lies within the tube.
    pub points: [DVec3; 2],
    /// Unit vector from the first element to the second; zero where it is not known.
    pub normal: DVec3,
}

impl Proximity {
    /// Seen from the other element.
    fn swapped(self) -> Self {
        Self {
            distance: self.distance,
            points: [self.points[1], self.points[0]],
            normal: -self.normal,
        }
    }
}

/// Signed distance of two elements in one frame. Which of them comes first changes no bit of it.
pub fn distance(a: &Element, b: &Element) -> Proximity {
    if a.core.order(&b.core) == Ordering::Greater {
        return in_order(b, a).swapped();
    }
    in_order(a, b)
}

fn in_order(a: &Element, b: &Element) -> Proximity {
    let cores = match (&a.core, &b.core) {
        (Core::HalfSpace(half), other) => half_space::nearest(half, other),
        (other, Core::HalfSpace(half)) => half_space::nearest(half, other).swapped(),
        (Core::Mesh(tree, pose), other) => mesh::nearest(tree, pose, other),
        (other, Core::Mesh(tree, pose)) => mesh::nearest(tree, pose, other).swapped(),
        (first, second) => signed(first, second),
    };
    let distance = cores.distance - (a.radius + b.radius);
    let is_mesh = |e: &Element| matches!(e.core, Core::Mesh(..));
    let is_flat = |e: &Element| matches!(e.core, Core::HalfSpace(_));
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
    }
}

fn signed(a: &Core, b: &Core) -> CorePair {
    let cores = nearest(a, b);
    let convex = |core: &Core| !matches!(core, Core::Circle(_));
    let has_inside = |core: &Core| matches!(core, Core::Box(_) | Core::Frustum(_));
    let is_point = |core: &Core| matches!(core, Core::Point(_));
    if cores.distance <= 0.0
        && convex(a)
        && convex(b)
        && (has_inside(a) || has_inside(b))
        && !(is_point(a) || is_point(b))
    {
        return overlap(a, b, cores);
    }
    cores
}

/// Whether `a` lies wholly inside `b`. Meshes, and solids in a torus, are never said to.
pub fn is_inside(a: &Element, b: &Element) -> bool {
    if let Core::HalfSpace(half) = &b.core {
        return half_space::encloses(half, &a.core, a.radius);
    }
    let farthest = match (&a.core, &b.core) {
        (Core::HalfSpace(_), _) | (_, Core::HalfSpace(_)) => return false,
        (_, Core::Mesh(..)) | (Core::Mesh(..), _) => return false,
        (Core::Point(p), _) => far(&b.core, &[*p]),
        (Core::Box(block), Core::Box(_) | Core::Frustum(_) | Core::Point(_) | Core::Segment(_)) => {
            far(&b.core, &block.corners())
        }
        (Core::Frustum(f), Core::Box(_) | Core::Frustum(_) | Core::Point(_) | Core::Segment(_)) => {
            let rims = f.rims().map(|rim| farthest_of_circle(&b.core, &rim));
            rims[0].max(rims[1])
        }
        (Core::Segment(ends), Core::Circle(_)) => {
            let span = ends[1] - ends[0];
            -least(0.0, 1.0, span.length(), |t| {
                backwards(&b.core, t, ends[0] + span * t, span)
            })
            .value
        }
        (Core::Segment(ends), _) => far(&b.core, ends),
        (Core::Triangle(corners), Core::Box(_) | Core::Frustum(_)) => far(&b.core, corners),
        (Core::Circle(circle), _) => farthest_of_circle(&b.core, circle),
        (Core::Box(_) | Core::Frustum(_) | Core::Triangle(_), _) => return false,
    };
    farthest + a.radius <= b.radius
}

fn far(core: &Core, points: &[DVec3]) -> f64 {
    let distances = points.iter().filter_map(|p| point_to(core, *p));
    distances
        .map(|hit| hit.distance)
        .fold(f64::NEG_INFINITY, f64::max)
}

fn backwards(core: &Core, at: f64, point: DVec3, tangent: DVec3) -> Spot {
    point_to(core, point).map_or(Spot::default(), |hit| Spot {
        at,
        value: -hit.distance,
        slope: -hit.normal.dot(tangent),
    })
}

fn farthest_of_circle(core: &Core, circle: &super::core::Circle) -> f64 {
    if circle.radius <= 0.0 {
        return far(core, &[circle.center]);
    }
    let [x, y] = circle.directions().map(|d| d * circle.radius);
    -least_on_circle(circle.radius, |angle, (sin, cos)| {
        let point = circle.center + x * cos + y * sin;
        backwards(core, angle, point, y * cos - x * sin)
    })
    .value
}
