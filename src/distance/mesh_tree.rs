//! The triangles of a file as a tree, and what is inside.

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
    /// The triangles that enclose nothing, once more.
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

    /// Whether a point is inside, by what crosses a ray from it; an open mesh has no inside.
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

/// Trees of meshes by where their triangles are kept: bodies that share these share the tree.
#[derive(Default)]
pub struct MeshTrees(HashMap<usize, Arc<MeshTree>>);

impl MeshTrees {
    /// That of some triangles.
    pub(crate) fn tree(&mut self, soup: &Arc<TriangleSoup>) -> Arc<MeshTree> {
        // They are kept by the mechanism as long as this lives.
        let kept = self.0.entry(Arc::as_ptr(soup) as usize);
        Arc::clone(kept.or_insert_with(|| Arc::new(MeshTree::new(soup))))
    }
}
