//! Triangle meshes for distances: a tree of balls over the triangles of a file, which are taken as they are.
//!
//! A mesh is a surface. It has distances and a test for points inside, but no depth.

use super::core::Core;
use super::cores::{self, CorePair};
use super::point::point_to;
use crate::geometry::Mesh;
use crate::math::Pose;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::f64::consts::PI;

/// Most triangles in a leaf.
const LEAF: usize = 4;

/// A ball around some triangles.
#[derive(Clone, Copy, Debug)]
struct Node {
    center: DVec3,
    radius: f64,
    /// A leaf's triangles, or the index of the second child (the first one follows).
    content: Content,
}

#[derive(Clone, Copy, Debug)]
enum Content {
    Leaf(usize, usize),
    Fork(usize),
}

/// How a file's triangles enclose space.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Enclosure {
    /// Closed, outside out.
    Solid,
    /// Closed, but the triangles are numbered as seen from inside.
    InsideOut,
    /// It has edges with one side only.
    Open,
}

/// The triangles of a file, ready for queries, in the frame of the file.
#[derive(Clone, Debug)]
pub struct MeshTree {
    /// Where they came from.
    pub source: String,
    /// Whether there is an inside.
    pub enclosure: Enclosure,
    triangles: Vec<[DVec3; 3]>,
    nodes: Vec<Node>,
}

impl MeshTree {
    /// Builds the tree: n log n.
    pub fn new(soup: &TriangleSoup) -> Self {
        let corner = |k: u32| soup.vertices.get(k as usize).copied().unwrap_or_default();
        let triangles = soup.triangles.iter().map(|t| t.map(corner)).collect();
        let mesh = Mesh {
            positions: soup.vertices.clone(),
            normals: Vec::new(),
            triangles: soup.triangles.clone(),
        };
        let enclosure = match (mesh.is_closed(), mesh.hides_its_inside()) {
            (true, true) => Enclosure::Solid,
            (true, false) => Enclosure::InsideOut,
            (false, _) => Enclosure::Open,
        };
        let mut tree = Self {
            source: soup.source.clone(),
            enclosure,
            triangles,
            nodes: Vec::new(),
        };
        tree.grow(0, tree.triangles.len());
        tree
    }

    /// Adds the node over a range of triangles and all below it.
    fn grow(&mut self, start: usize, end: usize) {
        let part = &mut self.triangles[start..end];
        let points = || part.iter().flatten();
        let low = points().fold(DVec3::INFINITY, |m, p| m.min(*p));
        let high = points().fold(DVec3::NEG_INFINITY, |m, p| m.max(*p));
        let center = (low + high) * 0.5;
        let radius = points().map(|p| p.distance(center)).fold(0.0, f64::max);
        let index = self.nodes.len();
        let content = Content::Leaf(start, end);
        self.nodes.push(Node {
            center,
            radius,
            content,
        });
        if end - start <= LEAF {
            return;
        }
        let span = high - low;
        let axis = (0..3).fold(0, |best, k| if span[k] > span[best] { k } else { best });
        let middle = (end - start) / 2;
        let key = |t: &[DVec3; 3]| t[0][axis] + t[1][axis] + t[2][axis];
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        self.grow(start, start + middle);
        self.nodes[index].content = Content::Fork(self.nodes.len());
        self.grow(start + middle, end);
    }

    /// Centre and radius of a ball around all triangles.
    pub fn bounds(&self) -> (DVec3, f64) {
        let root = self.nodes.first();
        root.map_or((DVec3::ZERO, 0.0), |n| (n.center, n.radius))
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// A point of the surface.
    pub fn any_point(&self) -> DVec3 {
        self.triangles.first().map_or(DVec3::ZERO, |t| t[0])
    }

    /// A vertex with the least n · p.
    pub fn lowest(&self, n: DVec3) -> DVec3 {
        let lower = |p: DVec3, q: DVec3| if n.dot(q) < n.dot(p) { q } else { p };
        let corners = self.triangles.iter().flatten().copied();
        corners.reduce(lower).unwrap_or_default()
    }

    /// Whether a point is inside, by the solid angle of all triangles; an open mesh has no inside.
    pub fn encloses(&self, point: DVec3) -> bool {
        if self.enclosure == Enclosure::Open {
            return false;
        }
        let angle = |t: &[DVec3; 3]| {
            let [a, b, c] = t.map(|p| (p - point).normalize_or_zero());
            let volume = a.dot(b.cross(c));
            2.0 * libm::atan2(volume, 1.0 + a.dot(b) + b.dot(c) + c.dot(a))
        };
        self.triangles.iter().map(angle).sum::<f64>().abs() > 2.0 * PI
    }

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

/// Whether one of two elements, at least one of them a mesh and their surfaces apart, lies inside the other.
pub fn one_inside(a: &Core, b: &Core) -> bool {
    let holds = |outer: &Core, inner: &Core| {
        let point = match inner {
            Core::Point(p) => *p,
            Core::Segment(ends) => ends[0],
            Core::Circle(c) => c.center + c.directions()[0] * c.radius,
            Core::Box(b) => b.from_box.translation,
            Core::Frustum(f) => f.from,
            Core::Triangle(t) => t[0],
            // Where surfaces are apart, a half-space's depth says all.
            Core::HalfSpace(_) => return false,
            Core::Mesh(tree, pose) => pose.transform_point(tree.any_point()),
        };
        match outer {
            Core::Mesh(tree, pose) => tree.encloses(pose.inverse().transform_point(point)),
            _ => point_to(outer, point).is_some_and(|hit| hit.distance <= 0.0),
        }
    };
    holds(a, b) || holds(b, a)
}
