//! Every printed row is as near to a closed pose as its `error_bound` says, read as the decimals that are printed:
//! judged with 96 digits by tests/suite/judge, which shares no code with the engine.

use crate::draws::Draws;
use crate::judge;
use crate::judge::loops::random_loop;
use crate::judge::table::Table;
use crate::judge::{Verdict, judge, judge_shown};
use crate::program::Workspace;
use std::path::Path;

/// What the program prints of a scene, and the size that measures angles.
struct Printed {
    table: Table,
    size: f64,
    /// Outputs that are angles.
    angles: Vec<String>,
}

/// Words of a scene that has no rows: nothing closes, or a random loop has a freedom too many.
const REFUSALS: [&str; 2] = [
    "the best pose found leaves",
    "are free than the inputs drive",
];

/// None where there are no rows.
fn solve(scene: &str, samples: usize) -> Option<Printed> {
    let folder = Workspace::new();
    folder.write("scene.toml", scene);
    let samples = samples.to_string();
    let solve = |samples: &str, out: &str| {
        folder.run(&[
            "solve",
            "scene.toml",
            "--samples",
            samples,
            "--out",
            out,
            "--bounds",
            "-q",
        ])
    };
    let run = solve(&samples, "rows.csv");
    if !folder.path("rows.csv").exists() {
        let is_refused = REFUSALS.iter().any(|words| run.stderr.contains(words));
        assert!(is_refused, "{}", run.stderr);
        return None;
    }
    solve("1", "size.json");
    let document: serde_json::Value = serde_json::from_slice(&folder.read("size.json")).unwrap();
    let is_angle = |unit: &serde_json::Value| ["deg", "rad"].contains(&unit.as_str().unwrap());
    let units = document["column_units"].as_object().unwrap();
    let angles = units.iter().filter(|(_, unit)| is_angle(unit));
    Some(Printed {
        angles: angles.map(|(name, _)| name.clone()).collect(),
        table: Table::parse(&String::from_utf8(folder.read("rows.csv")).unwrap()),
        size: document["size"].as_f64().unwrap(),
    })
}

/// What is wrong with the rows of many scenes.
#[derive(Default)]
struct Findings {
    judged: usize,
    /// Of these, by rotations of ball joints.
    locked: usize,
    worst: f64,
    /// Traced coordinates and outputs.
    shown: usize,
    worst_shown: f64,
    complaints: Vec<String>,
}

impl Findings {
    /// Solves and judges a scene. Returns how many rows were judged.
    fn look_at(&mut self, name: &str, scene: &str, samples: usize) -> usize {
        let Some(printed) = solve(scene, samples) else {
            return 0;
        };
        let verdicts = judge(scene, &printed.table, printed.size);
        let (mut judged, mut worst) = (0, 0.0f64);
        for (row, verdict) in printed.table.rows.iter().zip(&verdicts) {
            if let Verdict::Judged {
                ratio, is_locked, ..
            } = verdict
            {
                judged += 1;
                self.locked += usize::from(*is_locked);
                worst = worst.max(*ratio);
            }
            let complaint = verdict.complaint();
            self.complaints.extend(complaint.map(|c| {
                format!(
                    "{name}, t = {}, bound {}: {c}",
                    row["time"], row["error_bound"]
                )
            }));
        }
        for (shown, ratio) in judge_shown(scene, &printed.table, printed.size, &printed.angles) {
            self.shown += 1;
            self.worst_shown = self.worst_shown.max(ratio);
            let is_off = ratio.is_nan() || ratio > 1.0;
            self.complaints
                .extend(is_off.then(|| format!("{name}: {shown} is off by {ratio:.4} bounds")));
        }
        // Shown with --nocapture.
        println!(
            "{name}: {judged} of {} rows judged, worst {worst:.3} bounds",
            verdicts.len()
        );
        self.judged += judged;
        self.worst = self.worst.max(worst);
        judged
    }

    fn must_be_none(self) {
        let Self {
            judged,
            locked,
            worst,
            shown,
            worst_shown,
            complaints,
        } = self;
        let count = complaints.len();
        println!("{judged} rows judged, {locked} of them by rotations, worst {worst:.3} bounds");
        println!("{shown} traced coordinates and outputs, worst {worst_shown:.3} bounds");
        assert!(
            complaints.is_empty(),
            "{count} complaints:\n{}",
            complaints.join("\n")
        );
    }
}

/// Names and texts of the scenes in a folder.
fn scenes_in(folder: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let files = std::fs::read_dir(folder).unwrap();
    let mut paths: Vec<_> = files.map(|entry| entry.unwrap().path()).collect();
    paths.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    paths.sort();
    let name = |path: &Path| path.file_stem().unwrap().to_str().unwrap().to_owned();
    let read = |path: &Path| std::fs::read_to_string(path).unwrap();
    paths.iter().map(|path| (name(path), read(path))).collect()
}

#[test]
fn built_in_scenes() {
    let mut findings = Findings::default();
    for (name, text) in scenes_in("scenes") {
        let judged = findings.look_at(&name, &text, 21);
        assert!(judged >= 18, "{name}: {judged} rows were judged");
    }
    let four_bar = scenes_in("scenes")
        .into_iter()
        .find(|(name, _)| name == "four-bar");
    let (name, text) = four_bar.unwrap();
    for samples in [9, 13] {
        findings.look_at(&name, &text, samples);
    }
    findings.must_be_none();
}

/// Those without a proof: nothing closes, and two poses that are one.
const WITHOUT_PROOF: [&str; 2] = ["h08-double-root", "h10-four-bar-too-short"];

#[test]
fn hard_scenes() {
    let mut findings = Findings::default();
    for (name, text) in scenes_in("tests/hard") {
        let judged = findings.look_at(&name, &text, 13);
        assert_eq!(
            judged == 0,
            WITHOUT_PROOF.contains(&name.as_str()),
            "{name}"
        );
    }
    findings.must_be_none();
}

/// Name, unit of angle, and sections of every scene in the list of hard rows.
fn hard_row_texts() -> Vec<[String; 3]> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/hard_rows.toml");
    let text = std::fs::read_to_string(path).unwrap();
    let list = toml::de::DeTable::parse(&text).unwrap();
    let rows = list.get_ref()["rows"].get_ref().as_array().unwrap();
    let text_of = |row: &toml::de::DeTable, key| row[key].get_ref().as_str().unwrap().to_owned();
    let texts = rows.iter().map(|row| row.get_ref().as_table().unwrap());
    texts
        .map(|row| ["name", "angle", "scene"].map(|key| text_of(row, key)))
        .collect()
}

#[test]
fn hard_rows() {
    let mut findings = Findings::default();
    for [name, angle, sections] in hard_row_texts() {
        let units = format!("units = {{ length = \"mm\", angle = \"{angle}\" }}");
        let judged = findings.look_at(&name, &format!("duration = 1\n{units}\n{sections}"), 7);
        assert!(judged >= 3, "{name}: {judged} rows were judged");
    }
    findings.must_be_none();
}

#[test]
fn random_loops() {
    let (mut draws, mut findings) = (Draws(7), Findings::default());
    for number in 0..200 {
        let text = random_loop(&mut draws, number);
        findings.look_at(&format!("loop {number}"), &text, 3);
    }
    assert!(
        findings.judged > 540,
        "only {} rows were judged",
        findings.judged
    );
    findings.must_be_none();
}

/// Scenes for planted faults: of either unit, with dimensions to be changed by the last digit of 1e-12.
const TARGETS: [(&str, &str, &str); 4] = [
    ("slider-crank", "L = 80", "L = 80.000000000001"),
    ("four-bar", "coupler = 95", "coupler = 95.000000000001"),
    ("gearshift-left", "L4  = 880", "L4 = 880.000000000001"),
    ("h11-bennett", "a = 1\n", "a = 1.000000000001\n"),
];

#[test]
fn planted_faults_are_found() {
    let scenes = [scenes_in("scenes"), scenes_in("tests/hard")].concat();
    for (name, dimension, changed) in TARGETS {
        let text = &scenes.iter().find(|(n, _)| n == name).unwrap().1;
        let mut printed = solve(text, 7).unwrap();
        let other = text.replace(dimension, changed);
        assert_ne!(text, &other);
        for verdict in judge(&other, &printed.table, printed.size) {
            assert!(
                verdict.complaint().is_some(),
                "{name} with {changed}: {verdict:?}"
            );
        }
        move_one_unknown_a_row(&mut printed, text);
        for verdict in judge(text, &printed.table, printed.size) {
            assert!(
                verdict.complaint().is_some(),
                "{name}, an unknown changed: {verdict:?}"
            );
        }
    }
}

#[test]
fn a_moved_output_is_found() {
    let scenes = scenes_in("scenes");
    for (scene, shown) in [
        ("four-bar", "rocker_angle"),
        ("gearshift", "M.x"),
        ("rope-drum", "wrap"),
    ] {
        let text = &scenes.iter().find(|(n, _)| n == scene).unwrap().1;
        let mut printed = solve(text, 5).unwrap();
        let mut moved = 0;
        for row in &mut printed.table.rows {
            // A singular pose has no bounds.
            if let Ok(bound) = row[&format!("bound({shown})")].parse::<f64>() {
                let value: f64 = row[shown].parse().unwrap();
                row.insert(shown.to_owned(), (value + 3.0 * bound).to_string());
                moved += 1;
            }
        }
        let ratios = judge_shown(text, &printed.table, printed.size, &printed.angles);
        let found = ratios
            .iter()
            .filter(|(name, ratio)| name == shown && *ratio > 1.0);
        assert_eq!(found.count(), moved, "{scene}: {ratios:?}");
        assert!(moved >= 4, "{scene}");
    }
}

/// An ever turning drive, beyond where f64 angles are farther apart than loops usually close.
#[test]
fn rows_after_many_turns_keep_their_bounds() {
    let mut findings = Findings::default();
    for (unit, drive) in [("rad", "1e6*t"), ("deg", "36000000*t + 77")] {
        let text = format!(
            "duration = 1\nunits = {{ angle = \"{unit}\" }}\n[inputs]\nphi = \"{drive}\"\n[loops]\n\
             A = \"Rz(phi) Tx(40) Rz(alpha) Tx(80) Rz(beta) Tx(-h)\"\n[guess]\nh = 100\n[outputs]\nx = \"40*cos(phi)\"\n"
        );
        assert_eq!(findings.look_at(unit, &text, 11), 11, "{unit}");
    }
    findings.must_be_none();
}

/// Changes one unknown of every row, each row another one, by four times its bound.
fn move_one_unknown_a_row(printed: &mut Printed, scene: &str) {
    let unknowns = judge::unknowns(scene);
    for (k, row) in printed.table.rows.iter_mut().enumerate() {
        let (name, distance_of_one) = &unknowns[k % unknowns.len()];
        let distance_of_one = distance_of_one.map_or(1.0, |radians| radians * printed.size);
        let bound: f64 = row["error_bound"].parse().unwrap();
        let value: f64 = row[name].parse().unwrap();
        row.insert(
            name.clone(),
            (value + 4.0 * bound / distance_of_one).to_string(),
        );
    }
}

#[test]
fn the_judge_names_nothing_of_the_engine() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/suite/judge");
    for file in std::fs::read_dir(folder).unwrap() {
        let text = std::fs::read_to_string(file.unwrap().path()).unwrap();
        assert!(!text.contains(&["mechanim", "::"].concat()), "{text}");
    }
}

/// What `check` says of all poses is the worst of what `solve` prints beside each: with the rounding of the printed unknowns. That of
/// numbers far from one is all there is.
#[test]
fn checks_summarise_the_bounds_of_the_rows() {
    let folder = Workspace::new();
    let scene = |equation: &str| {
        format!("duration = 1\n[inputs]\nu = \"t\"\n[equations]\na = \"{equation} + 0*u\"\n")
    };
    folder.write("long.toml", scene("1073741824*x - 4503599627370497"));
    folder.write("large.toml", scene("1e-17*x - 1"));
    let scenes = [
        "slider-crank",
        "gearshift",
        "seven-r",
        "sarrus",
        "long.toml",
        "large.toml",
    ];
    for name in scenes {
        let samples = ["--samples", "11"];
        folder.run(&[&["check", name, "--json", "r.json"], &samples[..]].concat());
        folder.run(&[&["solve", name, "--out", "rows.csv"], &samples[..]].concat());
        let report: serde_json::Value = serde_json::from_slice(&folder.read("r.json")).unwrap();
        let rows = String::from_utf8(folder.read("rows.csv")).unwrap();
        let mut lines = rows.lines();
        let column = lines
            .next()
            .unwrap()
            .split(',')
            .position(|c| c == "error_bound");
        let bounds = lines.map(|row| {
            row.split(',')
                .nth(column.unwrap())
                .unwrap()
                .parse::<f64>()
                .unwrap()
        });
        let worst = bounds.fold(0.0, f64::max);
        let told = report["error_bound"].as_f64().unwrap();
        // A check also looks at the keys of its drives; bounds in tables are rounded up once more.
        let told = told * (1.0 + 2.0 * f64::EPSILON);
        assert!(told >= worst, "{name}: {told} {worst}");
        // The root is no f64 there: half a unit in the last place is the least that any bound can say.
        if name.ends_with(".toml") {
            assert!(
                told <= worst * (1.0 + 4.0 * f64::EPSILON),
                "{name}: {told} {worst}"
            );
            assert!(worst > 1e-10, "{name}: {worst}");
        }
    }
}
