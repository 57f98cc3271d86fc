//! The picture shown by the frames so far, and the changes that the next frame needs.

use super::colour_costs::{Pixel, PixelChange};
use crate::export::changed_area::PixelArea;

/// Runs of unchanged pixels at least this long are only ever coded as transparent. Shorter ones may also repeat their
/// colour where that continues a string (30 % of the file); in longer ones the choice only costs time.
const STRETCH: usize = 12;

/// Pixels compared at once: 64 bytes.
const BLOCK: usize = 16;

/// The picture shown after the frames so far.
pub(super) struct Screen {
    size: [usize; 2],
    transparent: u8,
    /// Source pixels of the last frame with their nearest index; empty before the first.
    source: Vec<[u8; 4]>,
    /// Index shown at every pixel.
    shown: Vec<u8>,
    pixels: Vec<Pixel>,
}

impl Screen {
    /// An empty screen of width and height `size`.
    pub(super) fn new(size: [usize; 2], transparent: u8) -> Self {
        Self {
            size,
            transparent,
            source: Vec::new(),
            shown: vec![transparent; size[0] * size[1]],
            pixels: Vec::new(),
        }
    }

    /// Switches to another table of colours: pixels with the same colour there get the index `indices`, others
    /// `transparent`.
    pub(super) fn change_table(&mut self, indices: &[u8; 256], transparent: u8) {
        for shown in &mut self.shown {
            *shown = indices[usize::from(*shown)];
        }
        self.transparent = transparent;
    }

    /// The smallest rectangle that changes in `frame` and its pixels, row by row; `None` if nothing does. `nearest`
    /// holds the indices of the nearest colours if those in `frame` are of another table.
    pub(super) fn changes(
        &mut self,
        frame: &[[u8; 4]],
        nearest: Option<&[u8]>,
    ) -> Option<(PixelArea, &[Pixel])> {
        let width = self.size[0];
        self.pixels.clear();
        let area = if self.source.is_empty() {
            self.pixels.extend(frame.iter().map(|&wanted| Pixel {
                wanted,
                shown: self.transparent,
                change: PixelChange::Changed,
            }));
            PixelArea::whole(self.size)
        } else {
            let area = PixelArea::changed(&self.source, frame, width)?;
            let rows = area.rows(frame, width).zip(area.rows(&self.source, width));
            for ((new, old), shown) in rows.zip(area.rows(&self.shown, width)) {
                push_row(&mut self.pixels, new, old, shown);
            }
            measure_stretches(&mut self.pixels);
            area
        };
        self.source.clear();
        self.source.extend_from_slice(frame);
        if let Some(nearest) = nearest {
            let own = area.rows(nearest, width).flatten();
            let changed = self.pixels.iter_mut().zip(own);
            for (pixel, index) in changed.filter(|(p, _)| p.change != PixelChange::Stretch) {
                pixel.wanted[3] = *index;
            }
        }
        Some((area, &self.pixels))
    }

    /// Adopts the indices that were sent for `area`.
    pub(super) fn show(&mut self, area: &PixelArea, sent: &[u8]) {
        let width = self.size[0];
        let rows = self
            .shown
            .chunks_exact_mut(width)
            .skip(area.top)
            .take(area.height);
        for (row, sent) in rows.zip(sent.chunks_exact(area.width)) {
            for (shown, &index) in row[area.left..area.left + area.width].iter_mut().zip(sent) {
                *shown = if index == self.transparent {
                    *shown
                } else {
                    index
                };
            }
        }
    }
}

/// Appends a row of pixels with their relation to the previous frame.
fn push_row(pixels: &mut Vec<Pixel>, new: &[[u8; 4]], old: &[[u8; 4]], shown: &[u8]) {
    let mut at = 0;
    while at < new.len() {
        let same = same_at_start(&new[at..], &old[at..]);
        let stretch = if same >= STRETCH { same } else { 0 };
        pixels.resize(pixels.len() + stretch, Pixel::STRETCH);
        at += stretch;
        let end = (at + if stretch == 0 { same.max(1) } else { 0 }).min(new.len());
        let change = if same == 0 {
            PixelChange::Changed
        } else {
            PixelChange::Same
        };
        let some = new[at..end].iter().zip(&shown[at..end]);
        pixels.extend(some.map(|(&wanted, &shown)| Pixel {
            wanted,
            shown,
            change,
        }));
        at = end;
    }
}

/// Number of equal pixels at the start of both rows.
fn same_at_start(new: &[[u8; 4]], old: &[[u8; 4]]) -> usize {
    let (blocks, _) = new.as_chunks::<BLOCK>();
    let equal = blocks
        .iter()
        .zip(old.as_chunks::<BLOCK>().0)
        .take_while(|(a, b)| a == b);
    let at = BLOCK * equal.count();
    at + new[at..]
        .iter()
        .zip(&old[at..])
        .take_while(|(a, b)| a == b)
        .count()
}

/// Stores in every pixel of a run how many pixels remain, across the ends of rows.
fn measure_stretches(pixels: &mut [Pixel]) {
    let mut left = 0;
    for pixel in pixels.iter_mut().rev() {
        left = if pixel.change == PixelChange::Stretch {
            left + 1
        } else {
            0
        };
        if left > 0 {
            pixel.set_stretch_left(left);
        }
    }
}
