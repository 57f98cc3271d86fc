//! Values that several verbs take, and their ranges.

use clap::ValueEnum;
use clap::builder::{PossibleValuesParser, TypedValueParser};

/// `--color`
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
#[allow(missing_docs)]
pub enum ColourChoice {
    Auto,
    Always,
    Never,
}

/// One of the words of a list, as what it stands for; the help lists them.
pub fn named_word<T: Copy + Send + Sync + 'static, const N: usize>(
    named: &'static [(&'static str, T); N],
) -> impl TypedValueParser<Value = T> {
    let words = PossibleValuesParser::new(named.map(|(word, _)| word));
    words.try_map(move |found| {
        let entry = named.iter().find(|(word, _)| *word == found);
        entry.map(|(_, value)| *value).ok_or("no such word")
    })
}

/// Longest side of a picture that the renderers draw.
pub use crate::render::cpu::MAX_SIDE;

/// Most pixels of a picture: 8K video has 33 million.
pub const MAX_PIXELS: u64 = 64_000_000;

/// Most pixels of a PNG of one picture, which is drawn in strips: A0 at 300 dots per inch has 139 million.
pub const MAX_POSTER_PIXELS: u64 = 240_000_000;

/// `NAME=VALUE`.
pub fn name_and_text(text: &str) -> Result<(String, String), String> {
    match text.split_once('=') {
        Some((name, value)) if !name.trim().is_empty() && !value.trim().is_empty() => {
            Ok((name.trim().to_owned(), value.trim().to_owned()))
        }
        _ => Err("write NAME=VALUE".to_owned()),
    }
}

/// `WIDTHxHEIGHT` in pixels.
pub fn picture_size(text: &str) -> Result<[u32; 2], String> {
    let size = sides_of(text)?;
    match pixels_of(size) {
        0..=MAX_PIXELS => Ok(size),
        _ => Err(too_many_pixels()),
    }
}

/// `WIDTHxHEIGHT` of a picture that may be a poster.
pub fn poster_size(text: &str) -> Result<[u32; 2], String> {
    let size = sides_of(text)?;
    match pixels_of(size) {
        0..=MAX_POSTER_PIXELS => Ok(size),
        _ => Err(too_many_pixels_of_poster()),
    }
}

/// Pixels of a picture.
pub fn pixels_of([width, height]: [u32; 2]) -> u64 {
    u64::from(width) * u64::from(height)
}

fn too_many_pixels() -> String {
    let millions = MAX_PIXELS / 1_000_000;
    format!("at most {MAX_SIDE} pixels a side and {millions} million in all")
}

/// What is said of a picture with too many pixels that could be a poster.
pub fn too_many_pixels_of_poster() -> String {
    let millions = MAX_POSTER_PIXELS / 1_000_000;
    let usual = too_many_pixels();
    format!("{usual}; a PNG of one picture may have {millions} million")
}

fn sides_of(text: &str) -> Result<[u32; 2], String> {
    let wrong = || "write WIDTHxHEIGHT, for example 640x480".to_owned();
    let (width, height) = text.split_once(['x', '×']).ok_or_else(wrong)?;
    let size = [
        width.trim().parse::<u32>().map_err(|_| wrong())?,
        height.trim().parse().map_err(|_| wrong())?,
    ];
    if size.contains(&0) {
        return Err("a picture needs at least one pixel".to_owned());
    }
    if size.iter().any(|side| *side > MAX_SIDE) {
        return Err(format!("at most {MAX_SIDE} pixels a side"));
    }
    Ok(size)
}

/// Frames a second.
pub fn frame_rate(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(rate) if (0.01..=1000.0).contains(&rate) => Ok(rate),
        _ => Err("a frame rate is between 0.01 and 1000".to_owned()),
    }
}

/// A resolution on paper.
pub fn dots_per_inch(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(dpi) if (1.0..=10_000.0).contains(&dpi) => Ok(dpi),
        _ => Err("a resolution is between 1 and 10000".to_owned()),
    }
}

/// A number of samples.
pub fn frame_count(text: &str) -> Result<usize, String> {
    let limit = crate::kinematics::motion::sampling::MAX_SAMPLES;
    match text.parse::<usize>() {
        Ok(count) if (1..=limit).contains(&count) => Ok(count),
        _ => Err(format!("between 1 and {limit}")),
    }
}

/// Quality of a GIF.
pub fn gif_quality(text: &str) -> Result<u8, String> {
    match text.parse() {
        Ok(quality) if (1..=100).contains(&quality) => Ok(quality),
        _ => Err("between 1 and 100".to_owned()),
    }
}

/// A number of workers.
pub fn worker_count(text: &str) -> Result<usize, String> {
    match text.parse() {
        Ok(count) if (1..=256).contains(&count) => Ok(count),
        _ => Err("between 1 and 256".to_owned()),
    }
}

/// Order of a derivative.
pub fn rate_order(text: &str) -> Result<usize, String> {
    let limit = crate::model::rate::MAX_ORDER;
    match text.parse::<usize>() {
        Ok(order) if (1..=limit).contains(&order) => Ok(order),
        _ => Err(format!("between 1 and {limit}")),
    }
}

/// `#rrggbb`.
pub fn hex_colour(text: &str) -> Result<[u8; 3], String> {
    crate::scene::values::parse_colour(text)
        .ok_or_else(|| "write #rrggbb, for example #c2452d".to_owned())
}
