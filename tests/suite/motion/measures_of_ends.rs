//! Measures of the end of a drive: of its last instant, whatever the samples, also where a cyclic motion is not sampled again.

use crate::program::Workspace;
use mechanim::{CheckOptions, Samples, Scene};
use serde_json::Value;
use std::f64::consts::TAU;

const SCENE: &str = r#"
duration = 4
units = { length = "mm", angle = "rad" }
[parameters]
r = 40
[inputs]
phi = "TURNS*2*pi*t/4"
[loops]
A = "Rz(phi) Tx(r) Rz(al) Tx(80) Rz(be) Tx(-h)"
[guess]
h = 40
[[bodies]]
name = "crank"
frame = "Rz(phi) Tx(r)"
[[traces]]
name = "C"
body = "crank"
[measures]
end = { of = "h", take = "last" }
back = { of = "h", take = "change" }
turn = { of = "phi", take = "change" }
start = { of = "h", take = "first" }
up = { of = "C.y", take = "positive" }
chord = { of = ["C.x", "C.y"], take = "chord" }
"#;

/// The values for so many turns.
fn known(turns: f64) -> [f64; 6] {
    let at = |phi: f64| 40.0 * phi.cos() + (80f64.powi(2) - (40.0 * phi.sin()).powi(2)).sqrt();
    let phi = TAU * turns;
    [
        at(phi),
        at(phi) - at(0.0),
        phi,
        120.0,
        // C is above the line in every first half of a turn.
        (turns.floor() * 0.5 + turns.fract().min(0.5)) / turns,
        80.0 * (0.5 * phi).sin().abs(),
    ]
}

const NAMES: [&str; 6] = ["end", "back", "turn", "start", "up", "chord"];

fn agree(what: &str, turns: f64, found: &[f64]) {
    for ((name, found), known) in NAMES.iter().zip(found).zip(known(turns)) {
        // The way is divided among the samples.
        let allowed = if *name == "up" { 2e-3 } else { 1e-9 };
        assert!(
            (found - known).abs() <= allowed,
            "{what}, {turns} turns, {name}: {found} {known}"
        );
    }
    assert_eq!(found.len(), NAMES.len(), "{what}");
}

#[test]
fn measures_of_the_end_are_those_of_the_last_instant() {
    for turns in [1.0, 2.0, 0.75, 0.5] {
        let text = SCENE.replace("TURNS", &turns.to_string());
        let scene = Scene::parse("ends", &text).unwrap();
        let of = |list: Vec<(String, Option<f64>)>| -> Vec<f64> {
            list.into_iter().map(|(_, value)| value.unwrap()).collect()
        };
        for count in [400, 399, 161] {
            let motion = scene.solve(Samples::Even(count)).unwrap();
            agree("solved", turns, &of(motion.measures()));
            let samples = Samples::Even(count);
            let check = scene
                .check(&CheckOptions {
                    samples,
                    ..CheckOptions::default()
                })
                .unwrap();
            let report: Value = serde_json::from_str(check.to_json()).unwrap();
            let rows = report["measures"].as_array().unwrap().iter();
            let values: Vec<f64> = rows.map(|row| row["value"].as_f64().unwrap()).collect();
            agree("checked", turns, &values);
        }
        agree(
            "frames",
            turns,
            &of(scene.solve(Samples::Frames).unwrap().measures()),
        );
        // A sweep of one design, and the bands of all pieces.
        let w = Workspace::new();
        w.write("ends.toml", &text);
        let run = w.run(&[
            "sweep",
            "ends.toml",
            "--design",
            "grid:r=40..41:2",
            "--out",
            "-",
        ]);
        let text = run.text();
        let lines: Vec<&str> = text.lines().collect();
        let heads: Vec<&str> = lines[0].split(',').collect();
        let cells: Vec<&str> = lines[1].split(',').collect();
        let value = |name: &&str| {
            let place = heads.iter().position(|head| head == name).unwrap();
            cells[place].parse::<f64>().unwrap()
        };
        agree("swept", turns, &NAMES.iter().map(value).collect::<Vec<_>>());
        let said = w
            .run(&[
                "enclose",
                "ends.toml",
                "--vary",
                "r",
                "--tolerance",
                "1e-6",
                "--samples",
                "3",
            ])
            .text();
        for (name, known) in NAMES.iter().zip(known(turns)) {
            let line = said
                .lines()
                .find(|line| line.trim_start().starts_with(&format!("{name} ")));
            let numbers = line
                .unwrap()
                .split_whitespace()
                .filter_map(|word| word.parse::<f64>().ok());
            if let [lo, hi, ..] = numbers.collect::<Vec<_>>()[..] {
                assert!(
                    lo - 1e-9 <= known && known <= hi + 1e-9,
                    "{turns} {name}: {lo} {hi} {known}"
                );
            }
        }
    }
}
