//! Random pieces in units: sums put together to the same bytes for any cut, which say what all pieces in one run say.

use super::run;
use crate::program::Workspace;
use serde_json::Value;

/// Pieces of which a few leave their lanes.
const PIECES: &str = "gearshift --vary L4,L6s,ZR1 --tolerance 2 --pieces 3001 --seed 3";

fn json(bytes: &[u8]) -> Value {
    serde_json::from_slice(bytes).unwrap()
}

/// A planned and finished study in the folder `study`, and its report.
fn done(units: u64) -> (Workspace, Vec<u8>) {
    let space = Workspace::new();
    let line = format!("study plan tolerance {PIECES} --units {units} --out study");
    let plan = run(&space, &line).exits(0).text();
    assert!(plan.contains("3001 pieces in"), "{plan}");
    run(&space, "study run study --threads 2").exits(0);
    run(&space, "study merge study --out report.json").exits(0);
    let report = space.read("report.json");
    (space, report)
}

#[test]
fn reports_do_not_depend_on_the_cut() {
    let (space, whole) = done(1);
    let text = run(&space, "study merge study").exits(0).text();
    for units in [2, 7, 64] {
        let (space, report) = done(units);
        assert!(report == whole, "{units} units");
        assert_eq!(run(&space, "study merge study").exits(0).text(), text);
    }
    let status = run(&space, "study status study").exits(0).text();
    assert!(status.contains("3001 pieces"), "{status}");
    // What is said of the pieces when all of them are kept.
    let line = format!("tolerance {PIECES} --json kept.json");
    run(&space, &line).exits(0);
    let (kept, summed) = (json(&space.read("kept.json")), json(&whole));
    for same in [
        "schema",
        "title",
        "dimensions",
        "samples",
        "seed",
        "failed",
        "good",
        "digest",
    ] {
        assert_eq!(kept[same], summed[same], "{same}");
    }
    let measures = kept["measures"].as_object().unwrap();
    assert_eq!(measures.len(), 10);
    for (name, kept) in measures {
        let summed = &summed["measures"][name];
        for same in [
            "nominal",
            "linear_sum",
            "linear_deviation",
            "found",
            "never_beyond",
        ] {
            assert_eq!(kept[same], summed[same], "{name}: {same}");
        }
        let deviation = kept["deviation"].as_f64().unwrap();
        for near in ["mean", "deviation"] {
            let [a, b] = [kept, summed].map(|v| v[near].as_f64().unwrap());
            assert!((a - b).abs() <= 1e-9 * deviation, "{name}: {near} {a} {b}");
        }
        for (share, value) in kept["quantiles"].as_object().unwrap() {
            let ends = summed["quantiles"][share].as_array().unwrap();
            let [low, high] = [0, 1].map(|k| ends[k].as_f64().unwrap());
            let value = value.as_f64().unwrap();
            // The file's units round once more.
            let slack = 1e-12 * value.abs();
            assert!(
                low - slack <= value && value <= high + slack,
                "{name}: {share}"
            );
            assert!(high - low <= 0.02 * deviation, "{name}: {share}");
        }
    }
}

#[test]
fn parts_of_sums_that_are_missing_broken_or_doubled_are_named() {
    let (space, whole) = done(7);
    let part = |first: u64, end: u64| format!("study/parts/items-{first:012}-{end:012}.part");
    let (lost, other) = (part(429, 858), part(858, 1287));
    let bytes = space.read(&lost);
    std::fs::remove_file(space.path(&lost)).unwrap();
    let merge = run(&space, "study merge study").exits(1);
    merge.says(&["items 429 to 857: missing"]);
    let mut flipped = bytes.clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 1;
    space.write(&lost, &flipped);
    run(&space, "study merge study")
        .exits(1)
        .says(&["is broken"]);
    space.write(&lost, &bytes[..middle]);
    run(&space, "study merge study")
        .exits(1)
        .says(&["is broken"]);
    // The sums of a unit of another cut hold pieces that others hold, too.
    let (wide, _) = done(2);
    space.write(&lost, &bytes);
    space.write(&part(0, 1501), wide.read(&part(0, 1501)));
    let merge = run(&space, "study merge study").exits(1);
    merge.says(&["in two parts"]);
    std::fs::remove_file(space.path(&part(0, 1501))).unwrap();
    // Part of another study: other random numbers.
    let foreign = Workspace::new();
    let line = PIECES.replace("--seed 3", "--seed 4");
    let line = format!("study plan tolerance {line} --units 7 --out study");
    run(&foreign, &line).exits(0);
    run(&foreign, "study run study --unit-range 2..3").exits(0);
    space.write(&other, foreign.read(&other));
    let merge = run(&space, "study merge study").exits(1);
    merge.says(&["is a part of another study"]);
    std::fs::remove_file(space.path(&other)).unwrap();
    run(&space, "study run study").exits(0);
    run(&space, "study merge study --out again.json").exits(0);
    assert!(space.read("again.json") == whole);
}

#[test]
fn what_cannot_be_meant_of_pieces_is_refused() {
    let space = Workspace::new();
    let plan = |rest: &str| format!("study plan tolerance gearshift --out study {rest}");
    for (rest, why) in [
        ("--tolerance 0.1 --pieces 1e19", "whole number"),
        ("--tolerance 0.1 --pieces 0", "whole number"),
        ("--tolerance 0.1 --pieces nan", "whole number"),
        ("--tolerance 0", "0"),
        ("--pieces 10", "there is no tolerance"),
        ("--tolerance 0.1 --vary nothing", "nothing"),
        (
            "--tolerance 0.1 --inputs t.csv",
            "--input-table cannot be used",
        ),
    ] {
        run(&space, &plan(rest)).exits(2).says(&[why]);
    }
    assert!(space.files().is_empty(), "{:?}", space.files());
    run(
        &space,
        &plan("--vary L4 --tolerance 0.1 --pieces 20 --units 2"),
    )
    .exits(0);
    run(&space, "study run study").exits(0);
    for asked in ["--out rows.csv", "--out rows.jsonl", "--plot map.svg"] {
        let merge = run(&space, &format!("study merge study {asked}")).exits(2);
        merge.says(&["keeps only sums"]);
    }
}
