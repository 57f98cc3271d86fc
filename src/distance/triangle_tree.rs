//! A tree of oriented boxes over triangles, independent of what they enclose.

use super::boxes::OrientedBox;
use super::winding::{Ray, turns_around};
use glam::DVec3;
use std::cmp::Ordering;

/// Maximum number of triangles in a leaf.
const LEAF: usize = 4;

/// A node over a range of triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeNode {
    /// Box around all of them.
    pub(crate) around: OrientedBox,
    /// A leaf's triangles, or the index of the second child (the first one follows).
    pub(crate) content: Content,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    Leaf(usize, usize),
    Fork(usize),
}

/// Triangles, ready for queries.
#[derive(Clone, Debug)]
pub(crate) struct TriangleTree {
    pub(crate) triangles: Vec<[DVec3; 3]>,
    pub(crate) nodes: Vec<TreeNode>,
}

impl TriangleTree {
    /// Builds the tree: n log n.
    pub(crate) fn new(triangles: Vec<[DVec3; 3]>) -> Self {
        let mut tree = Self {
            triangles,
            nodes: Vec::new(),
        };
        tree.grow(0, tree.triangles.len());
        tree
    }

    /// The same tree with all coordinates multiplied by a positive factor.
    pub(crate) fn scaled(&self, factor: f64) -> Self {
        let triangles = self.triangles.iter();
        let nodes = self.nodes.iter().map(|node| TreeNode {
            around: node.around.scaled(factor),
            ..*node
        });
        Self {
            triangles: triangles.map(|t| t.map(|p| p * factor)).collect(),
            nodes: nodes.collect(),
        }
    }

    /// Adds the node over a range of triangles and all below it.
    fn grow(&mut self, start: usize, end: usize) {
        let part = &mut self.triangles[start..end];
        let around = OrientedBox::around(part);
        let index = self.nodes.len();
        let content = Content::Leaf(start, end);
        self.nodes.push(TreeNode { around, content });
        if end - start <= LEAF {
            return;
        }
        let axis = around.longest();
        let middle = (end - start) / 2;
        let key = |t: &[DVec3; 3]| axis.dot(t[0] + t[1] + t[2]);
        part.select_nth_unstable_by(middle, |a, b| key(a).total_cmp(&key(b)));
        self.grow(start, start + middle);
        self.nodes[index].content = Content::Fork(self.nodes.len());
        self.grow(start + middle, end);
    }

    /// The order of two trees by the first coordinate that differs.
    pub(crate) fn order<'a>(&'a self, other: &'a Self) -> Ordering {
        let corners = |tree: &'a Self| tree.triangles.as_flattened().iter();
        let pairs = corners(self).zip(corners(other));
        let mut orders = pairs.flat_map(|(p, q)| {
            let coordinates = p.to_array().into_iter().zip(q.to_array());
            coordinates.map(|(a, b)| a.total_cmp(&b))
        });
        let by_length = self.triangles.len().cmp(&other.triangles.len());
        let mut differs = || orders.find(|order| order.is_ne());
        by_length.then_with(|| differs().unwrap_or(Ordering::Equal))
    }

    /// Centre and radius of a ball around all triangles.
    pub(crate) fn bounds(&self) -> (DVec3, f64) {
        let root = self.nodes.first().map(|node| node.around);
        root.map_or((DVec3::ZERO, 0.0), |around| (around.centre, around.radius))
    }

    /// Whether there are none.
    pub(crate) fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// A vertex with the largest n · p; none without triangles.
    pub(crate) fn farthest(&self, n: DVec3) -> Option<DVec3> {
        let corners = self.triangles.get(self.highest(0, n).triangle)?;
        Some(corners.iter().copied().fold(corners[0], |best, p| {
            if n.dot(p) > n.dot(best) { p } else { best }
        }))
    }

    /// Extreme point along `n` below a node.
    pub(crate) fn highest(&self, node: usize, n: DVec3) -> Highest {
        let mut best = Highest {
            height: f64::NEG_INFINITY,
            triangle: 0,
        };
        if !self.is_empty() {
            self.climb(node, n, &mut best);
        }
        best
    }

    fn climb(&self, node: usize, n: DVec3, best: &mut Highest) {
        match self.nodes[node].content {
            Content::Leaf(start, end) => {
                for triangle in start..end {
                    let height = corner_support(&self.triangles[triangle], n);
                    if height > best.height {
                        *best = Highest { height, triangle };
                    }
                }
            }
            Content::Fork(second) => {
                let below = |k: usize| (k, -self.nodes[k].around.support(n));
                for (k, lowest) in nearer_first([below(node + 1), below(second)]) {
                    if -lowest > best.height {
                        self.climb(k, n, best);
                    }
                }
            }
        }
    }

    /// Winding number of the triangles, without some of them, about a point; the rest must be closed.
    pub(crate) fn turns(&self, without: Option<&Self>, point: DVec3) -> f64 {
        let (centre, radius) = self.bounds();
        if point.distance(centre) > radius {
            return 0.0;
        }
        // For open parts the number depends on the ray, so both are counted with the same ray.
        let crossings = Ray::from_point(point).find_map(|ray| {
            let beside = without.map_or(Some(0), |tree| tree.crossings(0, &ray))?;
            Some(self.crossings(0, &ray)? - beside)
        });
        // On the surface itself no ray is clear of edges.
        crossings.map_or_else(
            || {
                let beside = without.map_or(0.0, |tree| turns_around(&tree.triangles, point));
                turns_around(&self.triangles, point) - beside
            },
            f64::from,
        )
    }

    /// Number of triangles below a node through which a ray leaves, minus those through which it enters; `None` where
    /// that is not clear.
    fn crossings(&self, node: usize, ray: &Ray) -> Option<i32> {
        let TreeNode { around, content } = &self.nodes[node];
        if !ray.may_meet(around.centre, around.radius, |n| around.reach(n)) {
            return Some(0);
        }
        match *content {
            Content::Leaf(start, end) => {
                let mut here = self.triangles[start..end].iter();
                here.try_fold(0, |sum, t| Some(sum + ray.crossing(t)?))
            }
            Content::Fork(second) => {
                Some(self.crossings(node + 1, ray)? + self.crossings(second, ray)?)
            }
        }
    }
}

/// The extreme triangle in a direction n, and the n · p of its corner.
#[derive(Clone, Copy)]
pub(crate) struct Highest {
    pub(crate) height: f64,
    pub(crate) triangle: usize,
}

/// Largest n · p of a triangle.
#[inline]
pub(crate) fn corner_support(corners: &[DVec3; 3], n: DVec3) -> f64 {
    let [a, b, c] = corners.each_ref().map(|p| n.dot(*p));
    a.max(b).max(c)
}

/// Two values in the order of their keys.
pub(crate) fn nearer_first<T: Copy>(mut two: [(T, f64); 2]) -> [(T, f64); 2] {
    if two[1].1 < two[0].1 {
        two.swap(0, 1);
    }
    two
}
