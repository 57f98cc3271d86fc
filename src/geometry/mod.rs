//! Triangle meshes of the model's solids. Holds no poses of links and no renderer.

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
