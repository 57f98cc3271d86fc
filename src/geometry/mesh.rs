//! A triangle mesh, and whether it encloses space.

use super::weld::{first_equal, point_bits};
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

    /// Whether the outside hides the inside completely: closed, and not inside out as a file may have it. A
    /// renderer may leave out the back faces of such a mesh.
    pub fn hides_its_inside(&self) -> bool {
        let corner = |index: u32| {
            let position = self.positions.get(index as usize);
            position.copied().unwrap_or_default()
        };
        let six_volumes: f64 = self
            .triangles
            .iter()
            .map(|t| corner(t[0]).dot(corner(t[1]).cross(corner(t[2]))))
            .sum();
        six_volumes > 0.0 && self.is_closed()
    }
}

/// Number of distinct vertices, edges and triangles of a closed mesh; `None` for an open one.
pub(super) fn closed_edges(mesh: &Mesh) -> Option<[usize; 3]> {
    let welded = first_equal(mesh.positions.len(), |k| point_bits(mesh.positions[k]));
    let mut edges: Vec<[u32; 2]> = Vec::with_capacity(3 * mesh.triangles.len());
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| welded.get(i as usize).copied());
        let [Some(a), Some(b), Some(c)] = corners else {
            return None;
        };
        if a != b && b != c && c != a {
            edges.extend([[a, b], [b, c], [c, a]]);
        }
    }
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
