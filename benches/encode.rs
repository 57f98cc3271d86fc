//! Cost and quality of the GIF encoder on 120 frames of 640x480: CPU milliseconds a stage, bytes, PSNR.
//!
//! The frames are drawn here (smooth shaded moving discs with antialiased edges), or read from the PNG files of the
//! folder in `ENCODE_FRAMES`, for example frames of another program that are to be compared on. `ENCODE_QUALITY`
//! picks one quality, `ENCODE_OUT` is a folder that keeps the files.

#![allow(clippy::expect_used)]

use image::RgbaImage;
use mechanim::export::gif::{GifSettings, GifSink, Quality, sample_indices};
use mechanim::export::palette::{MOST_COLOURS, Palette};
use mechanim::export::timing::{FrameTimes, Schedule};
use mechanim::export::{ExportError, FrameSink, Stream};
use std::sync::{Arc, Mutex};
use std::time::Instant;

const SIZE: [u32; 2] = [640, 480];
const FRAMES: usize = 120;
/// Runs of each quality; `ENCODE_REPEATS` replaces it, for a profiler.
const REPEATS: usize = 3;

fn main() {
    let frames = match std::env::var_os("ENCODE_FRAMES") {
        Some(folder) => read_frames(std::path::Path::new(&folder)),
        None => (0..FRAMES).map(synthetic).collect(),
    };
    println!(
        "{} frames of {}x{}",
        frames.len(),
        frames[0].width(),
        frames[0].height()
    );
    println!("quality    palette   map  code  total ms   bytes      PSNR dB");
    let only: Option<u8> = std::env::var("ENCODE_QUALITY")
        .ok()
        .and_then(|q| q.parse().ok());
    let repeats = std::env::var("ENCODE_REPEATS").ok();
    let repeats = repeats.and_then(|n| n.parse().ok()).unwrap_or(REPEATS);
    for quality in [100, 90, 75, 50, 25]
        .into_iter()
        .filter(|q| only.is_none_or(|o| o == *q))
    {
        let mut best: Option<Run> = None;
        for _ in 0..repeats {
            let run = encode(&frames, quality).expect("encoding into memory");
            if best.as_ref().is_none_or(|b| run.total() < b.total()) {
                best = Some(run);
            }
        }
        let run = best.expect("at least one run");
        let psnr = psnr(&frames, &run.bytes);
        println!(
            "{quality:7}    {:7.1} {:6.1} {:5.1} {:8.1} {:9} {psnr:9.2}",
            run.palette_ms,
            run.map_ms,
            run.code_ms,
            run.total(),
            run.bytes.len()
        );
        if let Some(folder) = std::env::var_os("ENCODE_OUT") {
            std::fs::write(
                std::path::Path::new(&folder).join(format!("q{quality}.gif")),
                &run.bytes,
            )
            .expect("write");
        }
    }
}

struct Run {
    palette_ms: f64,
    map_ms: f64,
    code_ms: f64,
    bytes: Vec<u8>,
}

impl Run {
    fn total(&self) -> f64 {
        self.palette_ms + self.map_ms + self.code_ms
    }
}

/// CPU milliseconds of this thread so far; wall time where the system does not say. All work is on one thread.
fn cpu_ms(start: Instant) -> f64 {
    let ticks = std::fs::read_to_string("/proc/thread-self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    ticks.map_or_else(
        || start.elapsed().as_secs_f64() * 1e3,
        |nanoseconds| nanoseconds * 1e-6,
    )
}

fn encode(frames: &[RgbaImage], quality: u8) -> Result<Run, ExportError> {
    let start = Instant::now();
    let begin = cpu_ms(start);
    let samples = sample_indices(frames.len());
    let palette = Palette::from_samples(samples.iter().map(|&i| &frames[i]), &[], MOST_COLOURS);
    let palette_ms = cpu_ms(start) - begin;
    let sink = Shared::default();
    let settings = GifSettings {
        size: [frames[0].width(), frames[0].height()],
        schedule: Schedule::new(
            FrameTimes::Uniform {
                fps: 25.0,
                count: frames.len(),
            },
            0.0,
        )?,
        repeat: true,
        quality: Quality::new(quality).unwrap_or(Quality::BEST),
    };
    let output = Box::new(Stream::new("memory", sink.clone()));
    let mut gif = Box::new(GifSink::new(output, settings, Arc::new(palette))?);
    let mut coder = gif.coder();
    let (mut map_ms, mut code_ms) = (0.0, 0.0);
    let mut coded = Vec::new();
    for (index, frame) in frames.iter().enumerate() {
        let begin = cpu_ms(start);
        coder.code(frame, &mut coded)?;
        let mapped = cpu_ms(start);
        gif.write(index, &coded)?;
        map_ms += mapped - begin;
        code_ms += cpu_ms(start) - mapped;
    }
    gif.finish()?;
    let bytes = std::mem::take(&mut *sink.0.lock().expect("one thread"));
    Ok(Run {
        palette_ms,
        map_ms,
        code_ms,
        bytes,
    })
}

/// Mean over the frames of each frame's PSNR, by the `gif` crate's decoder.
fn psnr(frames: &[RgbaImage], bytes: &[u8]) -> f64 {
    let mut options = gif::DecodeOptions::new();
    options.set_color_output(gif::ColorOutput::RGBA);
    let mut decoder = options.read_info(bytes).expect("a GIF");
    let width = usize::from(decoder.width());
    let mut canvas = vec![0u8; width * usize::from(decoder.height()) * 4];
    let mut shown = 0;
    let mut sum = 0.0;
    let mut index = 0;
    while let Some(frame) = decoder.read_next_frame().expect("a frame") {
        let stride = usize::from(frame.width) * 4;
        for (y, row) in frame.buffer.chunks_exact(stride).enumerate() {
            let at = ((y + usize::from(frame.top)) * width + usize::from(frame.left)) * 4;
            for (to, from) in canvas[at..at + stride]
                .chunks_exact_mut(4)
                .zip(row.chunks_exact(4))
            {
                if from[3] != 0 {
                    to.copy_from_slice(from);
                }
            }
        }
        shown += usize::from(frame.delay) / 4;
        while index < shown.min(frames.len()) {
            let pairs = frames[index]
                .as_raw()
                .chunks_exact(4)
                .zip(canvas.chunks_exact(4));
            let error: f64 = pairs
                .flat_map(|(a, b)| (0..3).map(|c| f64::from(a[c]) - f64::from(b[c])))
                .map(|d| d * d)
                .sum();
            let mean = error / (frames[index].as_raw().len() / 4 * 3) as f64;
            sum += 10.0 * (255.0 * 255.0 / mean.max(1e-9)).log10();
            index += 1;
        }
    }
    assert_eq!(index, frames.len(), "every frame is shown");
    sum / index as f64
}

#[derive(Clone, Default)]
struct Shared(Arc<Mutex<Vec<u8>>>);

impl std::io::Write for Shared {
    fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
        self.0.lock().expect("one thread").extend_from_slice(bytes);
        Ok(bytes.len())
    }
    fn flush(&mut self) -> std::io::Result<()> {
        Ok(())
    }
}

fn read_frames(folder: &std::path::Path) -> Vec<RgbaImage> {
    let entries = std::fs::read_dir(folder).expect("the folder of ENCODE_FRAMES");
    let mut paths: Vec<_> = entries.map(|e| e.expect("a folder entry").path()).collect();
    paths.retain(|p| p.extension().is_some_and(|e| e == "png"));
    paths.sort();
    paths
        .iter()
        .map(|p| image::open(p).expect("a PNG").to_rgba8())
        .collect()
}

/// Frame `k`: lit spheres on orbits over a vertical gradient.
fn synthetic(k: usize) -> RgbaImage {
    let t = k as f64 / FRAMES as f64 * std::f64::consts::TAU;
    let spheres: Vec<([f64; 2], f64, [f64; 3])> = (0..14)
        .map(|i| {
            let a = t * (1.0 + f64::from(i % 3)) + f64::from(i) * 0.9;
            let orbit = 60.0 + 11.0 * f64::from(i);
            let centre = [320.0 + orbit * a.cos(), 240.0 + 0.7 * orbit * a.sin()];
            let colour =
                [0.3, 0.55, 0.8].map(|c: f64| 0.5 + 0.45 * (f64::from(i) * 2.1 + c * 7.0).sin());
            (centre, 18.0 + f64::from(i % 5) * 9.0, colour)
        })
        .collect();
    RgbaImage::from_fn(SIZE[0], SIZE[1], |x, y| {
        let (px, py) = (f64::from(x) + 0.5, f64::from(y) + 0.5);
        let mut colour = [0.95, 0.96, 0.98].map(|c| c - 0.08 * py / 480.0);
        for (centre, radius, base) in &spheres {
            let (dx, dy) = ((px - centre[0]) / radius, (py - centre[1]) / radius);
            let r = dx.hypot(dy);
            let cover = ((1.0 - r) * radius + 0.5).clamp(0.0, 1.0);
            let nz = (1.0 - (r * r).min(1.0)).sqrt();
            let light = 0.25 + 0.7 * (0.5 * nz - 0.6 * dy - 0.4 * dx).max(0.0);
            let shine = 0.35 * (0.8 * nz - 0.5 * dy - 0.3 * dx).max(0.0).powi(20);
            for (c, b) in colour.iter_mut().zip(base) {
                *c += cover * ((b * light + shine).min(1.0) - *c);
            }
        }
        let [r, g, b] = colour.map(|c| (c * 255.0).round() as u8);
        image::Rgba([r, g, b, 255])
    })
}
