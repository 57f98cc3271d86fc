//! Half-spaces: distance of any core from one, or its depth in it. Closed forms.

use super::point::to_half_space;
use super::primitive::{Circle, HalfSpace, Primitive};
use super::primitive_pair::CorePair;
use glam::DVec3;

/// Normals this far from opposite are not parallel: the planes intersect.
const PARALLEL: f64 = 1e-12;

/// The deepest point of a core. The depth is the shortest translation that takes the core out.
///
/// Of two half-spaces only those that face each other have a distance; all others overlap without bound.
pub fn nearest_to_half_space(half: &HalfSpace, other: &Primitive) -> CorePair {
    let n = half.normal;
    let point = match other {
        Primitive::HalfSpace(second) => {
            // Two half-spaces overlap without bound unless their planes are parallel and face each other.
            if (n + second.normal).length() > PARALLEL {
                return CorePair {
                    distance: f64::NEG_INFINITY,
                    points: [half.point; 2],
                    normal: n,
                    missed: 0.0,
                };
            }
            second.point
        }
        core => lowest_point(core, n),
    };
    let hit = to_half_space(half, point);
    CorePair {
        distance: hit.distance,
        points: [hit.nearest, point],
        normal: n,
        missed: 0.0,
    }
}

/// Whether a core grown by `radius` lies wholly in the half-space.
pub fn encloses_core(half: &HalfSpace, core: &Primitive, radius: f64) -> bool {
    if let Primitive::HalfSpace(other) = core {
        let same = (half.normal - other.normal).length() <= PARALLEL;
        return same && to_half_space(half, other.point).distance <= 0.0;
    }
    to_half_space(half, lowest_point(core, -half.normal)).distance + radius <= 0.0
}

/// A point of a bounded core with the least n · p.
fn lowest_point(core: &Primitive, n: DVec3) -> DVec3 {
    let of = |points: &[DVec3]| {
        let lower = |p: DVec3, q: DVec3| if n.dot(q) < n.dot(p) { q } else { p };
        points.iter().copied().reduce(lower).unwrap_or_default()
    };
    let of_rim = |rim: &Circle| rim.centre - rim.outward(n) * rim.radius;
    match core {
        Primitive::Point(p) => *p,
        Primitive::Segment(ends) => of(ends),
        Primitive::Triangle(corners) => of(corners),
        Primitive::Circle(c) => of_rim(c),
        Primitive::Box(block) => of(&block.corners()),
        Primitive::Frustum(f) => of(&f.rims().map(|rim| of_rim(&rim))),
        Primitive::Mesh(tree, pose) => {
            let lowest = tree.tree.farthest(pose.rotation.transpose() * -n);
            pose.transform_point(lowest.unwrap_or_default())
        }
        Primitive::HalfSpace(half) => half.point,
    }
}
