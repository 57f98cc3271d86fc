//! Cut solids against closed forms.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::*;
use crate::geometry::{Mesh, mesh_of};
use crate::model::shape::Solid;
use glam::{DVec2, DVec3};
use std::f64::consts::PI;

const NEAR: f64 = 1e-12;

/// The part of a solid below a plane through `point`, with the region of the cut in a frame of the plane.
struct Cut {
    shell: Mesh,
    border: Vec<[DVec2; 2]>,
    point: DVec3,
}

fn plane(point: DVec3, normal: DVec3) -> CutPlane {
    CutPlane {
        point,
        normal: normal.normalize(),
    }
}

fn frame_of(plane: &CutPlane) -> PlaneFrame {
    let first = plane.normal.any_orthonormal_vector();
    PlaneFrame {
        origin: plane.point,
        axes: [first, plane.normal.cross(first)],
    }
}

fn cut(mesh: &Mesh, plane: &CutPlane) -> Cut {
    assert!(mesh.is_closed(), "the mesh is open");
    let CutMesh::Part(part) = cut_mesh(mesh, plane) else {
        panic!("the plane does not cut the mesh");
    };
    let frame = frame_of(plane);
    let border = part.border.iter().map(|ends| ends.map(|p| frame.flat(p)));
    Cut {
        border: border.collect(),
        shell: part.shell,
        point: plane.point,
    }
}

fn area(parts: &[Trapezoid]) -> f64 {
    parts.iter().map(Trapezoid::area).sum()
}

impl Cut {
    fn area(&self) -> f64 {
        area(&divide_region(&self.border, None))
    }

    /// The volume under the cut: seen from a point of the plane, the cut face spans none.
    fn volume(&self) -> f64 {
        let corner = |k: u32| self.shell.positions[k as usize] - self.point;
        let spanned = self.shell.triangles.iter().map(|t| {
            let [a, b, c] = t.map(corner);
            a.dot(b.cross(c)) / 6.0
        });
        spanned.sum()
    }
}

fn block(centre: DVec3, size: DVec3) -> Mesh {
    mesh_of(&Solid::Box { centre, size }, 1.0)
}

/// Both meshes as one; the second with its inside out.
fn hollow(outer: &Mesh, inner: &Mesh) -> Mesh {
    let mut mesh = outer.clone();
    let base = mesh.positions.len() as u32;
    mesh.positions.extend(&inner.positions);
    mesh.normals.extend(inner.normals.iter().map(|n| -n));
    let turned = inner.triangles.iter().map(|t| [t[0], t[2], t[1]]);
    mesh.triangles.extend(turned.map(|t| t.map(|k| k + base)));
    mesh
}

#[test]
fn a_box_keeps_its_exact_volume_below_the_plane() {
    let mesh = block(DVec3::new(1.0, 2.0, 3.0), DVec3::new(2.0, 4.0, 6.0));
    let level = cut(&mesh, &plane(DVec3::new(0.0, 0.0, 1.5), DVec3::Z));
    assert_eq!([level.volume(), level.area()], [2.0 * 4.0 * 1.5, 8.0]);
    // A corner cut off: a pyramid with three right angles and edges of 1, its base equilateral.
    let corner = plane(DVec3::new(0.0, 0.0, 1.0), DVec3::ONE);
    let corner = cut(&mesh, &corner);
    assert!((corner.volume() - 1.0 / 6.0).abs() < NEAR);
    assert!((corner.area() - 0.75f64.sqrt()).abs() < NEAR);
    // From the other side everything else remains.
    let rest = cut(&mesh, &plane(DVec3::new(0.0, 0.0, 1.0), DVec3::NEG_ONE));
    assert!((rest.volume() - (48.0 - 1.0 / 6.0)).abs() < 48.0 * NEAR);
    assert!((rest.area() - 0.75f64.sqrt()).abs() < NEAR);
}

#[test]
fn round_solids_have_round_cut_faces() {
    let tolerance = 1e-3;
    let [middle, up] = [
        DVec3::new(0.1, -0.2, 0.3),
        DVec3::new(0.3, 0.5, 0.8).normalize(),
    ];
    let (ring, tube) = (2.0, 0.5);
    let ball = Solid::Sphere {
        centre: middle,
        radius: 1.0,
    };
    let rod = Solid::Cylinder {
        from: middle - up * 2.0,
        to: middle + up * 2.0,
        radius: 1.0,
    };
    let torus = Solid::Torus {
        centre: middle,
        axis: up,
        ring,
        tube,
    };
    let across = up.any_orthonormal_vector();
    let tilt = (up + across).normalize();
    let cases = [
        (&ball, middle + up * 0.6, up, 0.64 * PI),
        (&rod, middle + up * 0.3, up, PI),
        // An ellipse.
        (&rod, middle, tilt, PI * 2f64.sqrt()),
        // A rectangle.
        (&rod, middle + across * 0.5, across, 4.0 * 3f64.sqrt()),
        // Two discs; a ring, of which one side is also that of its widest part.
        (&torus, middle, across, 2.0 * PI * tube * tube),
        (&torus, middle + up * 0.3, up, 4.0 * PI * ring * 0.4),
    ];
    for (solid, point, normal, expected) in cases {
        let mesh = mesh_of(solid, tolerance);
        let found = cut(&mesh, &plane(point, normal)).area();
        // Facets lie inside, by less than the tolerance along an edge that is shorter than 25.
        let off = (found - expected).abs();
        assert!(off < 25.0 * tolerance, "{solid:?}: {found}, not {expected}");
    }
}

#[test]
fn both_sides_together_are_the_whole() {
    let solid = Solid::Torus {
        centre: DVec3::ZERO,
        axis: DVec3::new(0.1, 0.2, 1.0),
        ring: 2.0,
        tube: 0.7,
    };
    let mesh = mesh_of(&solid, 1e-2);
    let whole = mesh.volume();
    for k in 0..20 {
        let (sin, cos) = crate::math::sin_cos(0.7 * f64::from(k));
        let normal = DVec3::new(sin, cos, 0.3 - 0.03 * f64::from(k));
        let point = normal * (0.1 * f64::from(k) - 1.0);
        let [low, high] = [normal, -normal].map(|n| cut(&mesh, &plane(point, n)));
        let sum = low.volume() + high.volume();
        assert!((sum - whole).abs() < 1e-9, "{k}: {sum}, not {whole}");
        assert!((low.area() - high.area()).abs() < 1e-9, "{k}");
    }
}

#[test]
fn a_hollow_body_has_a_ring() {
    let outer = block(DVec3::ZERO, DVec3::splat(4.0));
    let inner = block(DVec3::ZERO, DVec3::splat(2.0));
    let ring = cut(&hollow(&outer, &inner), &plane(DVec3::ZERO, DVec3::Z));
    assert_eq!(ring.area(), 12.0);
    assert!((ring.volume() - 28.0).abs() < 100.0 * NEAR);
}

#[test]
fn overlapping_solids_have_one_face() {
    let at = plane(DVec3::ZERO, DVec3::Z);
    let border = |mesh: &Mesh| cut(mesh, &at).border;
    let mut both = border(&block(DVec3::ZERO, DVec3::splat(2.0)));
    // One across a corner, one inside, one with a common side.
    for (centre, size) in [
        (DVec3::new(1.0, 1.0, 0.0), 2.0),
        (DVec3::new(0.2, 0.3, 0.0), 0.5),
        (DVec3::new(-2.0, 0.0, 0.0), 2.0),
    ] {
        both.extend(border(&block(centre, DVec3::splat(size))));
    }
    assert!((area(&divide_region(&both, None)) - 11.0).abs() < NEAR);
}

#[test]
fn a_plane_beside_a_body_leaves_all_or_nothing() {
    let mesh = block(DVec3::ZERO, DVec3::splat(2.0));
    for (height, normal, expected) in [
        (1.0, DVec3::Z, CutMesh::Whole),
        (1.0, DVec3::NEG_Z, CutMesh::Nothing),
        (5.0, DVec3::Z, CutMesh::Whole),
        (-1.0, DVec3::Z, CutMesh::Nothing),
    ] {
        let at = plane(DVec3::Z * height, normal);
        assert_eq!(cut_mesh(&mesh, &at), expected, "{height} {normal}");
    }
    let none = cut_mesh(&Mesh::default(), &plane(DVec3::ZERO, DVec3::Z));
    assert_eq!(none, CutMesh::Whole);
}

#[test]
fn an_open_mesh_is_cut_without_fault() {
    let mut mesh = block(DVec3::ZERO, DVec3::splat(2.0));
    mesh.triangles.truncate(7);
    let CutMesh::Part(part) = cut_mesh(&mesh, &plane(DVec3::ZERO, DVec3::ONE)) else {
        panic!("not cut");
    };
    let flat = part.border.iter().map(|ends| ends.map(|p| p.truncate()));
    let flat: Vec<_> = flat.collect();
    assert!(area(&divide_region(&flat, None)).is_finite());
    let broken = [[DVec2::NAN, DVec2::ONE], [DVec2::ONE, DVec2::INFINITY]];
    assert!(divide_region(&broken, None).is_empty());
}

#[test]
fn stripes_cover_their_share() {
    let frame = frame_of(&plane(DVec3::ZERO, DVec3::Z)).turned(0.25 * PI);
    let mesh = block(DVec3::ZERO, DVec3::splat(2.0));
    let CutMesh::Part(part) = cut_mesh(&mesh, &plane(DVec3::ZERO, DVec3::Z)) else {
        panic!("not cut");
    };
    let border: Vec<_> = part
        .border
        .iter()
        .map(|ends| ends.map(|p| frame.flat(p)))
        .collect();
    let strips = Strips {
        pitch: 0.02,
        width: 0.005,
    };
    let parts = divide_region(&border, Some(strips));
    let (striped, plain): (Vec<_>, Vec<_>) = parts.into_iter().partition(|part| part.is_striped);
    let areas = [area(&striped), area(&plain)];
    assert!((areas[0] + areas[1] - 4.0).abs() < NEAR, "{areas:?}");
    assert!((areas[0] - 1.0).abs() < 0.01, "{areas:?}");
    // Too many stripes are none.
    let strips = Strips {
        pitch: 1e-9,
        width: 1e-10,
    };
    let parts = divide_region(&border, Some(strips));
    assert!(parts.iter().all(|part| !part.is_striped));
}
