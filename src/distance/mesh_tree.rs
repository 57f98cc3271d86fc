//! A tree of oriented boxes over the triangles of a file, which are taken as they are.

use super::boxes::OrientedBox;
pub use super::shells::ShellEnclosure;
use super::shells::{Shells, turns_around};
use crate::model::shape::TriangleSoup;
use glam::DVec3;

/// Most triangles in a leaf.
const LEAF: usize = 4;

/// Some triangles.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TreeNode {
    /// Holds them all.
    pub(crate) around: OrientedBox,
    /// A leaf's triangles, or the index of the second child (the first one follows).
    pub(crate) content: Content,
}

#[derive(Clone, Copy, Debug)]
pub(crate) enum Content {
    Leaf(usize, usize),
    Fork(usize),
}

/// The triangles of a file, ready for queries, in the frame of the file.
#[derive(Clone, Debug)]
pub struct MeshTree {
    /// Where they came from.
    pub source: String,
    /// Whether there is an inside.
    pub enclosure: ShellEnclosure,
    /// Edges with one side only.
    pub open_edges: usize,
    /// A corner of every connected part.
    pub points: Vec<DVec3>,
    /// Triangles beside closed shells: they have distances and enclose nothing.
    pub flaps: usize,
    /// What encloses space where that is not all triangles.
    walls: Option<Vec<[DVec3; 3]>>,
    pub(crate) triangles: Vec<[DVec3; 3]>,
    pub(crate) nodes: Vec<TreeNode>,
}

impl MeshTree {
    /// Builds the tree: n log n.
    pub fn new(soup: &TriangleSoup) -> Self {
        let mut shells = Shells::new(soup);
        let flaps = shells.flaps.len();
        let walls = (flaps > 0).then(|| shells.triangles.clone());
        shells.triangles.append(&mut shells.flaps);
        let mut tree = Self {
            source: soup.source.clone(),
            enclosure: shells.enclosure,
            open_edges: shells.open_edges,
            points: shells.points,
            flaps,
            walls,
            triangles: shells.triangles,
            nodes: Vec::new(),
        };
        tree.grow(0, tree.triangles.len());
        tree
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

    /// Centre and radius of a ball around all triangles.
    pub fn bounds(&self) -> (DVec3, f64) {
        let root = self.nodes.first().map(|node| node.around);
        root.map_or((DVec3::ZERO, 0.0), |around| (around.center, around.radius))
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.triangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.triangles.is_empty()
    }

    /// A vertex with the largest n · p; none without triangles.
    pub fn farthest(&self, n: DVec3) -> Option<DVec3> {
        let corners = self.triangles.get(self.highest(0, n).triangle)?;
        Some(corners.iter().copied().fold(corners[0], |best, p| {
            if n.dot(p) > n.dot(best) { p } else { best }
        }))
    }

    /// What lies farthest along `n` below a node.
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

    /// Whether a point is inside, by the solid angle of all triangles; an open mesh has no inside.
    pub fn encloses(&self, point: DVec3) -> bool {
        let is_hollow = matches!(
            self.enclosure,
            ShellEnclosure::Solid | ShellEnclosure::InsideOut
        );
        let (center, radius) = self.bounds();
        is_hollow
            && point.distance(center) <= radius
            && turns_around(self.walls.as_ref().unwrap_or(&self.triangles), point).abs() > 0.5
    }
}

/// The triangle that reaches farthest in a direction n, and the n · p of its corner.
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

/// Two things in the order of their numbers.
pub(crate) fn nearer_first<T: Copy>(mut two: [(T, f64); 2]) -> [(T, f64); 2] {
    if two[1].1 < two[0].1 {
        two.swap(0, 1);
    }
    two
}
