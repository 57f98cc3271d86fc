//! Tubes and traces: corners, bends, closed curves, prefixes.

use super::*;

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
