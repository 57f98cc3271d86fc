//! Maps pixels to palette indices, and remembers every colour met. One mapper per worker thread.

use crate::export::palette::Palette;
use image::RgbaImage;
use std::sync::Arc;

/// Colours that are remembered: several times as many as a frame has, in 192 KB, which stay in a core's own cache.
const ENTRIES: usize = 1 << REMEMBERED_BITS;
const REMEMBERED_BITS: u32 = 15;

/// Distance in sRGB levels from which a colour visibly differs: a colour difference of about 3.
const NOTICED: u8 = 6;

/// Squared levels, summed over the pixels of one missed colour, from which on it is an area and not merely a few edge
/// pixels: 100 pixels that are 10 levels off. Rendered frames have up to 5000.
const AREA_ERROR: u64 = 100 * 10 * 10;

/// The same summed over all missed colours in a frame of 640 by 480 pixels; rendered frames have 200 000, on their
/// edges, which grow with the square root of the number of pixels.
const LARGE_ERROR: f64 = 5e5;
const LARGE_ERROR_PIXELS: f64 = 640.0 * 480.0;

/// Pixels that are mapped again together, if any of them has changed or is missed.
const PART: usize = 4;

/// A colour met before, with its palette index and how many levels it is off.
#[derive(Clone, Copy, Default)]
struct KnownColour {
    rgb: [u8; 3],
    index: u8,
    off: u8,
    is_known: bool,
}

/// Maps frames with one palette.
pub struct Mapper {
    palette: Arc<Palette>,
    /// Colours met, each where its hash says; a later one takes the place of an earlier.
    known: Vec<KnownColour>,
    /// Maximum error of a colour, in levels.
    tolerance: u8,
    /// Colours of the last frame whose error is above the maximum, one entry per pixel.
    missed: Vec<[u8; 3]>,
    /// Sum of the squares of their errors.
    missed_by: u64,
    /// Pixels of the last frame with their indices.
    last: Vec<[u8; 4]>,
    /// Which of its parts have no missed colour, so that they can be used again.
    reusable: Vec<bool>,
}

impl Mapper {
    /// A mapper without known colours.
    pub fn new(palette: Arc<Palette>) -> Self {
        let tolerance = if palette.is_exact() { 0 } else { NOTICED };
        Self {
            palette,
            tolerance,
            known: vec![KnownColour::default(); ENTRIES],
            missed: Vec::new(),
            missed_by: 0,
            last: Vec::new(),
            reusable: Vec::new(),
        }
    }

    /// Colours of the last frame that its palette misses, one entry per pixel, if they justify a table of their own.
    pub fn missed(&mut self) -> Option<&[[u8; 3]]> {
        let is_seen = if self.palette.is_exact() {
            !self.missed.is_empty()
        } else {
            let larger = (self.last.len() as f64 / LARGE_ERROR_PIXELS).sqrt();
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
        self.missed.clear();
        self.missed_by = 0;
        // Much of a frame is as in the one before: one comparison instead of as many look-ups.
        let mut mapped = std::mem::take(&mut self.last);
        if mapped.len() != pixels.len() {
            mapped.clear();
            mapped.resize(pixels.len(), [0; 4]);
            self.reusable.clear();
            self.reusable.resize(pixels.len() / PART, false);
        }
        let (parts, rest) = pixels.as_chunks::<PART>();
        let (places, last) = mapped.as_chunks_mut::<PART>();
        for (index, (part, places)) in parts.iter().zip(places).enumerate() {
            if self.reusable[index] && same_colours(part, places) {
                continue;
            }
            let missed = self.missed.len();
            for (pixel, place) in part.iter().zip(places) {
                *place = self.with_index(*pixel);
            }
            self.reusable[index] = self.missed.len() == missed;
        }
        for (pixel, place) in rest.iter().zip(last) {
            *place = self.with_index(*pixel);
        }
        indexed.clear();
        indexed.extend_from_slice(mapped.as_flattened());
        self.last = mapped;
    }

    /// The pixel with its index in the place of its alpha.
    #[inline]
    fn with_index(&mut self, [r, g, b, _]: [u8; 4]) -> [u8; 4] {
        [r, g, b, self.index([r, g, b])]
    }

    #[inline]
    fn index(&mut self, rgb: [u8; 3]) -> u8 {
        let entry = &mut self.known[cache_place(rgb)];
        if !entry.is_known || entry.rgb != rgb {
            let index = self.palette.map(rgb);
            *entry = KnownColour {
                rgb,
                index,
                off: self.palette.miss(rgb, index),
                is_known: true,
            };
        }
        let KnownColour { index, off, .. } = *entry;
        if off > self.tolerance {
            self.missed.push(rgb);
            self.missed_by += u64::from(off) * u64::from(off);
        }
        index
    }
}

/// Whether two lists of pixels differ in their last channels only.
#[inline]
fn same_colours(pixels: &[[u8; 4]; PART], others: &[[u8; 4]; PART]) -> bool {
    let colour = |pixel: &[u8; 4]| u32::from_le_bytes(*pixel) & 0x00ff_ffff;
    let pairs = pixels.iter().zip(others);
    pairs.fold(0, |bits, (a, b)| bits | (colour(a) ^ colour(b))) == 0
}

/// Place of a colour in the table: multiplicative hashing (Knuth) with the golden ratio.
#[inline]
fn cache_place([r, g, b]: [u8; 3]) -> usize {
    let colour = u32::from_le_bytes([r, g, b, 0]);
    (colour.wrapping_mul(0x9e37_79b9) >> (u32::BITS - REMEMBERED_BITS)) as usize
}
