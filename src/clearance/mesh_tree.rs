//! A tree of balls over the triangles of a file, which are taken as they are.

pub use super::shells::Enclosure;
use super::shells::{Shells, turns_around};
use crate::model::shape::TriangleSoup;
use glam::DVec3;

/// Most triangles in a leaf.
const LEAF: usize = 4;

/// A ball around some triangles.
#[derive(Clone, Copy, Debug)]
pub(super) struct Node {
    pub(super) center: DVec3,
    pub(super) radius: f64,
    /// A leaf's triangles, or the index of the second child (the first one follows).
    pub(super) content: Content,
}

#[derive(Clone, Copy, Debug)]
pub(super) enum Content {
    Leaf(usize, usize),
    Fork(usize),
}

/// The triangles of a file, ready for queries, in the frame of the file.
#[derive(Clone, Debug)]
pub struct MeshTree {
    /// Where they came from.
    pub source: String,
    /// Whether there is an inside.
    pub enclosure: Enclosure,
    /// Edges with one side only.
    pub open_edges: usize,
    /// A corner of every connected part.
    pub points: Vec<DVec3>,
    pub(super) triangles: Vec<[DVec3; 3]>,
    pub(super) nodes: Vec<Node>,
}

impl MeshTree {
    /// Builds the tree: n log n.
    pub fn new(soup: &TriangleSoup) -> Self {
        let shells = Shells::new(soup);
        let mut tree = Self {
            source: soup.source.clone(),
            enclosure: shells.enclosure,
            open_edges: shells.open_edges,
            points: shells.points,
            triangles: shells.triangles,
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

    /// A vertex with the least n · p.
    pub fn lowest(&self, n: DVec3) -> DVec3 {
        let lower = |p: DVec3, q: DVec3| if n.dot(q) < n.dot(p) { q } else { p };
        let corners = self.triangles.iter().flatten().copied();
        corners.reduce(lower).unwrap_or_default()
    }

    /// Whether a point is inside, by the solid angle of all triangles; an open mesh has no inside.
    pub fn encloses(&self, point: DVec3) -> bool {
        let is_hollow = matches!(self.enclosure, Enclosure::Solid | Enclosure::InsideOut);
        let (center, radius) = self.bounds();
        is_hollow
            && point.distance(center) <= radius
            && turns_around(&self.triangles, point).abs() > 0.5
    }
}
