//! Videos by another program: what it is given, what becomes of its file, what is said where there is none.

#![cfg(unix)]

use crate::program::{Run, Workspace, finish, interrupt};
use std::os::unix::fs::PermissionsExt;
use std::time::{Duration, Instant};

const FILM: [&str; 4] = ["render", "four-bar", "--size", "64x48"];

/// A folder with a program called `ffmpeg` that is this script, and no other program on the path.
fn with_encoder(script: &str) -> Workspace {
    let ws = Workspace::new();
    std::fs::create_dir(ws.path("bin")).unwrap();
    let program = ws.write("bin/ffmpeg", format!("#!/bin/sh\n{script}\n"));
    std::fs::set_permissions(program, PermissionsExt::from_mode(0o755)).unwrap();
    ws
}

/// Everything the script needs stands in these folders of every system.
fn command(ws: &Workspace, out: &str, frames: &str) -> std::process::Command {
    let mut command = ws.command(&[&FILM[..], &["--frames", frames, "--out", out]].concat());
    let bin = ws.path("bin").display().to_string();
    command.env("PATH", format!("{bin}:/usr/bin:/bin"));
    command
}

fn film(ws: &Workspace, out: &str) -> Run {
    finish(command(ws, out, "4").spawn().unwrap())
}

/// Takes the last argument for its file, as `file:PATH`.
const LAST: &str = "for last; do :; done; echo \"$@\" > arguments; to=${last#file:}";

#[test]
fn the_encoder_gets_raw_frames_and_its_file_goes_to_its_place() {
    for (out, codec) in [
        ("a.mp4", "libx264"),
        ("a.webm", "libvpx-vp9"),
        ("a.webp", "libwebp_anim"),
    ] {
        let ws = with_encoder(&format!("{LAST}; cat > \"$to\""));
        let said = film(&ws, out).exits(0).stderr;
        film(&ws, "a.y4m").exits(0);
        assert!(ws.read(out) == ws.read("a.y4m"), "{out}");
        let bytes = ws.read(out).len() as f64 / 1e6;
        assert!(said.contains(&format!("{bytes:.2} MB")), "{said}");
        let arguments = String::from_utf8(ws.read("arguments")).unwrap();
        assert!(arguments.contains(codec), "{arguments}");
        let mut files = ["a.y4m", out, "arguments", "bin"];
        files.sort_unstable();
        assert_eq!(ws.files(), files);
    }
}

#[test]
fn an_encoder_that_fails_leaves_what_was_there() {
    let cases = [
        // At once, after some frames, after all of them.
        "echo 'Unknown encoder' >&2; exit 3",
        "head -c 5000 >/dev/null; echo 'Unknown encoder' >&2; exit 3",
        "cat >/dev/null; echo 'Unknown encoder' >&2; exit 3",
    ];
    for script in cases {
        let ws = with_encoder(script);
        ws.write("a.mp4", "old");
        film(&ws, "a.mp4")
            .exits(2)
            .says(&["a.mp4", "ffmpeg ended", "Unknown encoder"]);
        assert_eq!(ws.read("a.mp4"), b"old");
        assert_eq!(ws.files(), ["a.mp4", "bin"]);
    }
}

#[test]
fn without_an_encoder_the_message_says_what_to_do() {
    for out in ["a.webm", "a.webp"] {
        let ws = Workspace::new();
        let mut command = ws.command(&[&FILM[..], &["--out", out]].concat());
        command.env("PATH", ws.path("nowhere"));
        let run = finish(command.spawn().unwrap());
        run.exits(2).says(&[out, "ffmpeg", ".y4m"]);
        assert!(ws.files().is_empty());
    }
}

#[test]
fn a_video_is_an_ordinary_file() {
    let ws = with_encoder("cat >/dev/null");
    film(&ws, "/dev/null").exits(2);
    let arguments = [&FILM[..], &["--out", "-", "--format", "mp4"]].concat();
    ws.run(&arguments).exits(2).says(&["ordinary file"]);
    let arguments = [&FILM[..], &["--out", "/dev/null", "--format", "mp4"]].concat();
    ws.run(&arguments).exits(2).says(&["ordinary file"]);
}

#[test]
fn ctrl_c_ends_the_encoder_too() {
    let ws = with_encoder(&format!("{LAST}; echo $$ > id; exec sleep 60"));
    let child = command(&ws, "a.mp4", "100000").spawn().unwrap();
    let begun = Instant::now();
    let id = loop {
        let id = std::fs::read_to_string(ws.path("id")).unwrap_or_default();
        if id.ends_with('\n') {
            break id;
        }
        assert!(begun.elapsed() < Duration::from_secs(20));
        std::thread::sleep(Duration::from_millis(10));
    };
    interrupt(&child);
    finish(child).exits(130);
    assert_eq!(ws.files(), ["arguments", "bin", "id"]);
    // One that has ended may stay in the list of processes until somebody asks for its end.
    let runs = || {
        let about = std::fs::read_to_string(format!("/proc/{}/stat", id.trim()));
        about.is_ok_and(|stat| !stat.contains(") Z"))
    };
    let begun = Instant::now();
    while runs() && begun.elapsed() < Duration::from_secs(5) {
        std::thread::sleep(Duration::from_millis(20));
    }
    assert!(!runs());
}

/// Decodes what the program wrote, where it is installed.
#[test]
#[ignore = "needs ffmpeg: run with --include-ignored"]
fn videos_show_the_frames() {
    let ws = Workspace::new();
    std::fs::create_dir(ws.path("f")).unwrap();
    ws.run(&[
        "render",
        "gearshift",
        "--frames",
        "6",
        "--size",
        "321x241",
        "--out",
        "f/",
    ])
    .exits(0);
    for out in ["a.mp4", "a.webm"] {
        ws.run(&[
            "render",
            "gearshift",
            "--frames",
            "6",
            "--size",
            "321x241",
            "--out",
            out,
        ])
        .exits(0);
        std::fs::create_dir(ws.path("back")).unwrap();
        let decoded = std::process::Command::new("ffmpeg")
            .current_dir(ws.path("."))
            .args(["-loglevel", "error", "-i", out, "back/%04d.png"])
            .status();
        assert!(decoded.unwrap().success());
        for k in 0..6 {
            let frame = image::open(ws.path(&format!("f/frame-{k:04}.png")))
                .unwrap()
                .to_rgb8();
            let back = image::open(ws.path(&format!("back/{:04}.png", k + 1)))
                .unwrap()
                .to_rgb8();
            assert_eq!(back.dimensions(), (320, 240));
            let pairs = back.enumerate_pixels().flat_map(|(x, y, p)| {
                let q = frame.get_pixel(x, y).0;
                [0, 1, 2].map(|c| f64::from(p.0[c].abs_diff(q[c])))
            });
            let (sum, count) = pairs.fold((0.0, 0.0), |(s, n), d| (s + d * d, n + 1.0));
            let decibels = 10.0 * (255.0_f64.powi(2) * count / sum).log10();
            assert!(decibels > 32.0, "{out}, frame {k}: {decibels} dB");
        }
        std::fs::remove_dir_all(ws.path("back")).unwrap();
    }
}
