//! Equations with a kink, or an infinite rate, that the motion meets at a sample or between two.

use crate::driven;
use crate::program::Workspace;
use crate::reference::scenes::written;

/// An unknown that a formula of the input gives, its value, and a start value.
type Kinked = (&'static str, fn(f64) -> f64, f64);

const KINKED: [Kinked; 9] = [
    ("x - sqrt(abs(phi))", |p| p.abs().sqrt(), 1.5),
    ("x - abs(phi)^(1/3)", |p| p.abs().cbrt(), 1.2),
    ("x - abs(phi)^0.2", |p| p.abs().powf(0.2), 1.1),
    ("x - asin(sin(phi))", |p| p.sin().asin(), -0.5),
    ("x - acos(cos(phi))", |p| p.cos().acos(), 1.0),
    ("x - abs(phi)", f64::abs, 2.0),
    ("x - max(phi, 0)", |p| p.max(0.0), 0.0),
    ("x^3 - phi", f64::cbrt, -1.2),
    ("x*abs(x) - phi", |p| p.signum() * p.abs().sqrt(), -1.4),
];

/// However many samples there are, and wherever they lie to the kink, every one has its pose.
#[test]
fn no_sample_is_lost_at_a_kink() {
    let mut lost = Vec::new();
    for (equation, exact, start) in KINKED {
        for shift in [2.0, 1.3] {
            let model = written(&format!(
                "duration = 4\n[inputs]\nphi = \"t-{shift}\"\n[equations]\ne = \"{equation}\"\n[guess]\nx = {start}\n"
            ));
            for count in 2..=12 {
                let trajectory = driven::solve(&model, &driven::even_times(&model, count)).unwrap();
                let is_right = trajectory.samples.iter().all(|sample| {
                    // A double root is known to half of the digits, a triple one to a third.
                    let pose = sample.pose.as_ref();
                    pose.is_some_and(|p| (p.unknowns[0] - exact(sample.inputs[0])).abs() < 1e-4)
                });
                if !is_right || !trajectory.is_whole() {
                    lost.push((equation, shift, count, trajectory.missing()));
                }
            }
        }
    }
    assert!(lost.is_empty(), "{lost:?}");
}

/// What jumps is no kink: the motion ends there, or the jump is passed as such.
#[test]
fn a_formula_that_jumps_is_not_taken_for_a_kink() {
    for step in ["floor(phi)", "0.05*floor(phi)"] {
        let model = written(&format!(
            "duration = 4\n[inputs]\nphi = \"t-2.5\"\n[equations]\ne = \"x - {step}\"\n[guess]\nx = 0\n"
        ));
        let trajectory = driven::solve(&model, &driven::even_times(&model, 4)).unwrap();
        assert!(!trajectory.is_whole(), "{step}");
    }
}

/// Formulas of one input, their values, and where they have a kink.
type KinkedInput = (&'static str, fn(f64) -> f64, f64);

const OF_INPUTS: [KinkedInput; 6] = [
    ("abs(a - 0.3)", |a| (a - 0.3).abs(), 0.3),
    ("max(a, 0.3)", |a| a.max(0.3), 0.3),
    ("min(0.3, a)*a", |a| a.min(0.3) * a, 0.3),
    ("abs(a)", f64::abs, 0.0),
    (
        "hypot(max(0, a - 2), 1)",
        |a| (a - 2.0).max(0.0).hypot(1.0),
        2.0,
    ),
    ("abs(abs(a) - 40)", |a| (a.abs() - 40.0).abs(), -40.0),
];

/// An input that rests at the kink, within rounding of it, for the whole motion or for a while: a cam that dwells. Every pose is
/// found and proved, and so is the motion between.
#[test]
fn an_input_may_rest_at_a_kink() {
    let workspace = Workspace::new();
    let mut wrong = Vec::new();
    for (formula, exact, kink) in OF_INPUTS {
        for off in [0, 1, -1, 3] {
            let place = (0..off).fold(kink, |x: f64, _| x.next_up());
            let place = (off..0).fold(place, |x, _| x.next_down());
            let drives = [
                format!("{place:?}"),
                format!("{place:?} + max(0, t - 0.5)"),
                format!("{place:?} - max(0, 0.5 - t)"),
                format!("{place:?} + max(0, t - 0.7) - max(0, 0.3 - t)"),
            ];
            for drive in drives {
                let scene = format!(
                    "duration = 1\n[inputs]\na = \"{drive}\"\n[equations]\ne = \"x - {formula}\"\n[guess]\nx = {}\n",
                    exact(kink - 0.4)
                );
                workspace.write("kink.toml", &scene);
                let run = workspace.run_within(5, &["check", "kink.toml"]);
                let text = run.text();
                if run.code != 0 || !text.contains("refused 0 of 21") {
                    wrong.push((formula, drive, text));
                }
            }
        }
    }
    let first = wrong.first();
    assert!(wrong.is_empty(), "{} {first:?}", wrong.len());
}

/// Drives whose kinks are nothing but rounding, at every time: neither the search for corners nor that for poses is lost in them.
#[test]
fn kinks_of_rounding_cost_nothing() {
    let workspace = Workspace::new();
    for drive in [
        "max(0.1*t + 0.2*t, 0.3*t)",
        "min(1, sin(t)^2+cos(t)^2)+t",
        "max(0.5*(1+cos(t)), cos(t/2)^2)",
        "abs(sin(t)^2+cos(t)^2-1)+t",
        "abs(3*t-2*t-t)+t",
        "abs(0.3*t-0.1*t-0.2*t)+t",
    ] {
        workspace.write(
            "rounding.toml",
            format!("duration = 1\n[inputs]\na = \"{drive}\"\n[equations]\ne = \"x-a\"\n"),
        );
        let run = workspace
            .run_within(5, &["check", "rounding.toml", "--samples", "5"])
            .exits(0);
        assert!(
            run.text().contains("(0 without a pose)"),
            "{drive}: {}",
            run.text()
        );
    }
}

/// A length that rests at zero has no tangent there; its poses are found all the same, with any number of samples.
#[test]
fn lengths_may_rest_at_zero() {
    let mut wrong = Vec::new();
    for formula in [
        "hypot(a, 0)",
        "hypot(a, 2*a)",
        "sqrt(a^2)",
        "2*hypot(0, a) + a",
    ] {
        for drive in [
            "max(0, t-0.5)",
            "max(0, 0.5-t)",
            "0",
            "0*t",
            "max(0, abs(t-0.5)-0.2)",
        ] {
            for samples in [2, 5, 20, 21] {
                let model = written(&format!(
                    "duration = 1\n[inputs]\na = \"{drive}\"\n[equations]\ne = \"x - ({formula})\"\n[guess]\nx = 0.5\n"
                ));
                let trajectory =
                    driven::solve(&model, &driven::even_times(&model, samples)).unwrap();
                if trajectory.missing() > 0 || !trajectory.is_whole() {
                    wrong.push((formula, drive, samples, trajectory.missing()));
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{wrong:?}");
}

/// An input that rests where a root of it is zero has no slope there, and needs none: what else moves, beside it or in the same
/// loop, keeps all its poses.
#[test]
fn roots_may_rest_at_zero_while_something_moves() {
    let crank = "[loops]\nA = \"Rz(u) Tx(30) Rz(b) Tx(80 + ROOT) Rz(c) Tx(-x)\"\n[guess]\nb = -0.3\nc = 0.3\nx = 110\n";
    let beside = "[equations]\ne = \"x - u\"\nf = \"w - ROOT\"\n";
    let mut lost = Vec::new();
    for scene in [crank, beside] {
        for root in [
            "sqrt(v)",
            "v^0.5",
            "v^0.75",
            "v^0.3",
            "v^(1/3)",
            "v^1.3",
            "abs(v)^0.3",
            "acos(1 - v)",
            "hypot(v, v)",
        ] {
            for count in [5, 20] {
                let equations = scene.replace("ROOT", root);
                let model = written(&format!(
                    "duration = 4\n[inputs]\nu = \"0.5*(t - 2)\"\nv = 0\n{equations}"
                ));
                let trajectory = driven::solve(&model, &driven::even_times(&model, count)).unwrap();
                let moves = |sample: &mechanim::kinematics::results::trajectory::Sample| {
                    let pose = sample.pose.as_ref();
                    pose.is_some_and(|p| p.closure_error < 1e-12)
                };
                if !trajectory.samples.iter().all(moves) || !trajectory.is_whole() {
                    lost.push((scene == crank, root, count, trajectory.missing()));
                }
            }
        }
    }
    assert!(lost.is_empty(), "{lost:?}");
}
