//! `mechanim synthesise` from outside: found, proved, written, refused.

use serde_json::Value;
use std::path::Path;
use std::process::{Command, Output};

fn mechanim(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_mechanim"))
        .args(arguments)
        .output()
        .unwrap()
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// The simplest rung, from the printed values: two seeds of differential evolution and a sequential linear search of
/// another program agree on 0.026732.
#[test]
fn two_spheres_reach_the_known_optimum_and_are_proved() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("found.toml");
    let json = folder.path().join("report.json");
    let csv = folder.path().join("report.csv");
    let path = |p: &Path| p.to_str().unwrap().to_owned();
    let done = mechanim(&[
        "synthesise",
        "sphere-sphere",
        "--starts",
        "1",
        "--iterations",
        "100",
        "--out",
        &path(&scene),
        "--json",
        &path(&json),
        "--csv",
        &path(&csv),
    ]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("proved: the mechanism moves as found"));
    let report: Value = serde_json::from_str(&std::fs::read_to_string(&json).unwrap()).unwrap();
    let found = &report["scenes"][0];
    let value = found["value"].as_f64().unwrap();
    // A little more than that, since the pressure angle is kept between the samples, too.
    assert!((value - 0.026732).abs() < 5e-6, "{value}");
    assert_eq!(found["measures"]["deviation"]["printed"], 0.03384);
    // Measured four times as finely as the search looked.
    let steepest = found["measures"]["steepest"]["found"].as_f64().unwrap();
    assert!(
        steepest <= 60.0 * (1.0 + 1e-6) && steepest > 59.9,
        "{steepest}"
    );
    assert!(found["proof"]["open"].as_f64().unwrap() < 1e-12);
    assert_eq!(found["proof"]["missing"], 0);
    // Every variable lies in its box, and is another than the scene's.
    for (name, both) in found["variables"].as_object().unwrap() {
        let (own, x) = (
            both["scene"].as_f64().unwrap(),
            both["found"].as_f64().unwrap(),
        );
        assert!(x.abs() <= 180.0 && x != own, "{name}");
    }
    // What was written is a scene that is as good when it is measured on its own.
    let again = mechanim(&["check", &path(&scene), "--json", "-"]);
    let again: Value = serde_json::from_slice(&again.stdout).unwrap();
    let measured = again.to_string();
    assert!(measured.contains("0.02673"), "{measured}");
    let rows = std::fs::read_to_string(&csv).unwrap();
    assert!(rows.starts_with("scene,kind,name,printed,scene_value,found\n"));
    assert!(rows.contains("sphere-sphere,measure,deviation,0.03384,"));
}

/// A path that ends with a separator is a folder, which is made; so is one that exists.
#[test]
fn one_scene_goes_into_a_folder_too() {
    let folder = tempfile::tempdir().unwrap();
    let place = |name: &str| format!("{}/{name}", folder.path().display());
    let search = ["synthesise", "sphere-sphere", "--starts", "1"];
    let few = ["--iterations", "1", "--out"];
    for (out, file) in [
        ("new/", "new/sphere-sphere.toml"),
        ("new", "new/sphere-sphere.toml"),
        ("new/below/", "new/below/sphere-sphere.toml"),
        ("one", "one"),
    ] {
        std::fs::remove_file(place(file)).ok();
        let done = mechanim(&[&search[..], &few, &[&place(out)]].concat());
        assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
        let scene = std::fs::read_to_string(place(file)).unwrap();
        assert!(scene.contains("[contacts"), "{out}: {scene}");
    }
}

/// The other pairs get well below what is printed within a few steps; their whole search is in `docs/synthesis.md`.
#[test]
fn tori_improve_on_the_print_within_few_steps() {
    for (name, below) in [("torus-torus", 2e-3), ("sphere-torus", 1.2e-2)] {
        let done = mechanim(&[
            "synthesise",
            name,
            "--starts",
            "1",
            "--iterations",
            "15",
            "--json",
            "-",
        ]);
        let report: Value = serde_json::from_slice(&done.stdout).unwrap();
        let found = &report["scenes"][0];
        let value = found["value"].as_f64().unwrap();
        assert!(value < below, "{name}: {value}");
        assert_eq!(found["proof"]["cutting"].as_array().unwrap().len(), 0);
        assert_eq!(found["proof"]["one_branch"], true);
        assert_eq!(done.status.code(), Some(0), "{name} {}", text(&done.stderr));
    }
}

/// The paper's procedure: simplify, and keep the last mechanism that still meets the demand.
#[test]
fn the_simplest_mechanism_that_meets_a_demand_is_named() {
    let search = ["--starts", "1", "--iterations", "15"];
    let pairs = ["synthesise", "sphere-torus", "sphere-sphere"];
    let cases: [(&[&str], &[&str], i32, &str); 3] = [
        (
            &pairs,
            &["deviation<=0.02"],
            0,
            "the simplest with deviation <= 0.02: sphere-torus, 9 variables",
        ),
        (
            &pairs[..2],
            &["deviation<=0.02", "range>=350"],
            1,
            "none is proved with deviation <= 0.02, range >= 350",
        ),
        (&pairs, &["nothing<=1"], 2, "there is no measure `nothing`"),
    ];
    for (verb, demands, code, word) in cases {
        let demands = demands.iter().flat_map(|demand| ["--require", demand]);
        let arguments: Vec<&str> = verb.iter().copied().chain(search).chain(demands).collect();
        let done = mechanim(&arguments);
        let said = text(&done.stdout) + &text(&done.stderr);
        assert_eq!(done.status.code(), Some(code), "{arguments:?} {said}");
        assert!(said.contains(word), "{arguments:?}: {said}");
    }
}

/// An objective that is one number of many poses, and one that is a formula of other measures.
#[test]
fn any_measure_may_be_made_small() {
    let cases = [
        ("torus-torus", "K", 0.0165, 1e-4),
        ("sphere-sphere", "K", 0.0674, 0.0649),
        ("gearshift", "F", 0.056, 6.6e-5),
    ];
    for (name, measure, first, below) in cases {
        let search = ["--starts", "1", "--iterations", "10", "--json", "-"];
        let verb = ["synthesise", name, "--minimise", measure];
        let done = mechanim(&[&verb[..], &search].concat());
        let report: Value = serde_json::from_slice(&done.stdout).unwrap();
        let found = &report["scenes"][0];
        let value = found["value"].as_f64().unwrap();
        let began = found["starts"][0]["first"].as_f64().unwrap();
        assert!((began - first).abs() < 0.01 * first, "{name}: {began}");
        assert!(value < below, "{name}: {value}");
        assert_eq!(done.status.code(), Some(0), "{name} {}", text(&done.stderr));
    }
}

#[test]
fn what_cannot_be_synthesised_is_said() {
    let cases: [(&[&str], i32, &str); 5] = [
        (&["synthesise", "feeder"], 2, "vary"),
        (&["synthesise"], 2, "SCENE"),
        (
            &["synthesise", "torus-torus", "--minimise", "k"],
            2,
            "there is no measure `k`",
        ),
        (
            &["synthesise", "torus-torus", "--starts", "0"],
            2,
            "whole number",
        ),
        (&["synthesise", "no-such-scene"], 2, "no-such-scene"),
    ];
    for (arguments, code, word) in cases {
        let done = mechanim(arguments);
        let said = text(&done.stderr);
        assert_eq!(done.status.code(), Some(code), "{arguments:?} {said}");
        assert!(said.contains(word), "{arguments:?}: {said}");
    }
}

/// Mistakes in the parts of `[study]` that only synthesis uses, all at once and each with its place.
#[test]
fn mistakes_of_limits_and_printed_values_have_places() {
    let folder = tempfile::tempdir().unwrap();
    let scene = folder.path().join("wrong.toml");
    let source = mechanim(&["scenes", "sphere-sphere"]);
    let wrong = text(&source.stdout)
        .replace("steepest = { max = 60 }", "steapest = { max = 60 }")
        .replace("range = 236", "rang = 236");
    std::fs::write(&scene, wrong).unwrap();
    let done = mechanim(&["synthesise", scene.to_str().unwrap()]);
    let said = text(&done.stderr);
    assert_eq!(done.status.code(), Some(2), "{said}");
    for word in ["steapest", "rang", "steepest"] {
        assert!(said.contains(word), "{said}");
    }
}
