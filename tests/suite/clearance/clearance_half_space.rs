//! Half-spaces against every other solid: depths and distances against closed forms and dense surface points.

use crate::driven::{check, even_times, knots, solve};
use crate::solids::element;
use glam::DVec3;
use mechanim::clearance::check::Judgement;
use mechanim::diag::Source;
use mechanim::distance::pair::{is_inside, signed_distance};
use mechanim::geometry::mesh_of;

use mechanim::math::Pose;
use mechanim::model::shape::{Solid, TriangleSoup};
use mechanim::scene::{Overrides, load_scene};
use std::sync::Arc;

fn solids() -> Vec<Solid> {
    let (from, to) = (DVec3::new(-1.0, 0.3, 0.2), DVec3::new(1.5, 0.1, -0.7));
    let cube = mesh_of(
        &Solid::Box {
            centre: DVec3::new(0.4, 0.0, 0.0),
            size: DVec3::new(1.0, 2.0, 0.5),
        },
        0.1,
    );
    vec![
        Solid::Sphere {
            centre: from,
            radius: 0.8,
        },
        Solid::Capsule {
            from,
            to,
            radius: 0.3,
        },
        Solid::Cylinder {
            from,
            to,
            radius: 0.6,
        },
        Solid::Cone {
            from,
            to,
            radius_from: 0.9,
            radius_to: 0.0,
        },
        Solid::Box {
            centre: to,
            size: DVec3::new(1.0, 0.4, 2.0),
        },
        Solid::Torus {
            centre: from,
            axis: DVec3::new(0.6, 0.0, 0.8),
            ring: 1.2,
            tube: 0.3,
        },
        Solid::Triangles(Arc::new(TriangleSoup {
            is_surface: false,
            source: "cube".to_owned(),
            vertices: cube.positions,
            triangles: cube.triangles,
        })),
    ]
}

fn pose(k: usize) -> Pose {
    let t = k as f64 * 0.377;
    let turn = Pose::from_axis_rotation(0, t) * Pose::from_axis_rotation(2, 1.7 * t);
    Pose::from_translation(DVec3::new(
        t.sin(),
        2.0 * (1.3 * t).cos(),
        1.9 * (0.7 * t).sin(),
    )) * turn
}

/// The facets of the drawn solid lie on the true surface, at most the tessellation's tolerance apart from it.
#[test]
fn distance_and_depth_are_those_of_the_lowest_point() {
    const TOLERANCE: f64 = 1e-4;
    let normal = DVec3::new(0.36, 0.48, 0.8);
    let point = DVec3::new(0.2, -0.1, 0.05);
    let half = element(Solid::HalfSpace {
        point,
        normal,
        size: 5.0,
    });
    let (mut outside, mut inside, mut cutting) = (0, 0, 0);
    for solid in solids() {
        let body = element(solid.clone());
        let mesh = mesh_of(&solid, TOLERANCE);
        for k in 0..200 {
            let placed = body.moved(&pose(k));
            let heights = mesh
                .positions
                .iter()
                .map(|p| normal.dot(pose(k).transform_point(*p) - point));
            let (low, high) = heights.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), d| {
                (l.min(d), h.max(d))
            });
            let found = signed_distance(&half, &placed);
            let off = low - found.distance;
            assert!(
                (-1e-12..2.0 * TOLERANCE).contains(&off),
                "{solid:?} {k}: {off:e}"
            );
            let swapped = signed_distance(&placed, &half);
            assert_eq!(swapped.distance, found.distance);
            assert_eq!(swapped.normal, -found.normal);
            let [on_plane, on_body] = found.points;
            assert!(normal.dot(on_plane - point).abs() < 1e-12);
            assert!((normal.dot(on_body - on_plane) - found.distance).abs() < 1e-12);
            if high.abs() > 2.0 * TOLERANCE {
                assert_eq!(is_inside(&placed, &half), high < 0.0, "{solid:?} {k}");
            }
            assert!(!is_inside(&half, &placed));
            outside += usize::from(low > 0.0);
            inside += usize::from(high < 0.0);
            cutting += usize::from(low < 0.0 && high > 0.0);
        }
    }
    assert!(
        outside > 100 && inside > 100 && cutting > 100,
        "{outside} {inside} {cutting}"
    );
}

#[test]
fn two_half_spaces_have_a_distance_only_where_they_face_each_other() {
    let half = |z: f64, normal: DVec3| {
        element(Solid::HalfSpace {
            point: DVec3::new(1.0, 2.0, z),
            normal,
            size: 1.0,
        })
    };
    let floor = half(0.0, DVec3::Z);
    assert_eq!(signed_distance(&floor, &half(3.0, -DVec3::Z)).distance, 3.0);
    assert_eq!(
        signed_distance(&floor, &half(-3.0, -DVec3::Z)).distance,
        -3.0
    );
    let tilted = half(9.0, DVec3::X);
    assert_eq!(signed_distance(&floor, &tilted).distance, f64::NEG_INFINITY);
    assert!(is_inside(&half(-1.0, DVec3::Z), &floor) && !is_inside(&half(1.0, DVec3::Z), &floor));
}

const PENDULUM: &str = r#"
title = "A pendulum over the ground"
units = { length = "mm", angle = "rad" }
duration = 3
[inputs]
a = "sin(2*t)"
b = 0
[[bodies]]
name = "pendulum"
frame = "Ry(a) Tx(1) Ry(b)"
shapes = [{ capsule = { from = [0, 0, 0], to = [0, 0, -100], radius = 4 } }]
[[bodies]]
name = "ground"
shapes = [{ half_space = { point = [0, 0, -105], size = 300 } }, { sphere = { center = [0, 0, 80], radius = 3 } }]
[clearance]
minimum = 0.5
"#;

#[test]
fn the_ground_is_kept_clear_over_the_motion() {
    let source = Source {
        name: "test".into(),
        text: PENDULUM.into(),
    };
    let scene = load_scene(&source, &Overrides::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let times = even_times(&scene, 30);
    let trajectory = solve(&scene, &knots(&scene, &times)).unwrap();
    let report = check(&scene, &trajectory, 1e-3);
    let pair = &report.judged[0];
    assert_eq!(pair.judgement, Judgement::Passed);
    // The end of the pendulum is lowest where tan a = -1/100, at the height -sqrt(100² + 1²) - 4.
    let exact = 101.0 - (100.0_f64 * 100.0 + 1.0).sqrt();
    let least = &pair.least;
    assert!((least.distance - exact).abs() < 1e-3, "{least:?}");
    assert!(
        least.is_certified && least.bound <= exact && least.bound > exact - 2e-3,
        "{least:?}"
    );
}
