//! Pixels to palette indices, remembering every colour met. One mapper a worker thread.

use super::palette::Palette;
use image::RgbaImage;
use std::sync::Arc;

/// Colours with the same upper four bits a channel share a page of this many entries, one page of memory:
/// shaded surfaces touch few of them, and untouched pages cost nothing.
const ENTRIES: usize = 1 << 24;

/// Pixels compared at once: 64 bytes.
const BLOCK: usize = 16;

/// Maps frames with one palette.
pub struct Mapper {
    palette: Arc<Palette>,
    /// Index plus one by colour, 0 for not yet known; palettes have at most 255 colours.
    known: Vec<u8>,
}

impl Mapper {
    /// A mapper that knows no colour yet.
    pub fn new(palette: Arc<Palette>) -> Self {
        Self {
            palette,
            known: vec![0; ENTRIES],
        }
    }

    /// Replaces `indexed` by the pixels of `frame` with the palette index of each in the place of its alpha.
    pub fn map(&mut self, frame: &RgbaImage, indexed: &mut Vec<u8>) {
        let (pixels, _) = frame.as_raw().as_chunks::<4>();
        indexed.clear();
        indexed.reserve(frame.as_raw().len());
        let (blocks, rest) = pixels.as_chunks::<BLOCK>();
        let mut mapped = [[0; 4]; BLOCK];
        let mut before: Option<&[[u8; 4]; BLOCK]> = None;
        for block in blocks {
            // Flat areas repeat whole blocks: one comparison instead of as many look-ups.
            if before != Some(block) {
                for (pixel, place) in block.iter().zip(&mut mapped) {
                    *place = self.indexed(*pixel);
                }
                before = Some(block);
            }
            indexed.extend_from_slice(mapped.as_flattened());
        }
        for pixel in rest {
            indexed.extend_from_slice(&self.indexed(*pixel));
        }
    }

    /// The pixel with its index in the place of its alpha.
    #[inline]
    fn indexed(&mut self, [r, g, b, _]: [u8; 4]) -> [u8; 4] {
        [r, g, b, self.index([r, g, b])]
    }

    #[inline]
    fn index(&mut self, rgb: [u8; 3]) -> u8 {
        let entry = &mut self.known[cache_place(rgb)];
        if *entry == 0 {
            *entry = self.palette.map(rgb).saturating_add(1);
        }
        *entry - 1
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
