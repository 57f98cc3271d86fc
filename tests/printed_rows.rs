//! Every printed row is as near to a closed pose as its `error_bound` says, read as the decimals that are printed.

mod draws;
mod judge;
mod program;

use judge::table::Table;
use judge::{Verdict, judge};
use program::Workspace;
use std::path::Path;

/// The size that measures angles.
fn size(folder: &Workspace, scene: &str) -> f64 {
    folder.run(&["solve", scene, "--samples", "1", "--out", "size.json", "-q"]);
    let document: serde_json::Value = serde_json::from_slice(&folder.read("size.json")).unwrap();
    document["size"].as_f64().unwrap()
}

/// The rows of a scene and its size; none where the program finds no pose at all.
fn solved(text: &str, samples: usize) -> Option<(Table, f64)> {
    let folder = Workspace::new();
    folder.write("scene.toml", text);
    let samples = samples.to_string();
    let run = folder.run(&["solve", "scene.toml", "--samples", &samples, "--out", "rows.csv", "-q"]);
    if !folder.path("rows.csv").exists() {
        assert!(run.stderr.contains("does not close"), "{}", run.stderr);
        return None;
    }
    let table = Table::parse(&String::from_utf8(folder.read("rows.csv")).unwrap());
    Some((table, size(&folder, "scene.toml")))
}

/// Complaints about a scene, and how many rows were judged.
fn judged(name: &str, text: &str, samples: usize) -> (Vec<String>, usize) {
    let Some((table, size)) = solved(text, samples) else {
        println!("{name}: no rows");
        return (Vec::new(), 0);
    };
    let verdicts = judge(text, &table, size);
    let count = verdicts.iter().filter(|v| matches!(v, Verdict::Judged { .. })).count();
    let locked = verdicts.iter().filter(|v| matches!(v, Verdict::Judged { is_locked: true, .. })).count();
    let worst = verdicts.iter().filter_map(|v| match v { Verdict::Judged { ratio, .. } => Some(*ratio), _ => None });
    let worst = worst.fold(0.0, f64::max);
    let complaints: Vec<String> = table.rows.iter().zip(&verdicts).filter_map(|(row, v)| {
        v.complaint().map(|c| format!("{name}: t = {}, bound {}: {c}", row["time"], row["error_bound"]))
    }).collect();
    println!("{name}: {count} of {} rows judged ({locked} by rotations), worst {worst:.3}, {} complaints", verdicts.len(), complaints.len());
    (complaints, count)
}

fn files(folder: &str) -> Vec<(String, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<_> = std::fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()).collect();
    files.retain(|p| p.extension().is_some_and(|e| e == "toml"));
    files.sort();
    files.iter().map(|p| (p.file_stem().unwrap().to_str().unwrap().to_owned(), std::fs::read_to_string(p).unwrap())).collect()
}

#[test]
fn scenes() {
    let mut complaints = Vec::new();
    for (name, text) in files("scenes").into_iter().chain(files("tests/hard")) {
        complaints.extend(judged(&name, &text, 9).0);
    }
    assert!(complaints.is_empty(), "{}", complaints.join("\n"));
}
