//! The colours of sampled frames: the distinct ones while there are few, otherwise bins with their mean colours.

use image::RgbaImage;

/// Bits a channel of a bin: 7 gives some twenty thousand occupied bins for a rendered animation; 6 costs 0.2 dB.
const BITS: u32 = 7;

/// A colour that represents the pixels of one bin.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ColourBin {
    /// Mean sRGB colour of the pixels, channels 0 to 255. The mean, not the bin's centre, which would shift
    /// every flat background.
    pub rgb: [f32; 3],
    /// Number of pixels.
    pub count: f32,
}

/// Colours counted over sampled frames.
pub struct Histogram {
    sums: Vec<[u64; 4]>,
    /// Occupied bins in the order of their first pixel.
    occupied: Vec<u32>,
    /// Sorted; `None` once there are more than the limit.
    distinct: Option<Vec<[u8; 3]>>,
    limit: usize,
}

impl Histogram {
    /// An empty histogram that remembers up to `limit` distinct colours exactly.
    pub fn new(limit: usize) -> Self {
        Self {
            sums: vec![[0; 4]; 1 << (3 * BITS)],
            occupied: Vec::new(),
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
        let bin = colour_cell(colour);
        if let Some(sum) = self.sums.get_mut(bin) {
            if sum[3] == 0 {
                self.occupied.push(bin as u32);
            }
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
    pub fn bins(&self) -> Vec<ColourBin> {
        let mut occupied = self.occupied.clone();
        occupied.sort_unstable();
        let sums = occupied
            .iter()
            .filter_map(|&bin| self.sums.get(bin as usize));
        sums.map(|&[r, g, b, n]| ColourBin {
            rgb: [r, g, b].map(|c| (c as f64 / n as f64) as f32),
            count: n as f32,
        })
        .collect()
    }
}

/// Bin of a colour. Bins of similar colours are neighbours in memory: a rendered animation touches a small part of
/// the table, and memory that is never touched costs nothing.
fn colour_cell(colour: [u8; 3]) -> usize {
    let [r, g, b] = colour.map(|c| usize::from(c >> (8 - BITS)));
    let (near, far) = ((r & 7, g & 7, b & 7), (r >> 3, g >> 3, b >> 3));
    let block = far.0 << (2 * (BITS - 3)) | far.1 << (BITS - 3) | far.2;
    block << 9 | near.0 << 6 | near.1 << 3 | near.2
}
