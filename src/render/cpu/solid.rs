//! The stage's meshes in f32, checked once.

use crate::geometry::Mesh;
use crate::math::narrow_vector;
use crate::render::edges;
use glam::DVec3;

/// A mesh as the frame loop reads it.
#[derive(Clone, Debug)]
pub(super) struct SolidPixels {
    pub(super) positions: Vec<[f32; 3]>,
    pub(super) normals: Vec<[f32; 3]>,
    /// Indices are within the vertices; a triangle that was not is all zeros and has no area.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The smooth patch of each vertex, and how many there are.
    pub(super) patches: Vec<u32>,
    pub(super) patch_count: u32,
    /// Back faces of a closed mesh are never seen.
    pub(super) closed: bool,
    /// Corners of the box around it.
    pub(super) bounds: [DVec3; 2],
}

impl SolidPixels {
    pub(super) fn new(mesh: &Mesh) -> Self {
        let count = mesh.positions.len().min(mesh.normals.len());
        let triangle = |t: &[u32; 3]| {
            if t.iter().all(|i| (*i as usize) < count) {
                *t
            } else {
                [0; 3]
            }
        };
        let (patches, patch_count) = edges::patches(mesh);
        Self {
            patches,
            patch_count,
            positions: mesh.positions[..count]
                .iter()
                .map(|p| narrow_vector(*p))
                .collect(),
            normals: mesh.normals[..count]
                .iter()
                .map(|n| narrow_vector(*n))
                .collect(),
            triangles: if count > 0 {
                mesh.triangles.iter().map(triangle).collect()
            } else {
                Vec::new()
            },
            closed: mesh.hides_its_inside(),
            bounds: mesh.bounds().unwrap_or([DVec3::ZERO; 2]),
        }
    }
}
