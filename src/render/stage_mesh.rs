//! Meshes in the form that renderers read: in single precision, validated once. A picture needs no other copy.

use super::edges;
use crate::geometry::Mesh;
use crate::math::narrow_vector;
use glam::DVec3;

/// A box is far from the origin beyond this many times its size: up to there single precision tells 60 000 places along its sides
/// apart.
const FAR: f64 = 256.0;

/// A mesh of a stage.
#[derive(Clone, Debug, Default)]
pub struct StageMesh {
    /// Where the vertices are counted from, in the mesh's frame: its origin, or the middle of a mesh that is far from there,
    /// where single precision would not tell its vertices apart.
    pub origin: DVec3,
    /// Vertices from `origin` on, in the scene's length unit.
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
    /// Least and greatest corner of the box around it, in the mesh's frame; both zero without vertices.
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
        let origin = origin_of(bounds);
        let positions = narrowed_points(positions, count, origin);
        let normals = narrowed_points(normals, count, DVec3::ZERO);
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
            origin,
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

/// The middle of a box that is far from the origin for its size; otherwise the origin.
fn origin_of([low, high]: [DVec3; 2]) -> DVec3 {
    let size = (high - low).max_element();
    match low.abs().max(high.abs()).max_element() > FAR * size {
        true => 0.5 * low + 0.5 * high,
        false => DVec3::ZERO,
    }
}

fn narrowed_points(list: Vec<DVec3>, count: usize, origin: DVec3) -> Vec<[f32; 3]> {
    // Not in place: `collect` would keep the memory of the f64 list.
    let mut narrow = Vec::with_capacity(count);
    narrow.extend(list[..count].iter().map(|v| narrow_vector(*v - origin)));
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

    /// A millimetre is kept at any distance.
    #[test]
    fn vertices_far_from_the_origin_are_told_apart() {
        for far in [0.0, 1e3, 1e7, 1e12] {
            let corners = [DVec3::ZERO, DVec3::X, DVec3::Y].map(|p| p + DVec3::splat(far));
            let mesh = StageMesh::from(Mesh {
                positions: corners.to_vec(),
                normals: vec![DVec3::Z; 3],
                triangles: vec![[0, 1, 2]],
            });
            for (place, corner) in mesh.positions.iter().zip(corners) {
                let kept = mesh.origin + DVec3::from(place.map(f64::from));
                assert!(kept.distance(corner) < 1e-3, "{far}: {kept}");
            }
        }
    }
}
