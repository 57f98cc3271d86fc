//! Distances of triangle meshes: both trees are walked towards the nearest triangles.
//!
//! A mesh is a surface. It has distances and a test for points inside, but no depth.

use super::core::{Core, Element};
use super::cores::{self, CorePair};
use super::mesh_tree::{Content, MeshTree, Node};
use super::point::point_to;
use crate::math::Pose;
use glam::DVec3;

impl MeshTree {
    /// Nearest points of the mesh and a core in the mesh's frame.
    fn to_core(&self, node: usize, core: &Core, best: &mut CorePair) {
        match self.nodes[node].content {
            Content::Leaf(start, end) => {
                for t in &self.triangles[start..end] {
                    let pair = cores::nearest(&Core::Triangle(*t), core);
                    if pair.distance < best.distance {
                        *best = pair;
                    }
                }
            }
            Content::Fork(second) => {
                let far = |k: usize| {
                    let n = &self.nodes[k];
                    point_to(core, n.center).map_or(0.0, |hit| hit.distance - n.radius)
                };
                for (k, lowest) in ordered([node + 1, second].map(|k| (k, far(k)))) {
                    if lowest < best.distance && best.distance > 0.0 {
                        self.to_core(k, core, best);
                    }
                }
            }
        }
    }

    /// Nearest points of this mesh and another one placed in this one's frame.
    fn to_mesh(&self, other: &Self, pose: &Pose, nodes: [usize; 2], best: &mut CorePair) {
        let [a, b] = [&self.nodes[nodes[0]], &other.nodes[nodes[1]]];
        let far = |a: &Node, b: &Node| {
            pose.transform_point(b.center).distance(a.center) - a.radius - b.radius
        };
        let (forks, split_first) = match (a.content, b.content) {
            (Content::Leaf(s, e), Content::Leaf(t, f)) => {
                let (mine, theirs) = (&self.triangles[s..e], &other.triangles[t..f]);
                return leaf_pairs(mine, theirs, pose, best);
            }
            (Content::Fork(second), Content::Leaf(..)) => ([nodes[0] + 1, second], true),
            (Content::Leaf(..), Content::Fork(second)) => ([nodes[1] + 1, second], false),
            (Content::Fork(second), Content::Fork(theirs)) => {
                if a.radius >= b.radius {
                    ([nodes[0] + 1, second], true)
                } else {
                    ([nodes[1] + 1, theirs], false)
                }
            }
        };
        let next = forks.map(|k| {
            if split_first {
                ([k, nodes[1]], far(&self.nodes[k], b))
            } else {
                ([nodes[0], k], far(a, &other.nodes[k]))
            }
        });
        for (nodes, lowest) in ordered(next) {
            if lowest < best.distance && best.distance > 0.0 {
                self.to_mesh(other, pose, nodes, best);
            }
        }
    }
}

fn ordered<T: Copy>(mut two: [(T, f64); 2]) -> [(T, f64); 2] {
    if two[1].1 < two[0].1 {
        two.swap(0, 1);
    }
    two
}

fn leaf_pairs(mine: &[[DVec3; 3]], theirs: &[[DVec3; 3]], pose: &Pose, best: &mut CorePair) {
    for b in theirs {
        let b = Core::Triangle(b.map(|p| pose.transform_point(p)));
        for a in mine {
            let pair = cores::nearest(&Core::Triangle(*a), &b);
            if pair.distance < best.distance {
                *best = pair;
            }
        }
    }
}

/// Nearest points of a placed mesh and a core; not below zero.
pub fn nearest(tree: &MeshTree, pose: &Pose, other: &Core) -> CorePair {
    let mut best = CorePair::FAR;
    let back = pose.inverse();
    if !tree.nodes.is_empty() {
        match other {
            Core::Mesh(second, placed) if !second.nodes.is_empty() => {
                tree.to_mesh(second, &(back * *placed), [0, 0], &mut best);
            }
            Core::Mesh(..) => {}
            core => tree.to_core(0, &core.moved(&back), &mut best),
        }
    }
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
