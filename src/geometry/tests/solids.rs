//! Solids: volumes, genus, tolerance, ends, and what has no extent.

use super::*;

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
                centre: from,
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
                centre: from,
                axis,
                ring,
                tube,
            },
            2.0 * PI * PI * ring * tube * tube,
            Box::new(move |p| circle(p, ring) - tube),
        ),
        (
            Solid::Torus {
                centre: from,
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
            centre: DVec3::ONE,
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
fn solids_without_extent_give_no_triangles() {
    let nan = DVec3::NAN;
    for solid in [
        Solid::Sphere {
            centre: DVec3::ZERO,
            radius: 0.0,
        },
        Solid::Sphere {
            centre: nan,
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
            centre: DVec3::ZERO,
            size: DVec3::new(1.0, 0.0, 1.0),
        },
        Solid::Torus {
            centre: DVec3::ZERO,
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
                    centre: DVec3::ZERO,
                    radius: 1.0
                },
                tolerance
            )
            .is_closed()
        );
    }
}
