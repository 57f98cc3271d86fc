//! Motions that start on a singular pose, drives that jump, over-constrained loops of other dimensions, and scenes of
//! plain equations at any size: all samples have their pose, on one branch, against closed forms.

use crate::driven::{Driven, Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::motion::continuation::solve_until;
use mechanim::kinematics::results::certificate::Certificate;

use mechanim::kinematics::results::trajectory::{EventKind, Trajectory};

use crate::reference::{hard, slot, turned};
use mechanim::model::printed::InputReading;
use mechanim::scene::{Overrides, load_scene};
use std::cell::Cell;
use std::f64::consts::{PI, TAU};

fn read(text: &str) -> Model {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let scene = load_scene(&source, &Overrides::default());
    Model::from(scene.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)))
}

/// The motion at even times; every sample has a pose and every pose closes.
fn whole(mechanism: &Model, samples: usize) -> Trajectory {
    let trajectory = solve(mechanism, &even_times(mechanism, samples)).unwrap();
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    assert!(trajectory.gaps.is_empty(), "{:?}", trajectory.gaps);
    assert!(trajectory.closure_error() < 1e-11);
    trajectory
}

fn four_bar(start: f64, [mu, nu, theta]: [f64; 3]) -> Model {
    read(&format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n[inputs]\nphi = \"{start} + 360*t/4\"\n[loops]\n\
         A = \"Rz(phi) Tx(40) Rz(mu) Tx(100) Rz(nu) Tx(-40) Rz(-theta) Tx(-100)\"\n\
         [guess]\nmu = {mu}\nnu = {nu}\ntheta = {theta}\n"
    ))
}

#[test]
fn a_motion_starts_on_a_change_point_and_keeps_the_branch_nearest_to_its_start_values() {
    // All links are in line at 0 and 180 degrees; the folded form leaves them at another rate.
    for (start, guess, folded) in [
        (0.0, [0.0, 0.0, 0.0], false),
        (0.0, [-2.0, 2.0, 2.0], false),
        (180.0, [-180.0, 180.0, 180.0], true),
        (0.0, [-7.0, -3.0, -7.0], true),
    ] {
        let mechanism = four_bar(start, guess);
        for samples in [9, 73, 1000] {
            let trajectory = whole(&mechanism, samples);
            assert_eq!(trajectory.events[0].kind, EventKind::StartSingular);
            let theta = slot(&mechanism, "theta");
            for (k, pose) in trajectory.poses().enumerate().skip(1) {
                let phi = trajectory.samples[k].inputs[0];
                let half = (phi / 2.0).tan();
                let ratio = if folded { 140.0 / -60.0 } else { 1.0 };
                let expected = 2.0 * (ratio * half).atan();
                // Near the other change point the pose is known to half of the digits.
                let error = turned(pose.unknowns[theta] - expected);
                assert!(error < 1e-7, "{start} {folded} {phi}: {error:e}");
            }
        }
    }
}

#[test]
fn a_slider_leaves_its_dead_points_on_the_side_of_its_start_values() {
    for (h, phi, alpha, side) in [
        ("120 - 80*t/4", 0.3, -0.4, 1.0),
        ("120 - 80*t/4", -0.3, 0.4, -1.0),
        ("40 + 80*t/4", 3.1, 3.0, 1.0),
    ] {
        let mechanism = read(&format!(
            "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 4\n[inputs]\nh = \"{h}\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nphi = {phi}\nalpha = {alpha}\n"
        ));
        let trajectory = whole(&mechanism, 73);
        let place = slot(&mechanism, "phi");
        for (k, pose) in trajectory.poses().enumerate().skip(1) {
            let h = trajectory.samples[k].inputs[0];
            let cosine = (40.0 * 40.0 + h * h - 80.0 * 80.0) / (2.0 * 40.0 * h);
            let expected = side * cosine.clamp(-1.0, 1.0).acos();
            let error = turned(pose.unknowns[place] - expected);
            assert!(error < 1e-7, "{h}: {error:e}");
        }
    }
}

#[test]
fn a_drive_that_jumps_is_followed_straight_from_value_to_value() {
    let mechanism = read(
        "units = { length = \"mm\", angle = \"rad\" }\nduration = 4\n[inputs]\n\
         phi = { keys = [[0, 0], [1, 10], [2, -3], [3, 100], [4, 1]], ease = \"step\" }\n[loops]\n\
         A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\n",
    );
    let trajectory = whole(&mechanism, 73);
    assert_eq!(trajectory.events, []);
    for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
        let phi = sample.inputs[0];
        let h = 40.0 * phi.cos() + (6400.0 - (40.0 * phi.sin()).powi(2)).sqrt();
        assert!((pose.unknowns[slot(&mechanism, "h")] - h).abs() < 1e-10);
        // Turns are kept: the rod follows the crank.
        let swing = phi + pose.unknowns[slot(&mechanism, "alpha")];
        assert!(swing.abs() < 0.6, "{phi} {swing}");
    }
}

#[test]
fn an_over_constrained_loop_of_any_dimensions_turns_without_a_false_end() {
    for (alpha, beta, a) in [(25.0, 110.0, 7.3), (60.0, 100.0, 1e-6), (15.0, 70.0, 3e5)] {
        let (x, y): (f64, f64) = (f64::to_radians(alpha), f64::to_radians(beta));
        let b = a * y.sin() / x.sin();
        let product = ((y + x) / 2.0).sin() / ((y - x) / 2.0).sin();
        let t2 = |t1: f64| 2.0 * (product / (t1 / 2.0).tan()).atan();
        let mechanism = read(&format!(
            "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 4\n[inputs]\nt1 = \"1 + 2*pi*t/4\"\n[loops]\n\
             A = \"Rz(t1) Tx({a}) Rx({x}) Rz(t2) Tx({b}) Rx({y}) Rz(t3) Tx({a}) Rx({x}) Rz(t4) Tx({b}) Rx({y})\"\n\
             [guess]\nt2 = {}\nt3 = -1\nt4 = {}\n",
            t2(1.0),
            -t2(1.0)
        ));
        let trajectory = whole(&mechanism, 200);
        assert_eq!(trajectory.events, [], "{alpha} {beta}");
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let error = turned(pose.unknowns[slot(&mechanism, "t2")] - t2(sample.inputs[0]));
            assert!(error < 1e-12, "{error:e}");
            assert!(pose.certificate.bounds().is_some());
        }
    }
}

#[test]
fn equations_alone_are_solved_alike_at_any_size() {
    let bars = |size: f64| {
        read(&format!(
            "duration = 4\n[parameters]\nk = {size}\n[inputs]\nphi = \"1 + 0.5*t/4\"\n[equations]\n\
             crank = \"(x - 40*k*cos(phi))^2 + (y - 40*k*sin(phi))^2 - (100*k)^2\"\n\
             rocker = \"(x - 100*k)^2 + y^2 - (70*k)^2\"\nrope = \"s - 10*k*(phi + 0.3)\"\n\
             gear = \"20*psi - 40*phi\"\n[guess]\nx = \"60*k\"\ny = \"80*k\"\n"
        ))
    };
    let one = whole(&bars(1.0), 73);
    for size in [1e-9, 1e-6, 1e6, 1e9] {
        let mechanism = bars(size);
        let other = whole(&mechanism, 73);
        let proved = |pose: &Certificate| pose.bounds().is_some();
        assert!(other.poses().all(|p| proved(&p.certificate)), "{size}");
        for (a, b) in one.poses().zip(other.poses()) {
            for (k, unknown) in mechanism.unknowns.iter().enumerate() {
                let scale = if unknown.name == "psi" { 1.0 } else { size };
                let error = (a.unknowns[k] - b.unknowns[k] / scale).abs();
                assert!(
                    error < 1e-12 * a.unknowns[k].abs().max(1.0),
                    "{size}: {error:e}"
                );
            }
        }
    }
}

#[test]
fn dixons_bars_are_solved_alike_at_any_size() {
    let at = |size: f64| {
        let known = [30.0, -50.0, 70.0, -90.0, 40.0, -60.0, 80.0, -100.0];
        let lengths = ["a1", "a2", "a3", "a4", "b1", "b2", "b3", "b4"];
        let guess = ["p2", "p3", "p4", "v1", "v2", "v3", "v4"];
        let texts = known.map(|v| format!("{:e}", v * size));
        let drive = format!("{:e}*(30 + 10*t/4)", size);
        let mut changes = vec![("input", "p1", drive.as_str())];
        changes.extend(
            lengths
                .iter()
                .zip(&texts)
                .map(|(n, v)| ("param", *n, v.as_str())),
        );
        changes.extend(
            guess
                .iter()
                .zip(&texts[1..])
                .map(|(n, v)| ("guess", *n, v.as_str())),
        );
        hard("h16-dixon", &changes)
    };
    for size in [1e-9, 1e-6, 1.0, 1e6, 1e9] {
        let mechanism = at(size);
        let trajectory = whole(&mechanism, 73);
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            assert!(pose.certificate.bounds().is_some());
            let s = (sample.inputs[0] / size).powi(2) - 900.0;
            let expected = -(2500.0 + s).sqrt();
            let error = pose.unknowns[slot(&mechanism, "p2")] / size - expected;
            assert!(error.abs() < 1e-10, "{size}: {error:e}");
        }
    }
}

#[test]
fn a_position_at_gimbal_lock_is_exact_and_its_free_angle_is_held() {
    let mechanism = hard("h18-gimbal-lock", &[]);
    let trajectory = solve(&mechanism, &[0.0]).unwrap();
    let pose = trajectory.samples[0].pose.as_ref().unwrap();
    let angle = |name: &str| pose.unknowns[slot(&mechanism, name)];
    assert!(turned(angle("a") + angle("c") - 50.0 * PI / 180.0) < 1e-12);
    // The tip is 50 along x of Rx(30) Ry(90) Rz(20), which is (0, sin 50, -cos 50).
    let (sin, cos) = (50.0 * PI / 180.0).sin_cos();
    let tip = pose.traces[0];
    for (found, expected) in [(tip.x, 0.0), (tip.y, 50.0 * sin), (tip.z, -50.0 * cos)] {
        assert!((found - expected).abs() < 1e-12, "{tip}");
    }
    // One of the outer angles is named as exchangeable for the other, and held.
    let held = mechanism.system().unwrap().structure().held.clone();
    assert_eq!(held.len(), 1, "{held:?}");
}

#[test]
fn a_solve_that_is_cancelled_keeps_what_it_has() {
    let mechanism = four_bar(30.0, [-30.0, 30.0, 30.0]);
    let system = mechanism.system().unwrap();
    let times: Vec<f64> = (0..1000).map(|k| TAU * f64::from(k) / 2000.0).collect();
    let asked = Cell::new(0);
    let stop = || {
        asked.set(asked.get() + 1);
        asked.get() > 100
    };
    let trajectory = solve_until(
        &system,
        &mechanism.actuation,
        &times,
        Some(InputReading::Numbers),
        &stop,
    );
    let count = trajectory.samples.len();
    assert!((10..101).contains(&count), "{count}");
}
