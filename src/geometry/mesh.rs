//! A triangle mesh, and whether it encloses space.

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
    use std::collections::{HashMap, HashSet};
    // Adding zero makes -0 into 0, so that equal positions have equal bits.
    let mut index_of = HashMap::new();
    let welded: Vec<usize> = mesh
        .positions
        .iter()
        .map(|p| {
            let next = index_of.len();
            *index_of
                .entry((*p + 0.0).to_array().map(f64::to_bits))
                .or_insert(next)
        })
        .collect();
    let mut balance: HashMap<[usize; 2], [u32; 2]> = HashMap::new();
    let mut used = HashSet::new();
    let mut triangles = 0;
    for triangle in &mesh.triangles {
        let corners = triangle.map(|i| welded.get(i as usize).copied());
        let [Some(a), Some(b), Some(c)] = corners else {
            return None;
        };
        if a == b || b == c || c == a {
            continue;
        }
        triangles += 1;
        used.extend([a, b, c]);
        for [from, to] in [[a, b], [b, c], [c, a]] {
            balance.entry([from.min(to), from.max(to)]).or_default()[usize::from(from > to)] += 1;
        }
    }
    let closed = triangles > 0 && balance.values().all(|[along, against]| along == against);
    closed.then_some([used.len(), balance.len(), triangles])
}
