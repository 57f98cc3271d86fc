//! Ball joints written as three rotations, at and next to poses where their angles are locked: the position is exact,
//! the motion goes on smoothly, the place is named, and the rotation is proved there, not the single angles.

use crate::driven::{Model, even_times, solve};
use mechanim::diag::Source;
use mechanim::kinematics::results::certificate::Certificate;

use mechanim::kinematics::results::trajectory::{ClosedPose, EventKind, Trajectory};

use mechanim::model::mechanism::Mechanism;
use mechanim::scene::{Overrides, load_scene};
use std::f64::consts::FRAC_PI_2;

fn read(text: &str) -> Model {
    let source = Source {
        name: "test".into(),
        text: text.into(),
    };
    let scene = load_scene(&source, &Overrides::default());
    Model::from(scene.unwrap_or_else(|e| panic!("{:#?}", e.diagnostics)))
}

/// A body in a ball joint that is turned by three driven rotations: the joint's angles are the driven ones.
fn driven(inputs: &str, guess: &str) -> Model {
    read(&format!(
        "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n[inputs]\n{inputs}\n[loops]\n\
         A = \"Rx(a) Ry(b) Rz(c) Rz(-w) Ry(-v) Rx(-u)\"\n[guess]\n{guess}\n\
         [[bodies]]\nname = \"hand\"\nframe = \"Rx(a) Ry(b) Rz(c)\"\n\
         [[traces]]\nname = \"P\"\nbody = \"hand\"\npoint = [10, 20, 30]\n"
    ))
}

fn unknown(mechanism: &Mechanism, pose: &ClosedPose, name: &str) -> f64 {
    let index = mechanism.unknowns.iter().position(|u| u.name == name);
    pose.unknowns[index.unwrap()]
}

/// Distances of the locked poses that were reported, with the value of the first moving input.
fn locks(trajectory: &Trajectory, input: usize) -> Vec<(f64, f64)> {
    let found = trajectory.events.iter().map(|event| match &event.kind {
        EventKind::GimbalLock { distance, .. } => (event.inputs[input], *distance),
        other => panic!("{other:?}"),
    });
    found.collect()
}

fn assert_closed(mechanism: &Mechanism, trajectory: &Trajectory) {
    assert_eq!(trajectory.missing(), 0, "{:?}", trajectory.events);
    for pose in trajectory.poses() {
        assert!(pose.closure_error < 2e-14, "{:e}", pose.closure_error);
        assert_eq!(pose.rank, mechanism.unknowns.len());
        assert!(pose.sigma_min > 0.05, "{}", pose.sigma_min);
        assert!(pose.condition < 100.0);
    }
}

#[test]
fn a_locked_rotation_is_right_where_only_a_sum_of_angles_is_determined() {
    // Rx(30) Ry(90) Rz(20): any a + c = 50 degrees. From three starts, one of them locked itself.
    for guess in [
        "a = 20\nb = 70\nc = 10",
        "a = 0\nb = 90\nc = 0",
        "a = 100\nb = 20\nc = -80",
    ] {
        let mechanism = driven("u = 30\nv = 90\nw = 20", guess);
        let trajectory = solve(&mechanism, &[0.0]).unwrap();
        assert_closed(&mechanism, &trajectory);
        let pose = trajectory.poses().next().unwrap();
        let of = |name| unknown(&mechanism, pose, name);
        assert!((of("b").sin() - 1.0).abs() < 1e-15);
        let sum = of("a") + of("c") - 50f64.to_radians();
        let sum = if of("b").cos() < -0.5 {
            panic!("{guess}")
        } else {
            sum
        };
        assert!(
            (sum - (sum / std::f64::consts::TAU).round() * std::f64::consts::TAU).abs() < 1e-14
        );
        let (sin, cos) = 50f64.to_radians().sin_cos();
        let rows = [[0.0, 0.0, 1.0], [sin, cos, 0.0], [-cos, sin, 0.0]];
        let rotation = pose.bodies[0].rotation;
        for (i, row) in rows.iter().enumerate() {
            for (j, entry) in row.iter().enumerate() {
                assert!((rotation.col(j)[i] - entry).abs() < 1e-15);
            }
        }
        // Its rotation is proved, its single angles are not.
        let Certificate::Locked {
            error_bound,
            unique_radius,
            ..
        } = pose.certificate
        else {
            panic!("{:?}", pose.certificate)
        };
        assert!(error_bound < 1e-13 && unique_radius > 1e-3);
        let found = locks(&trajectory, 0);
        assert!(found.len() == 1 && found[0].1 < 1e-14, "{found:?}");
    }
}

#[test]
fn a_locked_pose_is_passed_on_the_smooth_branch_and_located() {
    // v runs through 90 degrees at several places between and on samples; the angles go straight on.
    for (drive, samples) in [
        ("60 + 15*t", 41),
        ("60 + 15*t", 40),
        ("89.9 + 0.05*t", 7),
        ("20 + 35*t", 5),
    ] {
        let mechanism = driven(
            &format!("u = \"30 + 5*t\"\nv = \"{drive}\"\nw = \"20 - 3*t\""),
            "a = 30\nb = 60\nc = 20",
        );
        let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
        assert_closed(&mechanism, &trajectory);
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let exactly = (sample.inputs[1] - FRAC_PI_2).abs() < 1e-13;
            let sum = unknown(&mechanism, pose, "a") + unknown(&mechanism, pose, "c");
            assert!((sum - sample.inputs[0] - sample.inputs[2]).abs() < 1e-12 || !exactly);
            for (name, value) in ["a", "b", "c"].iter().zip(&sample.inputs) {
                let error = (unknown(&mechanism, pose, name) - value).abs();
                let near = (sample.inputs[1] - FRAC_PI_2).abs();
                // At the locked pose itself the single angles are those of the motion so far, carried on.
                let allowed = if exactly {
                    2e-2
                } else {
                    1e-14 / near.min(1.0) + 1e-14
                };
                assert!(error < allowed, "{drive}: {name} off by {error:e}");
            }
        }
        let found = locks(&trajectory, 1);
        assert_eq!(found.len(), 1, "{drive}: {found:?}");
        assert!(
            (found[0].0 - FRAC_PI_2).abs() < 1e-9 && found[0].1 < 1e-9,
            "{found:?}"
        );
        let branches: Vec<&str> = trajectory.poses().map(|p| p.branch.as_str()).collect();
        assert!(branches.iter().all(|b| *b == branches[0]), "{branches:?}");
    }
}

#[test]
fn a_near_miss_keeps_the_position_and_says_how_near_it_was() {
    // The driven order of axes is another one: the ball's own angles only come near to their lock.
    for miss in [1e-2_f64, 5e-4, 1e-6] {
        let mechanism = read(&format!(
            "duration = 2\n[inputs]\nv = \"1 + t\"\n[loops]\n\
             A = \"Rx(a) Ry(b) Rz(c) Rx({miss}) Ry(-v)\"\n[guess]\nb = 1\n\
             [[bodies]]\nname = \"hand\"\nframe = \"Rx(a) Ry(b) Rz(c)\"\n\
             [[traces]]\nname = \"P\"\nbody = \"hand\"\npoint = [1, 2, 3]\n"
        ));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 33)).unwrap();
        assert_closed(&mechanism, &trajectory);
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let (sin, cos) = sample.inputs[0].sin_cos();
            let (s, c) = miss.sin_cos();
            // Ry(v) Rx(-miss) applied to (1, 2, 3).
            let (y, z) = (2.0 * c + 3.0 * s, 3.0 * c - 2.0 * s);
            let truth = glam::DVec3::new(cos + z * sin, y, z * cos - sin);
            assert!((pose.traces[0] - truth).length() < 2e-14);
        }
        let found = locks(&trajectory, 0);
        if miss > 1e-3 {
            assert!(found.is_empty(), "{found:?}");
            continue;
        }
        assert_eq!(found.len(), 1, "{miss}: {found:?}");
        assert!((found[0].0 - FRAC_PI_2).abs() < 1e-7, "{found:?}");
        assert!((found[0].1 - miss.sin()).abs() < 1e-3 * miss, "{found:?}");
    }
}

#[test]
fn a_linkage_with_a_ball_joint_moves_through_its_lock_as_with_other_angles() {
    // A rod on a slider and on a crank, its ball joint written in two orders of angles: only one of them locks.
    let scene = |ball: &str| {
        read(&format!(
            "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
             A = \"Rz(phi) Tx(30) {ball} Tx(100) Ry(d) Rz(e) T(-40, -20, 0) Tx(-s)\"\n\
             [guess]\ns = 60\n[[bodies]]\nname = \"rod\"\nframe = \"Rz(phi) Tx(30) {ball}\"\n\
             [[traces]]\nname = \"P\"\nbody = \"rod\"\npoint = [50, 7, 3]\n"
        ))
    };
    let (free, locking) = (scene("Rz(a) Ry(b) Rx(c)"), scene("Ry(a) Rz(b) Rx(c)"));
    let times = even_times(&free, 60);
    let (a, b) = (
        solve(&free, &times).unwrap(),
        solve(&locking, &times).unwrap(),
    );
    assert_eq!((a.missing(), b.missing()), (0, 0));
    for (a, b) in a.poses().zip(b.poses()) {
        assert!((a.traces[0] - b.traces[0]).length() < 1e-11);
        assert!(b.closure_error < 1e-14);
        assert!((a.branch.len(), a.rank) == (b.branch.len(), b.rank));
    }
    let is_lock = |e: &&mechanim::kinematics::results::trajectory::Event| {
        matches!(e.kind, EventKind::GimbalLock { .. })
    };
    assert_eq!(a.events.iter().filter(is_lock).count(), 0);
    assert!(
        b.events.iter().filter(is_lock).count() > 0,
        "{:?}",
        b.events
    );
}

#[test]
fn constants_between_the_rotations_make_no_difference_where_the_axes_meet_at_right_angles() {
    // The rotations, the same driven, and the value of v at which they are locked.
    for (own, driven, locked) in [
        (
            "Rz(a) Rx(90) Rz(b) Rx(-90) Rz(c)",
            "Rz(-w) Rx(90) Rz(-v) Rx(-90) Rz(-u)",
            0.0,
        ),
        (
            "Rx(a) Rx(10) Ry(b) Ry(-5) Rz(c)",
            "Rz(-w) Ry(-v) Rx(-u)",
            90.0,
        ),
        (
            "Rx(a) Ry(90) Rx(b) Rz(c)",
            "Rz(-w) Rx(-v) Ry(-90) Rx(-u)",
            0.0,
        ),
        (
            "Rx(a) Tx(5) Ry(b) Tz(7) Rz(c)",
            "Rz(-w) Tz(-7) Ry(-v) Tx(-5) Rx(-u)",
            90.0,
        ),
        ("Rx(-a) Ry(b) Rz(2*c)", "Rz(-w) Ry(-v) Rx(-u)", 90.0),
    ] {
        let mechanism = read(&format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n[inputs]\nu = \"30 + 5*t\"\n\
             v = \"{locked} - 30 + 15*t\"\nw = \"20 - 3*t\"\n[loops]\nA = \"{own} {driven}\"\n[guess]\n\
             b = {}\n",
            locked - 30.0
        ));
        for samples in [41, 40] {
            let trajectory = solve(&mechanism, &even_times(&mechanism, samples)).unwrap();
            assert_closed(&mechanism, &trajectory);
            for pose in trajectory.poses() {
                let proved = !matches!(pose.certificate, Certificate::Refused { .. });
                assert!(proved, "{own}: {:?}", pose.certificate);
            }
            let found = locks(&trajectory, 1);
            assert_eq!(found.len(), 1, "{own}: {found:?}");
            let error = found[0].0 - f64::to_radians(locked);
            assert!(error.abs() < 1e-9, "{own}: {error:e}");
            let branches: Vec<&str> = trajectory.poses().map(|p| p.branch.as_str()).collect();
            assert!(branches.iter().all(|b| *b == branches[0]), "{branches:?}");
        }
    }
}

#[test]
fn three_rotations_about_skew_or_oblique_axes_are_no_ball_joint() {
    // They end, or meet their other assembly, where the three axes lie in one plane: that is a singular pose.
    for (own, driven) in [
        ("Rx(a) Rz(30) Ry(b) Rz(c)", "Rz(-w) Ry(-v) Rz(-30) Rx(-u)"),
        (
            "Rx(a) Ry(60) Rx(b) Ry(60) Rx(c)",
            "Rx(-w) Ry(-60) Rx(-v) Ry(-60) Rx(-u)",
        ),
    ] {
        let mechanism = read(&format!(
            "units = {{ length = \"mm\", angle = \"deg\" }}\nduration = 4\n[inputs]\nu = 10\nv = \"60 + 40*t\"\n\
             w = 20\n[loops]\nA = \"{own} {driven}\"\n[guess]\na = 10\nb = 60\nc = 20\n"
        ));
        let trajectory = solve(&mechanism, &even_times(&mechanism, 40)).unwrap();
        assert_eq!(trajectory.missing(), 0);
        let kinds: Vec<&EventKind> = trajectory.events.iter().map(|e| &e.kind).collect();
        assert_eq!(kinds, [&EventKind::SingularPosePassed], "{own}");
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let error = unknown(&mechanism, pose, "b") - sample.inputs[1];
            assert!(error.abs() < 1e-7, "{own}: {error:e}");
        }
    }
}
