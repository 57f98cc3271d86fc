//! Meshes in the form that renderers read: in single precision, validated once. A picture needs no other copy.

use super::edges;
use crate::geometry::Mesh;
use crate::math::narrow_vector;
use glam::DVec3;

/// A mesh of a stage.
#[derive(Clone, Debug, Default)]
pub struct StageMesh {
    /// Vertices in the mesh's frame, in the scene's length unit.
    pub positions: Vec<[f32; 3]>,
    /// One for each vertex.
    pub normals: Vec<[f32; 3]>,
    /// Indices are within the vertices; an invalid triangle is all zeros and has no area.
    pub triangles: Vec<[u32; 3]>,
    /// The smooth patch of each vertex.
    pub patches: Vec<u32>,
    /// How many patches there are.
    pub patch_count: u32,
    /// Back faces of a closed mesh are invisible.
    pub closed: bool,
    /// Least and greatest corner of the box around it; both zero without vertices.
    pub bounds: [DVec3; 2],
}

/// The meshes that a frame can draw: those of its stage, then its own.
#[derive(Clone, Copy, Debug)]
pub struct MeshList<'a> {
    of_stage: &'a [StageMesh],
    of_frame: &'a [StageMesh],
}

impl<'a> MeshList<'a> {
    /// Both lists.
    pub fn new(of_stage: &'a [StageMesh], of_frame: &'a [StageMesh]) -> Self {
        Self { of_stage, of_frame }
    }

    /// The mesh that an instance means.
    pub fn get(&self, index: usize) -> Option<&'a StageMesh> {
        let own = index.checked_sub(self.of_stage.len());
        own.map_or_else(|| self.of_stage.get(index), |own| self.of_frame.get(own))
    }
}

impl From<Mesh> for StageMesh {
    fn from(mesh: Mesh) -> Self {
        // Work that needs double precision comes first. Then every list is freed as soon as it is converted, since two
        // of them can fill the memory allowed for a mesh of millions of triangles.
        let closed = mesh.hides_its_inside();
        let bounds = mesh.bounds().unwrap_or_default();
        let Mesh {
            positions,
            normals,
            mut triangles,
        } = mesh;
        let count = positions.len().min(normals.len());
        let positions = narrowed_points(positions, count);
        let normals = narrowed_points(normals, count);
        if count == 0 {
            triangles.clear();
        }
        for triangle in &mut triangles {
            if triangle.iter().any(|corner| *corner as usize >= count) {
                *triangle = [0; 3];
            }
        }
        let (patches, patch_count) = edges::patches(count, &triangles);
        Self {
            positions,
            normals,
            triangles,
            patches,
            patch_count,
            closed,
            bounds,
        }
    }
}

fn narrowed_points(list: Vec<DVec3>, count: usize) -> Vec<[f32; 3]> {
    // Not in place: `collect` would keep the memory of the f64 list.
    let mut narrow = Vec::with_capacity(count);
    narrow.extend(list[..count].iter().map(|v| narrow_vector(*v)));
    narrow
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_corner_without_vertex_takes_its_triangle_away() {
        let mesh = StageMesh::from(Mesh {
            positions: vec![DVec3::ZERO, DVec3::X, DVec3::new(0.2, 1.0, -4.0)],
            normals: vec![DVec3::Z; 3],
            triangles: vec![[0, 1, 2], [0, 1, 3]],
        });
        assert_eq!(mesh.triangles, [[0, 1, 2], [0; 3]]);
        assert_eq!(
            mesh.bounds,
            [DVec3::new(0.0, 0.0, -4.0), DVec3::new(1.0, 1.0, 0.0)]
        );
        assert_eq!(mesh.patch_count, 1);
        let nothing = StageMesh::from(Mesh {
            triangles: vec![[0, 0, 0]],
            ..Mesh::default()
        });
        assert!(nothing.triangles.is_empty() && nothing.bounds == [DVec3::ZERO; 2]);
    }
}
