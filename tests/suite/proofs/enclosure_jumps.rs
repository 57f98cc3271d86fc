//! Formulas that jump within the tolerances: no piece leaves its bands, at the samples, between them and in measures. The values of
//! the pieces are computed here.

use crate::program::Workspace;
use crate::solids::Random;
use serde_json::Value;

/// A formula of p, q and the input u as it is written, and its value.
type Formula = (&'static str, fn(f64, f64, f64) -> f64);

const FORMULAS: [Formula; 14] = [
    ("floor(3*p)", |p, _, _| (3.0 * p).floor()),
    ("p + floor(q)", |p, q, _| p + q.floor()),
    ("mod(p + q, 0.5)", |p, q, _| (p + q).rem_euclid(0.5)),
    ("q*mod(p, 1)", |p, q, _| q * p.rem_euclid(1.0)),
    ("atan2(p - 1, -q)", |p, q, _| f64::atan2(p - 1.0, -q)),
    ("floor(3*u)", |_, _, u| (3.0 * u).floor()),
    ("floor(p + 2*u)", |p, _, u| (p + 2.0 * u).floor()),
    ("mod(u - q, 0.3)", |_, q, u| (u - q).rem_euclid(0.3)),
    ("atan2(u - 0.4, -p)", |p, _, u| f64::atan2(u - 0.4, -p)),
    ("cos(atan2(u - 0.5, -q))", |_, q, u| {
        f64::atan2(u - 0.5, -q).cos()
    }),
    ("max(floor(p), floor(q))", |p, q, _| {
        p.floor().max(q.floor())
    }),
    ("abs(p - 1)*floor(q + u)", |p, q, u| {
        (p - 1.0).abs() * (q + u).floor()
    }),
    ("sqrt(9 + floor(p))", |p, _, _| (9.0 + p.floor()).sqrt()),
    ("p*q + u", |p, q, u| p * q + u),
];

/// Rounding of the values here.
const ROUNDING: f64 = 1e-13;

/// Whether a number is in a band of a document; one that is not given is no bound.
fn is_in(value: f64, band: [&Value; 2]) -> bool {
    let [lo, hi] = band.map(Value::as_f64);
    lo.is_none_or(|lo| value >= lo - ROUNDING) && hi.is_none_or(|hi| value <= hi + ROUNDING)
}

fn band_of<'v>(row: &'v Value, name: &str) -> [&'v Value; 2] {
    ["lo", "hi"].map(|end| &row[format!("{name}.{end}")])
}

/// Outputs, a traced point whose frame jumps, and measures, with nominal values on jumps and beside them.
#[test]
fn no_piece_leaves_bands_of_formulas_that_jump() {
    let w = Workspace::new();
    let mut random = Random(11);
    let mut bounded = 0;
    for round in 0..40 {
        let chosen: Vec<Formula> = (0..4)
            .map(|_| FORMULAS[random.range(0.0, FORMULAS.len() as f64) as usize])
            .collect();
        let places = [1.0, 2.0, 1.1, 0.96, 1.5, 3.0, -2.0];
        let mut place = || places[random.range(0.0, places.len() as f64) as usize];
        let (p, q) = (place(), place());
        let tolerance = [1e-6, 0.01, 0.15][round % 3];
        let outputs: Vec<String> = (chosen.iter().enumerate())
            .map(|(k, (text, _))| format!("o{k} = \"{text}\""))
            .collect();
        let takes = ["min", "max", "first", "last"];
        let measures: Vec<String> = (chosen.iter().enumerate())
            .map(|(k, (text, _))| {
                format!(
                    "m{k} = {{ track = \"R\", of = \"{text}\", take = \"{}\", min = -100 }}",
                    takes[k]
                )
            })
            .collect();
        let scene = format!(
            "duration = 1\nunits = {{ length = \"m\", angle = \"rad\" }}\n[parameters]\np = {p}\nq = {q}\n[inputs]\nu = \"t\"\n\
             [chains]\nC = \"T(u, {}, 0)\"\n[[bodies]]\nname = \"b\"\nframe = \"C\"\n[[traces]]\nname = \"K\"\nbody = \"b\"\n\
             [outputs]\n{}\n[tracks]\nR = {{ samples = 3, inputs = {{ u = [0, 1] }} }}\n[measures]\n{}\n",
            chosen[0].0,
            outputs.join("\n"),
            measures.join("\n"),
        );
        w.write("jumps.toml", &scene);
        let (tolerance_text, samples) = (tolerance.to_string(), "5");
        let run = w.run(&[
            "enclose",
            "jumps.toml",
            "--vary",
            "p,q",
            "--tolerance",
            &tolerance_text,
            "--samples",
            samples,
            "--between",
            "--out",
            "bands.json",
        ]);
        let said = run.text();
        let document: Value = serde_json::from_slice(&w.read("bands.json"))
            .unwrap_or_else(|e| panic!("{e}: {said}\n{scene}"));
        let rows = document["samples"].as_array().unwrap();
        let spans = document["stretches"].as_array().unwrap();
        for item in 0..60 {
            // Corners, the nominal piece, and others.
            let mut draw = || match item % 3 {
                0 => [-1.0, 1.0][usize::from(random.unit() < 0.5)],
                1 if item < 6 => 0.0,
                _ => random.range(-1.0, 1.0),
            };
            let (p, q) = (p + tolerance * draw(), q + tolerance * draw());
            let at = |formula: &Formula, u: f64| formula.1(p, q, u);
            for row in rows {
                let u = row["u"].as_f64().unwrap();
                for (k, formula) in chosen.iter().enumerate() {
                    let value = at(formula, u);
                    let (name, band) = (format!("o{k}"), band_of(row, &format!("o{k}")));
                    let is_in = is_in(value, band) || row[&name].is_null();
                    assert!(
                        is_in,
                        "{p} {q} {u}: {value} {band:?} of {}\n{scene}",
                        formula.0
                    );
                    bounded += usize::from(!band[0].is_null());
                }
                let band = band_of(row, "K.y");
                assert!(
                    is_in(at(&chosen[0], u), band) || row["K.y"].is_null(),
                    "{p} {q} {u}: {band:?}\n{scene}"
                );
            }
            // Everywhere in a stretch, and at its ends in one of those that meet there.
            for step in 0..=40 {
                let u = f64::from(step) / 40.0;
                let holds = |span: &&Value| {
                    let [from, until] = ["from", "until"].map(|end| span[end].as_f64().unwrap());
                    (from..=until).contains(&u)
                };
                let here: Vec<&Value> = spans.iter().filter(holds).collect();
                assert!(!here.is_empty(), "{u}\n{scene}");
                if here.iter().any(|span| span["proved"] == false) {
                    continue;
                }
                for (k, formula) in chosen.iter().enumerate() {
                    let value = at(formula, u);
                    let found = here
                        .iter()
                        .any(|span| is_in(value, band_of(span, &format!("o{k}"))));
                    assert!(
                        found,
                        "{p} {q} {u}: {value} of {}: {here:?}\n{scene}",
                        formula.0
                    );
                }
                let value = at(&chosen[0], u);
                let found = here.iter().any(|span| is_in(value, band_of(span, "K.y")));
                assert!(found, "{p} {q} {u}: {value} of K.y: {here:?}\n{scene}");
            }
            for (k, formula) in chosen.iter().enumerate() {
                let values = [0.0, 0.5, 1.0].map(|u| at(formula, u));
                let value = match takes[k] {
                    "min" => values.into_iter().fold(f64::INFINITY, f64::min),
                    "max" => values.into_iter().fold(f64::NEG_INFINITY, f64::max),
                    "first" => values[0],
                    _ => values[2],
                };
                let line = said
                    .lines()
                    .find(|line| line.trim_start().starts_with(&format!("m{k} ")));
                let Some(line) = line else { continue };
                let numbers: Vec<f64> = line
                    .split_whitespace()
                    .filter_map(|word| word.parse().ok())
                    .collect();
                let [lo, hi, ..] = numbers[..] else { continue };
                assert!(
                    value >= lo - ROUNDING && value <= hi + ROUNDING,
                    "{p} {q}: {value}: {line}\n{scene}"
                );
            }
        }
    }
    assert!(bounded > 2000, "{bounded}");
}

/// Poses at the instants of jumps belong to no stretch: they have bands of their own.
#[test]
fn poses_between_two_jumps_are_in_the_bands_of_the_whole_motion() {
    let w = Workspace::new();
    for (drive, at, value) in [
        ("\"floor(t/2)\"", 2.0, 1.0),
        ("\"floor(1 - t/2)\"", 0.0, 1.0),
        ("\"floor(t) + floor(-t) + 1\"", 1.0, 1.0),
        ("\"floor(t)*floor(2 - t)\"", 1.0, 1.0),
        (
            "{ keys = [[0, 0], [1, 3], [2, -1]], ease = \"step\" }",
            2.0,
            -1.0,
        ),
    ] {
        w.write(
            "lone.toml",
            format!(
                "duration = 2\n[parameters]\np = 1\n[inputs]\nw = {drive}\n[chains]\nC = \"T(p, w, 0)\"\n[[bodies]]\n\
                 name = \"b\"\nframe = \"C\"\n[[traces]]\nname = \"K\"\nbody = \"b\"\n"
            ),
        );
        for samples in ["2", "3", "8"] {
            let run = w.run(&[
                "enclose",
                "lone.toml",
                "--vary",
                "p",
                "--tolerance",
                "0.1",
                "--samples",
                samples,
                "--between",
                "--out",
                "lone.json",
            ]);
            run.exits(0);
            let document: Value = serde_json::from_slice(&w.read("lone.json")).unwrap();
            let spans = document["stretches"].as_array().unwrap();
            let is_there = |span: &&Value| span["from"] == at && span["until"] == at;
            let span = spans
                .iter()
                .find(is_there)
                .unwrap_or_else(|| panic!("{drive}: {spans:?}"));
            assert!(is_in(value, band_of(span, "K.y")), "{drive}: {span}");
            assert_eq!(span["proved"], true, "{drive}");
        }
    }
}
