//! Many scenes in one run of `check`, scenes of one's own from `new`, and runs after every change with `--watch`.

use crate::program::Workspace;
use mechanim::scene::builtin;
use serde_json::Value;

const FOUR_BAR: &str = include_str!("../../../scenes/four-bar.toml");

/// A scene that passes, one that fails, one that cannot be read.
fn workspace() -> Workspace {
    let w = Workspace::new();
    w.write("good.toml", FOUR_BAR);
    w.write(
        "near.toml",
        FOUR_BAR.replace("minimum = 0.5", "minimum = 50"),
    );
    w.write("wrong.txt", FOUR_BAR.replace("[loops]", "[lops]"));
    w
}

#[test]
fn the_worst_scene_decides() {
    let w = workspace();
    let run = w
        .run(&[
            "check",
            "*.toml",
            "slider-crank",
            "--json",
            "r.json",
            "--junit",
            "r.xml",
            "--jobs",
            "2",
        ])
        .exits(1);
    let text = run.text();
    let summary: Vec<&str> = text.lines().rev().take(4).collect();
    assert_eq!(summary[3], "3 scenes", "{text}");
    assert_eq!(summary[2], "  good.toml     passed");
    assert!(summary[1].starts_with("  near.toml     failed: "), "{text}");
    assert_eq!(summary[0], "  slider-crank  passed");
    // Every scene says what it says alone.
    for scene in ["good.toml", "near.toml", "slider-crank"] {
        let alone = w.run(&["check", scene, "--json", "one.json"]);
        assert!(text.contains(&alone.text()), "{scene}");
        let one: Value = serde_json::from_slice(&w.read("one.json")).unwrap();
        let all: Value = serde_json::from_slice(&w.read("r.json")).unwrap();
        assert_eq!(all["schema"], "mechanim-checks/1");
        let list = all["scenes"].as_array().unwrap();
        let entry = list.iter().find(|entry| entry["scene"] == scene).unwrap();
        assert_eq!(entry["report"]["result"], one["result"]);
        assert_eq!(entry["exit_code"], alone.code);
        assert_eq!(entry["report"]["clearance"], one["clearance"]);
    }
    let junit = String::from_utf8(w.read("r.xml")).unwrap();
    assert_eq!(junit.matches("<testsuite ").count(), 3, "{junit}");
}

#[test]
fn a_scene_with_mistakes_is_told_and_the_others_are_checked() {
    let w = workspace();
    let run = w.run(&[
        "check",
        "wrong.txt",
        "good.toml",
        "--junit",
        "r.xml",
        "--sarif",
        "r.sarif",
        "--summary",
        "r.md",
    ]);
    let run = run
        .exits(2)
        .says(&["lops", "1 of 2 scenes could not be checked"]);
    assert!(
        run.text()
            .contains("  wrong.txt  cannot be checked\n  good.toml  passed\n")
    );
    let junit = String::from_utf8(w.read("r.xml")).unwrap();
    assert!(
        junit.contains("errors=\"1\"") && junit.contains("can be checked"),
        "{junit}"
    );
    let sarif: Value = serde_json::from_slice(&w.read("r.sarif")).unwrap();
    let results = sarif["runs"][0]["results"].as_array().unwrap();
    assert_eq!(results.len(), 1);
    assert_eq!(results[0]["ruleId"], "scene");
    let summary = String::from_utf8(w.read("r.md")).unwrap();
    assert!(
        summary.contains("| wrong.txt |")
            && summary.contains("| good.toml | Four-bar linkage | passed |"),
        "{summary}"
    );
}

/// A report of an earlier run must not be taken for one of this run.
#[test]
fn a_single_scene_that_cannot_be_checked_has_reports_that_say_so() {
    let w = workspace();
    let files = ["r.json", "r.xml", "r.sarif", "r.md"];
    let reports = [
        "--json",
        files[0],
        "--junit",
        files[1],
        "--sarif",
        files[2],
        "--summary",
        files[3],
    ];
    let rows: [(&[&str], &str); 3] = [
        (&["wrong.txt"], "lops"),
        (&["missing.toml"], "No such file"),
        (&["good.toml", "--param", "nothing=3"], "nothing"),
    ];
    for (scene, why) in rows {
        w.run(&[&["check", "good.toml"], &reports[..]].concat())
            .exits(0);
        w.run(&[&["check"], scene, &reports[..]].concat())
            .exits(2)
            .prints_nothing()
            .says(&[why]);
        let json: Value = serde_json::from_slice(&w.read(files[0])).unwrap();
        assert_eq!(json["schema"], "mechanim-check/1");
        assert_eq!(json["result"], "cannot be checked");
        assert_eq!(json["checks"][0]["group"], "scene");
        assert!(
            json["checks"][0]["text"].as_str().unwrap().contains(why),
            "{json}"
        );
        let junit = String::from_utf8(w.read(files[1])).unwrap();
        assert!(
            junit.contains("errors=\"1\"") && junit.contains("cannot-be-checked"),
            "{junit}"
        );
        let sarif: Value = serde_json::from_slice(&w.read(files[2])).unwrap();
        assert_eq!(sarif["runs"][0]["results"][0]["level"], "error");
        let summary = String::from_utf8(w.read(files[3])).unwrap();
        assert!(summary.contains("cannot be checked"), "{summary}");
    }
}

#[test]
fn what_is_about_one_scene_is_refused_for_several() {
    let w = workspace();
    let options: [&[&str]; 4] = [
        &["--plot", "p.svg"],
        &["--csv", "-"],
        &["--pose", "a=1"],
        &["--inputs-box", "phi=0:1"],
    ];
    for option in options {
        let run = w
            .run(&[&["check", "good.toml", "near.toml"], option].concat())
            .exits(2);
        run.prints_nothing().says(&[
            "works on a single scene, and there are several",
            "mechanim report",
        ]);
    }
    w.run(&["check", "-", "good.toml"])
        .exits(2)
        .says(&["standard input is one scene"]);
    w.run(&["check", "none?.toml"])
        .exits(2)
        .says(&["no file matches `none?.toml`"]);
    // A report never lands on any of the scenes.
    let run = w
        .run(&["check", "good.toml", "near.toml", "--json", "near.toml"])
        .exits(2);
    run.says(&["is an input of this command"]);
}

#[test]
fn sarif_and_summary_of_one_scene_name_what_failed() {
    let w = workspace();
    w.run(&[
        "check",
        "near.toml",
        "--sarif",
        "r.sarif",
        "--summary",
        "r.md",
    ])
    .exits(1);
    let sarif: Value = serde_json::from_slice(&w.read("r.sarif")).unwrap();
    assert_eq!(sarif["version"], "2.1.0");
    let results = sarif["runs"][0]["results"].as_array().unwrap();
    assert!(
        !results.is_empty()
            && results
                .iter()
                .all(|r| r["level"] == "error" && r["ruleId"] == "clearance")
    );
    let place = &results[0]["locations"][0]["physicalLocation"]["artifactLocation"]["uri"];
    assert_eq!(place, "near.toml");
    let summary = String::from_utf8(w.read("r.md")).unwrap();
    assert!(summary.contains("- **failed**: "), "{summary}");
    w.run(&[
        "check",
        "near.toml",
        "--sarif",
        "r.json",
        "--json",
        "r.json",
    ])
    .exits(2)
    .says(&["both go to"]);
}

#[test]
fn new_scenes_pass_and_replace_nothing() {
    let w = Workspace::new();
    for scene in ["four-bar", "slider-crank", "gearshift"] {
        let name = format!("my {scene}");
        w.run(&["new", &name, "--from", scene])
            .exits(0)
            .says(&["next: mechanim check"]);
        let file = format!("{name}.toml");
        let text = w.run(&["check", &file]).exits(0).text();
        assert!(text.starts_with(&format!("{name}\n")), "{text}");
    }
    let before = w.read("my four-bar.toml");
    w.run(&["new", "my four-bar.toml", "--from", "four-bar"])
        .exits(2)
        .says(&["already exists"]);
    assert_eq!(w.read("my four-bar.toml"), before);
    w.run(&["new", "x", "--from", "fourbar"])
        .exits(2)
        .says(&["did you mean `four-bar`?"]);
    assert!(!w.path("x.toml").exists());
    assert_eq!(builtin::ALL[0].name, "gearshift");
}

#[test]
fn watching_needs_a_file() {
    let w = Workspace::new();
    w.run(&["check", "four-bar", "--watch"])
        .exits(2)
        .says(&["--watch needs a file"]);
}

/// Runs after a change, shows a mistake and waits for its end, and ends by Ctrl-C.
#[cfg(unix)]
#[test]
fn watching_runs_again_after_every_change() {
    use std::io::{BufRead, BufReader};
    use std::time::Duration;
    let w = Workspace::new();
    w.write("s.toml", FOUR_BAR);
    let arguments = ["plot", "s.toml", "--out", "p.svg", "--watch"];
    let mut child = w.command(&arguments).spawn().unwrap();
    let mut lines = BufReader::new(child.stderr.take().unwrap()).lines();
    let mut until = |word: &str| {
        let found = lines
            .by_ref()
            .map(Result::unwrap)
            .find(|line| line.contains(word));
        found.unwrap_or_else(|| panic!("the run ended before `{word}`"))
    };
    until("run 1 ended with exit code 0");
    let first = w.read("p.svg");
    std::thread::sleep(Duration::from_millis(300));
    w.write("s.toml", FOUR_BAR.replace("[loops]", "[lops]"));
    until("run 2 ended with exit code 2");
    assert_eq!(w.read("p.svg"), first);
    w.write("s.toml", FOUR_BAR.replace("rocker = 80", "rocker = 82"));
    until("run 3 ended with exit code 0");
    assert_ne!(w.read("p.svg"), first);
    crate::program::interrupt(&child);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}
