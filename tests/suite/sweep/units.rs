//! A study in any units gives the bytes of a run in one piece, or says what is wrong with its parts.

use super::{SWEEP, run};
use crate::program::Workspace;
use sha2::Digest;
use std::path::PathBuf;

/// A planned and finished study in `units` units in the folder `study`.
fn done(space: &Workspace, units: u64) {
    run(
        space,
        &format!("study plan sweep {SWEEP} --units {units} --out study"),
    )
    .exits(0);
    run(space, "study run study").exits(0);
}

fn parts(space: &Workspace) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(space.path("study/parts")).unwrap();
    let mut paths: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    paths.sort();
    paths
}

#[test]
fn bytes_do_not_depend_on_the_cut() {
    let space = Workspace::new();
    let whole = run(&space, &format!("sweep {SWEEP} --out -"))
        .exits(0)
        .stdout;
    for units in [1, 2, 7, 64] {
        let space = Workspace::new();
        done(&space, units);
        assert_eq!(parts(&space).len() as u64, units);
        run(&space, "study merge study --out rows.csv").exits(0);
        assert!(space.read("rows.csv") == whole, "{units} units");
    }
}

/// Workers that begin at other units and share one folder.
#[test]
fn workers_share_a_folder() {
    let space = Workspace::new();
    let whole = run(&space, &format!("sweep {SWEEP} --out -"))
        .exits(0)
        .stdout;
    run(
        &space,
        &format!("study plan sweep {SWEEP} --units 13 --out study"),
    )
    .exits(0);
    let worker = |k: u32| {
        let own = format!("{k}/3");
        let words = ["study", "run", "study", "--worker", &own, "--threads", "1"];
        space.command(&words).spawn().unwrap()
    };
    let all: Vec<_> = (1..=3).map(worker).collect();
    for child in all {
        crate::program::finish(child).exits(0);
    }
    run(&space, "study merge study --out rows.csv").exits(0);
    assert!(space.read("rows.csv") == whole);
    assert_eq!(
        std::fs::read_dir(space.path("study/leases"))
            .unwrap()
            .count(),
        0
    );
}

#[test]
fn what_is_missing_is_named() {
    let space = Workspace::new();
    run(
        &space,
        &format!("study plan sweep {SWEEP} --units 7 --out study"),
    )
    .exits(0);
    run(&space, "study run study --unit-range 0..2").exits(0);
    run(&space, "study run study --unit-range 4..5").exits(0);
    assert_eq!(
        run(&space, "study merge study --missing").text(),
        "2-3,5-6\n"
    );
    let merge = run(&space, "study merge study --out rows.csv").exits(1);
    merge.says(&["items 128 to 255: missing", "items 320 to 447: missing"]);
    assert!(!space.path("rows.csv").exists());
    let status = run(&space, "study status study").exits(0).text();
    assert!(
        status.contains("3 of 7 units done") && status.contains("missing: 2-3,5-6"),
        "{status}"
    );
    let document = run(&space, "study status study --json -").exits(0).text();
    let document: serde_json::Value = serde_json::from_str(&document).unwrap();
    assert_eq!(
        (&document["done"], &document["units"]),
        (&3.into(), &7.into())
    );
    run(&space, "study run study --until 1s").exits(0);
    run(&space, "study run study --unit-range 3..9")
        .exits(2)
        .says(&["7 units"]);
}

#[test]
fn a_flipped_bit_is_named() {
    let space = Workspace::new();
    done(&space, 7);
    let part = &parts(&space)[3];
    let bytes = std::fs::read(part).unwrap();
    let name = part.file_name().unwrap().to_str().unwrap();
    for place in [2, 30, bytes.len() / 2, bytes.len() - 1] {
        let mut flipped = bytes.clone();
        flipped[place] ^= 4;
        std::fs::write(part, flipped).unwrap();
        let merge = run(&space, "study merge study --out rows.csv");
        assert!([1, 2].contains(&merge.code), "{place}: {}", merge.stderr);
        merge.says(&[name]);
    }
    std::fs::write(part, &bytes[..bytes.len() / 2]).unwrap();
    run(&space, "study merge study")
        .exits(1)
        .says(&[name, "not as long"]);
    std::fs::write(part, &bytes).unwrap();
    run(&space, "study merge study").exits(0);
}

/// What is damaged is not done: it is counted as missing everywhere, and the next run makes it again.
#[test]
fn damaged_parts_are_made_again() {
    let space = Workspace::new();
    done(&space, 7);
    run(&space, "study merge study --out whole.csv").exits(0);
    let part = &parts(&space)[3];
    let bytes = std::fs::read(part).unwrap();
    let flipped = |place: usize| {
        let mut flipped = bytes.clone();
        flipped[place] ^= 4;
        flipped
    };
    let half = bytes[..bytes.len() / 2].to_vec();
    for damaged in [
        flipped(30),
        flipped(bytes.len() / 2),
        flipped(bytes.len() - 1),
        half,
        Vec::new(),
    ] {
        std::fs::write(part, damaged).unwrap();
        assert_eq!(run(&space, "study merge study --missing").text(), "3\n");
        let status = run(&space, "study status study").exits(0).text();
        assert!(
            status.contains("6 of 7 units done") && status.contains("missing: 3"),
            "{status}"
        );
        let again = run(&space, "study run study").exits(0).text();
        assert!(again.contains("7 of 7 units are done"), "{again}");
        run(&space, "study merge study --out again.csv").exits(0);
        assert!(space.read("again.csv") == space.read("whole.csv"));
    }
}

#[test]
fn a_part_of_another_study_is_named() {
    let space = Workspace::new();
    done(&space, 7);
    let other = Workspace::new();
    let line = SWEEP.replace("crank=20..50", "crank=20..51");
    run(
        &other,
        &format!("study plan sweep {line} --units 7 --out study"),
    )
    .exits(0);
    run(&other, "study run study --unit-range 3..4").exits(0);
    let foreign = &parts(&other)[0];
    std::fs::copy(foreign, space.path("study/parts/strange.part")).unwrap();
    run(&space, "study merge study")
        .exits(1)
        .says(&["strange.part", "another study"]);
}

/// A straggler and its copy: the same numbers are taken once, other numbers stop everything.
#[test]
fn doubled_parts_agree_or_stop_the_merge() {
    let space = Workspace::new();
    let whole = run(&space, &format!("sweep {SWEEP} --out -"))
        .exits(0)
        .stdout;
    done(&space, 7);
    let other = Workspace::new();
    done(&other, 5);
    for part in &parts(&other)[1..3] {
        std::fs::copy(
            part,
            space.path("study/parts").join(part.file_name().unwrap()),
        )
        .unwrap();
    }
    run(&space, "study merge study --out rows.csv").exits(0);
    assert!(space.read("rows.csv") == whole);
    // Numbers of another machine with a fault: a whole part with a digest of its own.
    let part = &parts(&other)[1];
    let mut bytes = std::fs::read(part).unwrap();
    let end = bytes.len() - 32;
    bytes[end - 3] ^= 1;
    let digest = sha2::Sha256::digest(&bytes[..end]);
    bytes[end..].copy_from_slice(&digest);
    std::fs::write(
        space.path("study/parts").join(part.file_name().unwrap()),
        bytes,
    )
    .unwrap();
    let merge = run(&space, "study merge study --out other.csv").exits(1);
    merge.says(&["has other numbers in", "items-"]);
    assert!(!space.path("other.csv").exists());
}

/// Whatever lies in the place of a plan is refused at once: devices, pipes, and more units than a study has.
#[test]
fn plans_without_end_are_refused() {
    let space = Workspace::new();
    run(&space, &format!("study plan sweep {SWEEP} --out study")).exits(0);
    let plan = space.path("study/plan.json");
    let text = String::from_utf8(space.read("study/plan.json")).unwrap();
    let mut document: serde_json::Value = serde_json::from_str(&text).unwrap();
    for (key, number) in [("items", 1_u64 << 40), ("numbers", 1 << 62)] {
        let before = document[key].take();
        document[key] = number.into();
        document["items_of_a_unit"] = 1.into();
        std::fs::write(&plan, document.to_string()).unwrap();
        for verb in ["status", "run"] {
            let asked = format!("study {verb} study --limits time=60s");
            run(&space, &asked).exits(2).says(&["units, or numbers"]);
        }
        document[key] = before;
    }
    let links: [&[&str]; 2] = [&["ln", "-s", "/dev/zero"], &["mkfifo"]];
    for words in links {
        std::fs::remove_file(&plan).unwrap();
        let made = std::process::Command::new(words[0])
            .args(&words[1..])
            .arg(&plan)
            .status();
        if made.is_ok_and(|status| status.success()) {
            let asked = "study status study --limits time=60s";
            run(&space, asked).exits(2).says(&["not a regular file"]);
        }
    }
}
