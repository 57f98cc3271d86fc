//! A body that casts shadows on others.

use crate::render::depth_order::Eye;
use crate::render::{Instance, StageMesh};

/// A body that shades others.
pub(super) struct Caster<'a> {
    pub(super) mesh: &'a StageMesh,
    /// What is drawn of it.
    pub(super) triangles: &'a [[u32; 3]],
    /// Whether their back faces are invisible.
    pub(super) closed: bool,
    /// The map from the mesh to the camera.
    pub(super) rows: [[f32; 4]; 3],
}

impl<'a> Caster<'a> {
    /// Instance `number` of a frame; `None` if it casts no shadow: only opaque bodies do, not traces or markers.
    pub(super) fn new(
        instance: &Instance,
        number: usize,
        mesh: &'a StageMesh,
        eye: &Eye,
    ) -> Option<Self> {
        let count = mesh.triangles.len();
        let end = (instance.triangles.end as usize).min(count);
        let start = (instance.triangles.start as usize).min(end);
        // Translucent bodies cast no shadow; a closed mesh needs only its faces towards the light.
        let casts = instance.casts_shadow && instance.opacity >= 1.0;
        casts.then(|| Self {
            mesh,
            triangles: &mesh.triangles[start..end],
            closed: mesh.closed && end - start == count,
            rows: eye.camera_from_mesh((instance, mesh.origin), number),
        })
    }
}

/// A row of a map applied to a point.
#[inline(always)]
pub(super) fn row_value(row: &[f32; 4], p: [f32; 3]) -> f32 {
    row[0] * p[0] + row[1] * p[1] + row[2] * p[2] + row[3]
}
