//! What happens to files that are replaced, to links, to what killed runs left, and to reports that clash.
#![cfg(unix)]

use crate::program;
use crate::program::{Workspace, moving};
use std::os::unix::fs::{MetadataExt, PermissionsExt, symlink};
use std::process::Stdio;
use std::time::{Duration, Instant, SystemTime};

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

/// Frames take the places of older ones together, when all are there.
#[test]
fn an_interrupted_sequence_leaves_the_older_frames() {
    let w = workspace();
    let frames = |count: &str, size: &str| {
        w.command(&[
            "render",
            "s.toml",
            "-q",
            "--size",
            size,
            "--frames",
            count,
            "--threads",
            "1",
            "--out",
            "f/",
        ])
    };
    program::finish(frames("40", "16x16").spawn().unwrap()).exits(0);
    let names = || {
        let entries = std::fs::read_dir(w.path("f")).unwrap();
        let names = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap());
        let mut names: Vec<String> = names.collect();
        names.sort();
        names
    };
    let old: Vec<(String, Vec<u8>)> = names()
        .into_iter()
        .map(|name| (name.clone(), w.read(&format!("f/{name}"))))
        .collect();
    assert_eq!(old.len(), 40);
    let child = frames("60", "1600x1200").spawn().unwrap();
    let begun = Instant::now();
    // A hidden folder, and in it the first frames.
    let waiting = || {
        let hidden = names().into_iter().find(|name| name.starts_with('.'));
        hidden.is_some_and(|name| {
            std::fs::read_dir(w.path("f").join(name)).is_ok_and(|d| d.count() > 1)
        })
    };
    while !waiting() {
        assert!(begun.elapsed() < Duration::from_secs(100));
        std::thread::sleep(Duration::from_millis(5));
    }
    program::interrupt(&child);
    program::finish(child)
        .exits(130)
        .says(&["nothing was written"]);
    let now: Vec<(String, Vec<u8>)> = names()
        .into_iter()
        .map(|name| (name.clone(), w.read(&format!("f/{name}"))))
        .collect();
    assert!(now == old, "{:?}", names());
    // And a whole run replaces them.
    program::finish(frames("40", "20x20").spawn().unwrap()).exits(0);
    assert_eq!(names().len(), 40);
    assert!(
        old.iter()
            .all(|(name, bytes)| w.read(&format!("f/{name}")) != *bytes)
    );
}

/// A folder of waiting frames that a killed run has left goes like its files; one in use stays.
#[test]
fn folders_of_waiting_frames_go_when_their_run_is_dead() {
    let w = workspace();
    let old = SystemTime::now() - Duration::from_secs(60);
    let mut held = None;
    for name in [".mechanim-dead02.part", ".mechanim-used02.part"] {
        std::fs::create_dir(w.path(name)).unwrap();
        w.write(&format!("{name}/0"), "frame");
        let folder = std::fs::File::open(w.path(name)).unwrap();
        folder.set_modified(old).unwrap();
        if name.contains("used") {
            folder.lock().unwrap();
            held = Some(folder);
        }
    }
    render(&w, "m.gif").exits(0);
    assert_eq!(w.files(), [".mechanim-used02.part", "m.gif", "s.toml"]);
    drop(held);
}

/// Whatever a run reads it does not write over: tables and meshes, too.
#[test]
fn meshes_and_tables_are_inputs() {
    let w = workspace();
    w.run(&["render", "s.toml", "--at", "0", "--out", "m.stl"])
        .exits(0);
    let mesh = w.read("m.stl");
    w.write("m.toml", program::with_mesh("m.stl"));
    w.write("t.csv", "phi\n0.1\n0.2\n");
    symlink("m.stl", w.path("link.json")).unwrap();
    for arguments in [
        &["render", "m.toml", "--at", "0", "--out", "m.stl"][..],
        &["render", "m.toml", "--at", "0", "--out", "./m.stl"],
        &["check", "m.toml", "--json", "m.stl"],
        &["check", "m.toml", "--json", "link.json"],
        &["check", "s.toml", "m.toml", "--json", "m.stl"],
        &["solve", "m.toml", "--inputs", "t.csv", "--out", "t.csv"],
        &["plot", "m.toml", "--out", "link.json"],
    ] {
        w.run(arguments).exits(2);
        assert!(w.read("m.stl") == mesh, "{arguments:?}");
        assert_eq!(w.read("t.csv").len(), 12, "{arguments:?}");
    }
    // A page of the first scene would stand where the second one does.
    std::fs::create_dir(w.path("d")).unwrap();
    w.write("d/a.toml", moving());
    w.write("a.html", moving());
    w.run(&["site", "d/a.toml", "a.html", "--out", "."])
        .exits(2)
        .says(&["is an input"]);
    assert_eq!(w.read("a.html"), moving().into_bytes());
    w.write("a.png", "old");
    w.run(&[
        "render", "s.toml", "--at", "0", "--size", "16x16", "--out", "a.png",
    ])
    .exits(0);
    w.run(&[
        "diff", "a.png", "a.png", "--out", "b.png", "--json", "b.png",
    ])
    .exits(2)
    .says(&["both go to"]);
}

/// What `--watch` looks at is a file of the size that a scene may have.
#[test]
fn nothing_endless_is_watched() {
    let w = Workspace::new();
    for scene in ["/dev/zero", "."] {
        let run = w.run(&[
            "check",
            scene,
            "--watch",
            "--limits",
            "memory=300M,time=20s",
        ]);
        run.exits(2).says(&["--watch"]);
    }
}

/// Whatever a command reads besides its scene is not written over either.
#[test]
fn tables_studies_and_goldens_are_inputs_too() {
    let w = Workspace::new();
    w.write(
        "f.toml",
        mechanim::scene::builtin::find_builtin("four-bar")
            .unwrap()
            .text,
    );
    w.write("d.csv", "crank\n30\n31\n");
    symlink(w.path("d.csv"), w.path("link.csv")).unwrap();
    let sweep = ["sweep", "f.toml", "--design", "d.csv", "--outputs", "K.x"];
    for out in ["d.csv", "link.csv", "./d.csv"] {
        let run = w.run(&[&sweep[..], &["--out", out]].concat());
        run.exits(2).says(&["is an input of this command"]);
    }
    let plan = [
        "study",
        "plan",
        "sweep",
        "f.toml",
        "--design",
        "d.csv",
        "--outputs",
        "K.x",
    ];
    w.run(&[&plan[..], &["--out", "st"]].concat()).exits(0);
    w.run(&["study", "run", "st"]).exits(0);
    for name in [
        "st/plan.json",
        "st/design.csv",
        "st/parts/new.json",
        "st/leases/x",
    ] {
        for arguments in [
            ["study", "status", "st", "--json", name],
            ["study", "merge", "st", "--out", name],
        ] {
            w.run(&arguments)
                .exits(2)
                .says(&["is an input of this command"]);
        }
    }
    // A file of one's own beside them is written.
    w.run(&["study", "merge", "st", "--out", "st/rows.csv"])
        .exits(0);
    assert!(
        String::from_utf8(w.read("st/rows.csv"))
            .unwrap()
            .contains("K.x")
    );
    assert_eq!(w.read("d.csv"), b"crank\n30\n31\n");
}

/// What was started with `nohup` goes on when the terminal goes away.
#[test]
fn hangups_that_were_ignored_stay_ignored() {
    let w = Workspace::new();
    let program = env!("CARGO_BIN_EXE_mechanim");
    let line = format!(
        "trap '' HUP; exec {program} render gearshift --frames 20 --size 64x48 --out o.gif --quiet"
    );
    let mut shell = std::process::Command::new("sh");
    let child = shell
        .arg("-c")
        .arg(line)
        .current_dir(w.path(""))
        .stderr(Stdio::null())
        .spawn();
    let mut child = child.unwrap();
    std::thread::sleep(Duration::from_millis(60));
    let hangup = std::process::Command::new("kill")
        .arg("-HUP")
        .arg(child.id().to_string())
        .status();
    assert!(hangup.is_ok());
    assert!(child.wait().unwrap().success());
    assert!(w.read("o.gif").starts_with(b"GIF89a"));
}
