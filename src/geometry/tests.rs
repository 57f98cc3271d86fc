//! Invariants of every mesh: closed, of the right genus, facing outward, within the tolerance.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::mesh::closed_edges;
use super::round::segment_count;
use super::*;
use crate::model::shape::TriangleSoup;
use glam::DVec3;
use std::f64::consts::PI;
use std::sync::Arc;

fn volume(mesh: &Mesh) -> f64 {
    mesh.triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            a.dot(b.cross(c)) / 6.0
        })
        .sum()
}

fn euler(mesh: &Mesh) -> i64 {
    let [v, e, f] = closed_edges(mesh).expect("a closed mesh");
    v as i64 - e as i64 + f as i64
}

/// Every normal is a unit vector on the outer side of the facets that use it.
fn check_normals(mesh: &Mesh) {
    assert_eq!(mesh.positions.len(), mesh.normals.len());
    for normal in &mesh.normals {
        assert!((normal.length() - 1.0).abs() < 1e-12);
    }
    for t in &mesh.triangles {
        let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
        let facet = (b - a).cross(c - a);
        if facet.length() > 0.0 {
            for i in t {
                let cosine = facet.normalize().dot(mesh.normals[*i as usize]);
                assert!(cosine > 0.5, "{cosine} in {t:?}");
            }
        }
    }
}

/// Directions in all octants and along the axes: no orientation of a link may turn it inside out.
fn directions() -> Vec<DVec3> {
    let mut all = vec![DVec3::new(1.0, 1e-12, 0.0)];
    for x in [-1.0, 0.0, 1.0] {
        for y in [-1.0, 0.0, 1.0] {
            for z in [-1.0, 0.0, 1.0] {
                let direction = DVec3::new(x, y * 1.3, z * 0.7);
                if direction != DVec3::ZERO {
                    all.push(direction * 2.0);
                }
            }
        }
    }
    all
}

/// A solid, its volume and the distance of a point from its surface.
type Case = (Solid, f64, Box<dyn Fn(DVec3) -> f64>);

fn segment_distance(p: DVec3, a: DVec3, b: DVec3) -> f64 {
    let t = ((p - a).dot(b - a) / (b - a).length_squared()).clamp(0.0, 1.0);
    p.distance(a + (b - a) * t)
}

fn round_cases(direction: DVec3) -> Vec<Case> {
    let (from, radius) = (DVec3::new(0.3, -0.2, 0.9), 0.35);
    let to = from + direction;
    let h = direction.length();
    let axis = direction.normalize();
    let (ring, tube) = (1.2_f64, 0.4_f64);
    let circle = move |p: DVec3, ring: f64| {
        let q = p - from;
        let up = q.dot(axis);
        ((q - axis * up).length() - ring).hypot(up)
    };
    let spindle = 0.25_f64;
    let reach = (-spindle / tube).acos();
    // Pappus over the part of the section beyond the axis, by integrating x² dz / 2 along its outline.
    let spindle_volume = {
        let steps = 20_000;
        let at = |k: usize| reach * (2.0 * k as f64 / steps as f64 - 1.0);
        (0..steps)
            .map(|k| {
                let x = spindle + tube * (0.5 * (at(k) + at(k + 1))).cos();
                PI * x * x * tube * (at(k + 1).sin() - at(k).sin())
            })
            .sum()
    };
    vec![
        (
            Solid::Sphere {
                center: from,
                radius,
            },
            4.0 / 3.0 * PI * radius.powi(3),
            Box::new(move |p| p.distance(from) - radius),
        ),
        (
            Solid::Capsule { from, to, radius },
            PI * radius * radius * (h + 4.0 / 3.0 * radius),
            Box::new(move |p| segment_distance(p, from, to) - radius),
        ),
        (
            Solid::Torus {
                center: from,
                axis,
                ring,
                tube,
            },
            2.0 * PI * PI * ring * tube * tube,
            Box::new(move |p| circle(p, ring) - tube),
        ),
        (
            Solid::Torus {
                center: from,
                axis,
                ring: spindle,
                tube,
            },
            spindle_volume,
            Box::new(move |p| circle(p, spindle) - tube),
        ),
        (
            Solid::Tube {
                points: vec![from, to],
                radius,
                closed: false,
            },
            PI * radius * radius * (h + 4.0 / 3.0 * radius),
            Box::new(move |p| segment_distance(p, from, to) - radius),
        ),
    ]
}

#[test]
fn round_solids_keep_the_tolerance_and_their_volume() {
    for direction in directions() {
        for (solid, exact, distance) in round_cases(direction) {
            let mut before = f64::INFINITY;
            for tolerance in [1e-2, 1e-3] {
                let mesh = mesh_of(&solid, tolerance);
                check_normals(&mesh);
                for t in &mesh.triangles {
                    let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
                    for p in [
                        a,
                        b,
                        c,
                        (a + b) / 2.0,
                        (b + c) / 2.0,
                        (c + a) / 2.0,
                        (a + b + c) / 3.0,
                    ] {
                        let off = distance(p);
                        // Where a torus is saddle-shaped its chords run outside.
                        assert!(off.abs() < tolerance, "{off} {solid:?}");
                    }
                }
                let error = (volume(&mesh) - exact).abs() / exact;
                assert!(error < before / 4.0, "{error} after {before} of {solid:?}");
                before = error;
            }
            assert!(before < 1e-2, "{before} {solid:?}");
        }
    }
}

#[test]
fn solids_are_closed_and_of_the_right_genus() {
    for direction in directions() {
        for (solid, _, _) in round_cases(direction) {
            let handle = matches!(solid, Solid::Torus { ring, tube, .. } if ring > tube);
            let mesh = mesh_of(&solid, 1e-2);
            assert_eq!(euler(&mesh), if handle { 0 } else { 2 }, "{solid:?}");
        }
    }
}

#[test]
fn sharp_solids_have_flat_ends_and_exact_volumes() {
    for direction in directions() {
        let (from, to) = (DVec3::ONE, DVec3::ONE + direction);
        for [first, second] in [[0.5, 0.5], [0.5, 0.2], [0.2, 0.5], [0.5, 0.0], [0.0, 0.5]] {
            let solid = Solid::Cone {
                from,
                to,
                radius_from: first,
                radius_to: second,
            };
            let mesh = mesh_of(&solid, 1e-4);
            assert_eq!(euler(&mesh), 2);
            check_normals(&mesh);
            let n = f64::from(segment_count(0.5, 1e-4));
            // The inscribed polygon's area over the circle's.
            let polygon = n / (2.0 * PI) * (2.0 * PI / n).sin();
            let exact =
                PI / 3.0 * direction.length() * (first * first + first * second + second * second);
            assert!((volume(&mesh) / (exact * polygon) - 1.0).abs() < 1e-7);
            let flat = mesh
                .normals
                .iter()
                .filter(|n| n.dot(direction.normalize()).abs() > 1.0 - 1e-12);
            let ends = f64::from(u8::from(first > 0.0)) + f64::from(u8::from(second > 0.0));
            assert_eq!(flat.count() as f64, ends * n);
        }
    }
    let size = DVec3::new(1.0, 2.0, 3.0);
    let cuboid = mesh_of(
        &Solid::Box {
            center: DVec3::ONE,
            size,
        },
        0.1,
    );
    assert_eq!((cuboid.positions.len(), cuboid.triangles.len()), (24, 12));
    assert_eq!(euler(&cuboid), 2);
    check_normals(&cuboid);
    assert!((volume(&cuboid) - 6.0).abs() < 1e-14);
    assert_eq!(
        cuboid.bounds(),
        Some([DVec3::new(0.5, 0.0, -0.5), DVec3::new(1.5, 2.0, 2.5)])
    );
}

#[test]
fn tubes_have_no_pinch_at_any_corner() {
    let corner = |angle: f64| DVec3::new(angle.cos(), angle.sin(), 0.0) * 2.0;
    for angle in [0.0, 0.05, 0.5, 1.5, 2.5, 3.1, PI] {
        let points = vec![DVec3::X * -2.0, DVec3::ZERO, DVec3::ZERO, corner(angle)];
        let solid = Solid::Tube {
            points: points.clone(),
            radius: 0.3,
            closed: false,
        };
        let mesh = mesh_of(&solid, 1e-3);
        assert_eq!(euler(&mesh), 2);
        for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
            let nearest = segment_distance(*position, points[0], points[1])
                .min(segment_distance(*position, points[1], points[3]));
            assert!(nearest < 0.3 + 1e-9);
            assert!((normal.length() - 1.0).abs() < 1e-12);
        }
        // The outside of the corner lies on the ball around it.
        let outside = (DVec3::X - corner(angle).normalize()).normalize_or(DVec3::NEG_Y);
        let reach = mesh
            .positions
            .iter()
            .map(|p| p.dot(outside))
            .fold(f64::MIN, f64::max);
        let ends = points
            .iter()
            .map(|p| p.dot(outside))
            .fold(f64::MIN, f64::max);
        assert!((reach - ends - 0.3).abs() < 2e-3, "{angle}: {reach}");
    }
}

/// The space of a bent tube is counted once: two legs up to the plane that halves the corner, a wedge of a ball outside,
/// and round ends. No two of its triangles have no area.
#[test]
fn bent_tubes_do_not_pass_through_themselves() {
    let r = 0.3;
    for angle in [0.7, 0.5 * PI, 2.2] {
        let end = DVec3::X * 2.0 + DVec3::new(angle.cos(), angle.sin(), 0.0) * 2.0;
        let solid = Solid::Tube {
            points: vec![DVec3::ZERO, DVec3::X * 2.0, end],
            radius: r,
            closed: false,
        };
        let mesh = mesh_of(&solid, 1e-4);
        assert_eq!(euler(&mesh), 2);
        let ball = 4.0 / 3.0 * PI * r.powi(3);
        let cut = 4.0 / 3.0 * r.powi(3) * (0.5 * angle).tan();
        let exact = PI * r * r * 4.0 + ball * (1.0 + angle / (2.0 * PI)) - cut;
        assert!((volume(&mesh) / exact - 1.0).abs() < 2e-3, "{angle}");
        for [a, b, c] in &mesh.triangles {
            let [a, b, c] = [a, b, c].map(|i| mesh.positions[*i as usize]);
            assert!((b - a).cross(c - a).length() > 1e-12, "{a} {b} {c}");
        }
    }
}

#[test]
fn closed_tubes_meet_without_twist() {
    // A closed space curve with torsion, so that the carried frame comes back turned.
    let points: Vec<DVec3> = (0..90)
        .map(|k| {
            let t = 2.0 * PI * f64::from(k) / 90.0;
            DVec3::new(2.0 * t.cos(), 2.0 * t.sin(), 0.8 * (2.0 * t).sin())
        })
        .collect();
    let mesh = mesh_of(
        &Solid::Tube {
            points: points.clone(),
            radius: 0.2,
            closed: true,
        },
        1e-2,
    );
    assert_eq!(euler(&mesh), 0);
    check_normals(&mesh);
    let length: f64 = (0..90)
        .map(|k| points[k].distance(points[(k + 1) % 90]))
        .sum();
    let n = f64::from(segment_count(0.2, 0.5e-2));
    let exact = length * 0.04 * 0.5 * n * (2.0 * PI / n).sin();
    assert!((volume(&mesh) / exact - 1.0).abs() < 0.01);
    let square = [
        DVec3::ZERO,
        DVec3::X,
        DVec3::new(1.0, 1.0, 0.0),
        DVec3::Y,
        DVec3::ZERO,
    ];
    let mesh = mesh_of(
        &Solid::Tube {
            points: square.to_vec(),
            radius: 0.1,
            closed: true,
        },
        1e-2,
    );
    assert_eq!(euler(&mesh), 0);
}

#[test]
fn every_prefix_of_a_trace_is_closed() {
    let at = |x: f64, y: f64| Some(DVec3::new(x, y, 0.1 * x * y));
    let points = [
        at(0.0, 0.0),
        at(1.0, 0.0),
        at(1.0, 1.0),
        at(1.0, 1.0),
        None,
        at(3.0, 0.0),
        at(4.0, 0.0),
        at(3.5, 0.0),
        Some(DVec3::NAN),
        at(5.0, 5.0),
    ];
    let trace = trace_mesh(&points, 0.05, 6);
    let per_step = trace.triangles_per_step as usize;
    assert_eq!(trace.mesh.triangles.len(), per_step * (points.len() - 1));
    for step in 1..points.len() {
        let mut part = trace.mesh.clone();
        part.triangles.truncate(step * per_step);
        assert!(part.is_closed(), "{step}");
    }
    let straight: Vec<_> = (0..5).map(|k| at(f64::from(k), 0.0)).collect();
    check_normals_of_sides(&trace_mesh(&straight, 0.05, 8).mesh);
    assert!(trace_mesh(&[], 1.0, 6).mesh.triangles.is_empty());
}

fn check_normals_of_sides(mesh: &Mesh) {
    for (position, normal) in mesh.positions.iter().zip(&mesh.normals) {
        assert!(normal.dot(*position - DVec3::X * position.x) >= 0.0);
    }
    assert!(volume(mesh) > 0.0);
}

#[test]
fn bare_triangles_get_smooth_and_sharp_normals() {
    let ball = mesh_of(
        &Solid::Sphere {
            center: DVec3::ZERO,
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
fn solids_without_extent_give_no_triangles() {
    let nan = DVec3::NAN;
    for solid in [
        Solid::Sphere {
            center: DVec3::ZERO,
            radius: 0.0,
        },
        Solid::Sphere {
            center: nan,
            radius: 1.0,
        },
        Solid::Capsule {
            from: DVec3::ZERO,
            to: DVec3::X,
            radius: f64::NAN,
        },
        Solid::Cylinder {
            from: DVec3::ZERO,
            to: DVec3::ZERO,
            radius: 1.0,
        },
        Solid::Box {
            center: DVec3::ZERO,
            size: DVec3::new(1.0, 0.0, 1.0),
        },
        Solid::Torus {
            center: DVec3::ZERO,
            axis: DVec3::Z,
            ring: 1.0,
            tube: 0.0,
        },
        Solid::Tube {
            points: vec![],
            radius: 1.0,
            closed: true,
        },
    ] {
        assert!(mesh_of(&solid, 0.01).triangles.is_empty(), "{solid:?}");
    }
    let tolerances = [0.0, -1.0, f64::NAN, 1e-300, 1e300];
    for tolerance in tolerances {
        assert!(
            mesh_of(
                &Solid::Sphere {
                    center: DVec3::ZERO,
                    radius: 1.0
                },
                tolerance
            )
            .is_closed()
        );
    }
}

#[test]
fn back_faces_are_hidden_only_by_a_whole_mesh_the_right_way_out() {
    let whole = mesh_of(
        &Solid::Box {
            center: DVec3::ONE,
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
