//! What the engine says where a motion ends, resumes, or passes a singular pose; never a stretched link.

use crate::driven::{even_times, frame_times, solve};
use mechanim::diag::Source;

use mechanim::kinematics::motion::sampling::frame_rate;
use mechanim::kinematics::results::trajectory::{Ending, EventKind, Trajectory};
use mechanim::kinematics::structure::block::StructureError;
use mechanim::scene::{Overrides, Scene, load_scene};

fn scene(text: &str) -> Scene {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    load_scene(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics))
}

fn slider_crank(r: f64, l: f64) -> Scene {
    scene(&format!(
        "duration = 4\n[parameters]\nr = {r}\nL = {l}\n[inputs]\nphi = \"2*pi*t/4\"\n\
         [loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)\"\n[guess]\nh = {}\n",
        r + l
    ))
}

/// Time per sample, or the events on failure.
fn run(scene: &Scene, samples: usize) -> Trajectory {
    solve(scene, &even_times(scene, samples)).unwrap()
}

fn assert_all_closed(trajectory: &Trajectory) {
    for pose in trajectory.poses() {
        assert!(pose.closure_error < 1e-12, "{}", pose.closure_error);
        assert!(pose.unknowns.iter().all(|v| v.is_finite()));
    }
}

#[test]
fn end_of_the_motion_is_located_and_frames_beyond_have_no_pose() {
    // sin phi <= L/r = 0.75.
    let limit = 0.75f64.asin();
    let trajectory = run(&slider_crank(80.0, 60.0), 80);
    assert_all_closed(&trajectory);
    let ends: Vec<f64> = trajectory
        .events
        .iter()
        .filter(|e| {
            e.kind
                == EventKind::MotionEnds(Ending::Fold {
                    proved: true,
                    asked: true,
                })
        })
        .map(|e| e.inputs[0])
        .collect();
    assert_eq!(ends.len(), 2);
    assert!((ends[0] - limit).abs() < 1e-9, "{}", ends[0] - limit);
    assert!((ends[1] - (limit + std::f64::consts::PI)).abs() < 1e-9);
    for sample in &trajectory.samples {
        let feasible = sample.inputs[0].sin().abs() <= 0.75;
        assert_eq!(
            sample.pose.is_some(),
            feasible,
            "phi = {}",
            sample.inputs[0]
        );
    }
}

#[test]
fn motion_that_starts_without_a_pose_resumes_when_there_is_one() {
    // The lifting arm: a real triangle only for t in [0.1575, 0.8425].
    let arm = scene(
        "duration = 1\n[parameters]\na = 1\nb = 2\nh = 0.5\nL = 2\n[inputs]\nl = \"4*L*t*(1-t)\"\n\
         [equations]\ntriangle = \"(a*cos(phi)-b)^2 + (a*sin(phi)+h)^2 - l^2\"\n[guess]\nphi = 1\n",
    );
    let times: Vec<f64> = (0..=100)
        .map(|k| 0.1 + 0.9 * f64::from(k) / 100.0)
        .collect();
    let trajectory = solve(&arm, &times).unwrap();
    assert_eq!(
        trajectory.missing(),
        25,
        "of the 101 samples of the source 25 are impossible"
    );
    let (a, b, h): (f64, f64, f64) = (1.0, 2.0, 0.5);
    for sample in trajectory.samples.iter().filter(|s| s.pose.is_some()) {
        let (l, d) = (sample.inputs[0], b.hypot(h));
        let phi = -h.atan2(b) + ((a * a + d * d - l * l) / (2.0 * a * d)).acos();
        let error = sample.pose.as_ref().unwrap().unknowns[0] - phi;
        assert!(
            error.abs() < 1e-12 / (0.01 + phi.abs()),
            "t = {}: {error:e}",
            sample.time
        );
    }
}

#[test]
fn change_point_is_passed_on_the_smooth_branch_and_said() {
    let scene = slider_crank(80.0, 80.0);
    for samples in [80, 77] {
        let trajectory = run(&scene, samples);
        assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
        assert_all_closed(&trajectory);
        for sample in &trajectory.samples {
            let pose = sample.pose.as_ref().unwrap();
            let error = pose.unknowns[2] - 160.0 * sample.inputs[0].cos();
            // On the singular pose itself two branches meet: position is known to the root of rounding only.
            let bound = if pose.sigma_min < 1e-6 { 1e-4 } else { 1e-9 };
            assert!(error.abs() < bound, "phi = {}: {error:e}", sample.inputs[0]);
        }
        let passed = trajectory
            .events
            .iter()
            .filter(|e| e.kind == EventKind::SingularPosePassed)
            .count();
        assert_eq!(passed, 2, "{:?}", trajectory.events);
    }
}

#[test]
fn mechanism_that_cannot_be_assembled_names_loop_and_gap() {
    // Sides 50, 60, 30 cannot reach over 150: 10 short, whatever the pose.
    let scene = scene(
        "[inputs]\nphi = 0.3\n[loops]\nquad = \"Rz(q) Tx(50) Rz(a) Tx(60) Rz(b) Tx(30) Rz(c) Tx(-150)\"\n\
         [equations]\nhold = \"q - phi\"\n",
    );
    let trajectory = solve(&scene, &[0.0]).unwrap();
    assert_eq!(trajectory.missing(), 1);
    let EventKind::StartNotClosed { name, distance, .. } = &trajectory.events[0].kind else {
        panic!("{:?}", trajectory.events)
    };
    assert_eq!(name, "quad");
    assert!(*distance >= 10.0, "{distance}");
}

#[test]
fn free_coordinates_are_named() {
    let scene = scene(
        "[inputs]\nphi = 0\n[loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(60) Rz(c) Tx(-h)\"\n[guess]\nh = 100\n",
    );
    let Err(StructureError::UnderDetermined { freedoms, names }) = solve(&scene, &[0.0]) else {
        panic!("one freedom too many must be refused")
    };
    assert_eq!(freedoms, 1);
    assert_eq!(names, ["a", "b", "c", "h"]);
}

#[test]
fn loop_with_a_constant_gap_is_impossible() {
    let scene = scene(
        "[inputs]\nphi = 0\n[loops]\nA = \"Rz(phi) Tx(40) Rz(a) Tx(80) Rz(b) Tx(-h) Tz(5)\"\n",
    );
    let Err(StructureError::Impossible {
        name, what, gap, ..
    }) = solve(&scene, &[0.0])
    else {
        panic!("an offset out of the plane can never close")
    };
    assert_eq!(
        (name.as_str(), what.as_str()),
        ("A", "the translation along z")
    );
    assert!((gap - 5.0).abs() < 1e-12);
}

#[test]
fn overconstrained_bennett_loop_moves() {
    // a = 1, alpha = 30 deg; b = sqrt 3, beta = 60 deg: tan(t1/2) tan(t2/2) = 1 + sqrt 3.
    let scene = scene(
        "units = { length = \"m\", angle = \"deg\" }\nduration = 4\n[parameters]\nb = \"sqrt(3)\"\n\
         [inputs]\nt1 = \"60 + 60*t/4\"\n[loops]\n\
         A = \"Rz(t1) Tx(1) Rx(30) Rz(t2) Tx(b) Rx(60) Rz(t3) Tx(1) Rx(30) Rz(t4) Tx(b) Rx(60)\"\n\
         [guess]\nt2 = 156\nt3 = -60\nt4 = -156\n",
    );
    let trajectory = run(&scene, 41);
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    for sample in &trajectory.samples {
        let t2 = 2.0 * ((1.0 + 3f64.sqrt()) / (0.5 * sample.inputs[0]).tan()).atan();
        let pose = sample.pose.as_ref().unwrap();
        assert!(
            (pose.unknowns[0] - t2).abs() < 1e-12,
            "{} {t2}",
            pose.unknowns[0]
        );
        assert!((pose.unknowns[1] + sample.inputs[0]).abs() < 1e-12);
        assert_eq!(pose.rank, 3);
    }
}

#[test]
fn size_of_the_mechanism_does_not_matter() {
    let iterations = |scale: f64| {
        let trajectory = run(&slider_crank(40.0 * scale, 80.0 * scale), 60);
        let h = trajectory
            .poses()
            .map(|p| p.unknowns[2] / scale)
            .collect::<Vec<_>>();
        (
            trajectory.poses().map(|p| p.iterations).collect::<Vec<_>>(),
            h,
        )
    };
    let (base, reference) = iterations(1.0);
    for scale in [1e-9, 1e6] {
        let (count, h) = iterations(scale);
        assert_eq!(count, base, "scale {scale}");
        for (a, b) in h.iter().zip(&reference) {
            assert!((a - b).abs() < 1e-13 * 120.0);
        }
    }
}

#[test]
fn many_turns_do_not_drift() {
    let mut scene = slider_crank(40.0, 80.0);
    scene.actuation.duration = 400.0;
    let times = frame_times(&scene, 10.0);
    let trajectory = solve(&scene, &times).unwrap();
    assert_eq!(trajectory.missing(), 0);
    for sample in &trajectory.samples {
        let phi = sample.inputs[0];
        let h = 40.0 * phi.cos() + (6400.0 - (40.0 * phi.sin()).powi(2)).sqrt();
        assert!(
            (sample.pose.as_ref().unwrap().unknowns[2] - h).abs() < 1e-11,
            "after {} turns",
            phi / std::f64::consts::TAU
        );
    }
}

/// `count` unknowns that are all plus or minus phi, in one block: at phi = 0 as many singular values pass zero at once.
fn meeting_branches(count: usize) -> Scene {
    let square = |k: usize| format!("(x{k}^2 - phi^2)");
    let equation = |k: usize| {
        let next = square((k + 1) % count);
        format!("e{k} = \"{} + 0.3*{next}\"\n", square(k))
    };
    let equations: String = (0..count).map(equation).collect();
    let guess: String = (0..count).map(|k| format!("x{k} = -2\n")).collect();
    scene(&format!(
        "duration = 4\n[inputs]\nphi = \"t - 2\"\n[equations]\n{equations}[guess]\n{guess}"
    ))
}

/// Where an even number of singular values passes zero no determinant changes its sign, wherever the samples are.
#[test]
fn a_change_point_that_no_sign_tells_is_an_event() {
    for count in [2, 3, 4] {
        let scene = meeting_branches(count);
        for samples in 2..=24 {
            let trajectory = run(&scene, samples);
            assert_eq!(trajectory.missing(), 0);
            let passed = trajectory.events.iter();
            let passed = passed.filter(|e| e.kind == EventKind::SingularPosePassed);
            let times: Vec<f64> = passed.map(|e| e.time).collect();
            assert!(
                matches!(times[..], [time] if (time - 2.0).abs() < 1e-4),
                "{count} {samples}: {:?}",
                trajectory.events
            );
            // Straight on: every unknown goes on through zero.
            for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
                let near = |x: &f64| (x - sample.inputs[0]).abs() < 1e-9;
                assert!(
                    pose.unknowns.iter().all(near),
                    "{count} {samples} {sample:?}"
                );
            }
        }
    }
}

/// Regular motions are not called singular, however few samples they have.
#[test]
fn regular_motions_pass_nothing_at_any_samples() {
    for samples in 2..=40 {
        let trajectory = run(&slider_crank(40.0, 60.0), samples);
        assert_eq!(trajectory.missing(), 0);
        assert!(trajectory.events.is_empty(), "{samples}");
    }
}

/// A motion with more frames than a table has rows is sampled to its end, in fewer of them.
#[test]
fn long_motions_are_sampled_to_their_end() {
    for duration in ["1", "40000", "400000", "3.1e7"] {
        let text = format!(
            "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = {duration}\n[inputs]\nq = \"t/3\"\n[outputs]\nw = \"q\"\n"
        );
        let scene = scene(&text);
        let end: f64 = duration.parse().unwrap();
        let times = frame_times(&scene, 20.0);
        assert_eq!((times[0], times[times.len() - 1]), (0.0, end));
        assert!(times.len() <= 1_000_000, "{}", times.len());
        let longest = times.windows(2).map(|w| w[1] - w[0]).fold(0.0, f64::max);
        assert!(
            longest <= 1.001 * f64::max(0.05, end / 999_999.0),
            "{longest}"
        );
        // A film of them plays as long as the motion.
        let plays = times.len() as f64 / frame_rate(&scene.actuation, 20.0);
        assert!((plays / end - 1.0).abs() < 0.1, "{plays}");
    }
}
