//! Solved poses against closed forms and independent high-precision references.
//!
//! `data/*.csv` were computed in 40-digit arithmetic from the closed forms of the mechanisms.
// References keep the digits they were given with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, solve};
use mechanim::kinematics::results::trajectory::{ClosedPose, Trajectory};
use mechanim::kinematics::solve::pose_check::{ClosureGap, LoopVerdict, judge_pose};

use crate::reference::{Table, drive_by_rows};
use mechanim::model::mechanism::Mechanism;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use std::f64::consts::{PI, TAU};

fn scene_with(name: &str, change: impl FnOnce(&mut Overrides)) -> Scene {
    let mut overrides = Overrides::default();
    change(&mut overrides);
    let source = builtin::find_builtin(name).unwrap();
    load_scene(&source, &overrides).unwrap_or_else(|e| panic!("{name}: {:#?}", e.diagnostics))
}

fn scene(name: &str) -> Scene {
    scene_with(name, |_| {})
}

fn pairs(list: &[(&str, &str)]) -> Vec<(String, String)> {
    list.iter()
        .map(|(name, value)| (name.to_string(), value.to_string()))
        .collect()
}

fn unknown(mechanism: &Mechanism, pose: &ClosedPose, name: &str) -> f64 {
    let index = mechanism
        .unknowns
        .iter()
        .position(|c| c.name == name)
        .unwrap();
    pose.unknowns[index]
}

fn poses(trajectory: &Trajectory) -> Vec<&ClosedPose> {
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    trajectory.poses().collect()
}

#[test]
fn gearshift_coordinates_match_the_reference_at_all_30_poses() {
    for (name, file) in [
        ("gearshift", "gearshift_orig_30"),
        ("gearshift-optimised", "gearshift_opt_30"),
    ] {
        let table = Table::read(file);
        let mut scene = Model::from(scene(name));
        assert_eq!(scene.actuation.guess, vec![0.0; 18], "start values of zero");
        let times = drive_by_rows(&mut scene, &table);
        let trajectory = solve(&scene, &times).unwrap();
        for (row, pose) in poses(&trajectory).into_iter().enumerate() {
            for k in 1..=18 {
                let name = format!("a{k}");
                let error = unknown(&scene.mechanism, pose, &name) - table.value(row, &name);
                assert!(error.abs() < 1e-10, "{file} row {row} {name}: {error:e}");
            }
            for (axis, name) in ["xM", "yM", "zM"].into_iter().enumerate() {
                let error = pose.traces[0][axis] - table.value(row, name);
                assert!(error.abs() < 1e-10, "{file} row {row} {name}: {error:e}");
            }
            assert!(pose.closure_error <= 1e-12);
            assert_eq!(pose.rank, 18);
        }
    }
}

#[test]
fn gearshift_is_solved_in_blocks_with_18_equations() {
    let system = scene("gearshift").system().unwrap();
    let sizes: Vec<(usize, usize)> = system
        .blocks()
        .iter()
        .map(|b| (b.rows(), b.unknowns.len()))
        .collect();
    assert_eq!(sizes, [(6, 6), (12, 12)]);
    assert!(system.structure().empty_equations.is_empty());
}

#[test]
fn optimised_scene_differs_from_the_original_in_two_dimensions_only() {
    let (a, b) = (
        Model::from(scene("gearshift")),
        Model::from(scene("gearshift-optimised")),
    );
    let dimensions = Table::read("gearshift_dims");
    assert_eq!(a.actuation.drives, b.actuation.drives);
    let source = |name: &str| builtin::find_builtin(name).unwrap().text;
    let differing = source("gearshift")
        .lines()
        .zip(source("gearshift-optimised").lines())
        .filter(|(x, y)| x != y)
        .count();
    assert_eq!(differing, 4, "title, description and two parameters");
    for (scene, column) in [
        ("gearshift", "original"),
        ("gearshift-optimised", "optimised"),
    ] {
        let text = source(scene);
        for row in 0..dimensions.len() {
            let name = dimensions.text(row, "name");
            let line = text
                .lines()
                .find(|l| l.split('=').next().is_some_and(|n| n.trim() == name))
                .unwrap();
            let value: f64 = line
                .split('=')
                .nth(1)
                .unwrap()
                .split('#')
                .next()
                .unwrap()
                .trim()
                .parse()
                .unwrap();
            assert_eq!(value, dimensions.value(row, column), "{scene} {name}");
        }
    }
}

#[test]
fn slider_crank_cycle_is_exact_on_both_assemblies() {
    let table = Table::read("crank_cycle");
    for (mode, guess) in [
        ("open", vec![]),
        (
            "crossed",
            pairs(&[("alpha", "3.1"), ("beta", "-3.1"), ("h", "-40")]),
        ),
    ] {
        let mut scene = Model::from(scene_with("slider-crank", |o| o.guess = guess));
        let times = drive_by_rows(&mut scene, &table);
        let trajectory = solve(&scene, &times).unwrap();
        for (row, pose) in poses(&trajectory).into_iter().enumerate() {
            let expected = table.value(row, &format!("h_{mode}"));
            let h = unknown(&scene.mechanism, pose, "h");
            assert!(
                (h - expected).abs() < 1e-12 * 120.0,
                "{mode} row {row}: {h} {expected}"
            );
            for angle in ["alpha", "beta"] {
                let difference = unknown(&scene.mechanism, pose, angle)
                    - table.value(row, &format!("{angle}_{mode}"));
                let wrapped = difference - TAU * (difference / TAU).round();
                assert!(
                    wrapped.abs() < 1e-12,
                    "{mode} row {row} {angle}: {wrapped:e}"
                );
            }
        }
    }
}

#[test]
fn slider_crank_finds_the_true_pose_from_the_lecture_starts_and_the_crossed_one_when_asked() {
    let starts: [(&[(&str, &str)], f64); 4] = [
        (
            &[("alpha", "0.1"), ("beta", "0.1"), ("h", "40")],
            112.77081077023263,
        ),
        (
            &[("alpha", "0"), ("beta", "0"), ("h", "20")],
            112.77081077023263,
        ),
        (
            &[("alpha", "2.9"), ("beta", "2.9"), ("h", "-40")],
            -42.564205819002808,
        ),
        // Offered as a start, the lecture's own false root is left behind.
        (
            &[("alpha", "2.8837"), ("beta", "-0.2421"), ("h", "42.5642")],
            f64::NAN,
        ),
    ];
    for (guess, expected) in starts {
        let scene = scene_with("slider-crank", |o| {
            o.guess = pairs(guess);
            o.inputs = pairs(&[("phi", "0.5")]);
        });
        let trajectory = solve(&scene, &[0.0]).unwrap();
        let h = unknown(&scene.mechanism, poses(&trajectory)[0], "h");
        if expected.is_nan() {
            let true_poses = [112.77081077023263, -42.564205819002808];
            assert!(true_poses.iter().any(|t| (h - t).abs() < 1e-10), "{h}");
        } else {
            assert!((h - expected).abs() < 1e-12 * 120.0, "{guess:?}: {h}");
        }
    }
}

#[test]
fn printed_root_of_the_lecture_is_named_a_half_turn() {
    let scene = scene_with("slider-crank", |o| o.inputs = pairs(&[("phi", "0.5")]));
    let printed = judge_pose(&scene.mechanism, &[2.8837, -0.2421, 42.5642, 0.5], 1e-9);
    assert_eq!(printed[0].verdict, LoopVerdict::HalfTurn);
    let ClosureGap::Loop { angle, .. } = printed[0].gap else {
        panic!("{printed:?}")
    };
    assert!((angle - PI).abs() < 1e-3);
    let all_digits = judge_pose(
        &scene.mechanism,
        &[
            2.8836626370770994,
            -0.24206998348730620,
            42.564205819002808,
            0.5,
        ],
        1e-9,
    );
    assert_eq!(all_digits[0].verdict, LoopVerdict::HalfTurn);
    let closed = judge_pose(
        &scene.mechanism,
        &[
            -0.74206998348730620,
            0.24206998348730620,
            112.77081077023263,
            0.5,
        ],
        1e-9,
    );
    assert_eq!(closed[0].verdict, LoopVerdict::Closed);
    let open = judge_pose(&scene.mechanism, &[-0.7, 0.2, 112.0, 0.5], 1e-9);
    assert_eq!(open[0].verdict, LoopVerdict::Open);
}

#[test]
fn planar_slider_crank_solves_three_equations() {
    let system = scene("slider-crank").system().unwrap();
    assert_eq!(system.structure().equation_count(), 3);
    assert_eq!(
        system.structure().empty_equations,
        [(0, 0), (0, 1), (0, 5)],
        "rotation about x and y, translation along z"
    );
}

#[test]
fn seven_r_output_follows_the_torus_pair_over_a_full_turn() {
    let table = Table::read("torus_ref");
    let rows: Vec<usize> = (0..table.len())
        .filter(|r| table.text(*r, "mechanism") == "torus-torus")
        .collect();
    assert_eq!(rows.len(), 72, "every five degrees");
    let scene = scene("seven-r");
    let times: Vec<f64> = rows
        .iter()
        .map(|r| 6.0 * table.value(*r, "beta1_deg") / 360.0)
        .collect();
    let trajectory = solve(&scene, &times).unwrap();
    for (row, pose) in rows.iter().zip(poses(&trajectory)) {
        for (ours, theirs) in [
            ("beta2", "beta2_deg"),
            ("theta1", "theta1_deg"),
            ("theta2", "theta2_deg"),
        ] {
            let difference =
                unknown(&scene.mechanism, pose, ours).to_degrees() - table.value(*row, theirs);
            let wrapped = difference - 360.0 * (difference / 360.0).round();
            assert!(
                wrapped.abs() < 1e-9,
                "{} deg {ours}: {wrapped:e}",
                table.value(*row, "beta1_deg")
            );
        }
    }
}

#[test]
fn seven_r_contact_point_lies_on_both_tori_and_the_normals_agree() {
    let scene = scene("seven-r");
    let mechanism = &Model::from(scene.clone());
    let times: Vec<f64> = (0..120).map(|k| 0.05 * k as f64).collect();
    let trajectory = solve(mechanism, &times).unwrap();
    let tori: Vec<_> = mechanism
        .bodies
        .iter()
        .enumerate()
        .flat_map(|(body, b)| b.shapes.iter().map(move |s| (body, s)))
        .filter_map(|(body, shape)| match shape.solid {
            mechanim::model::shape::Solid::Torus { ring, tube, .. } => {
                Some((body, shape.body_from_shape, ring, tube))
            }
            _ => None,
        })
        .collect();
    assert_eq!(tori.len(), 2);
    for pose in poses(&trajectory) {
        let normals: Vec<glam::DVec3> = tori
            .iter()
            .map(|(body, body_from_torus, ring, tube)| {
                let world_from_torus = pose.bodies[*body] * *body_from_torus;
                let p = world_from_torus.inverse().transform_point(pose.traces[0]);
                // On a spindle torus the outer sheet is the one farther from the ring circle's near side.
                let out = glam::DVec3::new(p.x, p.y, 0.0).normalize();
                let sheets = [out * *ring, -out * *ring].map(|centre| p - centre);
                let from_ring = sheets.into_iter().min_by(|a, b| {
                    (a.length() - tube)
                        .abs()
                        .total_cmp(&(b.length() - tube).abs())
                });
                let from_ring = from_ring.unwrap();
                assert!(
                    (from_ring.length() - tube).abs() < 1e-9,
                    "{}",
                    from_ring.length() - tube
                );
                world_from_torus.transform_vector(from_ring.normalize())
            })
            .collect();
        assert!(
            (normals[0] + normals[1]).length() < 1e-9,
            "external contact: opposite normals"
        );
    }
}

#[test]
fn bodies_stay_joined_in_every_frame() {
    // Centres of shared joints, as points of both bodies: equal in the world at every sample.
    let joints: [(&str, [f64; 3], &str, [f64; 3]); 8] = [
        ("shaft", [0.0, 0.0, 0.0], "cardan arm", [0.0, 0.0, 0.0]),
        ("cardan arm", [60.0, 0.0, 0.0], "pull rod", [0.0, 0.0, 0.0]),
        ("pull rod", [880.0, 0.0, 0.0], "rocker", [0.0, 0.0, -110.0]),
        ("rocker", [0.0, 0.0, 0.0], "frame", [930.0, 60.0, 270.0]),
        ("rocker", [0.0, 0.0, 100.0], "coupler", [0.0, 0.0, 0.0]),
        (
            "coupler",
            [-110.0, 130.0, 0.0],
            "short link",
            [0.0, 0.0, 0.0],
        ),
        (
            "short link",
            [0.0, 0.0, -297.0],
            "pull rod",
            [795.0, -65.0, 0.0],
        ),
        (
            "coupler",
            [120.0, 0.0, 30.0],
            "gear lever",
            [-30.0, 0.0, 65.0],
        ),
    ];
    let scene = scene("gearshift");
    let mechanism = &Model::from(scene.clone());
    let body = |name: &str| {
        mechanism
            .bodies
            .iter()
            .position(|b| b.name == name)
            .unwrap()
    };
    let times: Vec<f64> = (0..120).map(|k| 0.05 * k as f64).collect();
    let trajectory = solve(mechanism, &times).unwrap();
    for pose in poses(&trajectory) {
        for (a, p, b, q) in &joints {
            let gap = pose.bodies[body(a)].transform_point(glam::DVec3::from_array(*p))
                - pose.bodies[body(b)].transform_point(glam::DVec3::from_array(*q));
            assert!(gap.length() < 1e-10, "{a} - {b}: {}", gap.length());
        }
        let lever = pose.bodies[body("gear lever")].translation;
        assert!(lever.distance(glam::DVec3::new(1080.0, 70.0, 285.0)) < 1e-10);
    }
}

#[test]
fn rates_match_differences_of_the_motion() {
    for name in ["gearshift", "slider-crank", "seven-r", "dyads"] {
        let scene = scene(name);
        let (time, h) = (1.37, 1e-5);
        let trajectory = solve(&scene, &[time - h, time, time + h]).unwrap();
        let poses = poses(&trajectory);
        for k in 0..poses[1].unknowns.len() {
            let difference = (poses[2].unknowns[k] - poses[0].unknowns[k]) / (2.0 * h);
            let scale = 1.0 + difference.abs();
            assert!(
                (difference - poses[1].rates[k]).abs() < 1e-6 * scale,
                "{name} unknown {k}"
            );
        }
    }
}
