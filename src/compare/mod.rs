//! Image comparison: how far two pictures are apart, and where. Reads and writes no files.

pub mod film;

use image::{Rgba, RgbaImage};

/// Tolerances of the table in a [`Difference`], in levels of 0 to 255.
pub const LADDER: [u8; 8] = [0, 1, 2, 4, 8, 16, 32, 64];

/// Levels by which the middle picture of a triptych amplifies differences: one level must be seen.
const AMPLIFY: u8 = 8;

/// Width in pixels of the bars between the pictures of a triptych.
const GAP: u32 = 4;

/// Distance in pixels of the mark from the differences that it surrounds.
const MARK_DISTANCE: u32 = 3;

/// Colour of the bars, of the mark, and of places that only one picture has.
const FILL: Rgba<u8> = Rgba([255, 0, 255, 255]);

/// Outcome of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub enum Comparison {
    /// The pictures cannot be laid over each other.
    SizeMismatch {
        /// Width and height of the first.
        a: [u32; 2],
        /// Width and height of the second.
        b: [u32; 2],
    },
    /// Pictures of one size.
    SameSize(Difference),
}

impl Comparison {
    /// True when the sizes agree and at most `allowed` pixels are over the tolerance.
    pub fn is_within(&self, allowed: u64) -> bool {
        matches!(self, Self::SameSize(d) if d.over <= allowed)
    }
}

impl std::fmt::Display for Comparison {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::SizeMismatch { a, b } => {
                write!(f, "{}x{} expected, {}x{} found", a[0], a[1], b[0], b[1])
            }
            Self::SameSize(d) => {
                let (over, pixels, tolerance) = (d.over, d.pixels, d.tolerance);
                write!(f, "{over} of {pixels} pixels off by more than {tolerance}")?;
                if let Some([x, y]) = d.worst_at {
                    write!(f, ", worst {} at ({x}, {y})", d.worst)?;
                }
                if let Some([left, top, right, bottom]) = d.bounds {
                    write!(f, ", within ({left}, {top}) to ({right}, {bottom})")?;
                }
                Ok(())
            }
        }
    }
}

/// How two pictures of one size differ. The difference of a pixel is that of its worst channel, alpha included.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Pixels in all.
    pub pixels: u64,
    /// The tolerance asked for, in levels.
    pub tolerance: u8,
    /// Pixels that differ by more than the tolerance.
    pub over: u64,
    /// Pixels that differ by more than each tolerance of [`LADDER`].
    pub over_ladder: [u64; LADDER.len()],
    /// Root mean square over all pixels and the three colour channels, in levels.
    pub rmse: f64,
    /// Peak signal to noise ratio of the same in decibels; infinite for equal colours.
    pub psnr: f64,
    /// Difference of the worst pixel in levels.
    pub worst: u8,
    /// Column and row of the first pixel, in reading order, that is as bad; `None` if all are equal.
    pub worst_at: Option<[u32; 2]>,
    /// Left, top, right, bottom (inclusive) of the pixels over the tolerance.
    pub bounds: Option<[u32; 4]>,
}

/// Compares `a` and `b` channel by channel; a pixel counts when a channel is off by more than `tolerance` levels.
pub fn compare_pictures(a: &RgbaImage, b: &RgbaImage, tolerance: u8) -> Comparison {
    if a.dimensions() != b.dimensions() {
        return Comparison::SizeMismatch {
            a: a.dimensions().into(),
            b: b.dimensions().into(),
        };
    }
    // Pixels by their difference: the table and the count are sums over it.
    let mut histogram = [0u64; 256];
    let mut squares = 0u64;
    let (mut worst, mut worst_at) = (0, None);
    let mut bounds: Option<[u32; 4]> = None;
    for ((x, y, p), q) in a.enumerate_pixels().zip(b.pixels()) {
        if p == q {
            histogram[0] += 1;
            continue;
        }
        let off: [u8; 4] = std::array::from_fn(|c| p.0[c].abs_diff(q.0[c]));
        squares += off[..3]
            .iter()
            .map(|&d| u64::from(d) * u64::from(d))
            .sum::<u64>();
        let most = off.into_iter().fold(0, u8::max);
        histogram[usize::from(most)] += 1;
        if most > worst {
            (worst, worst_at) = (most, Some([x, y]));
        }
        if most > tolerance {
            let [l, t, r, b] = bounds.unwrap_or([x, y, x, y]);
            bounds = Some([l.min(x), t.min(y), r.max(x), b.max(y)]);
        }
    }
    let over = |tolerance: u8| histogram[usize::from(tolerance) + 1..].iter().sum();
    let pixels = u64::from(a.width()) * u64::from(a.height());
    let mean = squares as f64 / (3 * pixels.max(1)) as f64;
    Comparison::SameSize(Difference {
        pixels,
        tolerance,
        over: over(tolerance),
        over_ladder: LADDER.map(over),
        rmse: mean.sqrt(),
        psnr: 10.0 * (255.0 * 255.0 / mean).log10(),
        worst,
        worst_at,
        bounds,
    })
}

/// Expected, amplified difference and actual picture side by side, each given the larger width and height; what one
/// of them lacks is magenta, and so is the frame around the pixels that differ by more than `tolerance` levels.
pub fn difference_triptych(expected: &RgbaImage, actual: &RgbaImage, tolerance: u8) -> RgbaImage {
    let width = expected.width().max(actual.width());
    let height = expected.height().max(actual.height());
    let pixel = |image: &RgbaImage, x, y| image.get_pixel_checked(x, y).copied();
    let bounds = match compare_pictures(expected, actual, tolerance) {
        Comparison::SameSize(difference) => difference.bounds,
        Comparison::SizeMismatch { .. } => None,
    };
    RgbaImage::from_fn(3 * width + 2 * GAP, height, |x, y| {
        let (panel, x) = (x / (width + GAP), x % (width + GAP));
        let (e, a) = (pixel(expected, x, y), pixel(actual, x, y));
        let shown = match panel {
            0 => e,
            1 if bounds.is_some_and(|bounds| is_on_mark(bounds, x, y)) => None,
            1 => e.zip(a).map(|(e, a)| amplify_difference(e, a)),
            _ => a,
        };
        shown.unwrap_or(FILL)
    })
}

/// Whether a pixel is on the frame that surrounds `bounds` (left, top, right, bottom) at a small distance.
fn is_on_mark([left, top, right, bottom]: [u32; 4], x: u32, y: u32) -> bool {
    // Distances outwards from the bounds, as far as they are outside.
    let across = left.saturating_sub(x).max(x.saturating_sub(right));
    let down = top.saturating_sub(y).max(y.saturating_sub(bottom));
    across.max(down) == MARK_DISTANCE
}

/// Black where equal, brighter with the difference of each channel.
fn amplify_difference(e: Rgba<u8>, a: Rgba<u8>) -> Rgba<u8> {
    let [r, g, b] = std::array::from_fn(|c| e.0[c].abs_diff(a.0[c]).saturating_mul(AMPLIFY));
    Rgba([r, g, b, 255])
}

#[cfg(test)]
mod tests;
