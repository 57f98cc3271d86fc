//! Distances of triangle meshes: both trees are traversed towards the nearest triangles.
//!
//! The separation of two boxes along any direction is a lower bound of their distance. Along the line between the
//! nearest points known so far, the separation of the contents of two nodes is known, too: for surfaces that bulge
//! towards each other it proves that nothing is nearer, and otherwise the farthest points are the next pair to try.
//!
//! A mesh is a surface. It has distances and a test for points inside, but no depth.

use super::boxes::OrientedBox;
use super::point::point_to;
use super::primitive::{Element, Primitive};
use super::primitive_distance;
use super::primitive_pair::CorePair;
use super::triangle_tree::{Content, TriangleTree, corner_support, nearer_first};
use super::triangles;
use crate::math::Pose;
use glam::DVec3;

/// Anything within this fraction of the least distance counts as equally near: rounding.
const SAME: f64 = 1.0 - 4.0 * f64::EPSILON;

/// How often the extreme triangles are tried before a pair of nodes is split.
const TRIES: usize = 8;

/// Nodes with fewer triangles below are split at once.
const WORTH_A_TRY: usize = 16;

/// A mesh and a core of another kind, in the mesh's frame.
struct ToCore<'a> {
    tree: &'a TriangleTree,
    core: &'a Primitive,
    is_convex: bool,
    best: CorePair,
    /// Largest -n · p of the core for the best normal n.
    reach: f64,
}

impl ToCore<'_> {
    fn take(&mut self, triangle: usize) {
        let pair = primitive_distance::nearest_cores(
            &Primitive::Triangle(self.tree.triangles[triangle]),
            self.core,
        );
        let is_nearer = pair.distance < self.best.distance;
        self.best.take(pair);
        if is_nearer {
            self.reach = match self.core.support(-pair.normal) {
                Some(reach) if pair.normal != DVec3::ZERO => reach,
                _ => f64::INFINITY,
            };
        }
    }

    /// Nothing at this distance can improve the result.
    fn is_far(&self, distance: f64) -> bool {
        distance >= self.best.distance * SAME || self.best.distance <= 0.0
    }

    /// Whether the extreme points along the best normal are no nearer.
    fn is_parted(&self, support: f64) -> bool {
        self.is_far(-self.reach - support)
    }

    fn apart(&self, around: &OrientedBox) -> f64 {
        let hit = point_to(self.core, around.centre);
        hit.map_or(0.0, |hit| {
            // A convex core lies behind the plane through its point that is nearest to the centre.
            let is_flat = self.is_convex && hit.normal != DVec3::ZERO;
            let reach = if is_flat {
                around.reach(hit.normal)
            } else {
                around.radius
            };
            hit.distance - reach.min(around.radius)
        })
    }

    fn walk(&mut self, node: usize) {
        let second = match self.tree.nodes[node].content {
            // Measures the triangles of a leaf that the present plane does not separate.
            Content::Leaf(start, end) => {
                for k in start..end {
                    if !self.is_parted(corner_support(&self.tree.triangles[k], self.best.normal)) {
                        self.take(k);
                    }
                }
                return;
            }
            Content::Fork(second) => second,
        };
        // The nearer child first, so that the best distance drops early.
        let next = [node + 1, second].map(|k| (k, self.apart(&self.tree.nodes[k].around)));
        for (k, lowest) in nearer_first(next) {
            let top = self.tree.nodes[k].around.support(self.best.normal);
            if !self.is_far(lowest) && !self.is_parted(top) {
                self.walk(k);
            }
        }
    }
}

/// Two meshes, the second one placed in the frame of the first.
struct ToMesh<'a> {
    trees: [&'a TriangleTree; 2],
    pose: Pose,
    best: CorePair,
    /// The best normal in the second one's frame.
    turned: DVec3,
    /// Position of its origin along it.
    along: f64,
}

impl ToMesh<'_> {
    fn take(&mut self, [i, j]: [usize; 2]) -> bool {
        let second = self.trees[1].triangles[j].map(|p| self.pose.transform_point(p));
        let pair = triangles::to_triangle(&self.trees[0].triangles[i], &second);
        if pair.distance >= self.best.distance {
            return false;
        }
        self.best = pair;
        self.turned = self.pose.rotation.transpose() * pair.normal;
        self.along = self.pose.translation.dot(pair.normal);
        true
    }

    /// Nothing at this distance can improve the result.
    fn is_far(&self, distance: f64) -> bool {
        distance >= self.best.distance * SAME || self.best.distance <= 0.0
    }

    /// Whether the extreme points along the best normal, and against it, are no nearer.
    fn is_parted(&self, supports: [f64; 2]) -> bool {
        self.is_far(self.along - supports[0] - supports[1])
    }

    fn supports(&self, [a, b]: [&OrientedBox; 2]) -> [f64; 2] {
        [a.support(self.best.normal), b.support(-self.turned)]
    }

    /// Separation of two boxes along the line through their centres.
    fn apart(&self, [a, b]: [&OrientedBox; 2]) -> f64 {
        let span = self.pose.transform_point(b.centre) - a.centre;
        let distance = span.length();
        let of_balls = distance - a.radius - b.radius;
        if self.is_far(of_balls) || distance == 0.0 {
            return of_balls;
        }
        let n = span / distance;
        let back = self.pose.rotation.transpose() * n;
        distance - a.reach(n).min(a.radius) - b.reach(back).min(b.radius)
    }

    /// Whether nothing below two nodes is nearer; first tries to find something nearer.
    fn is_settled(&mut self, [a, b]: [usize; 2]) -> bool {
        for _ in 0..TRIES {
            let highest = [
                self.trees[0].highest(a, self.best.normal),
                self.trees[1].highest(b, -self.turned),
            ];
            if self.is_parted(highest.map(|h| h.height)) {
                return true;
            }
            if !self.take(highest.map(|h| h.triangle)) {
                return false;
            }
        }
        false
    }

    fn walk(&mut self, nodes: [usize; 2]) {
        let [a, b] = [0, 1].map(|k| &self.trees[k].nodes[nodes[k]]);
        let (splits, fork) = match (a.content, b.content) {
            (Content::Leaf(s, e), Content::Leaf(t, f)) => return self.leaves([s, e], [t, f]),
            (Content::Fork(second), Content::Leaf(..)) => (0, second),
            (Content::Fork(second), Content::Fork(_)) if a.around.radius >= b.around.radius => {
                (0, second)
            }
            (_, Content::Fork(second)) => (1, second),
        };
        // A separating direction for two whole branches avoids descending into them.
        if fork - nodes[splits] > WORTH_A_TRY && self.is_settled(nodes) {
            return;
        }
        let with = |k: usize| {
            let mut next = nodes;
            next[splits] = k;
            next
        };
        let [first, second] = self.trees;
        let boxes = |[i, j]: [usize; 2]| [&first.nodes[i].around, &second.nodes[j].around];
        let next = [nodes[splits] + 1, fork].map(with);
        for (next, lowest) in nearer_first(next.map(|k| (k, self.apart(boxes(k))))) {
            if !self.is_far(lowest) && !self.is_parted(self.supports(boxes(next))) {
                self.walk(next);
            }
        }
    }

    fn leaves(&mut self, [s, e]: [usize; 2], [t, f]: [usize; 2]) {
        let [first, second] = self.trees;
        for j in t..f {
            for i in s..e {
                let reach = corner_support(&first.triangles[i], self.best.normal);
                let back = corner_support(&second.triangles[j], -self.turned);
                if !self.is_parted([reach, back]) {
                    self.take([i, j]);
                }
            }
        }
    }
}

/// Nearest points of a placed mesh and a core; not below zero.
pub(crate) fn nearest_to_mesh(tree: &TriangleTree, pose: &Pose, other: &Primitive) -> CorePair {
    let back = pose.inverse();
    let best = match other {
        _ if tree.is_empty() => CorePair::FAR,
        Primitive::Mesh(second, _) if second.is_empty() => CorePair::FAR,
        Primitive::Mesh(second, placed) => {
            let (pose, second) = (back * *placed, &second.tree);
            let mut search = ToMesh {
                trees: [tree, second],
                pose,
                best: CorePair::FAR,
                turned: DVec3::ZERO,
                along: 0.0,
            };
            // A first pair: the extreme corners towards each other.
            let across = pose.transform_point(second.bounds().0) - tree.bounds().0;
            let ahead = tree.highest(0, across).triangle;
            let back = second
                .highest(0, pose.rotation.transpose() * -across)
                .triangle;
            search.take([ahead, back]);
            search.walk([0, 0]);
            search.best
        }
        core => {
            let mut search = ToCore {
                tree,
                core: &core.moved(&back),
                is_convex: !matches!(core, Primitive::Circle(_)),
                best: CorePair::FAR,
                reach: f64::INFINITY,
            };
            let across = search.core.bounds().0 - tree.bounds().0;
            search.take(tree.highest(0, across).triangle);
            search.walk(0);
            search.best
        }
    };
    CorePair {
        distance: best.distance.max(0.0),
        points: best.points.map(|p| pose.transform_point(p)),
        normal: pose.transform_vector(best.normal),
        missed: best.missed,
    }
}

/// Whether a mesh is among the elements.
pub fn is_any(elements: [&Element; 2]) -> bool {
    elements
        .iter()
        .any(|e| matches!(e.core, Primitive::Mesh(..)))
}

/// Whether one of two elements with disjoint surfaces, at least one of them a mesh, lies inside the other; for a mesh,
/// one of its shells.
pub fn one_inside(a: &Primitive, b: &Primitive) -> bool {
    let holds = |outer: &Primitive, point: DVec3| match outer {
        Primitive::Mesh(tree, pose) => tree.encloses(pose.inverse().transform_point(point)),
        // Where surfaces are disjoint, the depth in a half-space decides.
        Primitive::HalfSpace(_) => false,
        _ => point_to(outer, point).is_some_and(|hit| hit.distance <= 0.0),
    };
    let holds_some = |outer: &Primitive, inner: &Primitive| match inner {
        Primitive::Mesh(tree, pose) => {
            let mut points = tree.points.iter().map(|p| pose.transform_point(*p));
            points.any(|point| holds(outer, point))
        }
        solid => any_point(solid).is_some_and(|point| holds(outer, point)),
    };
    holds_some(a, b) || holds_some(b, a)
}

/// A point of a connected solid; none for unbounded ones.
fn any_point(core: &Primitive) -> Option<DVec3> {
    Some(match core {
        Primitive::Point(p) => *p,
        Primitive::Segment(ends) => ends[0],
        Primitive::Circle(c) => c.centre + c.directions()[0] * c.radius,
        Primitive::Box(b) => b.from_box.translation,
        Primitive::Frustum(f) => f.from,
        Primitive::Triangle(t) => t[0],
        Primitive::HalfSpace(_) | Primitive::Mesh(..) => return None,
    })
}
