//! Maps pixels to palette indices, and remembers every colour met. One mapper per worker thread.

use crate::export::palette::Palette;
use image::RgbaImage;
use std::sync::Arc;

/// Colours with the same upper four bits a channel share a page of this many entries, one page of memory:
/// shaded surfaces touch few of them, and untouched pages cost nothing.
const ENTRIES: usize = 1 << 24;

/// Distance in sRGB levels from which a colour visibly differs: a colour difference of about 3.
const NOTICED: u8 = 6;

/// Squared levels, summed over the pixels of one missed colour, from which on it is an area and not merely a few edge
/// pixels: 100 pixels that are 10 levels off. Rendered frames have up to 5000.
const AREA_ERROR: u64 = 100 * 10 * 10;

/// The same summed over all missed colours in a frame of 640 by 480 pixels; rendered frames have 200 000, on their
/// edges, which grow with the square root of the number of pixels.
const LARGE_ERROR: f64 = 5e5;
const LARGE_ERROR_PIXELS: f64 = 640.0 * 480.0;

/// Pixels compared at once: 64 bytes.
const BLOCK: usize = 16;

/// Maps frames with one palette.
pub struct Mapper {
    palette: Arc<Palette>,
    /// By colour: index plus one, 0 for not yet known (palettes have at most 255 colours), and above these eight bits
    /// the colour's error.
    known: Vec<u16>,
    /// Maximum error of a colour, in levels.
    tolerance: u8,
    /// Colours of the last frame whose error is above the maximum, one entry per pixel.
    missed: Vec<[u8; 3]>,
    /// Sum of the squares of their errors.
    missed_by: u64,
    /// Pixels of the last frame.
    pixels: usize,
}

impl Mapper {
    /// A mapper without known colours.
    pub fn new(palette: Arc<Palette>) -> Self {
        let tolerance = if palette.is_exact() { 0 } else { NOTICED };
        Self {
            palette,
            tolerance,
            known: vec![0; ENTRIES],
            missed: Vec::new(),
            missed_by: 0,
            pixels: 0,
        }
    }

    /// Colours of the last frame that its palette misses, one entry per pixel, if they justify a table of their own.
    pub fn missed(&mut self) -> Option<&[[u8; 3]]> {
        let is_seen = if self.palette.is_exact() {
            !self.missed.is_empty()
        } else {
            let larger = (self.pixels as f64 / LARGE_ERROR_PIXELS).sqrt();
            self.missed_by as f64 >= LARGE_ERROR * larger || self.has_area()
        };
        is_seen.then_some(&self.missed)
    }

    /// Whether one missed colour alone fills an area.
    fn has_area(&mut self) -> bool {
        self.missed.sort_unstable();
        let mut same = self.missed.chunk_by(|a, b| a == b);
        same.any(|same| {
            let off = u64::from(self.palette.miss(same[0], self.palette.map(same[0])));
            same.len() as u64 * off * off >= AREA_ERROR
        })
    }

    /// Replaces `indexed` by the pixels of `frame` with the palette index of each in the place of its alpha.
    pub fn map(&mut self, frame: &RgbaImage, indexed: &mut Vec<u8>) {
        let (pixels, _) = frame.as_raw().as_chunks::<4>();
        indexed.clear();
        indexed.reserve(frame.as_raw().len());
        self.missed.clear();
        self.missed_by = 0;
        self.pixels = pixels.len();
        let (blocks, rest) = pixels.as_chunks::<BLOCK>();
        let mut mapped = [[0; 4]; BLOCK];
        let mut before: Option<&[[u8; 4]; BLOCK]> = None;
        let mut misses = false;
        for block in blocks {
            // Flat areas repeat whole blocks: one comparison instead of as many look-ups.
            if before != Some(block) || misses {
                let missed = self.missed.len();
                for (pixel, place) in block.iter().zip(&mut mapped) {
                    *place = self.with_index(*pixel);
                }
                before = Some(block);
                misses = self.missed.len() > missed;
            }
            indexed.extend_from_slice(mapped.as_flattened());
        }
        for pixel in rest {
            indexed.extend_from_slice(&self.with_index(*pixel));
        }
    }

    /// The pixel with its index in the place of its alpha.
    #[inline]
    fn with_index(&mut self, [r, g, b, _]: [u8; 4]) -> [u8; 4] {
        [r, g, b, self.index([r, g, b])]
    }

    #[inline]
    fn index(&mut self, rgb: [u8; 3]) -> u8 {
        let entry = &mut self.known[cache_place(rgb)];
        if *entry == 0 {
            let index = self.palette.map(rgb);
            let off = self.palette.miss(rgb, index);
            *entry = u16::from_be_bytes([off, index.saturating_add(1)]);
        }
        let [off, index] = entry.to_be_bytes();
        if off > self.tolerance {
            self.missed.push(rgb);
            self.missed_by += u64::from(off) * u64::from(off);
        }
        index - 1
    }
}

/// Place of a colour in the table: the bits of the three channels in groups of two, so that similar colours share
/// cache lines (4x4x4 colours) and pages (16x16x16).
#[inline]
fn cache_place(rgb: [u8; 3]) -> usize {
    let [r, g, b] = rgb.map(usize::from);
    let line = (r & 3) << 4 | (g & 3) << 2 | b & 3;
    let page = (r >> 2 & 3) << 10 | (g >> 2 & 3) << 8 | (b >> 2 & 3) << 6;
    (r >> 4) << 20 | (g >> 4) << 16 | (b >> 4) << 12 | page | line
}
