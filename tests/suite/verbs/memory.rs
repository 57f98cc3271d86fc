//! How much memory runs take: each must end as it should under a limit that it is promised to stay below.
//!
//! Motions are measured by what ten times as many samples add, since the program and its libraries are not the motion's.

use crate::draws::Draws;
use crate::program::{Workspace, is_full, moving, peak_bytes, with_mesh};
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
        let check = ["check", "s.toml", "--samples", "3", "-q"];
        w.run(&[&check[..], &["--limits", most]].concat())
            .exits(0)
            .says_nothing();
        println!("{count} bodies: {:.0} MB", peak(&w, &check) / 1e6);
    }
}

/// The most bytes that a run has in memory, looked at a thousand times a second.
fn peak(w: &Workspace, arguments: &[&str]) -> f64 {
    let mut child = w.command(arguments).spawn().unwrap();
    let path = format!("/proc/{}/status", child.id());
    let mut most = 0.0f64;
    while child.try_wait().unwrap().is_none() {
        let status = std::fs::read_to_string(&path).unwrap_or_default();
        most = most.max(peak_bytes(&status));
        std::thread::sleep(Duration::from_millis(1));
    }
    assert!(child.wait().unwrap().success(), "{arguments:?}");
    most
}

/// A binary STL file of triangles without a common corner, all over a cube.
fn scattered_triangles(count: u32) -> Vec<u8> {
    let mut draws = Draws(1);
    let mut bytes = [&[0; 80][..], &count.to_le_bytes()].concat();
    for _ in 0..count {
        let centre = [(); 3].map(|()| 50.0 * draws.number());
        bytes.extend([0; 12]);
        for _ in 0..3 {
            let corner = centre.map(|c| (c + draws.number()) as f32);
            bytes.extend(corner.iter().flat_map(|c| c.to_le_bytes()));
        }
        bytes.extend([0; 2]);
    }
    bytes
}

#[test]
fn a_large_mesh_is_drawn_in_little_memory() {
    let w = Workspace::new();
    let (count, most) = if is_full() {
        (1_900_000, 600e6)
    } else {
        (190_000, 120e6)
    };
    w.write("m.stl", scattered_triangles(count));
    w.write("s.toml", with_mesh("m.stl"));
    let still = [
        "render", "s.toml", "-q", "--at", "0", "--size", "800x600", "--out", "o.png",
    ];
    let taken = peak(&w, &still);
    println!("{count} triangles: {:.0} MB", taken / 1e6);
    assert!(taken < most, "{taken}");
}

/// A poster is drawn in strips: it takes little more memory than one of a tenth of its pixels.
#[test]
fn a_poster_is_drawn_in_the_memory_of_its_strips() {
    let w = Workspace::new();
    let size = if is_full() { "9933x14043" } else { "3512x4967" };
    let poster = [
        "render",
        "gearshift",
        "-q",
        "--at",
        "1.45",
        "--size",
        size,
        "--out",
        "o.png",
    ];
    let taken = peak(&w, &poster);
    println!("a picture of {size} pixels: {:.0} MB", taken / 1e6);
    assert!(taken < 300e6, "{taken}");
}

/// Bodies of one file share its mesh: what every one adds are its triangles on the screen. With meshes of their own 20 take six
/// times as much as one.
#[test]
fn bodies_of_one_file_are_drawn_in_little_more_memory_than_one() {
    let w = Workspace::new();
    w.write("m.stl", scattered_triangles(60_000));
    let still = [
        "render", "s.toml", "-q", "--at", "0", "--size", "200x150", "--out", "o.png",
    ];
    let [one, many] = [1, 20].map(|count| {
        let body = |k: usize| {
            format!("[[bodies]]\nname = \"b{k}\"\nframe = \"Tx({k}) Rz({k}*phi)\"\nshapes = [{{ stl = {{ file = \"m.stl\", surface = true }} }}]\n")
        };
        let bodies: String = (0..count).map(body).collect();
        w.write("s.toml", format!("duration = 1\n[inputs]\nphi = \"2*t\"\n{bodies}"));
        peak(&w, &still)
    });
    println!("1 body {:.0} MB, 20 bodies {:.0} MB", one / 1e6, many / 1e6);
    assert!(many < 4.0 * one, "{one} {many}");
}

/// Tables are written row by row: of a motion of a million samples nothing is held but the motion. Measured at a tenth.
#[test]
fn tables_take_no_memory_beside_the_motion() {
    let count = if is_full() { 1_000_000 } else { 100_000 };
    // 100 MB for a million samples.
    let beside = 100.0 * count as f64;
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
    let of_motion = holds(count) - holds(10);
    for out in ["o.csv", "o.json"] {
        let added = solve(count, out) - solve(10, out);
        println!(
            "{count} samples to {out}: {:.1} MB beside the {:.1} MB of the motion",
            (added - of_motion) / 1e6,
            of_motion / 1e6
        );
        assert!(added < of_motion + beside, "{out}: {added} {of_motion}");
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
    let frames = if is_full() { "10000" } else { "4000" };
    let (short, long) = (film("200"), film(frames));
    println!(
        "200 frames {:.1} MB, {frames} frames {:.1} MB",
        short / 1e6,
        long / 1e6
    );
    assert!(long < short + 10e6, "{short} {long}");
}
