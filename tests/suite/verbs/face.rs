//! The library and the program give the same answers: one check, asked either way.

use mechanim::{CheckOptions, Samples, Scene};
use serde_json::Value;
use std::process::Command;

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
        let mut program = Command::new(env!("CARGO_BIN_EXE_mechanim"));
        let arguments = ["check", name, "--samples", "12", "--json", "-", "-q"];
        let out = program.args(arguments).output().unwrap();
        let theirs: Value = serde_json::from_slice(&out.stdout).unwrap();
        let ours: Value = serde_json::from_str(own.to_json()).unwrap();
        assert_eq!(own.passed(), out.status.success(), "{name}");
        assert_eq!(ours["result"], theirs["result"], "{name}");
        assert_eq!(answers(&ours), answers(&theirs), "{name}");
        assert!(!answers(&ours).is_empty() && own.to_junit().contains("<testcase"));
        failed += usize::from(!own.passed());
    }
    // Agreeing on nothing but successes would show little.
    assert!(failed > 0);
}
