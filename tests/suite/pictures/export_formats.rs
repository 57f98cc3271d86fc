//! APNG, PNG settings and raw video, judged by reading them back with other people's decoders.

use crate::frames::{flat, run, shaded};
use image::codecs::png::PngDecoder;
use image::{AnimationDecoder, Rgba, RgbaImage};
use mechanim::export::apng::{ApngSettings, ApngSink};
use mechanim::export::png::{Effort, PngSettings, StillSink};
use mechanim::export::raw::{Chroma, RawKind, RawSink};
use mechanim::export::timing::FrameTimes;
use mechanim::export::{ExportSummary, FrameSink, Output, PendingFile};
use std::io::Cursor;

/// Writes to a file of its own and returns the bytes.
fn written(
    count: usize,
    draw: fn(usize) -> RgbaImage,
    open: impl FnOnce(Box<dyn Output>) -> Box<dyn FrameSink>,
) -> (Vec<u8>, ExportSummary) {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let sink = open(Box::new(PendingFile::create(&path).unwrap()));
    let summary = run(3, count, draw, sink).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(summary.bytes, bytes.len() as u64);
    assert_eq!(summary.frames, count);
    (bytes, summary)
}

fn apng(draw: fn(usize) -> RgbaImage, settings: ApngSettings) -> (Vec<u8>, ExportSummary) {
    written(settings.times.count(), draw, |output| {
        Box::new(ApngSink::new(output, settings).unwrap())
    })
}

fn settings(draw: fn(usize) -> RgbaImage, fps: f64, count: usize) -> ApngSettings {
    ApngSettings {
        size: draw(0).dimensions().into(),
        times: FrameTimes::Uniform { fps, count },
        repeat: true,
        effort: Effort::Balanced,
        alpha: false,
    }
}

/// The frames as a viewer shows them.
fn shown(bytes: &[u8]) -> Vec<RgbaImage> {
    let decoder = PngDecoder::new(Cursor::new(bytes)).unwrap();
    let frames = decoder.apng().unwrap().into_frames();
    frames.map(|f| f.unwrap().into_buffer()).collect()
}

/// Contents of the chunks of a kind.
fn chunks<'a>(bytes: &'a [u8], kind: &[u8; 4]) -> Vec<&'a [u8]> {
    let (mut rest, mut found) = (&bytes[8..], Vec::new());
    while !rest.is_empty() {
        let length = u32::from_be_bytes(rest[..4].try_into().unwrap()) as usize;
        if &rest[4..8] == kind {
            found.push(&rest[8..8 + length]);
        }
        rest = &rest[12 + length..];
    }
    found
}

fn number(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0, |n, b| 256 * n + u32::from(*b))
}

/// Rectangle (x, y, width, height) and delay (numerator, denominator) of every frame.
fn controls(bytes: &[u8]) -> Vec<([u32; 4], [u32; 2])> {
    let controls = chunks(bytes, b"fcTL");
    let controls = controls.iter().map(|c| {
        let area = [12, 16, 4, 8].map(|at| number(&c[at..at + 4]));
        (area, [20, 22].map(|at| number(&c[at..at + 2])))
    });
    controls.collect()
}

#[test]
fn every_frame_of_an_apng_is_exact() {
    for effort in [Effort::Fast, Effort::Balanced, Effort::Small] {
        for draw in [shaded, flat] {
            let settings = ApngSettings {
                effort,
                ..settings(draw, 25.0, 30)
            };
            let (bytes, summary) = apng(draw, settings);
            assert!((summary.seconds - 1.2).abs() < 1e-9);
            for (k, frame) in shown(&bytes).iter().enumerate() {
                assert!(*frame == draw(k), "frame {k}");
            }
        }
    }
}

#[test]
fn an_apng_says_how_often_it_plays_and_how_many_frames_it_has() {
    for (repeat, plays) in [(true, 0), (false, 1)] {
        let settings = ApngSettings {
            repeat,
            ..settings(flat, 25.0, 7)
        };
        let (bytes, _) = apng(flat, settings);
        let [control] = chunks(&bytes, b"acTL")[..] else {
            panic!()
        };
        assert_eq!([number(&control[..4]), number(&control[4..])], [7, plays]);
        assert_eq!(shown(&bytes).len(), 7);
        assert_eq!(chunks(&bytes, b"IEND").len(), 1);
    }
}

#[test]
fn delays_of_an_apng_add_up_exactly() {
    for (fps, delay) in [
        (30.0, [1, 30]),
        (60.0, [1, 60]),
        (30000.0 / 1001.0, [1001, 30000]),
        (0.01, [65535, 655]),
    ] {
        let count = if fps > 1.0 { 1000 } else { 2 };
        let (bytes, summary) = apng(|k| flat(k / 50), settings(flat, fps, count));
        let controls = controls(&bytes);
        assert_eq!(controls.len(), count);
        let seconds: f64 = controls
            .iter()
            .map(|c| f64::from(c.1[0]) / f64::from(c.1[1]))
            .sum();
        let asked = count as f64 / fps;
        assert!((seconds - asked).abs() <= 6e-4 * asked, "{fps}: {seconds}");
        assert!((summary.seconds - seconds).abs() < 1e-6);
        if fps > 1.0 {
            assert!((seconds - asked).abs() < 1e-9 * asked, "{fps}: {seconds}");
            assert!(controls.iter().all(|c| c.1 == delay), "{:?}", controls[0]);
        }
    }
    let times = FrameTimes::At {
        starts: vec![7.0, 7.104, 7.5],
        end: 8.0,
    };
    let settings = ApngSettings {
        times,
        ..settings(flat, 1.0, 3)
    };
    let (bytes, _) = apng(flat, settings);
    let delays: Vec<[u32; 2]> = controls(&bytes).iter().map(|c| c.1).collect();
    assert_eq!(delays, [[1040, 10000], [3960, 10000], [5000, 10000]]);
}

#[test]
fn only_what_changes_is_sent() {
    let (bytes, _) = apng(|k| flat(k / 2), settings(flat, 25.0, 6));
    let areas: Vec<[u32; 4]> = controls(&bytes).iter().map(|c| c.0).collect();
    assert_eq!(areas[0], [0, 0, 20, 14]);
    // Equal frames are one pixel, moved discs less than the picture.
    assert_eq!([areas[1], areas[3], areas[5]], [[0, 0, 1, 1]; 3]);
    assert!([areas[2], areas[4]].iter().all(|a| a[2] < 10 && a[3] < 10));
}

/// A disc that fades: every alpha from 0 to 255.
fn translucent(k: usize) -> RgbaImage {
    RgbaImage::from_fn(20, 14, |x, y| {
        Rgba([200, 90, x as u8 * 10, (x * 13 + y + k as u32 * 5) as u8])
    })
}

#[test]
fn translucent_frames_keep_their_alpha() {
    let settings = ApngSettings {
        alpha: true,
        ..settings(translucent, 25.0, 9)
    };
    let (bytes, _) = apng(translucent, settings);
    for (k, frame) in shown(&bytes).iter().enumerate() {
        assert!(*frame == translucent(k), "frame {k}");
    }
    let settings = PngSettings {
        size: [20, 14],
        effort: Effort::Balanced,
        alpha: true,
        dpi: None,
        texts: Vec::new(),
    };
    let (bytes, _) = written(1, translucent, |output| {
        Box::new(StillSink::new(output, settings).unwrap())
    });
    let decoded = image::load_from_memory(&bytes).unwrap();
    assert_eq!(decoded.color(), image::ColorType::Rgba8);
    assert_eq!(decoded.to_rgba8(), translucent(0));
}

#[test]
fn apngs_of_one_frame_and_of_one_pixel_are_pictures_too() {
    fn dot(k: usize) -> RgbaImage {
        RgbaImage::from_pixel(1, 1, Rgba([k as u8, 2, 3, 255]))
    }
    for count in [1, 3] {
        let (bytes, _) = apng(dot, settings(dot, 25.0, count));
        assert_eq!(shown(&bytes), (0..count).map(dot).collect::<Vec<_>>());
        assert_eq!(image::load_from_memory(&bytes).unwrap().to_rgba8(), dot(0));
    }
    let folder = tempfile::tempdir().unwrap();
    let output = Box::new(PendingFile::create(&folder.path().join("a.apng")).unwrap());
    assert!(ApngSink::new(output, settings(dot, 25.0, 0)).is_err());
    let output = Box::new(PendingFile::create(&folder.path().join("a.apng")).unwrap());
    let sink = Box::new(ApngSink::new(output, settings(dot, 25.0, 5)).unwrap());
    run(1, 3, dot, sink).unwrap_err();
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
}

/// Flat surfaces, as our own pictures are, and a smooth one, as photographs are.
#[test]
fn smaller_settings_are_smaller_and_the_same_picture() {
    fn smooth(k: usize) -> RgbaImage {
        RgbaImage::from_fn(96, 72, |x, y| {
            let wave = |a: u32, b: u32| (a * a / 40 + b * 2 + k as u32) as u8;
            Rgba([wave(x, y), wave(y, x), wave(x + y, x), 255])
        })
    }
    let sizes = |draw: fn(usize) -> RgbaImage| {
        [Effort::Fast, Effort::Balanced, Effort::Small].map(|effort| {
            let still = PngSettings {
                size: [96, 72],
                effort,
                alpha: false,
                dpi: None,
                texts: Vec::new(),
            };
            let (bytes, _) = written(1, draw, |output| {
                Box::new(StillSink::new(output, still).unwrap())
            });
            assert_eq!(image::load_from_memory(&bytes).unwrap().to_rgba8(), draw(0));
            let moving = ApngSettings {
                effort,
                ..settings(draw, 25.0, 6)
            };
            [bytes.len(), apng(draw, moving).0.len()]
        })
    };
    for draw in [shaded, smooth] {
        let sizes = sizes(draw);
        for kind in 0..2 {
            let [fast, balanced, small] = sizes.map(|s| s[kind]);
            // The highest level of packing may lose a few bytes to the usual one.
            assert!(
                fast > small && balanced + balanced / 100 >= small,
                "{sizes:?}"
            );
            assert!(balanced < 2 * small, "{sizes:?}");
        }
    }
}

#[test]
fn a_y4m_says_what_it_holds_and_holds_it() {
    let kind = RawKind::Y4m {
        chroma: Chroma::Full,
        fps: 30000.0 / 1001.0,
    };
    let (bytes, summary) = written(5, shaded, |output| {
        Box::new(RawSink::new(output, kind, [96, 72]).unwrap())
    });
    assert!((summary.seconds - 5.0 * 1001.0 / 30000.0).abs() < 1e-12);
    let end = bytes.iter().position(|b| *b == b'\n').unwrap();
    let header = std::str::from_utf8(&bytes[..end]).unwrap();
    assert_eq!(
        header,
        "YUV4MPEG2 W96 H72 F30000:1001 Ip A1:1 C444 XCOLORRANGE=LIMITED"
    );
    let plane = 96 * 72;
    let frames = bytes[end + 1..].chunks(6 + 3 * plane);
    assert_eq!(frames.len(), 5);
    for (k, frame) in frames.enumerate() {
        let (mark, planes) = frame.split_at(6);
        assert_eq!(mark, b"FRAME\n");
        for (i, pixel) in shaded(k).pixels().enumerate() {
            let [y, cb, cr] = [0, 1, 2].map(|p| f64::from(planes[p * plane + i]));
            // The inverse of BT.709 in the limited range.
            let (y, cb, cr) = (
                (y - 16.0) / 219.0,
                (cb - 128.0) / 224.0,
                (cr - 128.0) / 224.0,
            );
            let (r, b) = (y + 1.5748 * cr, y + 1.8556 * cb);
            let g = (y - 0.2126 * r - 0.0722 * b) / 0.7152;
            for (back, code) in [r, g, b].into_iter().zip(pixel.0) {
                assert!((255.0 * back - f64::from(code)).abs() < 2.0, "{pixel:?}");
            }
        }
    }
}

#[test]
fn raw_pixels_are_the_frames_one_after_the_other() {
    let kind = RawKind::Rgba { fps: 25.0 };
    let (bytes, summary) = written(4, flat, |output| {
        Box::new(RawSink::new(output, kind, [20, 14]).unwrap())
    });
    assert!((summary.seconds - 0.16).abs() < 1e-12);
    assert_eq!(
        bytes,
        (0..4).flat_map(|k| flat(k).into_raw()).collect::<Vec<_>>()
    );
}

/// Runs the documented line where the program is installed; in CI it is.
#[test]
#[ignore = "needs ffmpeg: run with --include-ignored"]
fn ffmpeg_reads_the_video_with_the_right_colours() {
    use std::process::Command;
    let folder = tempfile::tempdir().unwrap();
    let at = |name: &str| folder.path().join(name);
    let sink = RawSink::new(
        Box::new(PendingFile::create(&at("a.y4m")).unwrap()),
        RawKind::Y4m {
            fps: 20.0,
            chroma: Chroma::Full,
        },
        [96, 72],
    );
    run(2, 8, shaded, Box::new(sink.unwrap())).unwrap();
    let ffmpeg = |arguments: &[&str]| {
        let run = Command::new("ffmpeg")
            .current_dir(folder.path())
            .args(["-loglevel", "error", "-y"])
            .args(arguments)
            .status();
        assert!(run.expect("ffmpeg is installed").success(), "{arguments:?}");
    };
    let tags = "setparams=colorspace=bt709:color_primaries=bt709:color_trc=bt709,format=yuv420p";
    let quarter = RawSink::new(
        Box::new(PendingFile::create(&at("q.y4m")).unwrap()),
        RawKind::Y4m {
            fps: 20.0,
            chroma: Chroma::Quarter,
        },
        [96, 72],
    );
    run(2, 8, shaded, Box::new(quarter.unwrap())).unwrap();
    ffmpeg(&[
        "-i",
        "q.y4m",
        "-pix_fmt",
        "yuv444p",
        "-vf",
        "scale=in_range=tv:out_range=tv",
        "q444.y4m",
    ]);
    let [quarter, full] = ["q444.y4m", "a.y4m"].map(|name| std::fs::read(at(name)).unwrap());
    let frames = |bytes: &[u8]| bytes[bytes.len() - 8 * (6 + 3 * 96 * 72)..].to_vec();
    let apart = frames(&quarter)
        .into_iter()
        .zip(frames(&full))
        .map(|(a, b)| f64::from(a.abs_diff(b)));
    let (sum, count) = apart.fold((0.0, 0.0), |(sum, count), d| (sum + d, count + 1.0));
    assert!(
        sum / count < 1.0,
        "colours are off by {} on average",
        sum / count
    );
    ffmpeg(&["-i", "a.y4m", "-vf", tags, "a.mp4"]);
    assert!(at("a.mp4").metadata().unwrap().len() > 500);
    let back = "setparams=colorspace=bt709,scale=in_color_matrix=bt709:in_range=tv,format=rgb24";
    ffmpeg(&["-i", "a.y4m", "-vf", back, "%d.png"]);
    for k in 0..8 {
        let frame = image::open(at(&format!("{}.png", k + 1)))
            .unwrap()
            .to_rgba8();
        let worst = frame
            .iter()
            .zip(shaded(k).iter())
            .map(|(a, b)| a.abs_diff(*b))
            .max();
        assert!(worst <= Some(4), "frame {k}: {worst:?}");
    }
    assert!(!at("9.png").exists());
}
