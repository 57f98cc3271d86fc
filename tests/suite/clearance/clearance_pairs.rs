//! Signed distances of pairs of solids: cases known in closed form, random pairs against the separating plane, and
//! what no pair may depend on. The slow reference is in `clearance_reference.rs`.

use crate::solids::{
    BOX_TRIANGLES, Random, box_corner, capsule, cone, cuboid, cylinder, element, sphere, torus, v,
};
use glam::{DMat3, DQuat, DVec3};
use mechanim::distance::mesh::one_inside;
use mechanim::distance::mesh_tree::{MeshTree, ShellEnclosure};
use mechanim::distance::pair::{is_inside, signed_distance};
use mechanim::distance::primitive::{Element, Primitive};
use mechanim::math::Pose;
use mechanim::model::shape::{Solid, TriangleSoup};
use std::sync::Arc;

fn turned(e: &Element, axis: DVec3, angle: f64) -> Element {
    e.moved(&Pose {
        rotation: DMat3::from_quat(DQuat::from_axis_angle(axis.normalize(), angle)),
        translation: DVec3::ZERO,
    })
}

/// The known signed distance, to 1e-12 of the largest length.
#[test]
fn known_pairs() {
    let z = DVec3::Z;
    let o = DVec3::ZERO;
    let rod = |r: f64| capsule(v(-5.0, 0.0, 0.0), v(5.0, 0.0, 0.0), r);
    let ring = torus(o, z, 10.0, 1.0);
    let unit = cuboid(o, DVec3::splat(2.0));
    let can = cylinder(v(0.0, 0.0, -2.0), v(0.0, 0.0, 2.0), 1.0);
    let diagonal = turned(&unit, z, std::f64::consts::FRAC_PI_4);
    let cases: Vec<(&str, Element, Element, f64)> = vec![
        (
            "spheres apart",
            sphere(o, 1.0),
            sphere(v(3.0, 4.0, 0.0), 1.5),
            2.5,
        ),
        (
            "spheres overlap",
            sphere(o, 3.0),
            sphere(v(3.0, 4.0, 0.0), 3.0),
            -1.0,
        ),
        ("spheres concentric", sphere(o, 3.0), sphere(o, 1.0), -4.0),
        (
            "capsules parallel",
            rod(1.0),
            capsule(v(-3.0, 4.0, 0.0), v(9.0, 4.0, 0.0), 1.0),
            2.0,
        ),
        (
            "capsules in line",
            rod(1.0),
            capsule(v(9.0, 0.0, 0.0), v(12.0, 0.0, 0.0), 1.0),
            2.0,
        ),
        (
            "capsules crossed",
            rod(1.0),
            capsule(v(1.0, -5.0, 3.0), v(1.0, 5.0, 3.0), 1.0),
            1.0,
        ),
        (
            "capsules touching",
            rod(1.0),
            capsule(v(1.0, -5.0, 2.0), v(1.0, 5.0, 2.0), 1.0),
            0.0,
        ),
        (
            "capsules in each other",
            rod(2.0),
            capsule(v(1.0, -5.0, 3.0), v(1.0, 5.0, 3.0), 2.0),
            -1.0,
        ),
        (
            "capsule in capsule",
            rod(3.0),
            capsule(v(-1.0, 0.0, 0.0), v(1.0, 0.0, 0.0), 1.0),
            -4.0,
        ),
        (
            "sphere in tube",
            ring.clone(),
            sphere(v(10.0, 0.0, 0.2), 0.3),
            -1.1,
        ),
        ("sphere in the hole", ring.clone(), sphere(o, 2.0), 7.0),
        (
            "tori coaxial",
            ring.clone(),
            torus(v(0.0, 0.0, 3.0), z, 14.0, 1.0),
            3.0,
        ),
        ("tori concentric", ring.clone(), torus(o, z, 6.0, 1.0), 2.0),
        (
            "tori equal circles",
            ring.clone(),
            torus(o, z, 10.0, 0.5),
            -1.5,
        ),
        (
            "tori coplanar apart",
            ring.clone(),
            torus(v(25.0, 0.0, 0.0), z, 10.0, 1.0),
            3.0,
        ),
        (
            "tori coplanar inside",
            ring.clone(),
            torus(v(3.0, 0.0, 0.0), z, 4.0, 1.0),
            1.0,
        ),
        (
            "tori coplanar crossing",
            ring.clone(),
            torus(v(5.0, 0.0, 0.0), z, 10.0, 1.0),
            -2.0,
        ),
        (
            "tori linked",
            ring.clone(),
            torus(v(10.0, 0.0, 0.0), DVec3::Y, 10.0, 1.0),
            8.0,
        ),
        (
            "torus through torus",
            ring.clone(),
            torus(v(0.0, 0.0, 4.0), DVec3::Y, 10.0, 1.0),
            // The circle |(x, z-4)| = 10 passes nearest to |(x, y)| = 10 beside z = 0.
            known_crossing(),
        ),
        (
            "rod through torus",
            ring.clone(),
            capsule(v(0.0, 0.0, -20.0), v(0.0, 0.0, 20.0), 1.0),
            8.0,
        ),
        (
            "rod at torus",
            ring.clone(),
            capsule(v(-20.0, 14.0, 0.0), v(20.0, 14.0, 0.0), 1.0),
            2.0,
        ),
        ("rod crosses torus", ring.clone(), rod_through_tube(), -2.0),
        (
            "boxes apart",
            unit.clone(),
            cuboid(v(4.0, 0.5, 0.3), DVec3::splat(2.0)),
            2.0,
        ),
        (
            "boxes corner to corner",
            unit.clone(),
            cuboid(v(5.0, 6.0, 4.0), DVec3::splat(2.0)),
            (9.0_f64 + 16.0 + 4.0).sqrt(),
        ),
        (
            "boxes overlap",
            unit.clone(),
            cuboid(v(1.5, 0.2, 0.1), DVec3::splat(2.0)),
            -0.5,
        ),
        (
            "box in box",
            unit.clone(),
            cuboid(v(0.3, 0.0, 0.0), DVec3::splat(0.2)),
            -0.8,
        ),
        (
            "box edge at cylinder",
            cylinder(v(4.0, -3.0, 0.0), v(4.0, 3.0, 0.0), 1.0),
            turned(&unit, DVec3::Y, std::f64::consts::FRAC_PI_4),
            3.0 - 2f64.sqrt(),
        ),
        (
            "box edge across cylinder",
            cylinder(v(4.0, -3.0, 0.0), v(4.0, 3.0, 0.0), 1.0),
            diagonal.clone(),
            3.0 - 2f64.sqrt(),
        ),
        (
            "drill through plate",
            cuboid(o, v(20.0, 20.0, 1.0)),
            cylinder(v(0.0, 0.0, -9.0), v(0.0, 0.0, 9.0), 0.5),
            -9.5,
        ),
        (
            "cylinders end to end",
            can.clone(),
            cylinder(v(0.5, 0.0, 3.0), v(0.5, 0.0, 5.0), 1.0),
            1.0,
        ),
        (
            "cylinders side by side",
            can.clone(),
            cylinder(v(5.0, 0.0, -1.0), v(5.0, 0.0, 9.0), 1.0),
            3.0,
        ),
        (
            "cylinders crossed",
            can.clone(),
            cylinder(v(4.0, -9.0, 0.3), v(4.0, 9.0, 0.3), 1.0),
            2.0,
        ),
        (
            "cylinders crossed, overlap",
            can.clone(),
            cylinder(v(1.5, -9.0, 0.3), v(1.5, 9.0, 0.3), 1.0),
            -0.5,
        ),
        (
            "cylinders rim to rim",
            can.clone(),
            cylinder(v(5.0, 0.0, 5.0), v(5.0, 0.0, 8.0), 1.0),
            (9.0_f64 + 9.0).sqrt(),
        ),
        (
            "pin in a thicker cylinder",
            can.clone(),
            cylinder(v(0.0, 0.0, -0.5), v(0.0, 0.0, 0.5), 0.25),
            -1.25,
        ),
        (
            "capsule over a cylinder's end",
            can.clone(),
            capsule(v(-4.0, 0.0, 4.0), v(4.0, 0.0, 4.0), 0.5),
            1.5,
        ),
        (
            "sphere in a box",
            unit.clone(),
            sphere(v(0.5, 0.0, 0.0), 0.2),
            -0.7,
        ),
        (
            "cone tip to sphere",
            cone(o, v(0.0, 0.0, 4.0), 2.0, 0.0),
            sphere(v(0.0, 0.0, 7.0), 1.0),
            2.0,
        ),
        (
            "torus over a cylinder's end",
            torus(v(0.0, 0.0, 4.0), z, 0.5, 0.5),
            can.clone(),
            1.5,
        ),
        ("torus around a cylinder", ring.clone(), can.clone(), 8.0),
        (
            "torus beside a box",
            ring.clone(),
            cuboid(v(15.0, 0.0, 0.0), v(4.0, 40.0, 4.0)),
            2.0,
        ),
    ];
    for (name, a, b, known) in cases {
        for (first, second) in [(&a, &b), (&b, &a)] {
            let found = signed_distance(first, second);
            let error = (found.distance - known).abs();
            assert!(error < 1e-11, "{name}: {} for {known}", found.distance);
            if known > 0.0 {
                let apart = found.points[0].distance(found.points[1]);
                assert!(
                    (apart - known).abs() < 1e-11,
                    "{name}: points {apart} apart"
                );
            }
        }
    }
}

/// By one-dimensional bisection, independent of the searched routine: points (x, 0, 4 + w) of the second circle.
fn known_crossing() -> f64 {
    let mut least = f64::INFINITY;
    let (mut low, mut high) = (-std::f64::consts::PI, 0.0);
    for _ in 0..200 {
        let f = |angle: f64| {
            let (s, c) = angle.sin_cos();
            ((10.0 * c).abs() - 10.0).hypot(4.0 + 10.0 * s)
        };
        let (a, b) = (low + (high - low) / 3.0, high - (high - low) / 3.0);
        if low < -1.6 {
            low = -std::f64::consts::FRAC_PI_2;
        } else if f(a) < f(b) {
            high = b;
        } else {
            low = a;
        }
        least = f(0.5 * (low + high)).min(least);
    }
    least - 2.0
}

fn rod_through_tube() -> Element {
    capsule(v(10.0, 0.0, -5.0), v(10.0, 0.0, 5.0), 1.0)
}

#[test]
fn what_lies_inside() {
    let ring = torus(DVec3::ZERO, DVec3::Z, 10.0, 1.0);
    let can = cylinder(v(0.0, 0.0, -2.0), v(0.0, 0.0, 2.0), 1.0);
    for (a, b, inside) in [
        (sphere(v(10.0, 0.0, 0.2), 0.3), ring.clone(), true),
        (sphere(v(10.0, 0.0, 0.8), 0.3), ring.clone(), false),
        (sphere(DVec3::ZERO, 2.0), ring.clone(), false),
        (torus(DVec3::ZERO, DVec3::Z, 10.2, 0.5), ring.clone(), true),
        (torus(DVec3::ZERO, DVec3::Z, 10.6, 0.5), ring.clone(), false),
        (
            capsule(v(10.0, -0.5, 0.0), v(10.0, 0.5, 0.0), 0.5),
            ring.clone(),
            true,
        ),
        (
            capsule(v(10.0, -5.0, 0.0), v(10.0, 5.0, 0.0), 0.5),
            ring,
            false,
        ),
        (
            cylinder(v(0.0, 0.0, -1.0), v(0.0, 0.0, 1.0), 0.5),
            can.clone(),
            true,
        ),
        (
            cylinder(v(0.0, 0.0, -1.0), v(0.0, 0.0, 3.0), 0.5),
            can.clone(),
            false,
        ),
        (cuboid(DVec3::ZERO, DVec3::splat(1.2)), can, true),
    ] {
        assert_eq!(is_inside(&a, &b), inside, "{a:?} in {b:?}");
    }
}

/// Of two convex elements that are apart, the points prove that the distance is not too large, and the plane between
/// them that it is not too small.
#[test]
fn planes_prove_the_distances_of_convex_pairs() {
    let mut random = Random(1);
    let mut apart = 0;
    for k in 0..60_000 {
        let a = random.solid(k % 5);
        let b = random.solid((k / 5) % 5).moved(&random.pose(4.0));
        let found = signed_distance(&a, &b);
        let n = found.normal;
        let gap = -a.core.support(n).unwrap() - b.core.support(-n).unwrap() - a.radius - b.radius;
        // An overlap's depth is a translation that parts the pair; a distance is a gap that is there.
        assert!(
            (gap - found.distance).abs() < 1e-7,
            "{k}: {gap} {found:?}\n{a:?}\n{b:?}"
        );
        if found.distance > 0.0 {
            apart += 1;
            let points = found.points[0].distance(found.points[1]);
            assert!(
                (points - found.distance).abs() < 1e-12 * (1.0 + points),
                "{k}"
            );
        }
    }
    assert!(apart > 10_000, "{apart}");
}

#[test]
fn nothing_depends_on_the_frame_or_the_unit() {
    let mut random = Random(3);
    for k in 0..6_000 {
        let (a, b) = (random.solid(k % 6), random.solid((k / 6) % 6));
        let there = random.pose(3.0);
        let b = b.moved(&random.pose(4.0));
        let here = signed_distance(&a, &b).distance;
        let moved = signed_distance(&a.moved(&there), &b.moved(&there)).distance;
        let tolerance = 1e-11;
        assert!((moved - here).abs() < tolerance, "{k}: {moved} {here}");
        for scale in [1e-9, 1e6] {
            let scaled = signed_distance(&scaled(&a, scale), &scaled(&b, scale)).distance / scale;
            assert!((scaled - here).abs() < tolerance, "{k}: {scaled} {here}");
        }
    }
}

fn scaled(e: &Element, by: f64) -> Element {
    let mut e = e.clone();
    e.radius *= by;
    match &mut e.core {
        Primitive::Point(p) => *p *= by,
        Primitive::Segment(ends) => ends.iter_mut().for_each(|p| *p *= by),
        Primitive::Triangle(corners) => corners.iter_mut().for_each(|p| *p *= by),
        Primitive::Circle(c) => (c.centre, c.radius) = (c.centre * by, c.radius * by),
        Primitive::Box(b) => {
            b.from_box.translation *= by;
            b.half *= by;
        }
        Primitive::Frustum(f) => {
            f.from *= by;
            f.length *= by;
            f.radii = f.radii.map(|r| r * by);
        }
        Primitive::HalfSpace(half) => half.point *= by,
        Primitive::Mesh(..) => panic!("not here"),
    }
    e
}

/// A cube of twelve triangles, its corners counted by bits.
fn cube(half: f64, inside_out: bool) -> TriangleSoup {
    let corner = |k: usize| half * box_corner(k);
    let mut triangles = BOX_TRIANGLES.map(|t| t.map(|k| k as u32)).to_vec();
    if inside_out {
        triangles.iter_mut().for_each(|t| t.swap(0, 1));
    }
    TriangleSoup {
        is_surface: false,
        source: "cube".to_owned(),
        vertices: (0..8).map(corner).collect(),
        triangles,
    }
}

#[test]
fn meshes_have_distances_but_no_depth() {
    let mesh = element(Solid::Triangles(Arc::new(cube(1.0, false))));
    let solid = cuboid(DVec3::ZERO, DVec3::splat(2.0));
    let mut random = Random(5);
    let mut apart = 0;
    for k in 0..1_500 {
        let there = random.pose(3.0);
        let other = random.solid(k % 6).moved(&random.pose(3.0));
        let (a, b) = (mesh.moved(&there), solid.moved(&there));
        let (found, known) = (signed_distance(&a, &other), signed_distance(&b, &other));
        if known.distance > 0.0 {
            apart += 1;
            assert!(
                (found.distance - known.distance).abs() < 1e-11,
                "{k}: {found:?} {known:?}"
            );
        } else {
            let inside = one_inside(&a.core, &other.core);
            assert!(
                found.distance == 0.0 || inside,
                "{k}: {found:?} {known:?}\n{b:?}\n{other:?}"
            );
        }
        let second = solid.moved(&random.pose(3.0));
        let second_mesh = element(Solid::Triangles(Arc::new(cube(1.0, true))));
        let Primitive::Box(block) = &second.core else {
            continue;
        };
        let placed = second_mesh.moved(&block.from_box);
        let (found, known) = (
            signed_distance(&a, &placed).distance,
            signed_distance(&b, &second).distance,
        );
        assert!(
            (found - known.max(0.0)).abs() < 1e-11 || one_inside(&a.core, &placed.core),
            "{k}"
        );
    }
    assert!(apart > 300);
    assert_eq!(
        MeshTree::new(&cube(1.0, false)).enclosure,
        ShellEnclosure::Solid
    );
    assert_eq!(
        MeshTree::new(&cube(1.0, true)).enclosure,
        ShellEnclosure::InsideOut
    );
    let mut open = cube(1.0, false);
    open.triangles.pop();
    assert_eq!(MeshTree::new(&open).enclosure, ShellEnclosure::Open);
}

/// A small ring at a large one: the least of the distances of many points of both circles.
#[test]
fn a_small_ring_at_a_large_one_is_measured_along_the_small_one() {
    let mut random = Random(77);
    for _ in 0..300 {
        let ring = 10f64.powf(random.range(-3.0, -1.0));
        let (angle, axis) = (
            random.range(0.0, 6.2),
            v(0.0, 0.0, 1.0) + random.vector(0.6),
        );
        let centre = v(angle.cos(), angle.sin(), 0.0) + random.vector(ring);
        let (large, small) = (
            torus(DVec3::ZERO, DVec3::Z, 1.0, 1e-5),
            torus(centre, axis, ring, 1e-5),
        );
        let [x, y] = {
            let axis = axis.normalize();
            let x = axis.any_orthonormal_vector();
            [x, axis.cross(x)]
        };
        let at = |k: usize| {
            let angle = std::f64::consts::TAU * k as f64 / 40_000.0;
            let p = centre + (x * angle.cos() + y * angle.sin()) * ring;
            (p.x.hypot(p.y) - 1.0).hypot(p.z)
        };
        let dense = (0..40_000).map(at).fold(f64::INFINITY, f64::min) - 2e-5;
        for found in [
            signed_distance(&large, &small),
            signed_distance(&small, &large),
        ] {
            let off = found.distance - dense;
            assert!(
                off <= 1e-12 && off > -2e-4 * ring,
                "{ring}: {} {dense}",
                found.distance
            );
        }
    }
}
