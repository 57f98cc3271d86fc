//! Triangles from files: normals, and which faces are hidden.

use super::*;

#[test]
fn bare_triangles_get_smooth_and_sharp_normals() {
    let ball = mesh_of(
        &Solid::Sphere {
            centre: DVec3::ZERO,
            radius: 1.0,
        },
        1e-3,
    );
    let soup = TriangleSoup {
        is_surface: false,
        source: String::new(),
        vertices: ball.positions.clone(),
        triangles: ball
            .triangles
            .iter()
            .copied()
            .chain([[0, 0, 1], [0, 1, 99_999_999]])
            .collect(),
    };
    let mesh = mesh_of(&Solid::Triangles(Arc::new(soup)), 1.0);
    assert_eq!(mesh.triangles.len(), ball.triangles.len());
    assert_eq!(mesh.positions.len(), ball.positions.len());
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(normal.dot(*position) > 0.999);
    }
}

#[test]
fn back_faces_are_hidden_only_by_a_whole_mesh_the_right_way_out() {
    let whole = mesh_of(
        &Solid::Box {
            centre: DVec3::ONE,
            size: DVec3::ONE,
        },
        0.1,
    );
    assert!(whole.hides_its_inside());
    let mut gap = whole.clone();
    gap.triangles.pop();
    assert!(!gap.hides_its_inside());
    let mut inside_out = whole;
    for triangle in &mut inside_out.triangles {
        triangle.swap(0, 1);
    }
    assert!(inside_out.is_closed() && !inside_out.hides_its_inside());
    assert!(!Mesh::default().hides_its_inside());
}
