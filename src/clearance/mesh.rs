//! Distances of triangle meshes: both trees are walked towards the nearest triangles.
//!
//! What parts two boxes along any direction is a lower bound of their distance. Along the line between the nearest points
//! known so far it is as good as the surfaces are flat, so that little is left to be looked at once these are right; the
//! other directions tell what lies elsewhere.
//!
//! A mesh is a surface. It has distances and a test for points inside, but no depth.

use super::boxes::OrientedBox;
use super::core::{Core, Element};
use super::cores::{self, CorePair};
use super::mesh_tree::{Content, MeshTree, nearer_first};
use super::point::point_to;
use super::triangles;
use crate::math::Pose;
use glam::DVec3;

/// A mesh and a core that is none, in the mesh's frame.
struct ToCore<'a> {
    tree: &'a MeshTree,
    core: &'a Core,
    is_convex: bool,
    best: CorePair,
    /// Largest -n · p of the core for the best normal n.
    reach: f64,
}

impl ToCore<'_> {
    fn take(&mut self, pair: CorePair) {
        if pair.distance < self.best.distance {
            self.best = pair;
            self.reach = match self.core.support(-pair.normal) {
                Some(reach) if pair.normal != DVec3::ZERO => reach,
                _ => f64::INFINITY,
            };
        }
    }

    /// What parts something with this support along the best normal from the core.
    fn slab(&self, support: f64) -> f64 {
        -self.reach - support
    }

    fn apart(&self, around: &OrientedBox) -> f64 {
        let slab = self.slab(around.support(self.best.normal));
        if slab >= self.best.distance {
            return slab;
        }
        let direct = point_to(self.core, around.center).map_or(0.0, |hit| {
            // A convex core lies behind the plane through its point that is nearest to the centre.
            let is_flat = self.is_convex && hit.normal != DVec3::ZERO;
            let reach = if is_flat {
                around.reach(hit.normal)
            } else {
                around.radius
            };
            hit.distance - reach.min(around.radius)
        });
        slab.max(direct)
    }

    fn walk(&mut self, node: usize) {
        match self.tree.nodes[node].content {
            Content::Leaf(start, end) => {
                for t in &self.tree.triangles[start..end] {
                    let triangle = Core::Triangle(*t);
                    let support = triangle.support(self.best.normal).unwrap_or(0.0);
                    if self.slab(support) < self.best.distance {
                        self.take(cores::nearest(&triangle, self.core));
                    }
                }
            }
            Content::Fork(second) => {
                let next = [node + 1, second].map(|k| (k, self.apart(&self.tree.nodes[k].around)));
                for (k, lowest) in nearer_first(next) {
                    let is_open = |found: &Self| found.best.distance > 0.0;
                    let around = &self.tree.nodes[k].around;
                    if is_open(self)
                        && lowest < self.best.distance
                        && self.slab(around.support(self.best.normal)) < self.best.distance
                    {
                        self.walk(k);
                    }
                }
            }
        }
    }
}

/// Two meshes, the second one placed in the frame of the first.
struct ToMesh<'a> {
    trees: [&'a MeshTree; 2],
    pose: Pose,
    best: CorePair,
    /// The best normal in the second one's frame.
    turned: DVec3,
    /// How far its origin lies along it.
    along: f64,
}

impl ToMesh<'_> {
    fn take(&mut self, pair: CorePair) {
        if pair.distance < self.best.distance {
            self.best = pair;
            self.turned = self.pose.rotation.transpose() * pair.normal;
            self.along = self.pose.translation.dot(pair.normal);
        }
    }

    /// What parts two boxes along the best normal.
    fn slab(&self, a: &OrientedBox, b: &OrientedBox) -> f64 {
        self.along - b.support(-self.turned) - a.support(self.best.normal)
    }

    fn apart(&self, a: &OrientedBox, b: &OrientedBox) -> f64 {
        let slab = self.slab(a, b);
        if slab >= self.best.distance {
            return slab;
        }
        let span = self.pose.transform_point(b.center) - a.center;
        let distance = span.length();
        if distance - a.radius - b.radius >= self.best.distance || distance == 0.0 {
            return slab.max(distance - a.radius - b.radius);
        }
        let n = span / distance;
        let reach = a.reach(n).min(a.radius);
        let back = b.reach(self.pose.rotation.transpose() * n).min(b.radius);
        slab.max(distance - reach - back)
    }

    fn walk(&mut self, nodes: [usize; 2]) {
        let [a, b] = [0, 1].map(|k| self.trees[k].nodes[nodes[k]]);
        let (forks, splits_first) = match (a.content, b.content) {
            (Content::Leaf(s, e), Content::Leaf(t, f)) => return self.leaves([s, e], [t, f]),
            (Content::Fork(second), Content::Leaf(..)) => ([nodes[0] + 1, second], true),
            (Content::Leaf(..), Content::Fork(second)) => ([nodes[1] + 1, second], false),
            (Content::Fork(second), Content::Fork(_)) if a.around.radius >= b.around.radius => {
                ([nodes[0] + 1, second], true)
            }
            (_, Content::Fork(second)) => ([nodes[1] + 1, second], false),
        };
        let boxes = |k: usize| {
            if splits_first {
                [self.trees[0].nodes[k].around, b.around]
            } else {
                [a.around, self.trees[1].nodes[k].around]
            }
        };
        let next = forks.map(|k| {
            let [a, b] = boxes(k);
            ((k, a, b), self.apart(&a, &b))
        });
        for ((k, a, b), lowest) in nearer_first(next) {
            let least = self.best.distance;
            if lowest < least && least > 0.0 && self.slab(&a, &b) < least {
                let nodes = if splits_first {
                    [k, nodes[1]]
                } else {
                    [nodes[0], k]
                };
                self.walk(nodes);
            }
        }
    }

    fn leaves(&mut self, [s, e]: [usize; 2], [t, f]: [usize; 2]) {
        let [first, second] = self.trees;
        for b in &second.triangles[t..f] {
            let b = b.map(|p| self.pose.transform_point(p));
            for a in &first.triangles[s..e] {
                let n = self.best.normal;
                let farthest = a
                    .iter()
                    .map(|p| n.dot(*p))
                    .fold(f64::NEG_INFINITY, f64::max);
                let nearest = b.iter().map(|p| n.dot(*p)).fold(f64::INFINITY, f64::min);
                if nearest - farthest < self.best.distance {
                    self.take(triangles::to_triangle(a, &b));
                }
            }
        }
    }
}

/// Nearest points of a placed mesh and a core; not below zero.
pub fn nearest(tree: &MeshTree, pose: &Pose, other: &Core) -> CorePair {
    let back = pose.inverse();
    let best = match other {
        _ if tree.is_empty() => CorePair::FAR,
        Core::Mesh(second, _) if second.is_empty() => CorePair::FAR,
        Core::Mesh(second, placed) => {
            let mut search = ToMesh {
                trees: [tree, second],
                pose: back * *placed,
                best: CorePair::FAR,
                turned: DVec3::ZERO,
                along: 0.0,
            };
            search.walk([0, 0]);
            search.best
        }
        core => {
            let mut search = ToCore {
                tree,
                core: &core.moved(&back),
                is_convex: !matches!(core, Core::Circle(_)),
                best: CorePair::FAR,
                reach: f64::INFINITY,
            };
            search.walk(0);
            search.best
        }
    };
    CorePair {
        distance: best.distance.max(0.0),
        points: best.points.map(|p| pose.transform_point(p)),
        normal: pose.transform_vector(best.normal),
    }
}

/// Whether a mesh is among the elements.
pub fn is_any(elements: [&Element; 2]) -> bool {
    elements.iter().any(|e| matches!(e.core, Core::Mesh(..)))
}

/// Whether one of two elements, at least one of them a mesh and their surfaces apart, lies inside the other; of a mesh, one
/// of its shells.
pub fn one_inside(a: &Core, b: &Core) -> bool {
    let holds = |outer: &Core, point: DVec3| match outer {
        Core::Mesh(tree, pose) => tree.encloses(pose.inverse().transform_point(point)),
        // Where surfaces are apart, a half-space's depth says all.
        Core::HalfSpace(_) => false,
        _ => point_to(outer, point).is_some_and(|hit| hit.distance <= 0.0),
    };
    let holds_some = |outer: &Core, inner: &Core| match inner {
        Core::Mesh(tree, pose) => {
            let mut points = tree.points.iter().map(|p| pose.transform_point(*p));
            points.any(|point| holds(outer, point))
        }
        solid => any_point(solid).is_some_and(|point| holds(outer, point)),
    };
    holds_some(a, b) || holds_some(b, a)
}

/// A point of a solid in one piece; none of what has no end.
fn any_point(core: &Core) -> Option<DVec3> {
    Some(match core {
        Core::Point(p) => *p,
        Core::Segment(ends) => ends[0],
        Core::Circle(c) => c.center + c.directions()[0] * c.radius,
        Core::Box(b) => b.from_box.translation,
        Core::Frustum(f) => f.from,
        Core::Triangle(t) => t[0],
        Core::HalfSpace(_) | Core::Mesh(..) => return None,
    })
}
