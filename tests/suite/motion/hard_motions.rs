//! Motions that are known to be hard: past change points, between assemblies that almost meet, up to folds and again
//! from where poses resume, through over-constrained loops and long rows of them. Coarse and fine samples, forwards
//! and backwards, two turns, against closed forms.

use crate::driven::{Model, even_times, feasible_inputs, solve};
use mechanim::kinematics::results::certificate::Certificate;

use mechanim::kinematics::results::trajectory::{ClosedPose, Ending, EventKind, Trajectory};

use crate::reference::{hard, slot, turned};
use std::f64::consts::{FRAC_PI_2, PI, TAU};

/// Samples over two turns: from a few steps of half a turn to steps of a tenth of a degree.
const SAMPLES: [usize; 6] = [8, 9, 24, 74, 720, 7202];

/// Input and pose of every sample that has one; every pose is checked to close.
fn poses(trajectory: &Trajectory) -> Vec<(f64, &ClosedPose)> {
    let samples = trajectory.samples.iter();
    let closed = samples.filter_map(|s| Some((s.inputs[0], s.pose.as_ref()?)));
    let list: Vec<_> = closed.collect();
    for (input, pose) in &list {
        // Plain equations have no size to be measured against; ours are of the order of 1e4.
        assert!(
            pose.closure_error < 1e-11,
            "{input}: {}",
            pose.closure_error
        );
    }
    list
}

fn inputs_of(trajectory: &Trajectory, kind: &EventKind) -> Vec<f64> {
    let events = trajectory.events.iter().filter(|e| e.kind == *kind);
    events.map(|e| e.inputs[0]).collect()
}

/// Two turns of `input` from `start` (in the scene's unit, of which a turn has `turn`), forwards and backwards, at
/// all densities.
fn two_turns(
    scene: &str,
    changes: &[(&str, &str, &str)],
    input: &str,
    (start, turn): (f64, f64),
    mut judge: impl FnMut(&Model, &Trajectory),
) {
    for direction in [1.0, -1.0] {
        let formula = format!("{start} + {}*t", direction * turn);
        let driven = [changes, &[("input", input, formula.as_str())]].concat();
        let mut mechanism = hard(scene, &driven);
        mechanism.actuation.duration = 2.0;
        for samples in SAMPLES {
            let times: Vec<f64> = (0..=samples)
                .map(|k| 2.0 * (k as f64 / samples as f64))
                .collect();
            let trajectory = solve(&mechanism, &times).unwrap();
            judge(&mechanism, &trajectory);
        }
    }
}

/// The located singular poses lie where they should, one for each time the drive passes one of `places` (modulo a
/// turn); the ends of the drive do not count.
fn assert_passed(mechanism: &Model, trajectory: &Trajectory, places: &[f64]) {
    let passed = inputs_of(trajectory, &EventKind::SingularPosePassed);
    let (start, end) = (
        mechanism.actuation.inputs_at(0.0)[0],
        mechanism.actuation.inputs_at(2.0)[0],
    );
    let (low, high) = (start.min(end) + 1e-6, start.max(end) - 1e-6);
    let turns = (-3..=3).flat_map(|k| places.iter().map(move |p| p + TAU * f64::from(k)));
    let expected = turns.filter(|p| (low..high).contains(p)).count();
    let samples = trajectory.samples.len();
    assert_eq!(passed.len(), expected, "{samples} samples: {passed:?}");
    for input in passed {
        let off = places.iter().map(|p| turned(input - p)).fold(PI, f64::min);
        assert!(off < 1e-9, "{samples} samples: {input} is off by {off:e}");
    }
}

#[test]
fn an_isosceles_slider_crank_passes_its_change_points() {
    for start in [0.0, 33.0] {
        let h = format!("{}", 160.0 * f64::to_radians(start).cos());
        let (alpha, beta) = (format!("-{}", 2.0 * start), format!("{start}"));
        let guess = [
            ("guess", "h", h.as_str()),
            ("guess", "alpha", alpha.as_str()),
            ("guess", "beta", beta.as_str()),
        ];
        two_turns(
            "h03-change-point",
            &guess,
            "phi",
            (start, 360.0),
            |m, trajectory| {
                assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
                assert_passed(m, trajectory, &[FRAC_PI_2, 3.0 * FRAC_PI_2]);
                for (phi, pose) in poses(trajectory) {
                    let error = (pose.unknowns[slot(m, "h")] - 160.0 * phi.cos()).abs();
                    // On the singular pose itself the position is known to the root of rounding.
                    let singular = phi.cos().abs() < 1e-6;
                    assert!(
                        error < if singular { 1e-5 } else { 1e-9 },
                        "{phi}: {error:e}"
                    );
                    if singular {
                        assert!(matches!(pose.certificate, Certificate::Refused { .. }));
                    }
                }
            },
        );
    }
}

#[test]
fn a_parallelogram_and_its_folded_form_pass_their_change_points() {
    for (a, b) in [(40.0, 100.0), (99.0, 100.0), (5.0, 100.0), (100.0, 40.0)] {
        let (a_text, b_text) = (a.to_string(), b.to_string());
        let sizes = [
            ("param", "a", a_text.as_str()),
            ("param", "b", b_text.as_str()),
        ];
        two_turns(
            "h04-parallelogram",
            &sizes,
            "phi",
            (30.0, 360.0),
            |m, trajectory| {
                assert_eq!(trajectory.missing(), 0, "{a} {b}: {:?}", trajectory.events);
                assert_passed(m, trajectory, &[0.0, PI]);
                for (phi, pose) in poses(trajectory) {
                    let error = turned(pose.unknowns[slot(m, "theta")] - phi);
                    let bound = if phi.sin().abs() < 1e-6 { 1e-6 } else { 1e-10 };
                    assert!(error < bound, "{a} {b} {phi}: {error:e}");
                }
            },
        );
    }
    let folded = [
        ("guess", "theta", "-64"),
        ("guess", "mu", "-70"),
        ("guess", "nu", "-30"),
    ];
    two_turns(
        "h04-parallelogram",
        &folded,
        "phi",
        (30.0, 360.0),
        |m, trajectory| {
            assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
            assert_passed(m, trajectory, &[0.0, PI]);
            for (phi, pose) in poses(trajectory) {
                // tan(theta/2) = (a + b) / (a - b) tan(phi/2)
                let theta = 2.0 * (-140.0 * (0.5 * phi).sin()).atan2(60.0 * (0.5 * phi).cos());
                let error = turned(pose.unknowns[slot(m, "theta")] - theta);
                let bound = if phi.sin().abs() < 1e-6 { 1e-6 } else { 1e-10 };
                assert!(error < bound, "{phi}: {error:e}");
            }
        },
    );
}

/// The direction of a rocker c on a base d = b, with a crank a = 40 and a coupler b = 100: base direction -+ g.
fn rocker(c: f64, phi: f64, sign: f64) -> f64 {
    let (x, y) = (40.0 * phi.cos() - 100.0, 40.0 * phi.sin());
    let reach = x.hypot(y);
    let longer = (100.0 - (reach - c)) * (100.0 + (reach - c));
    let shorter = (reach + c - 100.0) * (reach + c + 100.0);
    y.atan2(x) + sign * 2.0 * longer.max(0.0).sqrt().atan2(shorter.max(0.0).sqrt())
}

#[test]
fn almost_equal_assemblies_are_never_swapped() {
    for e in ["1e-3", "1e-6", "1e-9", "1e-12", "-1e-3", "-1e-6"] {
        let c = 40.0 * (1.0 + e.parse::<f64>().unwrap());
        let size = [("param", "e", e)];
        // With the longer rocker the crank turns, with the shorter one it stops short of the line.
        two_turns(
            "h05-almost-parallelogram",
            &size,
            "phi",
            (0.5, TAU),
            |m, trajectory| {
                if !e.starts_with('-') {
                    assert_eq!(trajectory.missing(), 0, "{e}: {:?}", trajectory.events);
                }
                let theta = slot(m, "theta");
                let first = trajectory.samples[0].pose.as_ref().unwrap().unknowns[theta];
                let sign = if turned(first - rocker(c, 0.5, 1.0)) < 1e-9 {
                    1.0
                } else {
                    -1.0
                };
                for (phi, pose) in poses(trajectory) {
                    let (mine, other) = (rocker(c, phi, sign), rocker(c, phi, -sign));
                    let error = turned(pose.unknowns[theta] - mine);
                    let apart = turned(mine - other);
                    assert!(
                        error < 1e-14 / apart.max(1e-7) + 1e-11 && error < 0.1 * apart,
                        "{e}, {} samples, {phi}: {error:e} of {apart:e}",
                        trajectory.samples.len()
                    );
                }
            },
        );
    }
}

#[test]
fn the_kite_turns_once_in_two_turns_of_its_crank() {
    two_turns("h06-kite", &[], "phi", (90.0, 360.0), |m, trajectory| {
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        assert_passed(m, trajectory, &[0.0]);
        let theta = slot(m, "theta");
        let exact = |phi: f64| FRAC_PI_2 + 0.5 * phi - (0.4 * (0.5 * phi).sin()).acos();
        let mirrored = |phi: f64| FRAC_PI_2 + 0.5 * phi + (0.4 * (0.5 * phi).sin()).acos();
        let (phi, first) = poses(trajectory)[0];
        let is_mirrored = turned(first.unknowns[theta] - mirrored(phi)) < 1e-9;
        for (phi, pose) in poses(trajectory) {
            let expected = if is_mirrored {
                mirrored(phi)
            } else {
                exact(phi)
            };
            let error = turned(pose.unknowns[theta] - expected);
            let bound = if (0.5 * phi).sin().abs() < 1e-6 {
                1e-6
            } else {
                1e-10
            };
            assert!(error < bound, "{phi}: {error:e}");
        }
    });
}

/// Ends of poses and where they resume, for short rods; the branch stays the one with the larger stroke.
#[test]
fn a_short_rod_has_feasible_intervals_located_from_both_sides() {
    for l in [60.0, 79.0, 5.0] {
        let limit = (l / 80.0_f64).asin();
        let text = l.to_string();
        let h = (80.0 + l).to_string();
        let size = [("param", "L", text.as_str()), ("guess", "h", h.as_str())];
        two_turns(
            "h10-rod-too-short",
            &size,
            "phi",
            (0.0, 360.0),
            |m, trajectory| {
                let sides = [limit, PI - limit, PI + limit, TAU - limit];
                let off = |input: f64| {
                    let offs = sides.iter().map(|s| turned(input - s));
                    offs.fold(PI, f64::min)
                };
                let label = format!("{l}, {} samples", trajectory.samples.len());
                // Feasible stretches that no sample falls into are not found.
                if l < 20.0 && !(300..1000).contains(&trajectory.samples.len()) {
                    return;
                }
                assert_eq!(trajectory.gaps.len(), 4, "{label}: {:?}", trajectory.gaps);
                for gap in &trajectory.gaps {
                    for end in [&gap.from, &gap.until] {
                        let off = off(end.as_ref().unwrap().inputs[0]);
                        assert!(off < 1e-9, "{label}: {off:e}");
                    }
                }
                for sample in &trajectory.samples {
                    let phi = sample.inputs[0];
                    let reaches = (80.0 * phi.sin()).abs() <= l;
                    assert_eq!(sample.pose.is_some(), reaches, "{label} {phi}");
                }
                let h = slot(m, "h");
                for (phi, pose) in poses(trajectory) {
                    let (r, y) = (80.0 * phi.cos(), 80.0 * phi.sin());
                    let w = ((l - y) * (l + y)).sqrt();
                    let error = (pose.unknowns[h] - (r + w)).abs();
                    assert!(error < 1e-8, "{label} {phi}: {error:e}");
                }
            },
        );
    }
}

#[test]
fn how_much_is_lacking_is_said_where_it_is_most() {
    let mechanism = hard("h10-rod-too-short", &[]);
    let trajectory = solve(&mechanism, &even_times(&mechanism, 72)).unwrap();
    for l in ["60", "5", "1", "30"] {
        for phi in ["90", "120", "-60", "271"] {
            let changes = [("param", "L", l), ("input", "phi", phi)];
            let short = hard("h10-rod-too-short", &changes);
            let trajectory = solve(&short, &[0.0]).unwrap();
            let (phi, l): (f64, f64) = (phi.parse().unwrap(), l.parse().unwrap());
            let exact = (80.0 * phi.to_radians().sin()).abs() - l;
            let lack = trajectory.gaps[0].widest.as_ref().unwrap();
            let error = (lack.distance - exact).abs();
            assert!(error < 1e-6 * exact, "{l} {phi}: {lack:?} {exact}");
        }
    }
    for (gap, place) in trajectory.gaps.iter().zip([90.0_f64, 270.0]) {
        let widest = gap.widest.as_ref().unwrap();
        assert!((widest.distance - 20.0).abs() < 1e-6, "{widest:?}");
        assert!((widest.at.inputs[0] - place.to_radians()).abs() < 1e-12);
        assert_eq!(widest.name, "A");
    }
    let never = hard("h10-four-bar-too-short", &[]);
    let trajectory = solve(&never, &even_times(&never, 36)).unwrap();
    assert_eq!(trajectory.poses().count(), 0);
    let [gap] = &trajectory.gaps[..] else {
        panic!("{:?}", trajectory.gaps)
    };
    assert!(gap.from.is_none() && gap.until.is_none());
    assert!((gap.widest.as_ref().unwrap().distance - 110.0).abs() < 1e-5);
}

#[test]
fn a_drive_that_begins_without_a_pose_says_where_poses_begin() {
    let drive = [("input", "phi", "90 + 80*t")];
    for samples in [3, 40, 500] {
        let mut mechanism = hard("h10-rod-too-short", &drive);
        mechanism.actuation.duration = 1.0;
        let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
        let [gap] = &trajectory.gaps[..] else {
            panic!("{:?}", trajectory.gaps)
        };
        let begins = gap.until.as_ref().unwrap().inputs[0];
        assert!(gap.from.is_none());
        assert!((begins - (PI - 0.75_f64.asin())).abs() < 1e-9, "{begins}");
    }
}

#[test]
fn an_input_without_a_pose_is_told_which_values_have_one() {
    for (phi, l) in [("90", "60"), ("-95", "79"), ("450", "30")] {
        let changes = [("input", "phi", phi), ("param", "L", l)];
        let mechanism = hard("h10-rod-too-short", &changes);
        let [feasible] = &feasible_inputs(&mechanism)[..] else {
            panic!("one input")
        };
        let limit = (l.parse::<f64>().unwrap() / 80.0).asin();
        let ends: Vec<f64> = feasible.stretches.iter().flatten().copied().collect();
        // From half a turn before the value to half a turn behind it there are two stretches.
        assert_eq!(ends.len(), 4, "{feasible:?}");
        for end in ends {
            let off = [limit, -limit, PI - limit, PI + limit].map(|side| turned(end - side));
            assert!(off.into_iter().fold(PI, f64::min) < 1e-9, "{phi} {end}");
        }
    }
    assert!(feasible_inputs(&hard("h10-four-bar-too-short", &[])).is_empty());
}

#[test]
fn a_driven_slider_stops_at_its_dead_points() {
    let mechanism = hard("h02-slider-drives", &[]);
    for samples in [4, 12, 37, 360, 3601] {
        let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
        let ends = inputs_of(
            &trajectory,
            &EventKind::MotionEnds(Ending::Fold {
                proved: true,
                asked: true,
            }),
        );
        assert_eq!(ends.len(), 2, "{samples}: {ends:?}");
        for (end, limit) in ends.iter().zip([120.0, 40.0]) {
            assert!((end - limit).abs() < 1e-7, "{samples}: {end}");
        }
        let starts_up = 1.0;
        for (h, pose) in poses(&trajectory) {
            let phi = pose.unknowns[slot(&mechanism, "phi")];
            let cosine = (h * h + 1600.0 - 6400.0) / (80.0 * h);
            let error = turned(phi - starts_up * cosine.acos());
            assert!(error < 1e-9, "{samples} {h}: {error:e}");
        }
    }
}

#[test]
fn over_constrained_loops_move_with_their_true_rank() {
    type Exact = fn(f64) -> f64;
    let cases: [(&str, &str, &str, Exact, usize); 4] = [
        (
            "h11-bennett",
            "t2",
            "0.3 + 2.5*t/4",
            |t1| 2.0 * ((1.0 + 3f64.sqrt()) / (0.5 * t1).tan()).atan(),
            3,
        ),
        (
            "h13-bricard",
            "t2",
            "80 + 20*t/4",
            |t1| (-t1.cos() / (1.0 + t1.cos())).acos(),
            5,
        ),
        ("h15-sarrus", "u", "20 + 60*t/4", |t1| t1, 5),
        (
            "h16-dixon",
            "v1",
            "20 + 25*t/4",
            |p1: f64| (1600.0 - (p1 * p1 - 900.0)).sqrt(),
            12,
        ),
    ];
    for (scene, name, drive, exact, rank) in cases {
        let input = hard(scene, &[]).inputs[0].name.clone();
        let drives = [("input", input.as_str(), drive)];
        let changes = if scene == "h13-bricard" {
            &[]
        } else {
            &drives[..]
        };
        let mechanism = hard(scene, changes);
        for samples in [5, 41, 401] {
            let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
            assert_eq!(trajectory.missing(), 0, "{scene}: {:?}", trajectory.events);
            for (input, pose) in poses(&trajectory) {
                let value = pose.unknowns[slot(&mechanism, name)];
                let error = (value - exact(input)).abs() / exact(input).abs().max(1.0);
                assert!(error < 1e-11, "{scene} {input}: {value} {error:e}");
                assert_eq!(pose.rank, rank, "{scene} {input}");
            }
        }
    }
}

#[test]
fn the_plate_of_sarrus_rises_straight() {
    let mechanism = hard("h15-sarrus", &[]);
    let trajectory = solve(&mechanism, &even_times(&mechanism, 41)).unwrap();
    for (t1, pose) in poses(&trajectory) {
        let plate = pose.traces[0];
        let error = (plate.z - 100.0 * t1.sin()).abs();
        assert!(
            error < 1e-11 && plate.x.abs() < 1e-11 && plate.y.abs() < 1e-11,
            "{plate}"
        );
        let q = pose.unknowns[slot(&mechanism, "q")];
        assert!((q - 2.0 * t1).abs() < 1e-11);
    }
    assert!((poses(&trajectory)[0].1.traces[0].z - 57.3576436351046).abs() < 1e-11);
}

#[test]
fn all_bars_of_dixons_linkage_keep_their_points_on_two_lines() {
    let mechanism = hard("h16-dixon", &[]);
    let trajectory = solve(&mechanism, &even_times(&mechanism, 81)).unwrap();
    for (p1, pose) in poses(&trajectory) {
        let s = p1 * p1 - 900.0;
        let root = |sign: f64, square: f64| sign * square.sqrt();
        let expected = [
            ("p2", root(-1.0, 2500.0 + s)),
            ("p3", root(1.0, 4900.0 + s)),
            ("p4", root(-1.0, 8100.0 + s)),
            ("v2", root(-1.0, 3600.0 - s)),
            ("v3", root(1.0, 6400.0 - s)),
            ("v4", root(-1.0, 10000.0 - s)),
            ("u3", 0.0),
            ("r4", 0.0),
        ];
        for (name, expected) in expected {
            let error = (pose.unknowns[slot(&mechanism, name)] - expected).abs();
            assert!(error < 1e-11, "{name} at {p1}: {error:e}");
        }
    }
}
