//! What a motion ends at, and what it does not end at: folds, proved; smooth singular poses, kinks, narrow swings and many
//! turns, through which it goes on; and the places where it is given up. Against closed forms.

use crate::driven::{Driven, Model, even_times, solve};
use crate::reference::scenes::written;
use crate::reference::{slot, turned};
use mechanim::kinematics::motion::continuation::solve_unproved;
use mechanim::kinematics::results::trajectory::{Ending, EventKind, Trajectory};
use std::f64::consts::FRAC_PI_2;

/// One equation in x, driven by phi over four seconds.
fn equation(phi: &str, equation: &str, guess: f64) -> Model {
    written(&format!(
        "duration = 4\n[inputs]\nphi = \"{phi}\"\n[equations]\ne = \"{equation}\"\n[guess]\nx = {guess}\n"
    ))
}

/// A case of the table: drive, equation, start value, solution, and how exact it is at the singular sample.
type Case = (&'static str, &'static str, f64, fn(f64) -> f64, f64);

fn signed_root(phi: f64) -> f64 {
    phi.signum() * phi.abs().sqrt()
}

#[test]
fn a_motion_goes_on_through_smooth_singular_poses_and_kinks() {
    let cases: [Case; 15] = [
        ("t - 2", "x^3 - phi", -1.2, f64::cbrt, 1e-7),
        ("2 - t", "x^3 - phi", 1.2, f64::cbrt, 1e-7),
        ("t", "x^3 - phi", 0.0, f64::cbrt, 1e-7),
        (
            "t - 2",
            "x^5 - phi",
            -1.2,
            |p| p.signum() * p.abs().powf(0.2),
            1e-3,
        ),
        ("t - 2", "x*abs(x) - phi", -1.4, signed_root, 1e-7),
        ("2 - t", "x*abs(x) - phi", 1.4, signed_root, 1e-7),
        ("t - 2", "x - sin(x) - phi", -2.0, |_| f64::NAN, 1e-4),
        ("t/2 - 1", "x - asin(phi)", -1.5, f64::asin, 1e-7),
        ("sin(2*pi*t/4)", "x - asin(phi)", 0.0, f64::asin, 1e-7),
        (
            "2*pi*t/4",
            "x - asin(sin(phi))",
            0.0,
            |p| p.sin().asin(),
            3e-7,
        ),
        (
            "2*pi*t/4",
            "x - acos(cos(phi))",
            0.0,
            |p| p.cos().acos(),
            3e-7,
        ),
        ("t/4", "x - sqrt(phi)", 0.0, f64::sqrt, 1e-7),
        (
            "t/2 - 1",
            "x - sqrt(1 - phi^2)",
            0.0,
            |p| (1.0 - p * p).sqrt(),
            1e-7,
        ),
        ("t - 2", "abs(x) - phi^2", 4.0, |p| p * p, 1e-7),
        ("t - 2", "x - abs(phi)", 2.0, f64::abs, 1e-7),
    ];
    for (drive, text, guess, solution, near) in cases {
        let model = equation(drive, text, guess);
        for samples in 3..=12 {
            let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
            let label = format!("{text} along {drive}, {samples} samples");
            assert_eq!(trajectory.missing(), 0, "{label}: {:?}", trajectory.events);
            assert!(trajectory.gaps.is_empty(), "{label}: {:?}", trajectory.gaps);
            for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
                let (phi, x) = (sample.inputs[0], pose.unknowns[0]);
                let expected = solution(phi);
                // Kepler's equation has no closed form: the residual stands for it.
                let error = match expected.is_nan() {
                    true => x - x.sin() - phi,
                    false => x - expected,
                };
                let allowed = if pose.sigma_min < 1e-4 { near } else { 1e-7 };
                assert!(error.abs() < allowed, "{label}: {phi} {x} {error:e}");
            }
        }
    }
}

#[test]
fn an_inflection_is_passed_and_does_not_turn_the_drive_back() {
    let model = equation("t - 2", "x^3 - phi", -1.2);
    for samples in [3, 5, 11] {
        let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
        let kinds: Vec<&EventKind> = trajectory.events.iter().map(|e| &e.kind).collect();
        assert_eq!(kinds, [&EventKind::SingularPosePassed], "{samples}");
        assert!((trajectory.events[0].time - 2.0).abs() < 1e-6);
    }
}

/// A Bennett ring with twists of 30 degrees and a little more, from `start` on; and the factor of its half angles.
fn ring(more: f64, start: f64) -> (Model, f64) {
    let (x, y) = (f64::to_radians(30.0), f64::to_radians(30.0 + more));
    let b = y.sin() / x.sin();
    let factor = ((y + x) / 2.0).sin() / ((y - x) / 2.0).sin();
    let t2 = 2.0 * (factor / (start / 2.0).tan()).atan();
    let model = written(&format!(
        "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 4\n[inputs]\nt1 = \"{start} + 2*pi*t/4\"\n[loops]\n\
         A = \"Rz(t1) Tx(1) Rx({x:?}) Rz(t2) Tx({b:?}) Rx({y:?}) Rz(t3) Tx(1) Rx({x:?}) Rz(t4) Tx({b:?}) Rx({y:?})\"\n\
         [guess]\nt2 = {t2:?}\nt3 = {:?}\nt4 = {:?}\n",
        -start, -t2
    ));
    (model, factor)
}

#[test]
fn a_ring_with_nearly_equal_twists_is_followed_through_its_swing_from_any_start() {
    for more in [1e-1, 1e-2, 5e-3, 1e-3] {
        for start in [0.3, 1.0, 2.0, 3.0, 3.13, 4.0, 5.5] {
            let (model, factor) = ring(more, start);
            for samples in [20, 81] {
                let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
                assert_eq!(trajectory.missing(), 0, "{more} {start} {samples}");
                assert_eq!(trajectory.events, [], "{more} {start} {samples}");
                assert!(trajectory.gaps.is_empty());
                let t2 = slot(&model, "t2");
                let mut last: Option<f64> = None;
                for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
                    let half = (sample.inputs[0] / 2.0).tan();
                    let error = turned(pose.unknowns[t2] - 2.0 * (factor / half).atan());
                    assert!(error.abs() < 1e-9, "{more} {start}: {error:e}");
                    // It only ever turns backwards: no turn is lost.
                    let is_later = last.is_none_or(|last| pose.unknowns[t2] < last);
                    assert!(is_later, "{more} {start} {}", sample.time);
                    last = Some(pose.unknowns[t2]);
                }
            }
        }
    }
}

/// The engine's own rounding of the angle: half a spacing of each of two.
fn spacing(angle: f64) -> f64 {
    2.0 * f64::EPSILON * angle.abs() + 1e-12
}

#[test]
fn a_crank_keeps_its_poses_and_its_turns_after_a_hundred_thousand_turns() {
    for radians in [1e3, 2e5] {
        let model = written(&format!(
            "units = {{ length = \"mm\", angle = \"rad\" }}\nduration = 4\n[inputs]\nphi = \"{radians:?}*t/4\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\n"
        ));
        let trajectory = solve(&model, &even_times(&model, 11)).unwrap();
        assert_eq!(
            (trajectory.missing(), trajectory.gaps.len()),
            (0, 0),
            "{radians}"
        );
        for (sample, pose) in trajectory.samples.iter().zip(trajectory.poses()) {
            let phi = sample.inputs[0];
            let [alpha, h] = ["alpha", "h"].map(|name| pose.unknowns[slot(&model, name)]);
            let swing = -(0.5 * phi.sin()).asin();
            assert!(
                (phi + alpha - swing).abs() < 2.0 * spacing(phi),
                "{phi} {alpha}"
            );
            let expected = 40.0 * phi.cos() + 80.0 * swing.cos();
            assert!((h - expected).abs() < 160.0 * spacing(phi), "{phi} {h}");
        }
    }
}

/// More turns from one row to the next than are followed: nothing is said of the way, and the rows that are found are poses.
#[test]
fn a_crank_that_turns_too_often_between_two_rows_is_undecided() {
    let model = written(
        "units = { length = \"mm\", angle = \"rad\" }\nduration = 4\n[inputs]\nphi = \"1e12*t/4\"\n[loops]\n\
         A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\n",
    );
    let trajectory = solve(&model, &even_times(&model, 3)).unwrap();
    assert!(!trajectory.is_whole() && trajectory.is_undecided());
    for (sample, pose) in trajectory
        .samples
        .iter()
        .filter_map(|s| Some((s, s.pose.as_ref()?)))
    {
        let phi = sample.inputs[0];
        let h = pose.unknowns[slot(&model, "h")];
        let along = 80.0 * (0.5 * phi.sin()).asin().cos();
        let off = (h - 40.0 * phi.cos()).abs() - along;
        assert!(off.abs() < 1e-9, "{phi} {h}");
    }
}

#[test]
fn angles_too_large_to_close_a_loop_are_called_so() {
    let model = written(
        "units = { length = \"mm\", angle = \"rad\" }\nduration = 1\n[inputs]\nphi = \"0.3*t\"\n[loops]\n\
         A = \"Rz(phi) Tx(40) Rz(1.7*alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 120\nalpha = 3e13\n",
    );
    let trajectory = solve(&model, &[0.0, 0.5, 1.0]).unwrap();
    assert_eq!(trajectory.missing(), 3);
    let [gap] = &trajectory.gaps[..] else {
        panic!("{:?}", trajectory.gaps)
    };
    assert_eq!(gap.ending, Some(Ending::AngleTooLarge));
    assert!(gap.is_undecided());
}

fn rod_too_short(excess: f64) -> Model {
    written(&format!(
        "duration = 4\n[parameters]\nL = 80\nr = \"L*(1 + {excess})\"\n[inputs]\nphi = \"2*pi*t/4\"\n[loops]\n\
         A = \"Rz(phi) Tx(r) Rz(a) Tx(L) Rz(b) Tx(-h)\"\n[guess]\nh = 160\n"
    ))
}

fn endings(trajectory: &Trajectory) -> Vec<(f64, Ending)> {
    let ends = trajectory.events.iter().filter_map(|e| match &e.kind {
        EventKind::MotionEnds(ending) => Some((e.inputs[0], ending.clone())),
        _ => None,
    });
    ends.collect()
}

#[test]
fn folds_are_located_and_proved() {
    for excess in [0.5, 1e-2, 1e-4, 1e-6, 1e-8] {
        let model = rod_too_short(excess);
        let half = (excess * (2.0 + excess)).sqrt().atan();
        for samples in [12, 80, 361] {
            let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
            let proved = Ending::Fold {
                proved: true,
                asked: true,
            };
            assert_eq!(trajectory.gaps.len(), 2, "{excess} {samples}");
            for (gap, middle) in trajectory.gaps.iter().zip([FRAC_PI_2, 3.0 * FRAC_PI_2]) {
                let label = format!("{excess} {samples}: {gap:?}");
                assert_eq!(gap.ending.as_ref(), Some(&proved), "{label}");
                assert_eq!(gap.beginning.as_ref(), Some(&proved), "{label}");
                let ends = [&gap.from, &gap.until].map(|at| at.as_ref().unwrap().inputs[0]);
                for (end, side) in ends.iter().zip([-half, half]) {
                    let error = end - (middle + side);
                    assert!(error.abs() < 1e-9 + 1e-12 / half, "{label}: {error:e}");
                }
            }
        }
    }
}

#[test]
fn folds_of_the_narrowest_gaps_are_folds() {
    for excess in [1e-9, 1e-10] {
        let model = rod_too_short(excess);
        let trajectory = solve(&model, &even_times(&model, 80)).unwrap();
        let ends = endings(&trajectory);
        assert_eq!(ends.len(), 2);
        for (_, ending) in ends {
            // A gap of a hundred-thousandth of a radian is at the limit: rounding decides whether its ends are told from a passage.
            let is_undecided = matches!(ending, Ending::GivenUp { .. }) && excess < 1e-9;
            assert!(
                matches!(ending, Ending::Fold { .. }) || is_undecided,
                "{excess}: {ending:?}"
            );
        }
    }
}

#[test]
fn nothing_is_called_proved_that_nobody_proved() {
    // No certificates are asked for; two inputs move at once.
    let model = rod_too_short(0.1);
    let times = even_times(&model, 80);
    let unproved = solve_unproved(&model.system().unwrap(), model.actuation(), &times);
    let both = written(
        "duration = 4\n[inputs]\nphi = \"2*pi*t/4\"\nr = \"88 + t/100\"\n[loops]\n\
         A = \"Rz(phi) Tx(r) Rz(a) Tx(80) Rz(b) Tx(-h)\"\n[guess]\nh = 168\n",
    );
    for (asked, trajectory) in [(false, unproved), (true, solve(&both, &times).unwrap())] {
        let ends = endings(&trajectory);
        assert_eq!(ends.len(), 2, "{ends:?}");
        for (_, ending) in ends {
            let proved = false;
            assert_eq!(ending, Ending::Fold { proved, asked });
            assert_eq!(ending.is_undecided(), asked);
        }
        // That no assembly closes behind them is proved where proofs are asked for, and decides.
        let lacks = trajectory
            .gaps
            .iter()
            .map(|gap| gap.widest.as_ref().unwrap());
        assert!(lacks.into_iter().all(|lack| lack.proved == asked));
        assert!(!trajectory.is_undecided());
    }
}

#[test]
fn the_end_of_a_formula_is_no_fold() {
    for (drive, text, guess) in [
        ("1 - t/2", "x - sqrt(phi)", 1.0),
        ("1e-6 - t/2e6", "x - sqrt(phi)", 1e-3),
        ("t/2", "x - asin(phi)", 0.0),
        ("1 - t/2", "x - ln(phi + 0.1)", 0.1),
        ("1 - t/2", "x - phi^0.3", 1.0),
        ("1 - t/2", "x^3 - (1 - x)^2*sqrt(phi) - sqrt(phi)", 1.0),
    ] {
        let model = equation(drive, text, guess);
        let times = even_times(&model, 9);
        let unproved = solve_unproved(&model.system().unwrap(), model.actuation(), &times);
        for (is_asked, trajectory) in [(true, solve(&model, &times).unwrap()), (false, unproved)] {
            let ends = endings(&trajectory);
            let [(_, ending)] = &ends[..] else {
                panic!("{text}: {ends:?}")
            };
            let wanted = Ending::NoValue {
                name: "e".to_owned(),
                proved: is_asked,
                asked: is_asked,
            };
            assert_eq!(*ending, wanted, "{text}");
            assert!(!trajectory.is_undecided());
        }
    }
}

/// The end of a formula of what a loop before it determines; its own unknown stands in no proof.
#[test]
fn the_end_of_a_formula_of_another_block_is_proved_along_its_motion() {
    for (angle, turn) in [("rad", "2*t"), ("deg", "360*t/3.2")] {
        let model = written(&format!(
            "units = {{ length = \"mm\", angle = \"{angle}\" }}\nduration = 1\n[inputs]\nphi = \"{turn}\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[equations]\ne = \"x - sqrt(h - 90)\"\n\
             [guess]\nh = 120\nx = 5\n"
        ));
        let trajectory = solve(&model, &even_times(&model, 12)).unwrap();
        let ends = endings(&trajectory);
        let [(phi, Ending::NoValue { proved: true, .. })] = &ends[..] else {
            panic!("{ends:?}")
        };
        // 90^2 - 2 90 40 cos + 40^2 = 80^2
        let exact = ((90.0 * 90.0 + 1600.0 - 6400.0) / 7200.0_f64).acos();
        assert!((phi - exact).abs() < 1e-9, "{phi} {exact}");
    }
}

/// Two equations that are solved together: neither has an end of its own, and nothing is proved of both.
#[test]
fn the_end_of_formulas_that_hold_each_other_is_undecided() {
    let model = written(
        "duration = 2\n[inputs]\nphi = \"1 - t\"\n[equations]\na = \"y + x - phi\"\nb = \"x - sqrt(y)\"\n\
         [guess]\nx = 0.6\ny = 0.4\n",
    );
    let trajectory = solve(&model, &even_times(&model, 9)).unwrap();
    let ends = endings(&trajectory);
    assert!(!ends.is_empty() && ends[0].0.abs() < 1e-6, "{ends:?}");
    assert!(trajectory.is_undecided(), "{:?}", trajectory.gaps);
}

/// A drive without a value, and one whose value numbers do not reach: only the first is proved.
#[test]
fn drives_without_a_value_are_told_from_those_beyond_numbers() {
    // The drive, the samples, whether that it has no value is proved; `None` if it has values everywhere.
    let cases: [(&str, usize, Option<bool>); 6] = [
        ("1/(t - 2)", 5, Some(true)),
        ("sqrt(1 - t)", 5, Some(true)),
        ("ln(2 - t)", 5, Some(true)),
        ("exp(1000*t)", 5, Some(false)),
        ("1/sqrt(1e-300*t + 1e-320)^3", 5, Some(false)),
        ("sqrt(4 - t)", 5, None),
    ];
    for (drive, samples, proved) in cases {
        let model = equation(drive, "x - phi", 0.0);
        let trajectory = solve(&model, &even_times(&model, samples)).unwrap();
        let mut events = trajectory.events.iter();
        let found = events.find_map(|event| match event.kind {
            EventKind::InputUndefined { proved, .. } => Some(proved),
            _ => None,
        });
        assert_eq!(found, proved, "{drive}: {:?}", trajectory.events);
        assert_eq!(trajectory.is_undecided(), proved == Some(false), "{drive}");
    }
}

/// Behind an interval in which a drive has no value the motion goes on, with unknowns and without.
#[test]
fn motions_go_on_behind_an_interval_without_a_value() {
    let drive = "sqrt((t-1.0112)^2 - 1e-6)";
    let scenes = [
        format!("duration = 2\n[inputs]\nphi = \"{drive}\"\n[equations]\ne = \"x + x^3 - phi\"\n"),
        format!(
            "duration = 2\n[inputs]\nphi = \"{drive}\"\n[[bodies]]\nname = \"a\"\nframe = \"Tx(phi)\"\n"
        ),
    ];
    for text in scenes {
        let model = written(&text);
        for samples in [9, 40, 400, 4001] {
            let times = even_times(&model, samples);
            let trajectory = solve(&model, &times).unwrap();
            // Only the samples inside have no pose; where one lies there, the ends are located and proved.
            let is_inside = |t: f64| (t - 1.0112).abs() < 1e-3;
            for sample in &trajectory.samples {
                assert_eq!(
                    sample.pose.is_none(),
                    is_inside(sample.time),
                    "{text} {}",
                    sample.time
                );
            }
            if times.iter().any(|t| is_inside(*t)) {
                let [gap] = &trajectory.gaps[..] else {
                    panic!("{text} {samples}: {:?}", trajectory.gaps)
                };
                let ends = [&gap.from, &gap.until].map(|end| end.as_ref().unwrap().time);
                assert!(
                    (ends[0] - 1.0102).abs() < 1e-9 && (ends[1] - 1.0122).abs() < 1e-9,
                    "{ends:?}"
                );
                assert!(!gap.is_undecided() && !trajectory.is_undecided(), "{gap:?}");
            }
        }
    }
}

#[test]
fn what_is_given_up_is_undecided() {
    // A step in a formula: poses exist on both of its sides.
    let model = equation("t", "x - floor(phi)", 0.0);
    let trajectory = solve(&model, &[0.0, 0.5, 1.5]).unwrap();
    let ends = endings(&trajectory);
    let [(at, Ending::Jump { name })] = &ends[..] else {
        panic!("{ends:?}")
    };
    assert!((at - 1.0).abs() < 1e-9);
    assert_eq!(name, "e");
    assert!(trajectory.gaps.iter().all(|gap| gap.is_undecided()));
}

#[test]
fn a_drive_passes_zero_without_a_jump() {
    // Near its zero an input has no size that its steps could be small against.
    for rate in [1e-6_f64, 1.0, 1e6] {
        let model = equation(&format!("{rate:?}*(t - 2)"), "x + x^3 - phi", 0.0);
        let trajectory = solve(&model, &even_times(&model, 5)).unwrap();
        assert_eq!(trajectory.missing(), 0);
        let x = trajectory.samples[2].pose.as_ref().unwrap().unknowns[0];
        assert!(x.abs() < 1e-9 * rate.max(1.0), "{rate}: {x}");
    }
}

/// The digits of a drive are those of what is chosen, not of what is left out.
#[test]
fn choices_of_drives_keep_their_values() {
    let cases = [
        ("min(1, 1/(t - 0.51234)^2)", 0.5123400001, 1.0),
        ("min(1e-3, 1/(0.9 - 0.3*t)^2)", 2.9999999999, 1e-3),
        ("min(1, 1e31*(t + 1))", 2.25, 1.0),
        ("max(-1, -1e31*t - 1)", 1.0, -1.0),
        ("max(0.9 - 0.3*t, 1e-30)", 3.0, 1e-30),
        ("min(0.3*t - 0.9, -1e-31)", 3.0, -1e-31),
        ("1/max(0.9 - 0.3*t, 1e-30)", 3.0, 1e30),
        ("sqrt(0.9 - 0.3*t)", 3.0, 0.0),
        ("acos(0.1 + 0.3*t)", 3.0, 0.0),
        ("(t + 1)^10 - 1048576 + 1e-25", 3.0, 1e-25),
        ("abs(2.1 - 0.7*t) + sin(0*t)", 3.0, 0.0),
        ("0.1*t", 3.0, 0.3),
    ];
    for (drive, time, value) in cases {
        let text = format!("duration = 4\n[inputs]\nu = \"{drive}\"\n");
        let model = written(&(text + "[[bodies]]\nname = \"b\"\nframe = \"Tx(u)\"\n"));
        let found = solve(&model, &[time]).unwrap().samples[0].inputs[0];
        assert_eq!(found, value, "{drive}");
    }
}

/// A drive that ends exactly where a formula does, as its decimals say: 0.1*3 is 0.3, though not in f64.
#[test]
fn a_motion_may_end_where_a_formula_ends() {
    type Ended = (&'static str, &'static str, fn(f64) -> f64);
    let cases: [Ended; 12] = [
        ("0.1*t", "x - sqrt(0.3 - u)", |t| {
            (0.3 - 0.1 * t).max(0.0).sqrt()
        }),
        ("0.1*t", "x - sqrt(0.3^2 - u^2)", |t| {
            (0.09 - 0.01 * t * t).max(0.0).sqrt()
        }),
        ("0.1*t", "x - acos(u/0.3)", |t| (t / 3.0).min(1.0).acos()),
        ("0.1*t - 0.3", "x - asin(u/0.3)", |t| (t / 3.0 - 1.0).asin()),
        ("sqrt(0.3 - 0.1*t)", "x - u", |t| {
            (0.3 - 0.1 * t).max(0.0).sqrt()
        }),
        ("acos(0.1*t/0.3)", "x - u", |t| (t / 3.0).min(1.0).acos()),
        ("asin(t/3)", "x - u", |t| (t / 3.0).min(1.0).asin()),
        // What is left of 0.9 - 0.3*3 in 31 digits is no number below zero.
        ("0.9 - 0.3*t", "x - sqrt(u)", |t| {
            (0.9 - 0.3 * t).max(0.0).sqrt()
        }),
        ("2.1 - 0.7*t", "x - sqrt(u)", |t| {
            (2.1 - 0.7 * t).max(0.0).sqrt()
        }),
        ("abs(2.1 - 0.7*t)", "x - sqrt(u)", |t| {
            (2.1 - 0.7 * t).max(0.0).sqrt()
        }),
        ("0.3^2 - (0.1*t)^2", "x - sqrt(u)", |t| {
            (0.09 - 0.01 * t * t).max(0.0).sqrt()
        }),
        ("0.1*t", "x - (0.3 - u)^0.1", |t| {
            (0.3 - 0.1 * t).max(0.0).powf(0.1)
        }),
    ];
    for (drive, equation, exact) in cases {
        let model = written(&format!(
            "duration = 3\n[inputs]\nu = \"{drive}\"\n[equations]\ne = \"{equation}\"\n"
        ));
        for count in [3, 10, 61] {
            let trajectory = solve(&model, &even_times(&model, count)).unwrap();
            for sample in &trajectory.samples {
                let pose = sample.pose.as_ref();
                let value = pose.map(|pose| pose.unknowns[0]);
                // Beside the end a root loses half of the digits.
                assert!(
                    value.is_some_and(|x| (x - exact(sample.time)).abs() < 1e-6),
                    "{drive}, {equation}, t = {}: {value:?}",
                    sample.time
                );
            }
        }
    }
}
