//! Variables of a study in places that it cannot follow: refused, never used with the file's value. Everywhere else what is said
//! of a neighbouring design is what a check of that design says.

use crate::program::Workspace;
use mechanim::{CheckOptions, Samples, Scene};
use serde_json::Value;

/// A slider-crank whose places can be replaced.
const CRANK: &str = r#"
duration = "DURATION"
units = { length = "mm", angle = "rad" }
[parameters]
r = 40
L = 80
n = 12
twice = "2*r"
[inputs]
phi = "DRIVE"
[loops]
A = "Rz(phi) Tx(r) Rz(al) Tx(L) Rz(be) Tx(-h)"
[guess]
h = 40
[[bodies]]
name = "crank"
frame = "DIRECTION(phi) Tx(r)"
[tracks]
turn = { samples = "SAMPLES", inputs = { phi = [0, "END"] } }
[clearance]
minimum = "MINIMUM"
[measures]
far = { track = "turn", of = "h", take = "max", max = "LIMIT" }
size = { track = "turn", of = "h/L", take = "norm", power = "POWER" }
STUDY
[study.variables]
r = { range = RANGE }
"#;

const PLAIN: [(&str, &str); 10] = [
    ("DURATION", "2"),
    ("DRIVE", "t"),
    ("DIRECTION", "Rz"),
    ("SAMPLES", "12"),
    ("END", "3"),
    ("LIMIT", "300"),
    ("POWER", "4"),
    ("STUDY", ""),
    ("MINIMUM", "0.1"),
    ("RANGE", "[35, 45]"),
];

fn crank(place: &str, text: &str) -> String {
    let fill = |scene: String, (name, plain): &(&str, &str)| {
        scene.replace(name, if *name == place { text } else { plain })
    };
    PLAIN.iter().fold(CRANK.to_owned(), fill)
}

#[test]
fn a_variable_where_it_cannot_be_followed_is_refused() {
    let w = Workspace::new();
    for (place, text, word) in [
        ("DURATION", "r/20", "in the duration"),
        ("DRIVE", "t*r/40", "in a drive"),
        ("DRIVE", "t*twice/80", "in a drive"),
        ("SAMPLES", "r/2 - 8", "in a track"),
        ("END", "3*r/40", "in a track"),
        ("LIMIT", "twice + 40", "in the limits of a measure"),
        ("POWER", "r/10", "in the power of a norm"),
        ("MINIMUM", "twice/800", "in the limits of clearances"),
        (
            "RANGE",
            "[\"r - 5\", 45]",
            "in the range or tolerance of a variable",
        ),
        (
            "STUDY",
            "[study.limits]\nfar = { max = \"r + L\" }",
            "in the limits of a measure",
        ),
    ] {
        w.write("frozen.toml", crank(place, text));
        for verb in [
            &["sensitivity", "frozen.toml", "--vary", "r"][..],
            &[
                "tolerance",
                "frozen.toml",
                "--vary",
                "r",
                "--tolerance",
                "0.1",
            ],
            &[
                "optimise",
                "frozen.toml",
                "--vary",
                "r",
                "--minimise",
                "far",
                "--within",
                "10%",
            ],
            &[
                "synthesise",
                "frozen.toml",
                "--vary",
                "r",
                "--minimise",
                "far",
                "--starts",
                "2",
            ],
            &[
                "enclose",
                "frozen.toml",
                "--vary",
                "r",
                "--tolerance",
                "0.1",
                "--samples",
                "3",
            ],
        ] {
            let run = w.run(verb);
            let said = format!("{text}: {verb:?}: {}", run.stderr);
            assert_eq!(run.code, 2, "{said}");
            assert!(
                run.stderr.contains("`r` appears") && run.stderr.contains(word),
                "{said}"
            );
        }
        // A sweep reads the scene anew.
        let run = w.run(&[
            "sweep",
            "frozen.toml",
            "--design",
            "grid:r=38..42:3",
            "--out",
            "-",
        ]);
        let table = run.text();
        let lines: Vec<&str> = table.lines().collect();
        for (line, r) in lines[1..].iter().zip([38, 40, 42]) {
            let of = |name: &str| {
                let place = lines[0].split(',').position(|head| head == name).unwrap();
                line.split(',').nth(place).unwrap().parse::<f64>().unwrap()
            };
            let scene = Scene::parse("frozen", &crank(place, text)).unwrap();
            let check = scene.with_parameter("r", f64::from(r)).unwrap();
            let check = check.check(&CheckOptions::default()).unwrap();
            let report: Value = serde_json::from_str(check.to_json()).unwrap();
            let size = report["measures"][1]["value"].as_f64().unwrap();
            assert!(
                (of("size") - size).abs() < 1e-9,
                "{text} r = {r}: {line} {size}"
            );
            if place == "LIMIT" {
                let holds = report["measures"][0]["holds"].as_bool().unwrap();
                assert_eq!(of("feasible") == 1.0, holds, "{text} r = {r}: {line}");
            }
        }
    }
}

/// The value of a measure of a scene with other values.
fn checked(scene: &Scene, name: &str, values: &[(&str, f64)]) -> f64 {
    let with =
        |scene: Scene, (name, value): &(&str, f64)| scene.with_parameter(name, *value).unwrap();
    let scene = values.iter().fold(scene.clone(), with);
    let samples = Samples::Even(180);
    let check = scene
        .check(&CheckOptions {
            samples,
            ..CheckOptions::default()
        })
        .unwrap();
    let report: Value = serde_json::from_str(check.to_json()).unwrap();
    let mut rows = report["measures"].as_array().unwrap().iter();
    rows.find(|row| row["name"] == name).unwrap()["value"]
        .as_f64()
        .unwrap()
}

/// Derivatives of measures through parameters that are computed from the variables, against differences of checks.
#[test]
fn measures_follow_computed_parameters() {
    let text = crank(
        "STUDY",
        "z = { track = \"turn\", of = \"h + twice\", take = \"max\" }\nboth = \"far + z*twice\"",
    );
    let text = text.replace("STUDY", "");
    let scene = Scene::parse("computed", &text).unwrap();
    let w = Workspace::new();
    w.write("computed.toml", &text);
    let run = w.run(&["sensitivity", "computed.toml", "--vary", "r,L"]);
    let document = run.exits(0).text();
    for (variable, start) in [("r", 40.0), ("L", 80.0)] {
        for measure in ["far", "z", "both"] {
            let step = 1e-4;
            let [low, high] =
                [-step, step].map(|by| checked(&scene, measure, &[(variable, start + by)]));
            let difference = (high - low) / (2.0 * step);
            let found = derivative(&document, measure, variable);
            assert!(
                (found - difference).abs() < 1e-4 * (1.0 + difference.abs()),
                "d{measure}/d{variable}: {found} {difference}"
            );
        }
    }
}

/// A derivative in the table of a sensitivity.
fn derivative(table: &str, measure: &str, variable: &str) -> f64 {
    let words = |line: &str| {
        line.split_whitespace()
            .map(str::to_owned)
            .collect::<Vec<_>>()
    };
    let mut rows = table.lines().map(words);
    let head = rows.find(|row| row.first().is_some_and(|word| word == "dimension"));
    let place = head
        .unwrap()
        .iter()
        .position(|word| *word == format!("d{measure}"));
    let row = rows.find(|row| row.first().is_some_and(|word| word == variable));
    row.unwrap()[place.unwrap()].parse().unwrap()
}

/// A measure beside others changes none of them.
#[test]
fn a_measure_of_the_end_leaves_sums_and_means_alone() {
    let text = crank("DRIVE", "pi*t");
    let measures = "mean = { of = \"h\", take = \"mean\" }\nsum = { of = \"h\", take = \"sum\" }\nrms = { of = \"h\", take = \"norm\", power = 2 }\n";
    let with = |more: &str| text.replace("[study.variables]", &format!("{more}[study.variables]"));
    let alone = with(measures);
    let beside = with(&format!(
        "{measures}back = {{ of = \"h\", take = \"change\" }}\n"
    ));
    let w = Workspace::new();
    let mut rows = Vec::new();
    for text in [&alone, &beside] {
        let scene = Scene::parse("sums", text).unwrap();
        w.write("sums.toml", text);
        let table = w
            .run(&[
                "sweep",
                "sums.toml",
                "--design",
                "grid:r=40..41:2",
                "--out",
                "-",
            ])
            .text();
        let proved = w
            .run(&[
                "enclose",
                "sums.toml",
                "--vary",
                "r",
                "--tolerance",
                "1e-7",
                "--samples",
                "2",
            ])
            .text();
        let heads: Vec<&str> = table.lines().next().unwrap().split(',').collect();
        let cells: Vec<&str> = table.lines().nth(1).unwrap().split(',').collect();
        for name in ["mean", "sum", "rms"] {
            let swept: f64 = cells[heads.iter().position(|head| *head == name).unwrap()]
                .parse()
                .unwrap();
            let known = checked(&scene, name, &[]);
            assert!(
                (swept - known).abs() < 1e-9 * known,
                "{name}: {swept} {known}"
            );
            let line = proved
                .lines()
                .find(|line| line.trim_start().starts_with(&format!("{name} ")))
                .unwrap();
            let ends: Vec<f64> = line
                .split_whitespace()
                .filter_map(|word| word.parse().ok())
                .collect();
            assert!(ends[0] <= known && known <= ends[1], "{line}: {known}");
            rows.push(swept);
        }
    }
    assert_eq!(rows[..3], rows[3..]);
}

/// Solids that vary, at the end of a variable's range.
#[test]
fn distances_follow_their_solids_at_the_ends_of_ranges() {
    let text = r#"
duration = 1
units = { length = "mm", angle = "rad" }
[parameters]
k = 4
d = 50
[inputs]
phi = "2*pi*t"
[outputs]
gap = { distance = ["a", "b"] }
[measures]
g = { of = "gap", take = "min" }
[[bodies]]
name = "a"
frame = "Rz(phi) Tx(20)"
shapes = [{ sphere = { radius = 6 } }]
[[bodies]]
name = "b"
shapes = [{ sphere = { center = ["d", 0, 0], radius = "k" } }]
[study]
minimise = "g"
[study.variables]
k = { range = [2, 4], tolerance = 0.1 }
d = { range = [45, 55], tolerance = 0.2 }
"#;
    let w = Workspace::new();
    w.write("gap.toml", text);
    let run = w.run(&["sensitivity", "gap.toml"]);
    let document = run.exits(0).text();
    assert!(
        (derivative(&document, "g", "k") + 1.0).abs() < 1e-6,
        "{document}"
    );
    assert!(
        (derivative(&document, "g", "d") - 1.0).abs() < 1e-6,
        "{document}"
    );
    for method in ["bfgs", "minimax"] {
        let run = w.run(&[
            "optimise",
            "gap.toml",
            "--method",
            method,
            "--json",
            "best.json",
        ]);
        assert!(run.code <= 1, "{}", run.stderr);
        let best: Value = serde_json::from_slice(&w.read("best.json")).unwrap();
        // 45 - 20 - 6 - 4
        let found = best["verified"]["measures"]["g"]
            .as_f64()
            .unwrap_or_else(|| panic!("{best}"));
        assert!((found - 15.0).abs() < 1e-3, "{method}: {best}");
    }
}
