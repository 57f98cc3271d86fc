//! GIF files decoded again by an independent decoder.

use crate::frames::{Shown, flat, palette, run, settings, shaded, sink};
use image::{Rgba, RgbaImage};
use mechanim::compare::{Comparison, compare_pictures};
use mechanim::export::gif::index_mapper::Mapper;
use mechanim::export::gif::{GifSink, Quality, sample_indices};
use mechanim::export::palette::Palette;
use mechanim::export::timing::{FrameTimes, Schedule};
use mechanim::export::{ExportError, ExportSummary, FrameSink, Stream};
use std::io::Write;
use std::sync::{Arc, Mutex};

#[derive(Clone, Default)]
struct Memory(Arc<Mutex<Vec<u8>>>);

impl Write for Memory {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().unwrap().extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn gif(
    workers: usize,
    count: usize,
    draw: fn(usize) -> RgbaImage,
    quality: u8,
) -> (Vec<u8>, ExportSummary) {
    let memory = Memory::default();
    let sink = sink(
        Box::new(Stream::new("memory", memory.clone())),
        draw,
        count,
        quality,
    );
    let summary = run(workers, count, draw, sink).unwrap();
    let bytes = memory.0.lock().unwrap().clone();
    (bytes, summary)
}

/// Feeds frames one by one, without the pump.
fn feed(sink: GifSink, frames: &[RgbaImage]) -> Result<ExportSummary, ExportError> {
    let mut sink: Box<dyn FrameSink> = Box::new(sink);
    let (mut coder, mut coded) = (sink.coder(), Vec::new());
    for (k, frame) in frames.iter().enumerate() {
        coder.code(frame, &mut coded)?;
        sink.write(k, &coded)?;
    }
    sink.finish()
}

fn psnr(a: &RgbaImage, b: &RgbaImage) -> f64 {
    match compare_pictures(a, b, 0) {
        Comparison::SameSize(d) => d.psnr,
        other => panic!("{other:?}"),
    }
}

#[test]
fn shaded_frames_keep_their_times_and_stay_close() {
    let (bytes, summary) = gif(2, 60, shaded, 100);
    let shown = Shown::decode(&bytes);
    assert_eq!((shown.frames.len(), shown.duration()), (60, 240));
    assert_eq!(shown.repeat, gif::Repeat::Infinite);
    assert_eq!((summary.frames, summary.bytes), (60, bytes.len() as u64));
    assert!((summary.seconds - 2.4).abs() < 1e-12);
    for k in 0..60 {
        let source = shaded(k);
        let decoded = shown.at(4 * k as u32);
        assert!(
            psnr(&source, decoded) > 45.0,
            "frame {k}: {}",
            psnr(&source, decoded)
        );
    }
}

/// The bound of the format: nearest colour plus the most error that the quality may add.
#[test]
fn no_pixel_is_farther_off_than_the_quality_allows() {
    for (quality, limit) in [(100, 12), (88, 23), (75, 48), (50, 192)] {
        let shown = Shown::decode(&gif(1, 30, shaded, quality).0);
        let palette = palette(shaded, 30);
        for k in 0..30 {
            for (want, got) in shaded(k).pixels().zip(shown.at(4 * k as u32).pixels()) {
                let error = |c: [u8; 3]| {
                    (0..3)
                        .map(|i| i32::from(want.0[i].abs_diff(c[i])).pow(2))
                        .sum::<i32>()
                };
                let [r, g, b, _] = want.0;
                let nearest = error(palette.colours()[usize::from(palette.map([r, g, b]))]);
                assert!(error([got.0[0], got.0[1], got.0[2]]) <= nearest + limit);
            }
        }
    }
}

#[test]
fn lower_quality_is_smaller_and_still_no_worse_than_it_says() {
    let sizes: Vec<usize> = [100, 75, 50, 25]
        .map(|q| gif(1, 40, shaded, q).0.len())
        .to_vec();
    assert!(sizes.is_sorted_by(|a, b| a > b), "{sizes:?}");
}

#[test]
fn a_pixel_that_does_not_change_never_changes_what_it_shows() {
    let shown = Shown::decode(&gif(3, 50, shaded, 25).0);
    let mut moments = 0;
    for k in 1..50 {
        let (before, after) = (shaded(k - 1), shaded(k));
        let (was, is) = (shown.at(4 * k as u32 - 4), shown.at(4 * k as u32));
        for (x, y, pixel) in after.enumerate_pixels() {
            if before.get_pixel(x, y) == pixel {
                assert_eq!(
                    was.get_pixel(x, y),
                    is.get_pixel(x, y),
                    "frame {k} pixel {x} {y}"
                );
                moments += 1;
            }
        }
    }
    assert!(moments > 100_000);
}

#[test]
fn few_colours_are_exact_at_any_quality() {
    for quality in [1, 50, 100] {
        let shown = Shown::decode(&gif(2, 30, flat, quality).0);
        for k in 0..30 {
            assert_eq!(shown.at(4 * k as u32), &flat(k), "frame {k}");
        }
        assert_eq!(&shown.colours[..2], [[10, 90, 200], [250, 251, 252]]);
    }
}

/// Few colours, of which one shows in a single frame that the palette never saw.
#[test]
fn few_colours_are_exact_whichever_frames_show_them() {
    for odd in [17, 91, 163] {
        let picture = move |k: usize| {
            let mut image = flat(k);
            if k == odd {
                image.put_pixel(3, 4, Rgba([255, 0, 0, 255]));
                image.put_pixel(18, 13, Rgba([9, 90, 200, 255]));
            }
            image
        };
        let shown = shown_of(200, picture, 60);
        assert_eq!(shown.own_tables, 1);
        for k in 0..200 {
            assert_eq!(shown.at(4 * k as u32), &picture(k), "frame {k}");
        }
    }
}

/// A small ball of another colour, lit, in one frame of 200: nothing like it is in the palette.
#[test]
fn a_colour_of_one_frame_survives() {
    for (odd, colour) in [
        (37, [193, 31, 37]),
        (118, [20, 60, 230]),
        (199 - 7, [240, 240, 20]),
    ] {
        let picture = move |k: usize| {
            let mut image = shaded(k);
            if k == odd {
                for (x, y, pixel) in image.enumerate_pixels_mut() {
                    let (dx, dy) = (f64::from(x) - 80.0, f64::from(y) - 60.0);
                    if dx.hypot(dy) < 7.0 {
                        let light = 1.0 - 0.03 * dx;
                        let lit = |c: u8| (f64::from(c) * light).min(255.0) as u8;
                        *pixel = Rgba([lit(colour[0]), lit(colour[1]), lit(colour[2]), 255]);
                    }
                }
            }
            image
        };
        let shown = shown_of(200, picture, 100);
        let got = shown.at(4 * odd as u32);
        for (want, got) in picture(odd).pixels().zip(got.pixels()) {
            assert!(
                colour_difference(want, got) < 3.0,
                "frame {odd}: {want:?} {got:?}"
            );
        }
        assert!(shown.own_tables <= 3, "{}", shown.own_tables);
    }
}

/// What `picture` looks like as a GIF of `count` frames, with the palette that a caller would sample.
fn shown_of(count: usize, picture: impl Fn(usize) -> RgbaImage, quality: u8) -> Shown {
    let memory = Memory::default();
    let output = Box::new(Stream::new("memory", memory.clone()));
    let settings = settings(&picture(0), 25.0, count, quality);
    let palette = Arc::new(palette(&picture, count));
    let frames: Vec<RgbaImage> = (0..count).map(&picture).collect();
    feed(GifSink::new(output, settings, palette).unwrap(), &frames).unwrap();
    let bytes = memory.0.lock().unwrap().clone();
    Shown::decode(&bytes)
}

/// CIE 1976 colour difference of two sRGB pixels.
fn colour_difference(a: &Rgba<u8>, b: &Rgba<u8>) -> f64 {
    let lab = |c: &Rgba<u8>| {
        let linear = |k: usize| {
            let v = f64::from(c.0[k]) / 255.0;
            if v <= 0.040_45 {
                v / 12.92
            } else {
                ((v + 0.055) / 1.055).powf(2.4)
            }
        };
        let [r, g, b] = [0, 1, 2].map(linear);
        let xyz = [
            (0.4124 * r + 0.3576 * g + 0.1805 * b) / 0.950_47,
            0.2126 * r + 0.7152 * g + 0.0722 * b,
            (0.0193 * r + 0.1192 * g + 0.9505 * b) / 1.088_83,
        ];
        let [x, y, z] = xyz.map(|t: f64| {
            if t > 216.0 / 24_389.0 {
                t.cbrt()
            } else {
                (24_389.0 / 27.0 * t + 16.0) / 116.0
            }
        });
        [116.0 * y - 16.0, 500.0 * (x - y), 200.0 * (y - z)]
    };
    let (a, b) = (lab(a), lab(b));
    (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
}

#[test]
fn the_palette_is_exact_up_to_255_colours_and_clustered_above() {
    let ramp = |n: u32| {
        RgbaImage::from_fn(n, 1, |x, _| {
            Rgba([x as u8, 255 - x as u8, (x / 2) as u8, 255])
        })
    };
    let exact = Palette::from_samples([&ramp(255)], &[], 255);
    assert!(exact.is_exact());
    assert_eq!(exact.colours().len(), 255);
    for pixel in ramp(255).pixels() {
        let [r, g, b, _] = pixel.0;
        assert_eq!(
            exact.colours()[usize::from(exact.map([r, g, b]))],
            [r, g, b]
        );
    }
    let clustered = Palette::from_samples([&ramp(256)], &[], 255);
    assert!(!clustered.is_exact() && clustered.colours().len() <= 255);
    // A colour no sample shows is represented when asked for.
    let alarm = Palette::from_samples([&shaded(0)], &[[255, 0, 255]], 255);
    assert!(alarm.colours().contains(&[255, 0, 255]));
}

#[test]
fn the_mapper_agrees_with_the_palette_for_every_colour() {
    let palette = Arc::new(palette(shaded, 10));
    let mut mapper = Mapper::new(Arc::clone(&palette));
    let image = RgbaImage::from_fn(256, 64, |x, y| {
        Rgba([x as u8, (x * 7 + y * 5) as u8, (y * 4) as u8, 255])
    });
    let mut indexed = Vec::new();
    // Twice: computed first, remembered then.
    for _ in 0..2 {
        mapper.map(&image, &mut indexed);
        for (pixel, mapped) in image.pixels().zip(indexed.as_chunks::<4>().0) {
            let [r, g, b, _] = pixel.0;
            assert_eq!(*mapped, [r, g, b, palette.map([r, g, b])]);
        }
    }
}

#[test]
fn equal_frames_collapse_into_one_long_one() {
    let picture = |k: usize| flat(if k < 7 { 0 } else { 1 });
    let shown = Shown::decode(&gif(2, 10, picture, 100).0);
    let delays: Vec<u16> = shown.frames.iter().map(|f| f.1).collect();
    assert_eq!(delays, [28, 12]);
    let shown = Shown::decode(&gif(2, 10, |_| flat(3), 100).0);
    assert_eq!((shown.frames.len(), shown.duration()), (1, 40));
}

#[test]
fn only_the_changed_rectangle_is_sent() {
    let picture = |k: usize| {
        let mut image = RgbaImage::from_pixel(40, 30, Rgba([9, 9, 9, 255]));
        image.put_pixel(5 + k as u32, 7, Rgba([200, 0, 0, 255]));
        image
    };
    let shown = Shown::decode(&gif(1, 3, picture, 100).0);
    assert_eq!(shown.areas, [[0, 0, 40, 30], [5, 7, 2, 1], [6, 7, 2, 1]]);
}

#[test]
fn a_pause_longer_than_a_delay_can_say_is_split() {
    let memory = Memory::default();
    let mut settings = settings(&flat(0), 25.0, 2, 100);
    // 65536 hundredths: one more than fits, and a rest of one would be below the shortest delay.
    let times = FrameTimes::At {
        starts: vec![0.0, 655.36],
        end: 655.4,
    };
    settings.schedule = Schedule::new(times, 1500.0).unwrap();
    let output = Box::new(Stream::new("memory", memory.clone()));
    let sink = GifSink::new(output, settings, Arc::new(palette(flat, 2))).unwrap();
    feed(sink, &[flat(0), flat(1)]).unwrap();
    let shown = Shown::decode(&memory.0.lock().unwrap());
    let delays: Vec<u16> = shown.frames.iter().map(|f| f.1).collect();
    assert_eq!(delays, [65534, 2, 65535, 65535, 18934]);
    assert_eq!((shown.at(65535), shown.at(65536)), (&flat(0), &flat(1)));
    assert_eq!(shown.at(shown.duration() - 1), &flat(1));
}

#[test]
fn one_frame_one_pixel_and_three_hundred_frames() {
    let shown = Shown::decode(&gif(1, 1, shaded, 100).0);
    assert_eq!(shown.frames.len(), 1);
    assert_eq!(shown.repeat, gif::Repeat::Finite(0));
    let blink = |k: usize| RgbaImage::from_pixel(1, 1, Rgba([20 * k as u8, 0, 0, 255]));
    let shown = Shown::decode(&gif(3, 12, blink, 100).0);
    assert!((0..12).all(|k| shown.at(4 * k as u32) == &blink(k)));
    let shown = Shown::decode(&gif(3, 300, shaded, 50).0);
    assert_eq!((shown.frames.len(), shown.duration()), (300, 1200));
}

/// A hundredth holds no thirtieth of a second: every frame begins at the nearest hundredth, and none drifts.
#[test]
fn a_thousand_frames_at_thirty_a_second_do_not_drift() {
    let memory = Memory::default();
    let output = Box::new(Stream::new("memory", memory.clone()));
    let settings = settings(&flat(0), 30.0, 1000, 100);
    let sink = GifSink::new(output, settings, Arc::new(palette(flat, 1000))).unwrap();
    let summary = run(2, 1000, flat, Box::new(sink)).unwrap();
    let shown = Shown::decode(&memory.0.lock().unwrap());
    assert_eq!(shown.frames.len(), 1000);
    let mut start = 0;
    for (k, (picture, delay)) in shown.frames.iter().enumerate() {
        let exact = 100.0 * k as f64 / 30.0;
        assert!(
            (f64::from(start) - exact).abs() <= 0.5,
            "{k}: {start} {exact}"
        );
        assert_eq!(picture, &flat(k));
        start += u32::from(*delay);
    }
    assert_eq!(start, 3333);
    assert!((summary.seconds - 33.33).abs() < 1e-9);
}

#[test]
fn bytes_do_not_depend_on_workers_or_runs() {
    for quality in [100, 40] {
        let first = gif(1, 45, shaded, quality).0;
        for workers in [1, 2, 3, 7] {
            assert!(
                gif(workers, 45, shaded, quality).0 == first,
                "{workers} workers"
            );
        }
    }
}

/// Noise fills the dictionary many times over, in every width of code.
#[test]
fn noise_survives_every_code_width() {
    let noise = |k: usize| {
        let mut state = k as u32 + 1;
        RgbaImage::from_fn(150, 90, |_, _| {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let level = (state >> 24) as u8 % 251;
            Rgba([level, level / 2, 255 - level, 255])
        })
    };
    let shown = Shown::decode(&gif(2, 4, noise, 100).0);
    assert!((0..4).all(|k| shown.at(4 * k as u32) == &noise(k)));
}

#[test]
fn wrong_sizes_and_no_frames_are_refused() {
    let open = |size, count| {
        let mut settings = settings(&flat(0), 25.0, count, 100);
        settings.size = size;
        GifSink::new(
            Box::new(Stream::new("memory", Vec::new())),
            settings,
            Arc::new(palette(flat, 1)),
        )
    };
    assert!(matches!(open([0, 5], 1), Err(ExportError::Size { .. })));
    assert!(matches!(
        open([5, 65_536], 1),
        Err(ExportError::Size { .. })
    ));
    assert!(matches!(
        open([5, 5], 0),
        Err(ExportError::FrameCount { .. })
    ));
    let outcome = feed(open([20, 14], 2).unwrap(), &[flat(0), shaded(0)]);
    assert!(matches!(
        outcome,
        Err(ExportError::FrameSize {
            expected: [20, 14],
            got: [96, 72]
        })
    ));
}

#[test]
fn samples_are_spread_and_qualities_bounded() {
    assert!(sample_indices(0).is_empty());
    assert_eq!(sample_indices(1), [0]);
    assert_eq!(sample_indices(2), [0, 1]);
    let many = sample_indices(1000);
    assert_eq!((many.len(), many[0], many[11]), (12, 0, 999));
    assert!(many.is_sorted_by(|a, b| a < b));
    assert_eq!((Quality::new(0), Quality::new(101)), (None, None));
}
