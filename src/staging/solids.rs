//! Several solids as one mesh: symbols that pictures add to a mechanism are drawn as one instance.

use crate::geometry::{Mesh, mesh_of};
use crate::math::Pose;
use crate::model::shape::Solid;
use crate::render::{Instance, StageMesh};
use glam::DVec3;

/// The mesh of all `solids`; facets are off by `tolerance` at most.
pub fn merged_mesh(solids: &[Solid], tolerance: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for solid in solids {
        let part = mesh_of(solid, tolerance);
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(part.positions);
        mesh.normals.extend(part.normals);
        let triangles = part.triangles.iter();
        mesh.triangles
            .extend(triangles.map(|t| t.map(|k| k + first)));
    }
    mesh
}

/// An arrow from the origin along `direction` (unit length).
pub fn arrow_solids(direction: DVec3, length: f64, shaft: f64, head: f64) -> Vec<Solid> {
    let neck = direction * (length - head).max(0.0);
    let mut solids = vec![Solid::Cone {
        from: neck,
        to: neck + direction * head,
        radius_from: 0.36 * head,
        radius_to: 0.0,
    }];
    if length > head {
        solids.push(Solid::Cylinder {
            from: DVec3::ZERO,
            to: neck,
            radius: shaft,
        });
    }
    solids
}

/// A whole mesh, opaque, without shadow; `flat` as in [`Instance`].
pub fn sign_instance(
    mesh: usize,
    meshes: &[StageMesh],
    at: Pose,
    colour: [u8; 3],
    flat: f64,
) -> Instance {
    Instance {
        mesh,
        world_from_mesh: at,
        colour,
        opacity: 1.0,
        triangles: 0..meshes[mesh].triangles.len() as u32,
        casts_shadow: false,
        outline: None,
        flat,
    }
}
