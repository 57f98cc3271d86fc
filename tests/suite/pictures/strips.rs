//! Large stills in strips: every pixel is that of the picture drawn as a whole, and of the file nothing is missing.

use crate::driven::{frame_times, solve};
use crate::program::{Workspace, moving};
use image::RgbaImage;
use mechanim::export::frame_pipeline::write_frames;
use mechanim::export::png::{Effort, PngSettings};
use mechanim::export::png_strips::StripSink;
use mechanim::export::{FrameSink, PendingFile};
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::kinematics::structure::system::System;
use mechanim::model::view::{Decor, EdgeLines, Ghosts, Shadows, ShownAxes, View};
use mechanim::pictures::frames::{DrawnBy, Pictures, with_pictures};
use mechanim::pictures::playback::PlayOrder;
use mechanim::render::open::RendererChoice;
use mechanim::render::strips::Strips;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::staging::PictureOptions;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// Even and odd sides: the last strip is shorter, and the halves of four views differ.
const SIZE: [u32; 2] = [261, 203];

fn solved(name: &str, fps: f64, change: impl Fn(&mut View)) -> (Scene, System, Trajectory) {
    let source = builtin::find_builtin(name).unwrap();
    let mut scene = load_scene(&source, &Overrides::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    change(Arc::make_mut(&mut scene.view));
    let times = frame_times(&scene, fps);
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
    let trajectory = solve(&scene, &times).unwrap();
    (scene, system, trajectory)
}

/// The first picture as a whole.
fn whole(pictures: Pictures, size: [u32; 2]) -> RgbaImage {
    let drawn_by = DrawnBy {
        renderer: RendererChoice::Cpu,
        threads: 1,
        ..DrawnBy::default()
    };
    let mut image = RgbaImage::new(size[0], size[1]);
    let mut workers = pictures.workers(&drawn_by).unwrap().list;
    workers[0](0, &mut image).unwrap();
    image
}

/// The same put together from strips, drawn from the last to the first.
fn from_strips(pictures: Pictures, strips: Strips) -> RgbaImage {
    let [width, height] = strips.size;
    let mut image = RgbaImage::new(width, height);
    let mut workers = pictures.strip_workers(strips, 1).unwrap();
    for strip in (0..strips.count()).rev() {
        let mut part = RgbaImage::new(width, strips.rows);
        workers[0](strip, &mut part).unwrap();
        let first = strips.first_row(strip);
        for (x, y, pixel) in part.enumerate_pixels() {
            if first + y < height {
                image.put_pixel(x, first + y, *pixel);
            }
        }
    }
    image
}

fn assert_alike(name: &str, samples: u32, change: impl Fn(&mut View)) {
    let options = PictureOptions {
        size: SIZE,
        samples,
    };
    assert_alike_in(name, options, &[1, 7, 32, 61, 203, 400], change);
}

fn assert_alike_in(
    name: &str,
    options: PictureOptions,
    heights: &[u32],
    change: impl Fn(&mut View),
) {
    let (size, samples) = (options.size, options.samples);
    let (scene, system, trajectory) = solved(name, 4.0, change);
    with_pictures(&scene, (&system, &trajectory), options, |mut pictures| {
        // A sample in the middle of the motion: trails, arrows and moving cameras have something to show.
        let middle = trajectory.samples.len() / 2;
        pictures.order = PlayOrder::plain(pictures.order.sample(middle), 1);
        let expected = whole(pictures, size);
        for rows in heights {
            let strips = Strips { size, rows: *rows };
            let drawn = from_strips(pictures, strips);
            let differing = drawn.pixels().zip(expected.pixels());
            let differing = differing.filter(|(a, b)| a != b).count();
            assert_eq!(differing, 0, "{name}, {samples} samples, {rows} rows");
        }
    });
}

#[test]
fn strips_have_the_pixels_of_the_whole_picture() {
    // Labels, ground and lines, in a perspective; the scene's own look.
    assert_alike("gearshift", 4, |_| ());
    assert_alike("gearshift", 1, |view| view.shadows = Shadows::All);
    assert_alike("gearshift", 16, |view| {
        view.shadows = Shadows::All;
        view.edges = EdgeLines::Outline;
    });
    assert_alike("lifting-arm", 8, |view| view.shadows = Shadows::All);
    assert_alike("four-bar", 2, |view| view.edges = EdgeLines::None);
}

/// The lines of a poster are 16 pixels wide, and the cells of its shadow maps have 27 pixels.
#[test]
fn strips_of_the_highest_pictures_have_the_pixels_of_the_whole() {
    let options = PictureOptions {
        size: [90, 14_043],
        samples: 4,
    };
    assert_alike_in("gearshift", options, &[64, 237], |view| {
        view.shadows = Shadows::All;
    });
}

#[test]
fn strips_have_all_that_is_drawn_over_the_bodies() {
    assert_alike("gearshift", 4, |view| {
        view.shadows = Shadows::All;
        view.decor = Decor {
            ghosts: Ghosts::Count(4),
            arrows: true,
            axes: ShownAxes::Corner,
            ticks: Some(0.5),
            scale: true,
            gauge: true,
            joints: true,
            ..view.decor.clone()
        };
    });
}

#[test]
fn strips_have_the_four_views_and_the_translucent_background() {
    assert_alike("gearshift", 4, |view| view.four = true);
    assert_alike("torus-torus", 4, |view| {
        view.four = true;
        view.shadows = Shadows::All;
        view.transparent = true;
    });
    assert_alike("bricard", 4, |view| view.transparent = true);
}

/// A picture without a pose has a border along all sides.
#[test]
fn strips_have_the_border_of_a_picture_without_a_pose() {
    // So many frames that the paths need no other poses.
    let (scene, system, mut trajectory) = solved("four-bar", 30.0, |_| ());
    trajectory.samples[0].pose = None;
    let options = PictureOptions {
        size: SIZE,
        samples: 4,
    };
    with_pictures(&scene, (&system, &trajectory), options, |pictures| {
        let expected = whole(pictures, SIZE);
        let strips = Strips {
            size: SIZE,
            rows: 23,
        };
        assert!(from_strips(pictures, strips) == expected);
    });
}

#[test]
fn a_file_of_strips_has_all_pixels_of_the_picture() {
    let (scene, system, trajectory) = solved("gearshift", 4.0, |_| ());
    let options = PictureOptions {
        size: SIZE,
        samples: 4,
    };
    let folder = tempfile::tempdir().unwrap();
    with_pictures(&scene, (&system, &trajectory), options, |pictures| {
        let expected = whole(pictures, SIZE);
        let path = folder.path().join("poster.png");
        for (effort, alpha, workers) in [
            (Effort::Fast, false, 1),
            (Effort::Balanced, true, 3),
            (Effort::Small, false, 2),
        ] {
            let strips = Strips {
                size: SIZE,
                rows: 19,
            };
            let settings = PngSettings {
                size: SIZE,
                effort,
                alpha,
                dpi: Some(300.0),
                texts: Vec::new(),
            };
            let output = Box::new(PendingFile::create(&path).unwrap());
            let sink = Box::new(StripSink::new(output, settings, strips.rows).unwrap());
            let workers = pictures.strip_workers(strips, workers).unwrap();
            let never = AtomicBool::new(false);
            let count = strips.count();
            let summary = write_frames(workers, count, Vec::new(), sink, &|_, _| {}, &never);
            let bytes = std::fs::read(&path).unwrap();
            let summary = summary.unwrap();
            assert_eq!((summary.frames, summary.bytes), (1, bytes.len() as u64));
            let read = image::load_from_memory(&bytes).unwrap();
            assert_eq!(read.color().has_alpha(), alpha);
            assert!(read.to_rgba8() == expected, "{effort:?}");
        }
    });
}

/// A picture of which strips are missing is an error, not a file.
#[test]
fn an_incomplete_picture_is_no_file() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("poster.png");
    let settings = PngSettings {
        size: [10, 10],
        effort: Effort::Balanced,
        alpha: false,
        dpi: None,
        texts: Vec::new(),
    };
    let output = Box::new(PendingFile::create(&path).unwrap());
    let mut sink = Box::new(StripSink::new(output, settings, 4).unwrap());
    let mut coded = Vec::new();
    let strip = RgbaImage::new(10, 4);
    sink.coder().code(&strip, &mut coded).unwrap();
    sink.write(0, &coded).unwrap();
    assert!(sink.finish().is_err());
    assert!(!path.exists());
}

/// The contents of the chunks of a kind.
fn chunks_of(png: &[u8], kind: &[u8; 4]) -> Vec<Vec<u8>> {
    let (mut rest, mut found) = (&png[8..], Vec::new());
    while let [a, b, c, d, after @ ..] = rest {
        let length = u32::from_be_bytes([*a, *b, *c, *d]) as usize;
        if &after[..4] == kind {
            found.push(after[4..4 + length].to_vec());
        }
        rest = &after[length + 8..];
    }
    found
}

/// The content of the first chunk of a kind.
fn chunk_of(png: &[u8], kind: &[u8; 4]) -> Option<Vec<u8>> {
    chunks_of(png, kind).into_iter().next()
}

/// Title, program, scene and changes stand in every PNG, in pictures and posters: a hostile title as it is shown elsewhere.
#[test]
fn pngs_tell_what_they_show() {
    let w = Workspace::new();
    let scene = moving().replace("\"moving\"", "\"\\u001b[2J Größe\"");
    w.write("s.toml", &scene);
    let input = ["--input", "phi=0.5"];
    for size in ["64x48", "4200x4100"] {
        let mut args = vec![
            "render", "s.toml", "-q", "--at", "0", "--out", "o.png", "--size", size,
        ];
        args.extend(input);
        w.run(&args).exits(0);
        let png = std::fs::read(w.path("o.png")).unwrap();
        // Keyword, uncompressed, no language, no translated keyword, text.
        let said: Vec<String> = chunks_of(&png, b"iTXt")
            .into_iter()
            .map(|text| String::from_utf8(text).unwrap().replace("\0\0\0\0\0", ": "))
            .collect();
        let software = format!("Software: mechanim {}", env!("CARGO_PKG_VERSION"));
        let expected = [
            "Title: \\u{1b}[2J Größe",
            &software,
            "Source: s.toml",
            "Comment: --input=phi=0.5",
        ];
        assert_eq!(said, expected, "{size}");
    }
}

/// What PNGs say of themselves: the colours are sRGB, and with `--dpi` so many pixels are a metre.
#[test]
fn pngs_know_their_size_on_paper() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    let render = |more: &[&str]| {
        let still = [
            "render", "s.toml", "-q", "--at", "0", "--size", "64x48", "--out", "o.png",
        ];
        w.run(&[&still[..], more].concat()).exits(0);
        std::fs::read(w.path("o.png")).unwrap()
    };
    let plain = render(&[]);
    assert_eq!(chunk_of(&plain, b"sRGB"), Some(vec![0]));
    assert_eq!(chunk_of(&plain, b"pHYs"), None);
    // 300 / 0.0254 in both directions, in metres.
    let [a, b] = 11811u32.to_be_bytes()[2..] else {
        unreachable!()
    };
    let expected = vec![0, 0, a, b, 0, 0, a, b, 1];
    assert_eq!(
        chunk_of(&render(&["--dpi", "300"]), b"pHYs"),
        Some(expected)
    );
    let gif = ["render", "s.toml", "--dpi", "300", "--out", "o.gif"];
    w.run(&gif).exits(2).says(&["--dpi has no effect on a GIF"]);
    let zero = ["render", "s.toml", "--dpi", "0", "--out", "o.png"];
    w.run(&zero).exits(2).says(&["between 1 and 10000"]);
}

/// Only what is never in memory as a whole may have more pixels, and no more than the limits permit.
#[test]
fn large_pictures_that_are_no_posters_are_refused() {
    let w = Workspace::new();
    w.write("s.toml", moving());
    for (arguments, says) in [
        (&["--out", "p.gif"][..], "64 million in all"),
        (&["--out", "p.glb"], "64 million in all"),
        (&["--out", "f/"], "64 million in all"),
        (
            &["--at", "0", "--out", "p.png", "--panel"],
            "leave out --panel",
        ),
        (
            &["--at", "0", "--out", "p.png", "--renderer", "gpu"],
            "leave out --renderer",
        ),
        (
            &["--at", "0", "--out", "p.png", "--limits", "poster=100M"],
            "the limit `poster` is 100000000, and a picture of --size, 9933 x 14043 pixels, needs",
        ),
        (
            &["--at", "0", "--out", "p.png", "--limits", "pixels=100M"],
            "the limit `poster` is 100000000",
        ),
        (
            &["--at", "0", "--out", "p.png", "--limits", "memory=60M"],
            "the limit `memory` is 60 MiB",
        ),
    ] {
        let render = ["render", "s.toml", "--size", "9933x14043"];
        let run = [&render[..], arguments].concat();
        w.run(&run).exits(2).says(&[says]);
    }
    assert_eq!(w.files(), ["s.toml"]);
}
