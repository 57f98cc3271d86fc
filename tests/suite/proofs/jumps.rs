//! Drives and equations that jump, and others that look as if: what is certified is known for each of them.

use crate::program::Workspace;

/// A coordinate that is what an equation says of an input.
fn scene(phi: &str, equation: &str) -> String {
    format!("duration = 2\n[inputs]\nphi = \"{phi}\"\n[equations]\ne = \"{equation}\"\n")
}

/// Drives over two seconds, and whether they are continuous there.
const DRIVES: [(&str, bool); 22] = [
    ("t + 1e-9*floor(t)", false),
    ("t + 1e-40*floor(t)", false),
    ("t + 1e-9*floor(t + 1e-3)", false),
    ("t + 1e-10*(floor(t) + floor(-t))", false),
    ("t + 1e-9*floor(-mod(0.353 + t, 0.063))", false),
    ("t + 1e-10*max(0, atan(1/(t - 1.01)))", false),
    ("t + 1e-10*min(t, cos(atan2(t - 1.01, -1)/2))", false),
    ("t + 1e-11*floor(floor(2*t)/3 + t)", false),
    ("t + 1e-12*mod(t, 0.7)", false),
    ("abs(mod(t, 0.2) - 0.1000000000001)", false),
    ("t + floor(t^2)*(t - sqrt(2))", false),
    ("t + 1e-10*sin(0.5*atan2(t - 1, -1))", false),
    ("t + 1e-10*atan2(t - 1, -1)", false),
    ("1e-10*atan(1/(t - 1.01))", false),
    (
        "mod(sin(1.1 - t), 0.2) + 0.19*floor(sin(1.1 - t)/0.2)",
        false,
    ),
    // Both jump where their one quotient, which is no line over the time, comes to a whole number.
    ("mod(sin(1.1 - t), 0.2) + 0.2*floor(sin(1.1 - t)/0.2)", true),
    ("cos(mod(t^2, 0.7) + 0.7*floor(t^2/0.7))", true),
    ("t + floor(t)*(t - 1)*(t - 2)", true),
    ("abs(mod(t, 0.2) - 0.1)", true),
    ("sin(2*pi*mod(t, 0.5)*2)", true),
    ("mod(t, 0.7) + 0.7*floor(t/0.7)", true),
    ("max(min(t, 1.3), abs(t - 0.7)) + 1e-9*floor(t/5)", true),
];

#[test]
fn drives_are_certified_if_and_only_if_they_do_not_jump() {
    let folder = Workspace::new();
    for (k, (phi, is_continuous)) in DRIVES.iter().enumerate() {
        let name = format!("{k}.toml");
        folder.write(&name, scene(phi, "x - phi"));
        for samples in ["2", "3", "4", "9", "21"] {
            let how = ["--certify", "motion", "--samples", samples];
            let run = folder.run(&[&["check", &name][..], &how].concat());
            let expected = i32::from(!is_continuous);
            assert_eq!(run.code, expected, "{phi} at {samples}: {}", run.text());
        }
    }
}

/// Steps of keys are jumps, however small.
#[test]
fn steps_of_keys_are_jumps() {
    let folder = Workspace::new();
    for (step, code) in [("1", 0), ("1.0000000001", 1)] {
        let keys = format!("{{ keys = [[0, 1], [1, {step}], [2, {step}]], ease = \"step\" }}");
        let text = scene("t", "x - phi").replace("\"t\"", &keys);
        folder.write("keys.toml", text);
        for samples in ["3", "4", "8"] {
            let how = [
                "check",
                "keys.toml",
                "--certify",
                "motion",
                "--samples",
                samples,
            ];
            folder.run(&how).exits(code);
        }
    }
}

/// Equations and computed steps of loops: whether their formula jumps, not by how much.
#[test]
fn motions_end_where_a_formula_of_a_loop_jumps() {
    let folder = Workspace::new();
    let cases = [
        ("x - 1e-8*floor(phi) - phi", true),
        ("x - 1e-3*floor(phi) - sqrt(abs(phi - 1))", true),
        ("x - 0.5*floor(phi)", true),
        ("x - 1e-9*atan2(phi - 1, -1) - phi", true),
        // At the very start, and to and fro within a step.
        ("x - floor(-phi)", true),
        ("x - phi - floor(phi - 0.3) + floor(phi - 0.31)", true),
        ("x - phi - floor(phi - 1) + floor(phi - 1.001)", true),
        ("x - floor(phi)*(phi - 1)*(phi - 2)", false),
        ("x - abs(mod(phi, 0.5) - 0.25)", false),
        ("x - mod(phi, 0.7) - 0.7*floor(phi/0.7)", false),
        ("x - phi - min(mod(phi, 0.4), 0.4 - mod(phi, 0.4))", false),
        ("x - sqrt(abs(phi - 1))", false),
        ("x - sin(atan2(phi - 1, phi - 3))", false),
    ];
    for (equation, jumps) in cases {
        folder.write("jump.toml", scene("t", equation));
        for samples in ["2", "4", "9"] {
            let run = folder.run(&["solve", "jump.toml", "--samples", samples, "--out", "-"]);
            let said = run.stderr.contains("where a formula of `e` jumps");
            assert_eq!(
                (said, run.code),
                (jumps, i32::from(jumps)),
                "{equation} at {samples}: {}",
                run.stderr
            );
        }
    }
    for (step, jumps) in [
        ("Tx(10 + 1e-8*floor(phi))", true),
        ("Rz(mod(phi, 2*pi/7))", true),
        ("Rz(mod(phi, 2*pi))", false),
    ] {
        let text = format!(
            "duration = 9\n[inputs]\nphi = \"t\"\n[loops]\nA = \"{step} Rz(a) Tx(30) Rz(b) Tx(30) Rz(c) Tx(-25)\"\n[guess]\na = 1\n"
        );
        folder.write("loop.toml", &text);
        let run = folder.run(&["solve", "loop.toml", "--samples", "40", "--out", "-"]);
        assert_eq!(
            run.stderr.contains("where a formula of `A` jumps"),
            jumps,
            "{step}: {}",
            run.stderr
        );
    }
}

/// Where no row is missing and the motion goes on, nothing has failed.
#[test]
fn singular_samples_and_kinks_with_poses_are_no_failure() {
    let folder = Workspace::new();
    let equations = [
        "x - sqrt(max(phi, 0))",
        "x^3 - phi",
        // No tangent leads to these or from them.
        "x^5 - phi^3",
        "x^7 - phi^3",
        "x^9 - phi^5",
    ];
    for equation in equations {
        folder.write("smooth.toml", scene("t - 1", equation));
        for samples in ["2", "3", "4", "9", "40"] {
            folder
                .run(&["solve", "smooth.toml", "--samples", samples, "--out", "-"])
                .exits(0);
        }
    }
}

/// Folds that face each other over a gap in which nothing closes, at most a single pose in its middle: all terms of the equation
/// are small there, and what they leave is small, but not against them.
#[test]
fn no_motion_goes_on_over_a_gap_between_folds() {
    let folder = Workspace::new();
    let equations = [
        // x = ±phi sqrt(phi² - gap²), and the pose at zero.
        "x^2 - phi^4 + 0.03^2*phi^2",
        "x^2 - phi^4 + 0.01^2*phi^2",
        "x^2 - phi^4 + 0.003^2*phi^2",
        "x^2 - phi^6 + 0.03^2*phi^4",
        "x^2 - phi^6 + 0.01^2*phi^4",
        // No pose at all between.
        "x^2 - phi^4 + 0.0001^4",
        "x^2 - phi^6 + 0.003^6",
        "x^4 - phi^6 + 0.003^6",
        // Ever narrower ones, to less than a millionth of a step.
        "x^2 - phi^2 + 1e-12",
        "x^2 - phi^2 + 1e-14",
        "x^2 - phi^2 + 1e-16",
        "x^2 - phi^6 + 1e-18",
        "x^2 - phi^6 + 1e-10*phi^4",
        "x^4 - phi^2 + 1e-10",
        "x^4 - phi^2 + 1e-14",
        "x^4 - phi^6 + 1e-24",
        "x^6 - phi^4 + 1e-12",
        "x^6 - phi^4 + 1e-16",
    ];
    for equation in equations {
        let text = scene("t - 1", equation) + "[guess]\nx = 1\n";
        folder.write("gap.toml", text);
        for samples in ["6", "7", "8", "40"] {
            for verb in [&["solve", "--out", "-"][..], &["check"]] {
                let run = folder.run(&[verb, &["gap.toml", "--samples", samples]].concat());
                assert!(
                    [1, 4].contains(&run.code),
                    "{verb:?} {equation} at {samples}: {} {}",
                    run.code,
                    run.stderr
                );
            }
        }
    }
}

/// Poses join the two sides of a singular one, however flat it is.
#[test]
fn a_motion_goes_on_where_poses_join() {
    let folder = Workspace::new();
    for equation in [
        "x^2 - phi^2",
        "x^2 - phi^4",
        "x^2 - phi^6",
        "x^2 - phi^8",
        "x^2 - phi^2 - 0.1*phi^3",
        "x^3 - phi",
        "x^3 - phi^9",
        "x^4 - phi^2",
        "x^4 - phi^6",
        "x^6 - phi^4",
    ] {
        let text = scene("t - 1", equation) + "[guess]\nx = 1\n";
        folder.write("joined.toml", text);
        for samples in ["6", "40"] {
            folder
                .run(&["check", "joined.toml", "--samples", samples])
                .exits(0);
        }
    }
}

/// Singular poses that a motion passes straight on, or a gap too narrow to be told from one: passed with a warning, but never
/// within a certified interval.
#[test]
fn no_proof_of_a_motion_reaches_over_a_singular_pose() {
    let folder = Workspace::new();
    for equation in [
        "x^7 - phi^3",
        "x^2 - phi^2",
        "x^2 - phi^2 + 1e-18",
        "x^2 - phi^6 + 1e-18",
        "x^2 - phi^4 + 0.0000001^2*phi^2",
    ] {
        let text = scene("t - 1", equation) + "[guess]\nx = 1\n";
        folder.write("singular.toml", text);
        for samples in ["6", "7", "40"] {
            for verb in [&["solve", "--out", "-"][..], &["check"]] {
                let proof = ["singular.toml", "--certify", "motion", "--samples", samples];
                let run = folder.run(&[verb, &proof].concat());
                assert!(
                    [1, 4].contains(&run.code),
                    "{verb:?} {equation} at {samples}: {} {}",
                    run.code,
                    run.stderr
                );
            }
        }
    }
}
