//! Pictures, plots and films of studies, as their readers decode them; and studies that are interrupted.

use crate::program;
use crate::program::Workspace;
use image::{AnimationDecoder, RgbImage};
use std::io::BufRead;

/// A slider-crank with a traced pin on the rod, whose stroke is to be 100.
const CRANK: &str = r##"title = "stroke"
duration = 1
units = { length = "mm", angle = "deg" }
[parameters]
r = 40
L = 80
[inputs]
phi = "360*t"
[chains]
crank = "Rz(phi) Tx(r)"
rod = "crank Rz(alpha)"
[loops]
A = "rod Tx(L) Rz(beta) Tx(-h)"
[guess]
h = 120
[tracks]
turn = { samples = 37, inputs = { phi = [0, 360] } }
back = { samples = 19, inputs = { phi = [0, 180] } }
[measures]
stroke = { track = "back", of = "-h", take = "change" }
size = { track = "turn", of = "M.y", take = "range" }
miss = "(stroke - 100)^2"
[study]
minimise = "miss"
[study.variables]
r = { range = [20, 70], tolerance = 2 }
L = { tolerance = 1 }
[[bodies]]
name = "rod"
frame = "rod"
colour = "#7f7f7f"
shapes = [{ capsule = { from = [0, 0, 0], to = ["L", 0, 0], radius = 4 } }]
[[traces]]
name = "M"
body = "rod"
point = ["L/2", 0, 0]
colour = "#d81b60"
"##;

fn workspace() -> Workspace {
    let w = Workspace::new();
    w.write("crank.toml", CRANK);
    w
}

fn picture(w: &Workspace, name: &str) -> RgbImage {
    image::load_from_memory(&w.read(name)).unwrap().to_rgb8()
}

/// Pixels of the trace's colour, more or less mixed with what is behind it.
fn reddish(image: &RgbImage) -> usize {
    let red = |p: &&image::Rgb<u8>| i32::from(p[0]) > i32::from(p[1]) + 25;
    image.pixels().filter(red).count()
}

#[test]
fn bars_name_every_dimension_and_measure() {
    let w = workspace();
    for file in ["bars.svg", "bars.png"] {
        w.run(&["sensitivity", "crank.toml", "--plot", file])
            .exits(0);
    }
    let svg = String::from_utf8(w.read("bars.svg")).unwrap();
    for text in [
        ">dmiss<",
        ">dstroke [mm]<",
        ">r<",
        ">L<",
        ">per mm<",
        ">2.00<",
    ] {
        assert!(svg.contains(text), "{text}");
    }
    // Ranked by the objective, which comes first.
    assert!(svg.find(">dmiss<") < svg.find(">dstroke") && svg.find(">r<") < svg.find(">L<"));
    assert!(picture(&w, "bars.png").width() >= 500);
    w.run(&["sensitivity", "crank.toml", "--plot", "bars.gif"])
        .exits(2)
        .says(&["unknown kind of plot"]);
}

#[test]
fn clouds_of_paths_are_drawn_and_do_not_depend_on_threads() {
    let w = workspace();
    let run = |more: &[&str]| {
        let base = [
            "tolerance",
            "crank.toml",
            "--vary",
            "r,L",
            "--pieces",
            "300",
        ];
        w.run(&[&base[..], more].concat()).exits(0);
    };
    run(&["--picture", "a.png", "--plot", "a.svg", "--threads", "1"]);
    run(&["--picture", "b.png", "--plot", "b.svg", "--threads", "2"]);
    assert_eq!(w.read("a.png"), w.read("b.png"));
    assert_eq!(w.read("a.svg"), w.read("b.svg"));
    run(&["--picture", "wide.png", "--enlarge", "30"]);
    run(&["--picture", "thin.png", "--enlarge", "0.001"]);
    let [thin, usual, wide] = ["thin.png", "a.png", "wide.png"].map(|n| reddish(&picture(&w, n)));
    assert!(
        0 < thin && 2 * thin < usual && usual < wide,
        "{thin} {usual} {wide}"
    );
    let svg = String::from_utf8(w.read("a.svg")).unwrap();
    // Two tracks of one point: two panels with two bands each.
    assert_eq!(svg.matches("<polygon").count(), 4);
    assert!(svg.contains("M along turn") && svg.contains("M along back"));
    w.write(
        "bare.toml",
        CRANK
            .split("[[traces]]")
            .next()
            .unwrap()
            .replace("M.y", "h"),
    );
    w.run(&[
        "tolerance",
        "bare.toml",
        "--vary",
        "r,L",
        "--pieces",
        "9",
        "--plot",
        "c.svg",
    ])
    .exits(2)
    .says(&["but the scene has none"]);
    w.run(&[
        "tolerance",
        "crank.toml",
        "--vary",
        "r,L",
        "--picture",
        "c.gif",
    ])
    .exits(2)
    .says(&["unknown kind of picture"]);
}

#[test]
fn a_film_shows_every_improvement() {
    let w = workspace();
    let run = [
        "optimise",
        "crank.toml",
        "--vary",
        "r,L",
        "--method",
        "nelder-mead",
    ];
    w.run(&[&run[..], &["--film", "film.gif", "--out", "best.toml"]].concat())
        .exits(0)
        .says(&["film.gif: "]);
    let bytes = w.read("film.gif");
    let decoder = image::codecs::gif::GifDecoder::new(std::io::Cursor::new(bytes)).unwrap();
    let frames = decoder.into_frames().collect_frames().unwrap();
    assert!(frames.len() > 2, "{}", frames.len());
    let (first, last) = (frames[0].buffer(), frames[frames.len() - 1].buffer());
    assert_eq!(first.dimensions(), (640, 480));
    let changed = first
        .pixels()
        .zip(last.pixels())
        .filter(|(a, b)| a != b)
        .count();
    assert!(changed > 1000, "{changed}");
    // The last frame stays longer.
    let stay = |k: usize| {
        let (numerator, denominator) = frames[k].delay().numer_denom_ms();
        numerator / denominator
    };
    assert!(stay(frames.len() - 1) >= 5 * stay(0));
    w.run(&[
        "render",
        "best.toml",
        "--at",
        "0.2",
        "--size",
        "64x48",
        "--out",
        "best.png",
    ])
    .exits(0);
    w.run(&["optimise", "crank.toml", "--film", "film.png"])
        .exits(2)
        .says(&["cannot contain an animation"]);
}

/// Starts a run, waits for its first line on standard error, and interrupts it.
#[cfg(unix)]
fn interrupted(w: &Workspace, arguments: &[&str]) -> program::Run {
    let mut child = w.command(arguments).spawn().unwrap();
    let mut errors = std::io::BufReader::new(child.stderr.take().unwrap());
    let mut line = String::new();
    errors.read_line(&mut line).unwrap();
    program::interrupt(&child);
    let mut rest = String::new();
    std::io::Read::read_to_string(&mut errors, &mut rest).unwrap();
    let run = program::finish(child);
    program::Run {
        stderr: line + &rest,
        ..run
    }
}

#[test]
#[cfg(unix)]
fn ctrl_c_keeps_the_best_so_far() {
    let w = workspace();
    let plain = ["--progress", "plain"];
    // All dimensions of a lever whose paths have kinks: a search of hundreds of iterations.
    let search = [
        "optimise",
        "gearshift",
        "--vary",
        "all",
        "--within",
        "20%",
        "--out",
        "best.toml",
    ];
    let run = interrupted(&w, &[&search[..], &plain].concat()).exits(130);
    let text = run.text();
    run.says(&[
        "iteration 50",
        "interrupted; the best result so far was written to best.toml",
    ]);
    assert!(text.contains("interrupted, best so far"), "{text}");
    w.run(&["check", "best.toml", "--samples", "9"]).exits(0);
    let pairs = ["optimise", "gearshift", "--pairs", "--threads", "1"];
    let run = interrupted(&w, &[&pairs[..], &plain].concat()).exits(130);
    assert!(run.text().contains("pairs optimised"));
    run.says(&["interrupted; the ranking contains", "of 231 pairs"]);
    let pieces = [
        "tolerance",
        "gearshift",
        "--tolerance",
        "0.5",
        "--pieces",
        "60000",
    ];
    let run = interrupted(&w, &[&pieces[..], &plain].concat()).exits(130);
    assert!(run.text().contains("Digest"));
    run.says(&["interrupted; the report is that of the first"]);
    let search = ["synthesise", "sphere-sphere", "--out", "found.toml"];
    let run = interrupted(&w, &search).exits(130);
    assert!(run.text().contains("stopped"));
    run.says(&["the best result so far was reported"]);
    w.run(&[
        "solve",
        "found.toml",
        "--samples",
        "9",
        "--out",
        "motion.csv",
    ])
    .exits(0);
}
