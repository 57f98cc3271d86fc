//! Poses that are known to be hard, one scene a user could have written for each: all assemblies against closed forms
//! or published numbers, each with its proof, or with none where none is possible.
// Published numbers keep the digits they were published with.
#![allow(clippy::excessive_precision)]

use crate::driven::{Driven, Model, solve};
use mechanim::kinematics::results::certificate::Certificate;

use crate::reference::{Table, hard, slot, turned};
use mechanim::kinematics::assemblies::{DEFAULT_STARTS, find_modes};
use mechanim::kinematics::results::trajectory::{ClosedPose, EventKind};
use mechanim::model::mechanism::{Kind, Mechanism};
use std::f64::consts::{FRAC_PI_6, PI};

/// The only pose at the start of the drive.
fn pose(mechanism: &Model) -> ClosedPose {
    let trajectory = solve(mechanism, &[0.0]).unwrap();
    let pose = trajectory.samples[0].pose.clone();
    pose.unwrap_or_else(|| panic!("{}: {:?}", mechanism.title, trajectory.events))
}

fn value(mechanism: &Mechanism, pose: &ClosedPose, name: &str) -> f64 {
    pose.unknowns[slot(mechanism, name)]
}

/// The named unknowns of all assemblies at the start of the drive.
fn assemblies(mechanism: &Model, names: &[&str]) -> Vec<Vec<f64>> {
    let system = mechanism.system().unwrap();
    let first = mechanism.actuation.start_at(0.0);
    let modes = find_modes(&system, &first, &[], DEFAULT_STARTS, &|| false);
    let modes = modes.list.iter();
    let named = |coordinates: &[f64]| {
        let values = names.iter().map(|name| coordinates[slot(mechanism, name)]);
        values.collect()
    };
    modes.map(|mode| named(&mode.coordinates)).collect()
}

/// Angles up to whole turns, lengths relative to the mechanism's size.
fn distance(mechanism: &Mechanism, names: &[&str], a: &[f64], b: &[f64]) -> f64 {
    let differences = names.iter().zip(a.iter().zip(b)).map(|(name, (a, b))| {
        match mechanism.unknowns[slot(mechanism, name)].kind {
            Kind::Angle => turned(a - b),
            Kind::Length => (a - b).abs() / mechanism.size,
            Kind::Number => (a - b).abs(),
        }
    });
    differences.fold(0.0, f64::max)
}

/// The assemblies are exactly the expected ones, in any order.
fn assert_set(mechanism: &Model, names: &[&str], expected: &[Vec<f64>], tolerance: f64) {
    let found = assemblies(mechanism, names);
    assert_eq!(
        found.len(),
        expected.len(),
        "{}: {found:?}",
        mechanism.title
    );
    for expected in expected {
        let near = found
            .iter()
            .map(|f| distance(mechanism, names, f, expected));
        let nearest = near.fold(f64::INFINITY, f64::min);
        assert!(
            nearest < tolerance,
            "{}: {expected:?} is {nearest:e} from {found:?}",
            mechanism.title
        );
    }
}

/// Bound and radius in the scene's unit, if the pose is proved.
fn proof(pose: &ClosedPose) -> Option<(f64, f64)> {
    let is_locked = matches!(pose.certificate, Certificate::Locked { .. });
    let bounds = pose.certificate.bounds().filter(|_| !is_locked);
    bounds.map(|[error_bound, unique_radius]| (error_bound, unique_radius))
}

#[test]
fn the_slider_crank_closes_twice_at_any_angle_and_size() {
    for phi in [0.5, 0.0, 1.3, -2.0, 3.1] {
        for (r, l) in [(40.0, 80.0), (10.0, 1000.0), (79.2, 80.0)] {
            let (phi_text, r_text, l_text) = (phi.to_string(), r.to_string(), l.to_string());
            let mechanism = hard(
                "h01-slider-crank",
                &[
                    ("input", "phi", &phi_text),
                    ("param", "r", &r_text),
                    ("param", "L", &l_text),
                ],
            );
            let w = ((l - r * f64::sin(phi)) * (l + r * f64::sin(phi))).sqrt();
            // The rod's direction is psi = phi + alpha; r sin phi + L sin psi = 0.
            let closures = [w, -w].map(|w| {
                let psi = (-r * phi.sin()).atan2(w);
                vec![psi - phi, -psi, r * phi.cos() + w]
            });
            assert_set(&mechanism, &["alpha", "beta", "h"], &closures, 1e-12);
        }
    }
    let printed = hard("h01-slider-crank", &[]);
    let pose = pose(&printed);
    assert!((value(&printed, &pose, "h") - 112.770810770233).abs() < 1e-12);
    assert!((value(&printed, &pose, "alpha") + 0.742069983487306).abs() < 1e-14);
    assert!((value(&printed, &pose, "beta") - 0.242069983487306).abs() < 1e-14);
    assert!(proof(&pose).unwrap().0 < 1e-12);
}

#[test]
fn a_parallelogram_has_its_two_forms() {
    for phi in [30.0_f64, 150.0, 77.0, -100.0, 1.0] {
        let text = phi.to_string();
        let mechanism = hard("h04-parallelogram", &[("input", "phi", &text)]);
        let phi = phi.to_radians();
        // tan(theta/2) = (a + b) / (a - b) tan(phi/2)
        let folded = 2.0 * (-140.0 / 60.0 * (0.5 * phi).tan()).atan();
        assert_set(&mechanism, &["theta"], &[vec![phi], vec![folded]], 1e-11);
    }
}

/// The rocker's two directions at `phi`, of a four-bar with crank a, coupler b, rocker c on a base d.
fn rocker([a, b, c, d]: [f64; 4], phi: f64) -> [f64; 2] {
    let (x, y) = (a * phi.cos() - d, a * phi.sin());
    let reach = x.hypot(y);
    // acos of a number near one has lost half its digits; the half angle has not.
    let (longer, shorter) = (
        (b - (reach - c)) * (b + (reach - c)),
        (reach + c - b) * (reach + c + b),
    );
    let g = 2.0 * (longer / shorter).max(0.0).sqrt().atan();
    [1.0, -1.0].map(|sign| y.atan2(x) + sign * g)
}

#[test]
fn almost_equal_assemblies_of_a_parallelogram_stay_two() {
    // The published distances belong to the decimal e; c in f64 differs from it by up to 4e-15 of 40.
    for (e, published) in [
        ("1e-3", 0.0377760313986),
        ("1e-6", 0.00119522796334),
        ("1e-9", 3.77964472805e-5),
    ] {
        let mechanism = hard(
            "h05-almost-parallelogram",
            &[("param", "e", e), ("input", "phi", "pi")],
        );
        let exact = rocker(
            [40.0, 100.0, 40.0 * (1.0 + e.parse::<f64>().unwrap()), 100.0],
            PI,
        );
        let condition = 1e-15 / published;
        assert!((0.5 * turned(exact[0] - exact[1]) - published).abs() < 10.0 * condition);
        let exact = exact.map(|theta| vec![theta]);
        assert_set(&mechanism, &["theta"], &exact, 100.0 * condition);
    }
}

#[test]
fn nearly_tangent_circles_lose_half_the_digits_and_no_more() {
    for (e, published) in [
        ("1e-4", 0.7070891032960415),
        ("1e-8", 0.007071067794187806),
        ("1e-12", 7.071067811863707e-5),
        ("1e-15", 2.236067977499789e-6),
    ] {
        let mechanism = hard("h07-near-tangent-circles", &[("param", "e", e)]);
        // The distance 100 (1 - e) is known to all its digits, though f64 has no more than 16 of them.
        let e_value: f64 = e.parse().unwrap();
        let exact = 50.0 * (e_value * (2.0 - e_value)).sqrt();
        assert!((exact / published - 1.0).abs() < 1e-15, "{e}: {exact:e}");
        let pose = pose(&mechanism);
        let height = pose.outputs[0].abs();
        // An error of u in the closure is one of u over the sine of the bars' angle in the pose.
        let error = (height - exact).abs() / 100.0;
        let honest = 4e-16 * 50.0 / exact;
        assert!(error < honest && error < 1e-8, "{e}: {height:e} {exact:e}");
        if let Some((bound, _)) = proof(&pose) {
            assert!(bound >= error * 100.0);
        }
    }
}

/// Bars 2, 2 on 4, and circles of other sizes that touch from outside or inside.
#[test]
fn a_double_root_is_met_and_never_proved() {
    let mechanism = hard("h08-double-root", &[]);
    let trajectory = solve(&mechanism, &[0.0, 1.0, 2.0]).unwrap();
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    for pose in trajectory.poses() {
        let (x, y) = (pose.unknowns[0], pose.unknowns[1]);
        assert!((x - 2.0).abs() < 1e-9 && y.abs() < 1e-5, "({x}, {y})");
        assert!(proof(pose).is_none() && pose.sigma_min < 1e-4);
    }
    let chained = hard("h07-near-tangent-circles", &[("param", "e", "0")]);
    let pose = pose(&chained);
    assert!(proof(&pose).is_none(), "{:?}", pose.certificate);
    assert!(pose.outputs[0].abs() < 1e-5);
}

#[test]
fn a_structure_has_two_poses_and_does_not_move() {
    let mechanism = hard("h09-structure", &[]);
    let apex = |sign: f64| vec![sign * 0.5 * PI];
    assert_set(&mechanism, &["a"], &[apex(1.0), apex(-1.0)], 1e-14);
    let trajectory = solve(&mechanism, &[0.0, 1.0, 2.0]).unwrap();
    for pose in trajectory.poses() {
        assert!((pose.traces[0].y - 3.0).abs() < 1e-14);
        assert!(pose.rates.iter().all(|rate| *rate == 0.0));
    }
}

#[test]
fn what_cannot_be_assembled_says_how_much_is_lacking() {
    for (scene, phi, gap) in [
        ("h10-rod-too-short", "90", 20.0),
        ("h10-rod-too-short", "60", 80.0 * 0.75_f64.sqrt() - 60.0),
        ("h10-four-bar-too-short", "0", 10.0),
        ("h10-four-bar-too-short", "180", 110.0),
    ] {
        let mechanism = hard(scene, &[("input", "phi", phi)]);
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        assert!(trajectory.samples[0].pose.is_none());
        let EventKind::StartNotClosed { name, distance, .. } = &trajectory.events[0].kind else {
            panic!("{:?}", trajectory.events)
        };
        assert_eq!(name, "A");
        assert!(
            (distance - gap).abs() < 1e-6 * gap,
            "{scene} {phi}: {distance}"
        );
    }
}

#[test]
fn all_sixteen_closures_of_the_arm_are_found_and_proved() {
    let table = Table::read("hard_6r16");
    let names = ["t1", "t2", "t3", "t4", "t5", "t6"];
    let row = |row: usize| -> Vec<f64> {
        let columns = (1..=6).map(|k| format!("theta{k}_rad"));
        columns.map(|column| table.value(row, &column)).collect()
    };
    let expected: Vec<Vec<f64>> = (0..16).map(row).collect();
    assert_set(&hard("h20-six-r", &[]), &names, &expected, 1e-12);
    for angles in &expected {
        let texts: Vec<String> = angles.iter().map(|a| format!("{a:.4}")).collect();
        let guess = names.iter().zip(&texts);
        let guess: Vec<_> = guess.map(|(n, v)| ("guess", *n, v.as_str())).collect();
        let mechanism = hard("h20-six-r", &guess);
        let pose = pose(&mechanism);
        assert!(distance(&mechanism, &names, &pose.unknowns, angles) < 1e-13);
        let (bound, radius) = proof(&pose).unwrap();
        assert!(bound < 1e-12 && radius > 1e-3, "{bound:e} {radius:e}");
        assert!((0.2..0.7).contains(&pose.sigma_min), "{}", pose.sigma_min);
    }
}

#[test]
fn a_large_angle_is_taken_as_the_number_it_is() {
    // Cosines of the f64 nearest to 2 pi n + 0.5, 17 digits.
    for (turns, nearest, cosine) in [
        ("10", 63.33185307179586, 0.87758256189037389_f64),
        ("1e6", 6283185.807179586, 0.87758256210437986),
        ("1e9", 6283185307.679586, 0.87758259372558132),
        ("1e12", 6283185307180.087, 0.87737290330498808),
    ] {
        let mechanism = hard("h25-angle-wrap", &[("param", "turns", turns)]);
        assert_eq!(mechanism.actuation.inputs_at(0.0)[0], nearest);
        let pose = pose(&mechanism);
        let sine = (1.0 - cosine * cosine).sqrt();
        let h = 40.0 * cosine + (6400.0 - (40.0 * sine) * (40.0 * sine)).sqrt();
        assert!(
            (value(&mechanism, &pose, "h") - h).abs() < 1e-12,
            "{turns} turns"
        );
    }
}

#[test]
fn size_changes_neither_result_nor_work() {
    let at = |s: &str| {
        let mechanism = hard("h26-scale", &[("param", "s", s)]);
        let pose = pose(&mechanism);
        (
            value(&mechanism, &pose, "h") / s.parse::<f64>().unwrap(),
            pose.iterations,
        )
    };
    let (h, iterations) = at("1");
    assert!((h - 112.770810770233).abs() < 1e-12);
    for s in ["1e-9", "1e-6", "1e-3", "1e6", "1e9"] {
        let (scaled, work) = at(s);
        assert!((scaled / h - 1.0).abs() < 1e-15, "{s}: {:e}", scaled - h);
        assert_eq!(work, iterations, "{s}");
    }
}

#[test]
fn proofs_next_to_a_change_point_weigh_lengths_by_the_size() {
    // Error u / delta, unique within about delta: the law of two branches that meet.
    for (delta, limit) in [
        ("1e-1", 1e-13),
        ("1e-2", 1e-12),
        ("1e-3", 1e-11),
        ("1e-4", 1e-10),
        ("1e-5", 1e-9),
        ("1e-6", 1e-8),
    ] {
        let mechanism = hard("h27-mixed-units", &[("param", "delta", delta)]);
        let pose = pose(&mechanism);
        let exact: f64 = delta.parse().unwrap();
        let h = 160.0 * exact.sin();
        let error = (value(&mechanism, &pose, "h") - h).abs();
        let (bound, radius) = proof(&pose).unwrap_or_else(|| panic!("{delta}"));
        // The input itself is pi/2 - delta rounded.
        assert!(error < bound + 4e-16 * 160.0, "{delta}: {error:e}");
        assert!(
            bound / 80.0 < limit && radius / 80.0 > 0.1 * exact && radius / 80.0 < exact,
            "{delta}: {bound:e} {radius:e}"
        );
    }
    let crossing = hard("h27-mixed-units", &[("param", "delta", "0")]);
    assert!(proof(&pose(&crossing)).is_none());
}

#[test]
fn hookes_joint_follows_its_closed_form_until_it_locks() {
    for degrees in [1.0_f64, 30.0, 60.0, 89.0, 89.99] {
        for t1 in [1.0_f64, -0.3, 1.5] {
            let (beta, start) = (format!("{degrees}deg"), t1.to_string());
            let mechanism = hard(
                "h30-hooke",
                &[("param", "beta", &beta), ("input", "t1", &start)],
            );
            let exact = (degrees.to_radians().cos() * t1.tan()).atan();
            let pose = pose(&mechanism);
            let error = value(&mechanism, &pose, "t2") - exact;
            // Half a turn farther the cross stands on its head.
            assert!(
                (error - PI * (error / PI).round()).abs() < 1e-12,
                "{degrees} {t1}: {error:e}"
            );
        }
    }
    let mechanism = hard("h30-hooke", &[]);
    let angle = value(&mechanism, &pose(&mechanism), "t2");
    assert!((angle - 0.932806044670911).abs() < 1e-14);
    assert!((angle - (FRAC_PI_6.cos() * 1.0_f64.tan()).atan()).abs() < 1e-15);
}
