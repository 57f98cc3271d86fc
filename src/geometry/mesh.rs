//! A triangle mesh, and whether it is closed.

use crate::weld::{first_equal, point_bits};
use glam::DVec3;

/// A closed or open triangle mesh with one normal per vertex.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh {
    /// Vertices in the mesh's frame, in the scene's length unit.
    pub positions: Vec<DVec3>,
    /// Outward unit normals, one per vertex.
    pub normals: Vec<DVec3>,
    /// Corner indices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

impl Mesh {
    /// Adds a vertex and returns its index.
    pub fn push_vertex(&mut self, position: DVec3, normal: DVec3) -> u32 {
        self.positions.push(position);
        self.normals.push(normal);
        (self.positions.len() - 1) as u32
    }

    /// Least and greatest corner of the axis-parallel box around all vertices; `None` without vertices.
    pub fn bounds(&self) -> Option<[DVec3; 2]> {
        let first = *self.positions.first()?;
        Some(
            self.positions
                .iter()
                .fold([first, first], |[low, high], p| [low.min(*p), high.max(*p)]),
        )
    }

    /// Whether every edge is shared by two triangles that run along it in opposite directions.
    ///
    /// Corners at exactly the same position count as one, triangles with two such corners are ignored.
    pub fn is_closed(&self) -> bool {
        closed_edges(self).is_some()
    }

    /// Whether the outside completely hides the inside: closed, and not inside out as in some files. A renderer may
    /// cull the back faces of such a mesh.
    pub fn hides_its_inside(&self) -> bool {
        self.volume() > 0.0 && self.is_closed()
    }

    /// The volume inside a closed mesh, negative if it is inside out.
    pub fn volume(&self) -> f64 {
        let corner = |index: u32| {
            let position = self.positions.get(index as usize);
            position.copied().unwrap_or_default()
        };
        let six_volumes: f64 = self
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))
            .sum();
        six_volumes / 6.0
    }
}

/// Number of distinct vertices, edges and triangles of a closed mesh; `None` for an open one.
pub(super) fn closed_edges(mesh: &Mesh) -> Option<[usize; 3]> {
    let welded = first_equal(mesh.positions.len(), |k| point_bits(mesh.positions[k]));
    let is_corner = |i: &u32| (*i as usize) < welded.len();
    if !mesh.triangles.iter().flatten().all(is_corner) {
        return None;
    }
    let edges = || {
        let corners = mesh.triangles.iter();
        let corners = corners.map(|triangle| triangle.map(|i| welded[i as usize]));
        let has_edges = |[a, b, c]: &[u32; 3]| a != b && b != c && c != a;
        let corners = corners.filter(has_edges);
        corners.flat_map(|[a, b, c]| [[a, b], [b, c], [c, a]])
    };
    // Most open meshes are recognised without a list of their edges, which would fill the memory for large ones.
    let balance = edges().fold(0u64, |sum, [a, b]| match a < b {
        true => sum.wrapping_add(edge_mark(a, b)),
        false => sum.wrapping_sub(edge_mark(b, a)),
    });
    if balance != 0 {
        return None;
    }
    let mut edges: Vec<[u32; 2]> = edges().collect();
    let triangles = edges.len() / 3;
    let ends = |edge: &[u32; 2]| [edge[0].min(edge[1]), edge[0].max(edge[1])];
    edges.sort_unstable_by_key(ends);
    let mut count = 0;
    for edge in edges.chunk_by(|a, b| ends(a) == ends(b)) {
        let along = edge.iter().filter(|edge| edge[0] < edge[1]).count();
        if 2 * along != edge.len() {
            return None;
        }
        count += 1;
    }
    let mut used: Vec<u32> = edges.into_iter().map(|edge| edge[0]).collect();
    used.sort_unstable();
    used.dedup();
    (triangles > 0).then_some([used.len(), count, triangles])
}

/// A hash of a directed edge: the hashes of opposite edges cancel.
fn edge_mark(low: u32, high: u32) -> u64 {
    let mixed = (u64::from(low) << 32 | u64::from(high)).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    (mixed ^ (mixed >> 29)).wrapping_mul(0xbf58_476d_1ce4_e5b9)
}
