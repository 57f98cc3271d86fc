//! Patches of meshes, and widths of lines.

use super::*;
use crate::geometry::mesh_of;
use crate::model::shape::Solid;
use crate::render::StageMesh;
use glam::DVec3;

#[test]
fn a_box_has_six_patches_a_cylinder_three_a_ball_one() {
    let solid = [
        Solid::Box {
            centre: DVec3::ZERO,
            size: DVec3::ONE,
        },
        Solid::Cylinder {
            from: DVec3::ZERO,
            to: DVec3::Z,
            radius: 0.3,
        },
        Solid::Sphere {
            centre: DVec3::X,
            radius: 2.0,
        },
        Solid::Capsule {
            from: DVec3::ZERO,
            to: DVec3::Y,
            radius: 0.2,
        },
        Solid::Torus {
            centre: DVec3::ZERO,
            axis: DVec3::Z,
            ring: 2.0,
            tube: 0.5,
        },
    ];
    let counts = solid.map(|solid| StageMesh::from(mesh_of(&solid, 0.01)).patch_count);
    assert_eq!(counts, [6, 3, 1, 1, 1]);
}

#[test]
fn lines_grow_with_the_picture() {
    let widths = [240, 480, 2160].map(|height| EdgeStyle::half_width(height, 4));
    assert!(widths.is_sorted() && widths[2] > 2.5);
    assert!(EdgeStyle::half_width(480, 1) > 1.0);
}
