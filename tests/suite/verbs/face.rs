//! The library and the program give the same answers: one check, asked either way.

use mechanim::study::{OptimiseOptions, ToleranceOptions};
use mechanim::{CheckOptions, Samples, Scene};
use serde_json::Value;
use std::process::Command;

/// What the program prints as JSON for these arguments, and whether it exited with 0.
fn program(arguments: &[&str]) -> (Value, bool) {
    let mut program = Command::new(env!("CARGO_BIN_EXE_mechanim"));
    let out = program.args(arguments).output().unwrap();
    let found = serde_json::from_slice(&out.stdout);
    (found.unwrap(), out.status.success())
}

/// Whether a number is the one of the document, but for reading it as text.
fn is_same(ours: f64, theirs: &Value) -> bool {
    let theirs = theirs.as_f64().unwrap();
    (ours - theirs).abs() <= 1e-15 * theirs.abs()
}

fn parsed(json: &str) -> Value {
    serde_json::from_str(json).unwrap()
}

/// Every question with its answer, but for the seconds it took.
fn answers(report: &Value) -> Vec<[String; 3]> {
    let cases = report["checks"].as_array().unwrap().iter();
    let word = |case: &Value, key: &str| case[key].as_str().unwrap().to_owned();
    cases
        .map(|case| ["name", "status", "text"].map(|key| word(case, key)))
        .collect()
}

#[test]
fn checks_of_library_and_program_agree() {
    let options = CheckOptions {
        samples: Samples::Even(12),
        ..CheckOptions::default()
    };
    let mut failed = 0;
    for name in Scene::builtin_names() {
        let own = Scene::builtin(name).unwrap().check(&options).unwrap();
        // The library lists all pairs.
        let arguments = [
            "check",
            name,
            "--samples",
            "12",
            "--rows",
            "100000",
            "--json",
            "-",
            "-q",
        ];
        let (theirs, passed) = program(&arguments);
        let ours = parsed(own.to_json());
        assert_eq!(own.passed(), passed, "{name}");
        assert_eq!(ours["result"], theirs["result"], "{name}");
        assert_eq!(answers(&ours), answers(&theirs), "{name}");
        assert!(!answers(&ours).is_empty() && own.to_junit().contains("<testcase"));
        failed += usize::from(!own.passed());
    }
    // Agreeing on nothing but successes would show little.
    assert!(failed > 0);
}

/// Studies of a closed contact and of a linkage.
const STUDIES: [&str; 2] = ["sphere-sphere", "gearshift-optimised"];

#[test]
fn sensitivities_of_library_and_program_agree() {
    for name in STUDIES {
        let own = Scene::builtin(name).unwrap().study().sensitivity().unwrap();
        let (theirs, _) = program(&["sensitivity", name, "--out", "-", "-q"]);
        assert_eq!(parsed(&own.to_json()), theirs, "{name}");
        let (measure, variable) = (own.measures()[0].0, own.variables()[0]);
        let slope = &theirs["dimensions"][0]["derivatives"][measure];
        assert!(
            is_same(own.derivative(measure, variable).unwrap(), slope),
            "{name}"
        );
    }
}

#[test]
fn tolerances_of_library_and_program_agree() {
    let options = ToleranceOptions {
        tolerance: Some(0.02),
        pieces: 100,
        seed: 7,
        ..Default::default()
    };
    let study = Scene::builtin("gearshift").unwrap().study();
    let own = study.vary(&["L4", "L7"]).tolerance(&options).unwrap();
    let asked =
        "tolerance gearshift --vary L4,L7 --tolerance 0.02 --pieces 100 --seed 7 --json - -q";
    let (theirs, _) = program(&asked.split(' ').collect::<Vec<_>>());
    assert_eq!(parsed(own.to_json()), theirs);
    for measure in own.measures() {
        let there = &theirs["measures"][&measure.name];
        assert!(is_same(measure.linear_sum, &there["linear_sum"]));
        assert!(is_same(measure.found[1], &there["found"][1]));
        assert!(is_same(measure.band.unwrap()[0], &there["never_beyond"][0]));
    }
    assert!(
        study.tolerance(&Default::default()).is_err(),
        "there is no tolerance"
    );
}

#[test]
fn optima_of_library_and_program_agree() {
    let options = OptimiseOptions {
        iterations: 3,
        ..Default::default()
    };
    for name in ["gearshift", "gearshift-optimised"] {
        let own = Scene::builtin(name)
            .unwrap()
            .study()
            .optimise(&options)
            .unwrap();
        let asked = ["optimise", name, "--iterations", "3", "--json", "-", "-q"];
        let (theirs, done) = program(&asked);
        assert_eq!(parsed(&own.to_json()), theirs, "{name}");
        assert_eq!(own.holds(), done, "{name}");
        assert!(is_same(own.objective()[1], &theirs["to"]), "{name}");
    }
}
