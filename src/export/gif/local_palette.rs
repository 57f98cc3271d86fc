//! The palette of a single GIF frame, for colours that the animation's palette lacks.

use crate::export::palette::Palette;
use image::RgbaImage;
use std::collections::HashMap;

/// For every index into `from` that of the same colour in `to`, and `none` where there is none.
pub(super) fn translation(from: &[[u8; 3]], to: &[[u8; 3]], none: u8) -> [u8; 256] {
    let mut indices = [none; 256];
    for (index, colour) in indices.iter_mut().zip(from) {
        let same = to.iter().position(|c| c == colour);
        *index = same.map_or(none, |place| place as u8);
    }
    indices
}

/// The colours of a frame that the palette misses, and the nearest of them for each pixel.
pub(super) struct OwnTable {
    pub(super) palette: Palette,
    pub(super) nearest: Vec<u8>,
}

impl OwnTable {
    pub(super) fn new(frame: &RgbaImage, missed: &[[u8; 3]]) -> Self {
        let palette = Palette::of_frame(frame, missed);
        let (pixels, _) = frame.as_raw().as_chunks::<4>();
        let mut last = None;
        let mut known = HashMap::new();
        let nearest = pixels.iter().map(|&[r, g, b, _]| {
            let colour = [r, g, b];
            match last {
                Some((before, index)) if before == colour => index,
                _ => {
                    let index = *known.entry(colour).or_insert_with(|| palette.map(colour));
                    last = Some((colour, index));
                    index
                }
            }
        });
        let nearest = nearest.collect();
        Self { palette, nearest }
    }

    /// Appends indices, whether the table is exact, and its colours to the pixels of a frame.
    pub(super) fn append(&self, coded: &mut Vec<u8>) {
        coded.extend_from_slice(&self.nearest);
        coded.push(u8::from(self.palette.is_exact()));
        coded.extend(self.palette.colours().iter().flatten());
    }

    /// What `append` wrote after the pixels of a frame; `None` if it did not.
    pub(super) fn read(coded: &[u8], pixels: usize) -> Option<Self> {
        let (nearest, rest) = coded.get(4 * pixels..)?.split_at_checked(pixels)?;
        let (exact, colours) = rest.split_first()?;
        let (colours, _) = colours.as_chunks::<3>();
        Some(Self {
            palette: Palette::new(colours.to_vec(), *exact == 1),
            nearest: nearest.to_vec(),
        })
    }
}
