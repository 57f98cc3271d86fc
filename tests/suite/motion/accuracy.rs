//! Work against precision: the errors of all routes are those of an independent computation, and the report says them.

use crate::driven::{Driven, Model};
use crate::reference;
use mechanim::analysis::observer::largest_distance;
use mechanim::analysis::reference::Reference;
use mechanim::analysis::routes::{RotationForm, Route, Walker};
use mechanim::analysis::work_precision::{
    PrecisionRow, PrecisionStudy, StudyError, study_precision,
};
use mechanim::diag::Source;
use mechanim::kinematics::loops::forward::closure_error;

use crate::program::Workspace;
use crate::reference::{Table, mechanism};

fn scene_of_data(name: &str) -> Model {
    let path = format!("{}/tests/data/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap();
    mechanism(&Source { name: path, text }, &[])
}

fn builtin(name: &str) -> Model {
    mechanism(&mechanim::scene::builtin::find_builtin(name).unwrap(), &[])
}

fn row<'a>(study: &'a PrecisionStudy, family: &str, steps: usize) -> &'a PrecisionRow {
    let mut rows = study
        .rows
        .iter()
        .filter(|r| r.family == family && r.steps == steps);
    rows.next()
        .unwrap_or_else(|| panic!("no {family} with {steps} steps"))
}

/// Routes along a mechanism's motion.
fn compared(mechanism: &Model, poses: usize, turns: usize) -> Result<PrecisionStudy, StudyError> {
    study_precision(
        &mechanism.system().unwrap(),
        &mechanism.actuation,
        poses,
        turns,
    )
}

#[test]
fn integration_errors_are_those_of_the_independent_computation() {
    let study = compared(&scene_of_data("dyads-bars"), 90, 100).unwrap();
    let within_two = |found: f64, expected: f64, what: &str| {
        let ratio = found / expected;
        assert!(
            (0.5..=2.0).contains(&ratio),
            "{what}: {found:e} for {expected:e}"
        );
    };
    let table = Table::read("interval_mech10_ode");
    let mut compared = 0;
    for line in 0..table.len() {
        let steps = table.value(line, "steps_or_rhs_evals") as usize;
        let expected = table.value(line, "max_position_error_after_run_mm");
        let family = match table.text(line, "method") {
            "ODE Euler" if [90, 360, 3600].contains(&steps) => "Euler",
            "ODE RK4" if [90, 180, 360, 1440, 3600].contains(&steps) => "Runge-Kutta 4",
            _ => continue,
        };
        compared += 1;
        within_two(
            row(&study, family, steps).end_error,
            expected,
            &format!("{family} {steps}"),
        );
    }
    assert_eq!(compared, 8);
    // The drift grows with the number of turns; the projected routes do not drift.
    for (turns, expected) in [(1, 2.994e-6), (10, 2.994e-5), (100, 2.994e-4)] {
        for drift in study.drift.iter().filter(|d| d.turns == turns) {
            match drift.name {
                "Runge-Kutta 4" => within_two(drift.error, expected, &format!("{turns} turns")),
                name => assert!(drift.error < 1e-11, "{name} {turns}: {:e}", drift.error),
            }
        }
    }
    assert_eq!(study.drift.len(), 9);
    for steps in [90, 180] {
        assert!(row(&study, "Runge-Kutta 4 + Newton", steps).error < 1e-11);
    }
    assert!(row(&study, "mechanim solve", 90).error < 1e-11);
}

/// The source's own route: the velocities of the points from system (3), and from the rows of the bars.
#[test]
fn points_are_moved_as_in_the_independent_computation() {
    let table = Table::read("interval_mech10_ode");
    for name in ["dyads", "dyads-bars"] {
        let mechanism = builtin(name);
        let study = compared(&mechanism, 90, 1).unwrap();
        let size = mechanism.mechanism.size;
        let mut compared = 0;
        for line in 0..table.len() {
            let steps = table.value(line, "steps_or_rhs_evals") as usize;
            let family = match table.text(line, "method") {
                "ODE Euler" => "Euler on the bars",
                "ODE RK4" => "Runge-Kutta 4 on the bars",
                "ODE RK4; J-form (3) scaled from v8" => "Runge-Kutta 4 on system (3)",
                _ => continue,
            };
            let mut rows = study.rows.iter();
            let Some(row) = rows.find(|r| r.family == family && r.steps == steps) else {
                continue;
            };
            compared += 1;
            for (found, expected) in [
                (row.end_error, "max_position_error_after_run_mm"),
                (row.closure * size, "max_link_length_error_mm"),
            ] {
                let expected = table.value(line, expected);
                // The reference prints four digits; the smallest errors are partly rounding, and its lengths are
                // compared at the steps, ours at the poses.
                let off = (found - expected).abs() - 2e-12;
                assert!(
                    off <= 0.6 * expected,
                    "{name}, {family} {steps}: {found:e} {expected:e}"
                );
                let is_position = found == row.end_error;
                assert!(
                    !is_position || off <= 2e-3 * expected,
                    "{name}, {family} {steps}: {found:e} {expected:e}"
                );
            }
            assert_eq!(row.lost, 0);
        }
        assert_eq!(compared, 10, "{name}");
    }
}

/// Crank and coupler of this four-bar are in line at 0 degrees, within a step: a pole of system (3), beside which it still
/// gives the velocities of the bars.
#[test]
fn steps_over_a_pole_of_system_three_are_those_of_the_bars() {
    let text = "units = { length = \"mm\", angle = \"deg\" }\nduration = 1\n[inputs]\nphi = \"20*t - 10\"\n[loops]\n\
                A = \"Rz(phi) Tx(20) Rz(mu) Tx(60) Rz(nu) Tx(-50) Rz(-theta) Ty(40) Tx(-50)\"\n\
                [guess]\ntheta = 53\n";
    let source = Source {
        name: "in-line".to_owned(),
        text: text.to_owned(),
    };
    let study = compared(&mechanism(&source, &[]), 5, 1).unwrap();
    for steps in [5, 10, 20, 80] {
        let [bars, three] = ["Runge-Kutta 4 on the bars", "Runge-Kutta 4 on system (3)"]
            .map(|family| row(&study, family, steps));
        assert_eq!([bars.lost, three.lost], [0, 0]);
        assert!(
            bars.error < 1e-3 / (steps as f64).powi(4),
            "{steps}: {}",
            bars.error
        );
        assert!((bars.error - three.error).abs() <= 1e-6 * bars.error + 1e-12);
    }
    // What is no linkage of dyads has no such routes.
    let study = compared(&builtin("slider-crank"), 5, 1).unwrap();
    assert!(study.rows.iter().all(|r| !r.family.contains("bars")));
}

#[test]
fn orders_of_the_routes() {
    let study = compared(&builtin("dyads"), 90, 1).unwrap();
    assert!(study.rows.iter().all(|r| r.lost == 0));
    let error = |family, steps| row(&study, family, steps).error;
    let fourth = error("Runge-Kutta 4", 180) / error("Runge-Kutta 4", 360);
    assert!((10.0..24.0).contains(&fourth), "{fourth}");
    let first = error("Euler", 360) / error("Euler", 3600);
    assert!((8.0..12.0).contains(&first), "{first}");
    assert!(
        study.reference_bound.is_some_and(|b| b < 1e-12),
        "{:?}",
        study.reference_bound
    );
    for row in &study.rows {
        let Some(Route::Position { tolerance, .. }) = row.route else {
            continue;
        };
        // A pose that closes to the tolerance is as good as its condition allows: 11 for this mechanism.
        assert!(row.error <= 1e3 * tolerance * 155.0 + 1e-12, "{row:?}");
        assert!(row.closure <= 10.0 * tolerance, "{row:?}");
    }
    // The better the prediction, the fewer corrections.
    let tight: Vec<f64> = study
        .rows
        .iter()
        .filter(|r| {
            let log = RotationForm::Log;
            matches!(r.route, Some(Route::Position { tolerance: 1e-13, form, .. }) if form == log)
                && r.steps == 90
        })
        .map(|r| r.iterations)
        .collect();
    assert_eq!(tight.len(), 4);
    assert!(tight.windows(2).all(|w| w[0] > w[1]), "{tight:?}");
}

#[test]
fn the_reference_is_the_closed_form() {
    let mechanism = reference::mechanism(
        &mechanim::scene::builtin::find_builtin("slider-crank").unwrap(),
        &[],
    );
    let system = mechanism.system().unwrap();
    let times: Vec<f64> = (0..=200).map(|k| 0.02 * f64::from(k)).collect();
    let reference = Reference::new(&system, &mechanism.actuation, times);
    let h = mechanism
        .unknowns
        .iter()
        .position(|c| c.name == "h")
        .unwrap();
    for pose in reference.poses.iter().flatten() {
        let phi = pose[mechanism.unknowns.len()];
        let exact = 40.0 * phi.cos() + (6400.0 - (40.0 * phi.sin()).powi(2)).sqrt();
        assert!(
            (pose[h] - exact).abs() < 2e-13,
            "{phi}: {:e}",
            pose[h] - exact
        );
    }
}

#[test]
fn the_skew_residual_takes_a_half_turn_for_closed() {
    let mechanism = reference::mechanism(
        &mechanim::scene::builtin::find_builtin("slider-crank").unwrap(),
        &[("phi", "0.5")],
    );
    let system = mechanism.system().unwrap();
    let mut walker = Walker::new(&system, &mechanism.actuation);
    let wrong = [("alpha", 2.8837), ("beta", -0.2421), ("h", 42.5642)];
    let mut start = vec![0.0; mechanism.unknowns.len()];
    for (name, value) in wrong {
        start[mechanism
            .unknowns
            .iter()
            .position(|c| c.name == name)
            .unwrap()] = value;
    }
    start.push(0.5);
    let route = |form| Route::Position {
        predictor: 0,
        tolerance: 1e-12,
        form,
    };
    let mut skew = start.clone();
    walker
        .advance(route(RotationForm::Skew), &mut skew, 0.0, 0.0)
        .unwrap();
    assert!((closure_error(&mechanism, &skew) - std::f64::consts::PI).abs() < 1e-9);
    let mut log = start.clone();
    if walker
        .advance(route(RotationForm::Log), &mut log, 0.0, 0.0)
        .is_some()
    {
        assert!(closure_error(&mechanism, &log) < 1e-11);
    }
}

#[test]
fn distances_see_what_is_no_number() {
    assert_eq!(largest_distance(&[1.0, 2.0], &[1.5, 2.0]), 0.5);
    assert_eq!(
        largest_distance(&[1.0, f64::NAN], &[1.0, 2.0]),
        f64::INFINITY
    );
}

const BLOCKED: &str = r#"
duration = 4
[inputs]
phi = "2*pi*t/4"
[loops]
A = "Rz(phi) Tx(80) Rz(alpha) Tx(60) Rz(beta) Tx(-h)"
[guess]
h = 140
"#;

#[test]
fn motions_with_gaps_are_refused() {
    let source = Source {
        name: "blocked".into(),
        text: BLOCKED.into(),
    };
    let found = compared(&mechanism(&source, &[]), 90, 1);
    assert!(
        matches!(found, Err(StudyError::Gap { time }) if time > 0.5 && time < 0.6),
        "{found:?}"
    );
    let w = Workspace::new();
    w.write("blocked.toml", BLOCKED);
    w.run(&["accuracy", "blocked.toml"])
        .exits(4)
        .says(&["no pose at t = 0.5", "mechanim check"]);
}

#[test]
fn the_report_in_all_its_forms() {
    let w = Workspace::new();
    let run = |out: &str| {
        w.run(&["accuracy", "slider-crank", "--turns", "1", "--out", out])
            .exits(0)
    };
    let table = run("a.json").text();
    for word in [
        "route",
        "us_per_pose",
        "end_error",
        "tangent + Newton",
        "Runge-Kutta 4",
        "mechanim solve",
        "Drift",
    ] {
        assert!(table.contains(word), "{word} is not in\n{table}");
    }
    let document: serde_json::Value = serde_json::from_slice(&w.read("a.json")).unwrap();
    assert_eq!(document["schema"], "mechanim-accuracy/1");
    let rows = document["rows"].as_array().unwrap();
    assert!(
        rows.iter()
            .all(|r| r["us_per_pose"].as_f64().unwrap() > 0.0)
    );
    run("a.csv");
    let csv = String::from_utf8(w.read("a.csv")).unwrap();
    let lines: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
    assert_eq!(lines.len(), rows.len() + 1);
    assert!(lines.iter().all(|l| l.len() == lines[0].len()));
    run("a.svg");
    let svg = String::from_utf8(w.read("a.svg")).unwrap();
    assert!(svg.contains("largest error [mm]") && svg.contains("time per pose [µs]"));
    let alone = run("-");
    let parsed: Result<serde_json::Value, _> = serde_json::from_slice(&alone.stdout);
    assert!(parsed.is_ok(), "JSON alone on standard output");
    for bad in [["--out", "a.pdf"], ["--poses", "0"], ["--turns", "x"]] {
        w.run(&[&["accuracy", "slider-crank"][..], &bad[..]].concat())
            .exits(2);
    }
}

/// A full turn of an angle is no error, also where nothing but unknowns can be compared.
#[test]
fn without_bodies_turns_are_no_errors() {
    let w = crate::program::Workspace::new();
    w.write(
        "s.toml",
        "units = { length = \"mm\" }\nduration = 4\n[inputs]\nphi = \"2*pi*t/4\"\n[chains]\ncrank = \"Rz(phi) Tx(40)\"\n\
         rod = \"Rz(alpha) Tx(80)\"\nslide = \"Rz(beta) Tx(-h)\"\n[loops]\nA = \"crank rod slide\"\n[guess]\nh = 100\n",
    );
    for poses in ["30", "31", "120"] {
        w.run(&["accuracy", "s.toml", "--poses", poses, "--out", "a.csv"])
            .exits(0);
        let table = String::from_utf8(w.read("a.csv")).unwrap();
        let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let column = heads.iter().position(|head| *head == "error").unwrap();
        for line in table.lines().skip(1) {
            let error = line.split(',').nth(column).unwrap();
            // The reach is 120 mm, and the coarsest route is off by less than half of that.
            if let Ok(error) = error.parse::<f64>() {
                assert!(error < 60.0, "{poses}: {line}");
            }
        }
    }
}
