//! How much memory runs take: each must end as it should under a limit that it is promised to stay below.
//!
//! Motions are measured by what ten times as many samples add, since the program and its libraries are not the motion's.

use crate::program::{Workspace, moving};
use std::fmt::Write as _;
use std::time::Duration;

/// So many spheres in a row, every one on an angle of its own, all to be kept apart.
fn spheres(count: usize) -> String {
    let mut scene =
        "title = \"spheres\"\nduration = 1\nunits = { length = \"mm\" }\n[inputs]\nphi = \"2*t\"\n\
                     [clearance]\nminimum = 0.1\n"
            .to_owned();
    for k in 0..count {
        let (at, speed) = (3 * k, k % 7 + 1);
        write!(
            scene,
            "[[bodies]]\nname = \"b{k}\"\nframe = \"Tx({at}) Rz({speed}*phi)\"\n\
             shapes = [{{ sphere = {{ center = [0.2, 0, 0], radius = 1 }} }}]\n"
        )
        .unwrap();
    }
    scene
}

#[test]
fn thousands_of_bodies_are_checked_in_little_memory() {
    let w = Workspace::new();
    for (count, most) in [(1000, "memory=200M"), (2000, "memory=400M")] {
        w.write("s.toml", spheres(count));
        w.run(&["check", "s.toml", "--samples", "3", "-q", "--limits", most])
            .exits(0)
            .says_nothing();
    }
}

/// The most bytes that a run has in memory, looked at a thousand times a second.
fn peak(w: &Workspace, arguments: &[&str]) -> f64 {
    let mut child = w.command(arguments).spawn().unwrap();
    let path = format!("/proc/{}/status", child.id());
    let mut most = 0.0f64;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(&path).unwrap_or_default();
        let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
        let kib = line.and_then(|line| line.split_whitespace().next()?.parse::<f64>().ok());
        most = most.max(1024.0 * kib.unwrap_or(0.0));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success(), "{arguments:?}");
    most
}

/// Tables are written row by row: of a motion of a million samples nothing is held but the motion. Measured at a tenth.
#[test]
fn tables_take_no_memory_beside_the_motion() {
    const SAMPLES: usize = 100_000;
    /// Of 100 MB for a million samples.
    const BESIDE: f64 = 10e6;
    let w = Workspace::new();
    w.write("s.toml", moving());
    let solve = |samples: usize, out: &str| {
        let samples = samples.to_string();
        let arguments = ["solve", "s.toml", "--certify", "none", "-q", "--samples"];
        peak(&w, &[&arguments[..], &[&samples, "--out", out]].concat())
    };
    // A check of a scene without bodies holds the motion and nothing else.
    let holds = |samples: usize| {
        let samples = samples.to_string();
        let arguments = ["check", "s.toml", "--certify", "none", "-q", "--samples"];
        peak(&w, &[&arguments[..], &[&samples]].concat())
    };
    let of_motion = holds(SAMPLES) - holds(10);
    for out in ["o.csv", "o.json"] {
        let added = solve(SAMPLES, out) - solve(10, out);
        println!(
            "{SAMPLES} samples to {out}: {:.1} MB beside the {:.1} MB of the motion",
            (added - of_motion) / 1e6,
            of_motion / 1e6
        );
        assert!(added < of_motion + BESIDE, "{out}: {added} {of_motion}");
    }
}

/// Frames go to the file as they are drawn.
#[test]
fn long_films_take_no_more_memory_than_short_ones() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    let film = |frames: &str| {
        peak(
            &w,
            &[
                "render", "s.toml", "-q", "--size", "32x24", "--frames", frames, "--out", "o.gif",
            ],
        )
    };
    let (short, long) = (film("200"), film("4000"));
    println!(
        "200 frames {:.1} MB, 4000 frames {:.1} MB",
        short / 1e6,
        long / 1e6
    );
    assert!(long < short + 10e6, "{short} {long}");
}
