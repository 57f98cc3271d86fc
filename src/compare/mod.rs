//! Image comparison: how much two pictures differ, and where. Reads and writes no files.

pub mod film;
pub mod triptych;

use crate::import::{ImportError, PictureRows};
use image::RgbaImage;

/// Tolerances of the table in a [`Difference`], in levels of 0 to 255.
pub const LADDER: [u8; 8] = [0, 1, 2, 4, 8, 16, 32, 64];

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
    /// The tolerance, in levels.
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
    /// Column and row of the first pixel with the largest difference, in reading order; `None` if all are equal.
    pub worst_at: Option<[u32; 2]>,
    /// Left, top, right, bottom (inclusive) of the pixels over the tolerance.
    pub bounds: Option<[u32; 4]>,
}

/// Compares `a` and `b` channel by channel; a pixel counts when a channel is off by more than `tolerance` levels.
pub fn compare_pictures(a: &RgbaImage, b: &RgbaImage, tolerance: u8) -> Comparison {
    if a.dimensions() != b.dimensions() {
        let [a, b] = [a, b].map(|p| p.dimensions().into());
        return Comparison::SizeMismatch { a, b };
    }
    let mut tally = Tally::new(tolerance);
    let width = 4 * a.width().max(1) as usize;
    let [left, right] = [a, b].map(|p| p.as_raw().chunks_exact(width));
    left.zip(right).for_each(|(l, r)| tally.add_row(l, r));
    Comparison::SameSize(tally.difference())
}

/// The same row by row, of pictures that may be larger than the memory.
///
/// Errors: a file is damaged.
pub fn compare_rows(
    mut a: PictureRows,
    mut b: PictureRows,
    tolerance: u8,
) -> Result<Comparison, ImportError> {
    if a.size() != b.size() {
        let (a, b) = (a.size(), b.size());
        return Ok(Comparison::SizeMismatch { a, b });
    }
    let mut tally = Tally::new(tolerance);
    // Both are read to their ends: a file may be damaged after its last row.
    loop {
        match (a.next_row()?, b.next_row()?) {
            (Some(left), Some(right)) => tally.add_row(left, right),
            _ => return Ok(Comparison::SameSize(tally.difference())),
        }
    }
}

/// Difference of the rows so far.
struct Tally {
    tolerance: u8,
    rows: u32,
    pixels: u64,
    /// Pixels by their difference: the table and the count are sums over it.
    histogram: [u64; 256],
    squares: u64,
    worst: u8,
    worst_at: Option<[u32; 2]>,
    bounds: Option<[u32; 4]>,
}

impl Tally {
    fn new(tolerance: u8) -> Self {
        Self {
            tolerance,
            rows: 0,
            pixels: 0,
            histogram: [0; 256],
            squares: 0,
            worst: 0,
            worst_at: None,
            bounds: None,
        }
    }

    /// The next row of both, RGBA.
    fn add_row(&mut self, a: &[u8], b: &[u8]) {
        let y = self.rows;
        self.rows += 1;
        let (pixels, others) = (a.as_chunks::<4>().0, b.as_chunks::<4>().0);
        self.pixels += pixels.len() as u64;
        for (x, (p, q)) in (0u32..).zip(pixels.iter().zip(others)) {
            if p == q {
                self.histogram[0] += 1;
                continue;
            }
            let off: [u8; 4] = std::array::from_fn(|c| p[c].abs_diff(q[c]));
            let squares = off[..3].iter().map(|&d| u64::from(d) * u64::from(d));
            self.squares += squares.sum::<u64>();
            let most = off.into_iter().fold(0, u8::max);
            self.histogram[usize::from(most)] += 1;
            if most > self.worst {
                (self.worst, self.worst_at) = (most, Some([x, y]));
            }
            if most > self.tolerance {
                let [l, t, r, b] = self.bounds.unwrap_or([x, y, x, y]);
                self.bounds = Some([l.min(x), t.min(y), r.max(x), b.max(y)]);
            }
        }
    }

    fn difference(&self) -> Difference {
        let over = |tolerance: u8| {
            self.histogram[usize::from(tolerance) + 1..]
                .iter()
                .sum::<u64>()
        };
        let mean = self.squares as f64 / (3 * self.pixels.max(1)) as f64;
        Difference {
            pixels: self.pixels,
            tolerance: self.tolerance,
            over: over(self.tolerance),
            over_ladder: LADDER.map(over),
            rmse: mean.sqrt(),
            psnr: 10.0 * libm::log10(255.0 * 255.0 / mean),
            worst: self.worst,
            worst_at: self.worst_at,
            bounds: self.bounds,
        }
    }
}

#[cfg(test)]
mod tests;
