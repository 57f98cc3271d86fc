//! What happens to files that are replaced, to links, to what killed runs left, and to reports that clash.
#![cfg(unix)]

use crate::program;
use crate::program::{Workspace, moving};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::process::Stdio;
use std::time::{Duration, SystemTime};

fn workspace() -> Workspace {
    let w = Workspace::new();
    w.write("s.toml", moving());
    w
}

const SMALL: [&str; 6] = ["render", "s.toml", "--size", "16x16", "--frames", "2"];

fn render(w: &Workspace, out: &str) -> program::Run {
    w.run(&[&SMALL[..], &["--out", out]].concat())
}

#[test]
fn mode_and_owner_of_a_replaced_file_stay() {
    let w = workspace();
    for mode in [0o640, 0o600, 0o755] {
        let path = w.write("m.gif", "old");
        std::fs::set_permissions(&path, std::fs::Permissions::from_mode(mode)).unwrap();
        let may_give = std::os::unix::fs::chown(&path, Some(65534), None).is_ok();
        render(&w, "m.gif").exits(0);
        let about = std::fs::metadata(&path).unwrap();
        assert_eq!(about.mode() & 0o777, mode);
        assert!(!may_give || about.uid() == 65534, "{}", about.uid());
        assert!(w.read("m.gif").starts_with(b"GIF89a"));
    }
}

#[test]
fn links_are_followed_also_to_nothing() {
    let w = workspace();
    std::fs::create_dir(w.path("there")).unwrap();
    w.write("there/old.gif", "old");
    for (link, to) in [
        ("a.gif", "there/old.gif"),
        ("b.gif", "there/new.gif"),
        ("c.gif", "b.gif"),
    ] {
        symlink(to, w.path(link)).unwrap();
        render(&w, link).exits(0);
        assert!(w.path(link).is_symlink(), "{link}");
        assert!(w.read(to).starts_with(b"GIF89a"), "{link}");
    }
    symlink("y.gif", w.path("x.gif")).unwrap();
    symlink("x.gif", w.path("y.gif")).unwrap();
    render(&w, "x.gif").exits(2).says(&["x.gif", "circle"]);
    assert!(w.path("x.gif").is_symlink());
}

#[test]
fn a_name_that_is_too_long_is_found_before_the_work() {
    let w = workspace();
    let name = format!("{}.gif", "x".repeat(260));
    let run = w.run(&["render", "s.toml", "--frames", "100000", "--out", &name]);
    run.exits(2).says(&["too long"]);
}

#[test]
fn what_a_killed_run_left_goes_and_what_is_in_use_stays() {
    let w = workspace();
    let old = SystemTime::now() - Duration::from_secs(60);
    let mut held = Vec::new();
    for name in [
        ".mechanim-dead01.part",
        ".mechanim-used01.part",
        "other.part",
    ] {
        let file = std::fs::File::create(w.path(name)).unwrap();
        file.set_modified(old).unwrap();
        if name.contains("used") {
            file.lock().unwrap();
            held.push(file);
        }
    }
    w.write(".mechanim-young1.part", "");
    render(&w, "m.gif").exits(0);
    let left = [
        ".mechanim-used01.part",
        ".mechanim-young1.part",
        "m.gif",
        "other.part",
        "s.toml",
    ];
    assert_eq!(w.files(), left);
}

#[test]
fn reports_that_clash_are_refused_before_the_work() {
    let w = workspace();
    symlink("a.x", w.path("link.x")).unwrap();
    w.write("a.x", "old");
    for (options, says) in [
        (
            ["--json", "a.x", "--junit", "a.x"],
            "--json and --junit both go to a.x",
        ),
        (["--json", "a.x", "--junit", "./a.x"], "both go to"),
        (["--json", "a.x", "--junit", "link.x"], "both go to"),
        (["--json", "-", "--junit", "-"], "both go to -"),
        (["--json", "s.toml", "--junit", "b.x"], "is an input"),
    ] {
        // Solving would take minutes.
        let run = w.run(&[&["check", "s.toml", "--samples", "1000000"], &options[..]].concat());
        run.exits(2).says(&[says]);
        assert_eq!(w.read("a.x"), b"old");
    }
    w.run(&[
        "check",
        "s.toml",
        "--json",
        "/dev/null",
        "--junit",
        "/dev/null",
    ])
    .exits(0);
}

/// A reader that goes away early does not turn an answer into another.
#[test]
fn the_verdict_wins_over_a_closed_pipe() {
    let w = workspace();
    w.write(
        "gap.toml",
        moving().replace("2*t", "9*t").replace("Tx(40)", "Tx(81)"),
    );
    for (code, arguments) in [
        (
            1,
            &[
                "check",
                "s.toml",
                "--closure",
                "1e-300",
                "--certify",
                "none",
                "--json",
                "-",
            ][..],
        ),
        (
            1,
            &[
                "check",
                "s.toml",
                "--closure",
                "1e-300",
                "--certify",
                "none",
            ],
        ),
        (4, &["solve", "gap.toml", "--samples", "2000", "--out", "-"]),
        (4, &["check", "gap.toml", "--json", "-"]),
        (0, &["solve", "s.toml", "--samples", "2000", "--out", "-"]),
    ] {
        let (reader, writer) = std::io::pipe().unwrap();
        drop(reader);
        let child = w
            .command(arguments)
            .stdout(Stdio::from(writer))
            .spawn()
            .unwrap();
        assert_eq!(
            program::finish(child).exits(code).code,
            code,
            "{arguments:?}"
        );
    }
}

/// `ulimit -f`: the write fails as on a full disk, nothing is left and the old file stays.
#[test]
fn a_file_that_may_not_grow_is_an_error_and_leaves_nothing() {
    let w = workspace();
    w.write("m.y4m", "old");
    let program = env!("CARGO_BIN_EXE_mechanim");
    let line = format!(
        "ulimit -f 4; exec '{program}' render s.toml --size 200x200 --frames 4 --out m.y4m"
    );
    let mut shell = std::process::Command::new("sh");
    shell
        .args(["-c", &line])
        .current_dir(w.path("."))
        .stderr(Stdio::piped())
        .stdout(Stdio::piped());
    program::finish(shell.spawn().unwrap())
        .exits(2)
        .says(&["m.y4m"]);
    assert_eq!(w.files(), ["m.y4m", "s.toml"]);
    assert_eq!(w.read("m.y4m"), b"old");
}

#[test]
fn older_frames_behind_a_sequence_are_named() {
    let w = workspace();
    std::fs::create_dir(w.path("f")).unwrap();
    for frames in ["5", "3"] {
        let run = w
            .run(&[
                "render", "s.toml", "--size", "16x16", "--frames", frames, "--out", "f/",
            ])
            .exits(0);
        assert_eq!(
            run.stderr.contains("2 older frames remain"),
            frames == "3",
            "{}",
            run.stderr
        );
    }
    std::fs::create_dir(w.path("d.gif")).unwrap();
    render(&w, "d.gif").exits(2).says(&["is a folder"]);
}
