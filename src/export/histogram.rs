//! The colours of sampled frames: the distinct ones while they are few, else bins that keep their mean colour.

use image::RgbaImage;

/// Bits a channel of a bin: 7 gives some twenty thousand occupied bins for a rendered animation; 6 costs 0.2 dB.
const BITS: u32 = 7;

/// A colour that stands for the pixels of one bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bin {
    /// Mean sRGB colour of the pixels, channels 0 to 255. The mean, not the bin's centre, which would shift
    /// every flat background.
    pub rgb: [f32; 3],
    /// Number of pixels.
    pub count: f32,
}

/// Colours counted over sampled frames.
pub struct Histogram {
    sums: Vec<[u64; 4]>,
    /// Sorted; `None` once there are more than the limit.
    distinct: Option<Vec<[u8; 3]>>,
    limit: usize,
}

impl Histogram {
    /// An empty histogram that remembers up to `limit` distinct colours exactly.
    pub fn new(limit: usize) -> Self {
        Self {
            sums: vec![[0; 4]; 1 << (3 * BITS)],
            distinct: Some(Vec::new()),
            limit,
        }
    }

    /// Counts all pixels of `frame`.
    pub fn add(&mut self, frame: &RgbaImage) {
        let mut pixels = frame.as_raw().chunks_exact(4).map(|p| [p[0], p[1], p[2]]);
        let Some(mut colour) = pixels.next() else {
            return;
        };
        // Neighbours are mostly equal: counting runs is several times faster than counting pixels.
        let mut run = 1;
        for pixel in pixels {
            if pixel == colour {
                run += 1;
            } else {
                self.add_colour(colour, run);
                colour = pixel;
                run = 1;
            }
        }
        self.add_colour(colour, run);
    }

    /// Counts `colour` `run` times.
    pub fn add_colour(&mut self, colour: [u8; 3], run: u64) {
        let [r, g, b] = colour.map(u64::from);
        let shift = 8 - BITS;
        let bin = (r >> shift) << (2 * BITS) | (g >> shift) << BITS | b >> shift;
        if let Some(sum) = self.sums.get_mut(bin as usize) {
            sum[0] += r * run;
            sum[1] += g * run;
            sum[2] += b * run;
            sum[3] += run;
        }
        if let Some(distinct) = &mut self.distinct
            && let Err(place) = distinct.binary_search(&colour)
        {
            distinct.insert(place, colour);
            if distinct.len() > self.limit {
                self.distinct = None;
            }
        }
    }

    /// All colours seen, sorted, if they are within the limit.
    pub fn distinct(&self) -> Option<&[[u8; 3]]> {
        self.distinct.as_deref()
    }

    /// The occupied bins in a fixed order.
    pub fn bins(&self) -> Vec<Bin> {
        let occupied = self.sums.iter().filter(|s| s[3] > 0);
        occupied
            .map(|&[r, g, b, n]| Bin {
                rgb: [r, g, b].map(|c| (c as f64 / n as f64) as f32),
                count: n as f32,
            })
            .collect()
    }
}
