//! The triangles of a file as a tree, and tests for their inside.

pub use super::shells::ShellEnclosure;
use super::shells::Shells;
use super::triangle_tree::TriangleTree;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// The triangles of a file, ready for queries, in the frame of the file.
#[derive(Clone, Debug)]
pub struct MeshTree {
    /// The triangles they came from.
    pub source: String,
    /// Whether there is an inside.
    pub enclosure: ShellEnclosure,
    /// Edges that do not have equally many triangles on both sides, as the file orients them.
    pub open_edges: usize,
    /// A corner of every connected part.
    pub points: Vec<DVec3>,
    /// Triangles beside closed shells: they have distances and enclose nothing.
    pub flaps: usize,
    /// The triangles that enclose nothing, as a tree of their own.
    flap_tree: Option<TriangleTree>,
    /// All triangles.
    pub(crate) tree: TriangleTree,
}

impl MeshTree {
    /// Builds the tree: n log n.
    pub fn new(soup: &TriangleSoup) -> Self {
        let mut shells = Shells::new(soup);
        let flaps = shells.flaps.len();
        let flap_tree = (flaps > 0).then(|| TriangleTree::new(shells.flaps.clone()));
        shells.triangles.append(&mut shells.flaps);
        Self {
            source: soup.source.clone(),
            enclosure: shells.enclosure,
            open_edges: shells.open_edges,
            points: shells.points,
            flaps,
            flap_tree,
            tree: TriangleTree::new(shells.triangles),
        }
    }

    /// The same mesh with all its coordinates multiplied by a positive factor.
    pub fn scaled(&self, factor: f64) -> Self {
        Self {
            source: self.source.clone(),
            points: self.points.iter().map(|point| *point * factor).collect(),
            flap_tree: self.flap_tree.as_ref().map(|tree| tree.scaled(factor)),
            tree: self.tree.scaled(factor),
            ..*self
        }
    }

    /// Whether a point is inside, by the triangles that a ray from it crosses; an open mesh has no inside.
    pub fn encloses(&self, point: DVec3) -> bool {
        let is_hollow = matches!(
            self.enclosure,
            ShellEnclosure::Solid | ShellEnclosure::InsideOut
        );
        is_hollow && self.tree.turns(self.flap_tree.as_ref(), point).abs() > 0.5
    }

    /// Number of triangles.
    pub fn len(&self) -> usize {
        self.tree.triangles.len()
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.tree.triangles.is_empty()
    }
}

/// Trees of meshes by the address of their triangles: bodies with the same mesh share its tree.
#[derive(Default)]
pub struct MeshTrees(HashMap<usize, Arc<MeshTree>>);

impl MeshTrees {
    /// The tree of these triangles.
    pub(crate) fn tree(&mut self, soup: &Arc<TriangleSoup>) -> Arc<MeshTree> {
        // The mechanism keeps the triangles alive as long as this value lives.
        let kept = self.0.entry(Arc::as_ptr(soup) as usize);
        Arc::clone(kept.or_insert_with(|| Arc::new(MeshTree::new(soup))))
    }
}
