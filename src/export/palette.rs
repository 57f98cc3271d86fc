//! One palette for a whole animation, from a few sampled frames.
//!
//! Distances are taken in sRGB. Oklab was measured on rendered frames and did worse in every figure, also in the
//! perceptual ones (0.5 dB; mean colour difference 0.159 against 0.153): clusters of 255 colours are so small that
//! the spaces differ only in how they weigh dark colours, where the eye's advantage is lost to rounding.

use super::colour_histogram::Histogram;
use super::kmeans::{self, ColourPoint};
use super::nearest_colour::PalettePoints;
use image::RgbaImage;

/// Maximum number of colours: 256 less the one that means "unchanged".
pub const MOST_COLOURS: usize = 255;

/// Rounds of k-means; 20 gain 0.01 dB over these.
const STEPS: usize = 5;

/// The pixels of a frame together weigh this many times as much as its missed colours.
const MISSED_SHARE: u64 = 3;

/// Up to 255 colours and the rule that maps every colour to one of them. The rule depends on the colour alone,
/// so a pixel that does not change never changes its index.
#[derive(Clone)]
pub struct Palette {
    colours: Vec<[u8; 3]>,
    exact: bool,
    nearest: PalettePoints,
}

impl Palette {
    /// Builds a palette of at most `limit` (1 to 255) colours from sampled frames.
    ///
    /// It is exact when the samples and `required` together have no more colours than that; else it is clustered, and
    /// holds the colours in `required` as they are, as far as they take half of it.
    pub fn from_samples<'a>(
        samples: impl IntoIterator<Item = &'a RgbaImage>,
        required: &[[u8; 3]],
        limit: usize,
    ) -> Self {
        let mut histogram = Histogram::new(limit.clamp(1, MOST_COLOURS));
        for frame in samples {
            histogram.add(frame);
        }
        Self::from_histogram(histogram, required, limit)
    }

    /// The same from colours that were counted; the histogram must remember `limit` colours.
    pub fn from_histogram(mut histogram: Histogram, required: &[[u8; 3]], limit: usize) -> Self {
        let limit = limit.clamp(1, MOST_COLOURS);
        for &colour in required {
            histogram.add_colour(colour, 1);
        }
        match histogram.distinct() {
            Some([]) => Self::new(vec![[0; 3]], true),
            Some(colours) => Self::new(colours.to_vec(), true),
            None => {
                let mut colours: Vec<[u8; 3]> = Vec::new();
                for colour in required {
                    if colours.len() < limit / 2 && !colours.contains(colour) {
                        colours.push(*colour);
                    }
                }
                let rest = cluster_colours(&histogram, limit - colours.len());
                colours.extend(rest);
                Self::new(colours, false)
            }
        }
    }

    /// The palette of one frame alone, for the sake of the colours in `missed`, an entry a pixel.
    ///
    /// Exact up to 255 colours. Among more, what is missed weighs a third of the rest: however few its pixels are, the
    /// clusters come to it.
    pub fn of_frame(frame: &RgbaImage, missed: &[[u8; 3]]) -> Self {
        let mut histogram = Histogram::new(MOST_COLOURS);
        histogram.add(frame);
        let pixels = u64::from(frame.width()) * u64::from(frame.height());
        let weight = (pixels / (MISSED_SHARE * missed.len().max(1) as u64)).max(1);
        for colour in missed {
            histogram.add_colour(*colour, weight);
        }
        Self::from_histogram(histogram, &[], MOST_COLOURS)
    }

    /// The palette of these colours; `exact` if there are no others.
    pub(super) fn new(colours: Vec<[u8; 3]>, exact: bool) -> Self {
        let places: Vec<[f32; 3]> = colours.iter().map(|c| c.map(f32::from)).collect();
        Self {
            nearest: PalettePoints::new(&places),
            colours,
            exact,
        }
    }

    /// The colours, sRGB.
    pub fn colours(&self) -> &[[u8; 3]] {
        &self.colours
    }

    /// True when every sampled colour is in the palette unchanged.
    pub fn is_exact(&self) -> bool {
        self.exact
    }

    /// How far the nearest colour is, in sRGB levels, rounded up; 255 at most.
    pub fn miss(&self, rgb: [u8; 3], index: u8) -> u8 {
        let colour = self.colours.get(usize::from(index)).copied();
        let squared = colour.unwrap_or_default().into_iter().zip(rgb);
        let squared: u32 = squared.map(|(a, b)| u32::from(a.abs_diff(b)).pow(2)).sum();
        let level = squared.isqrt();
        (level + u32::from(level * level < squared)).min(255) as u8
    }

    /// Index of the nearest colour. Slow; [`super::gif::index_mapper::Mapper`] remembers the answers.
    pub fn map(&self, rgb: [u8; 3]) -> u8 {
        self.nearest.find(rgb.map(f32::from))
    }
}

/// Clusters the histogram's bins; each colour is the mean of its pixels.
fn cluster_colours(histogram: &Histogram, limit: usize) -> Vec<[u8; 3]> {
    let bins = histogram.bins();
    let points: Vec<ColourPoint> = bins
        .iter()
        .map(|bin| ColourPoint {
            at: bin.rgb,
            weight: bin.count,
        })
        .collect();
    let owners = kmeans::cluster_points(&points, limit, STEPS);
    let mut sums = vec![[0.0f64; 4]; limit];
    for (bin, owner) in bins.iter().zip(owners) {
        let sum = &mut sums[usize::from(owner)];
        for (s, c) in sum.iter_mut().zip(bin.rgb) {
            *s += f64::from(c) * f64::from(bin.count);
        }
        sum[3] += f64::from(bin.count);
    }
    let used = sums.iter().filter(|s| s[3] > 0.0);
    used.map(|s| [s[0], s[1], s[2]].map(|c| (c / s[3]).round() as u8))
        .collect()
}
