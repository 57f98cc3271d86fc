//! Runs that are stopped or killed leave whole parts, and go on to the same bytes.
#![cfg(unix)]

use super::{cells, run, words};
use crate::program::{Workspace, finish, interrupt};
use std::time::{Duration, Instant};

/// A thousand rows, which take a few tenths of a second.
const LONG: &str =
    "four-bar --design grid:crank=20..50:20,ex=0..90:50 --outputs K.x,K.y --samples 30";

/// Shares of a whole run after which one is killed.
const MOMENTS: [f64; 10] = [0.01, 0.07, 0.12, 0.18, 0.25, 0.31, 0.4, 0.52, 0.66, 0.83];

/// The bytes of a run in one piece, and how long it takes.
fn whole(space: &Workspace) -> (Vec<u8>, Duration) {
    let begun = Instant::now();
    let bytes = run(space, &format!("sweep {LONG} --threads 1 --out -"))
        .exits(0)
        .stdout;
    assert_eq!(cells(&bytes).len(), 1001);
    (bytes, begun.elapsed())
}

#[test]
fn a_run_that_is_killed_again_and_again_goes_on() {
    let space = Workspace::new();
    let (whole, time) = whole(&space);
    run(
        &space,
        &format!("study plan sweep {LONG} --units 50 --out study"),
    )
    .exits(0);
    let mut was_killed = 0;
    for moment in MOMENTS {
        let words = ["study", "run", "study", "--threads", "1"];
        let mut child = space.command(&words).spawn().unwrap();
        std::thread::sleep(time.mul_f64(moment));
        was_killed += u32::from(child.try_wait().unwrap().is_none());
        child.kill().unwrap();
        child.wait().unwrap();
        // Every part that is there is whole: nothing but missing items is named.
        let merge = run(&space, "study merge study");
        let lines = merge.stderr.lines();
        let other: Vec<&str> = lines.filter(|line| !line.contains(": missing")).collect();
        assert!(other.is_empty(), "{other:?}");
    }
    assert!(was_killed >= 3, "{was_killed}");
    run(&space, "study run study").exits(0);
    run(&space, "study merge study --out rows.csv").exits(0);
    assert!(space.read("rows.csv") == whole);
}

#[test]
fn a_sweep_that_is_stopped_goes_on_with_resume() {
    let space = Workspace::new();
    let (whole, time) = whole(&space);
    let line = format!("sweep {LONG} --threads 1 --out rows.csv");
    let child = space.command(&words(&line)).spawn().unwrap();
    std::thread::sleep(time.mul_f64(0.4));
    interrupt(&child);
    let stopped = finish(child);
    // A quick machine may have been done.
    if stopped.code == 130 {
        assert!(stopped.stderr.contains("--resume"), "{}", stopped.stderr);
        assert_eq!(space.files(), ["rows.csv.parts"]);
        run(&space, &line).exits(2).says(&["--resume"]);
        run(&space, &format!("{line} --resume")).exits(0);
    }
    assert!(space.read("rows.csv") == whole);
    assert_eq!(space.files(), ["rows.csv"]);
}
