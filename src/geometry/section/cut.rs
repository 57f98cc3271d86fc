//! Removes what lies on one side of a plane from a mesh.
//!
//! Triangles that cross the plane are cut. Both triangles at an edge find the same point on it, to the last bit, so that
//! the border of a closed mesh is closed as well.

use super::plane::CutPlane;
use crate::geometry::mesh::Mesh;
use glam::DVec3;
use std::collections::HashMap;

/// Corners nearer to the plane than this lie in it, relative to the largest coordinate: single precision, in which
/// pictures keep meshes, rounds by a tenth of this. A face in the plane is thus never cut into splinters.
const IN_PLANE: f64 = 1e-6;

/// What a plane leaves of a mesh.
#[derive(Clone, Debug, PartialEq)]
pub enum CutMesh {
    /// All of it: the plane does not cross it, or only touches it.
    Whole,
    /// None of it.
    Nothing,
    /// A part of it.
    Part(CutPart),
}

/// The part of a mesh on one side of a plane.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CutPart {
    /// The surface, open at the plane.
    pub shell: Mesh,
    /// Its border in the plane, from point to point. Seen from the removed side, the inside of the solid is to the left.
    pub border: Vec<[DVec3; 2]>,
}

/// Cuts a mesh and keeps what is not on the side to which the normal points. Both are in the frame of the mesh.
pub fn cut_mesh(mesh: &Mesh, plane: &CutPlane) -> CutMesh {
    let largest = mesh.positions.iter().map(|p| p.abs().max_element());
    let largest = largest.fold(plane.point.abs().max_element(), f64::max);
    let heights = mesh.positions.iter().map(|p| {
        let height = plane.height(*p);
        match height.abs() <= IN_PLANE * largest {
            true => 0.0,
            false => height,
        }
    });
    let heights: Vec<f64> = heights.collect();
    // A mesh that only touches the plane is not cut.
    if !heights.iter().any(|height| *height > 0.0) {
        return CutMesh::Whole;
    }
    if !heights.iter().any(|height| *height < 0.0) {
        return CutMesh::Nothing;
    }
    let mut cutter = Cutter {
        mesh,
        heights: &heights,
        kept: vec![None; mesh.positions.len()],
        between: HashMap::new(),
        part: CutPart::default(),
    };
    for triangle in &mesh.triangles {
        cutter.add_triangle(*triangle);
    }
    CutMesh::Part(cutter.part)
}

/// Builds the part that is kept.
struct Cutter<'m> {
    mesh: &'m Mesh,
    /// Of every vertex above the plane; zero in it.
    heights: &'m [f64],
    /// New numbers of vertices.
    kept: Vec<Option<u32>>,
    /// New vertices on edges from a kept to a removed vertex. Triangles that share an edge share its point, so that a
    /// smooth patch stays one.
    between: HashMap<[u32; 2], u32>,
    part: CutPart,
}

impl Cutter<'_> {
    fn add_triangle(&mut self, triangle: [u32; 3]) {
        let is_removed = triangle.map(|corner| self.heights[corner as usize] > 0.0);
        let removed = is_removed.iter().filter(|removed| **removed).count();
        if removed == 3 {
            return;
        }
        // Begin at the first corner after a removed one: then the kept corners are in one piece.
        let start = (0..3).find(|k| is_removed[(k + 2) % 3] && !is_removed[*k]);
        let turned = [0, 1, 2].map(|k| triangle[(start.unwrap_or(0) + k) % 3]);
        let kept: Vec<u32> = turned[..3 - removed].to_vec();
        let mut corners: Vec<u32> = kept.iter().map(|corner| self.keep(*corner)).collect();
        if removed > 0 {
            // Out over the last kept corner's edge, back over the first one's.
            let out = self.cross(kept[kept.len() - 1], turned[kept.len()]);
            let back = self.cross(kept[0], turned[2]);
            corners.extend([out, back]);
            let [out, back] = [out, back].map(|k| self.part.shell.positions[k as usize]);
            // The boundary of the region in the plane runs the other way than that of the surface.
            if out != back {
                self.part.border.push([back, out]);
            }
        }
        // The rest of the triangle as a fan. Where a corner lies in the plane, a part of it has no area.
        corners.dedup();
        for k in 2..corners.len() {
            let fan = [corners[0], corners[k - 1], corners[k]];
            if fan[0] != fan[2] {
                self.part.shell.triangles.push(fan);
            }
        }
    }

    /// The new number of a kept vertex.
    fn keep(&mut self, vertex: u32) -> u32 {
        let old = vertex as usize;
        let (position, normal) = (self.mesh.positions[old], self.mesh.normals[old]);
        let shell = &mut self.part.shell;
        *self.kept[old].get_or_insert_with(|| shell.push_vertex(position, normal))
    }

    /// The vertex at which an edge from a kept to a removed vertex meets the plane.
    fn cross(&mut self, kept: u32, removed: u32) -> u32 {
        if self.heights[kept as usize] == 0.0 {
            return self.keep(kept);
        }
        let [from, to] = [kept, removed].map(|vertex| vertex as usize);
        let (mesh, heights, shell) = (self.mesh, self.heights, &mut self.part.shell);
        *self.between.entry([kept, removed]).or_insert_with(|| {
            // Always from the kept end, so that every triangle at this edge finds the same bits.
            let share = heights[from] / (heights[from] - heights[to]);
            let on_way = |list: &[DVec3]| list[from] + (list[to] - list[from]) * share;
            let normal = on_way(&mesh.normals);
            let normal = normal.try_normalize().unwrap_or(mesh.normals[from]);
            shell.push_vertex(on_way(&mesh.positions), normal)
        })
    }
}
