//! Triangle meshes of the model's solids. Independent of poses and renderers.

mod crease;
mod mesh;
mod primitive;
mod round;
pub mod section;
pub mod stl;
mod torus;
pub mod trace;
mod tube;

pub use crease::mesh_of_triangles;
pub use mesh::Mesh;
pub use round::{MAX_SEGMENTS, MIN_SEGMENTS};
pub use stl::{MAX_STL_TRIANGLES, StlError, read_stl};
pub use trace::{TraceMesh, trace_mesh};

use crate::model::shape::Solid;

/// The mesh of a solid in the solid's own frame.
///
/// `tolerance` is the largest distance between a round surface and its facets, in the scene's unit; the
/// facet count stays within [`MIN_SEGMENTS`] and [`MAX_SEGMENTS`] a turn. A solid without extent or with
/// numbers that are not finite gives an empty mesh.
pub fn mesh_of(solid: &Solid, tolerance: f64) -> Mesh {
    let mesh = match solid {
        Solid::Sphere { centre, radius } => primitive::ball_mesh(*centre, *radius, tolerance),
        Solid::Capsule { from, to, radius } => {
            primitive::capsule_mesh(*from, *to, *radius, tolerance)
        }
        Solid::Cylinder { from, to, radius } => {
            primitive::frustum_mesh([*from, *to], [*radius, *radius], tolerance)
        }
        Solid::Cone {
            from,
            to,
            radius_from,
            radius_to,
        } => primitive::frustum_mesh([*from, *to], [*radius_from, *radius_to], tolerance),
        Solid::Box { centre, size } => primitive::cuboid_mesh(*centre, *size),
        Solid::Torus {
            centre,
            axis,
            ring,
            tube,
        } => torus::torus_mesh(*centre, *axis, *ring, *tube, tolerance),
        Solid::Tube {
            points,
            radius,
            closed,
        } => tube::tube_mesh(points, *radius, *closed, tolerance),
        Solid::HalfSpace {
            point,
            normal,
            size,
        } => primitive::sheet_mesh(*point, *normal, *size),
        Solid::Triangles(soup) => mesh_of_triangles(&soup.vertices, &soup.triangles),
    };
    // Overflow of huge sizes gives no mesh instead of a broken one.
    let finite = mesh
        .positions
        .iter()
        .chain(&mesh.normals)
        .all(|v| v.is_finite());
    if finite { mesh } else { Mesh::default() }
}

/// The mesh of a solid whose facets are off by `share` of its own largest radius.
pub fn coarse_mesh_of(solid: &Solid, share: f64) -> Mesh {
    mesh_of(solid, share * largest_radius(solid).unwrap_or(1.0))
}

/// The largest radius of a solid's round surfaces; `None` if all of it is flat.
pub fn largest_radius(solid: &Solid) -> Option<f64> {
    match solid {
        Solid::Sphere { radius, .. }
        | Solid::Capsule { radius, .. }
        | Solid::Cylinder { radius, .. }
        | Solid::Tube { radius, .. } => Some(*radius),
        Solid::Cone {
            radius_from,
            radius_to,
            ..
        } => Some(radius_from.max(*radius_to)),
        Solid::Torus { ring, tube, .. } => Some(ring + tube),
        Solid::Box { .. } | Solid::HalfSpace { .. } | Solid::Triangles(_) => None,
    }
}

#[cfg(test)]
mod tests;
