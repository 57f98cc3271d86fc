//! Frames to export and a decoder that shows what a viewer would see.

use image::{Rgba, RgbaImage};
use mechanim::export::error::PipelineError;
use mechanim::export::frame_pipeline::write_frames;
use mechanim::export::gif::{GifSettings, GifSink, Quality, sample_indices};
use mechanim::export::palette::{MOST_COLOURS, Palette};
use mechanim::export::sampled_frames::DrawnSamples;
use mechanim::export::timing::{FrameTimes, Schedule};
use mechanim::export::{ExportSummary, FrameSink, Output};
use std::convert::Infallible;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// A shaded ball on an orbit over a gradient, with more than 255 colours; the lowest rows never change.
pub fn shaded(k: usize) -> RgbaImage {
    let angle = k as f64 * 0.3;
    let (cx, cy) = (48.0 + 24.0 * angle.cos(), 30.0 + 14.0 * angle.sin());
    RgbaImage::from_fn(96, 72, |x, y| {
        let (dx, dy) = ((f64::from(x) - cx) / 16.0, (f64::from(y) - cy) / 16.0);
        let r = dx.hypot(dy);
        let cover = ((1.0 - r) * 16.0 + 0.5).clamp(0.0, 1.0);
        let light = (0.9 - 0.5 * r * r - 0.3 * dy).clamp(0.1, 1.0);
        let mix =
            |ball: f64, ground: f64| (cover * ball * light + (1.0 - cover) * ground).round() as u8;
        let ground = 245.0 - f64::from(y) * 0.6;
        Rgba([
            mix(235.0, ground),
            mix(120.0, ground),
            mix(60.0, ground + 5.0),
            255,
        ])
    })
}

/// A disc of one colour moving over another, no antialiasing: two colours.
pub fn flat(k: usize) -> RgbaImage {
    RgbaImage::from_fn(20, 14, |x, y| {
        let inside = (x as i32 - 3 - k as i32 % 12).pow(2) + (y as i32 - 6).pow(2) < 12;
        if inside {
            Rgba([10, 90, 200, 255])
        } else {
            Rgba([250, 251, 252, 255])
        }
    })
}

/// Settings for `count` frames of the size of `frame` at `fps`.
pub fn settings(frame: &RgbaImage, fps: f64, count: usize, quality: u8) -> GifSettings {
    GifSettings {
        size: frame.dimensions().into(),
        schedule: Schedule::new(FrameTimes::Uniform { fps, count }, 0.0).unwrap(),
        repeat: true,
        quality: Quality::new(quality).unwrap(),
    }
}

/// The palette of the frames a caller would sample.
pub fn palette(draw: impl Fn(usize) -> RgbaImage, count: usize) -> Palette {
    let samples: Vec<RgbaImage> = sample_indices(count).into_iter().map(draw).collect();
    Palette::from_samples(&samples, &[], MOST_COLOURS)
}

/// A GIF sink for `count` frames of `draw` at 25 frames a second.
pub fn sink(
    output: Box<dyn Output>,
    draw: fn(usize) -> RgbaImage,
    count: usize,
    quality: u8,
) -> Box<dyn FrameSink> {
    let settings = settings(&draw(0), 25.0, count, quality);
    Box::new(GifSink::new(output, settings, Arc::new(palette(draw, count))).unwrap())
}

/// Pumps `count` frames with `workers` threads.
pub fn run(
    workers: usize,
    count: usize,
    draw: fn(usize) -> RgbaImage,
    sink: Box<dyn FrameSink>,
) -> Result<ExportSummary, PipelineError<Infallible>> {
    let worker = || {
        move |k: usize, image: &mut RgbaImage| {
            image.copy_from_slice(draw(k).as_raw());
            Ok(())
        }
    };
    let workers = (0..workers).map(|_| worker()).collect();
    write_frames(
        workers,
        count,
        DrawnSamples::new(),
        sink,
        &|_, _| {},
        &AtomicBool::new(false),
    )
}

/// A decoded GIF.
pub struct Shown {
    /// Picture after each block, and its delay in hundredths.
    pub frames: Vec<(RgbaImage, u16)>,
    /// Left, top, width, height of each block.
    pub areas: Vec<[u16; 4]>,
    pub repeat: gif::Repeat,
    pub colours: Vec<[u8; 3]>,
    /// Frames with a table of their own.
    pub own_tables: usize,
}

impl Shown {
    /// Decodes with the `gif` crate and lays the blocks over each other.
    pub fn decode(bytes: &[u8]) -> Self {
        let mut decoder = gif::DecodeOptions::new().read_info(bytes).unwrap();
        let palette: Vec<[u8; 3]> = decoder
            .global_palette()
            .unwrap()
            .as_chunks::<3>()
            .0
            .to_vec();
        let mut canvas = RgbaImage::new(decoder.width().into(), decoder.height().into());
        let (mut frames, mut areas) = (Vec::new(), Vec::new());
        let mut own_tables = 0;
        while let Some(frame) = decoder.read_next_frame().unwrap() {
            assert!(frame.dispose == gif::DisposalMethod::Keep);
            let own = frame.palette.as_ref().map(|table| table.as_chunks::<3>().0);
            own_tables += usize::from(own.is_some());
            let table = own.unwrap_or(&palette);
            for (i, &index) in frame.buffer.iter().enumerate() {
                let (x, y) = (
                    i as u32 % u32::from(frame.width),
                    i as u32 / u32::from(frame.width),
                );
                if Some(index) != frame.transparent {
                    let [r, g, b] = table[usize::from(index)];
                    let place = (x + u32::from(frame.left), y + u32::from(frame.top));
                    canvas.put_pixel(place.0, place.1, Rgba([r, g, b, 255]));
                }
            }
            frames.push((canvas.clone(), frame.delay));
            areas.push([frame.left, frame.top, frame.width, frame.height]);
        }
        Self {
            frames,
            areas,
            repeat: decoder.repeat(),
            colours: palette,
            own_tables,
        }
    }

    /// What is shown at `hundredths` after the start.
    pub fn at(&self, hundredths: u32) -> &RgbaImage {
        let mut end = 0;
        let frame = self.frames.iter().find(|(_, delay)| {
            end += u32::from(*delay);
            end > hundredths
        });
        &frame.expect("within the duration").0
    }

    /// Sum of the delays in hundredths.
    pub fn duration(&self) -> u32 {
        self.frames.iter().map(|(_, delay)| u32::from(*delay)).sum()
    }
}
