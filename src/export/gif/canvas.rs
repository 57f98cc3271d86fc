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
            self.source.extend_from_slice(frame);
            PixelArea::whole(self.size)
        } else {
            let area = PixelArea::changed(&self.source, frame, width)?;
            let rows = area.rows(frame, width).zip(area.rows(&self.source, width));
            let mut list = PixelList::new(&mut self.pixels);
            for ((new, old), shown) in rows.zip(area.rows(&self.shown, width)) {
                list.push_row(new, old, shown);
            }
            list.end_run();
            // Above and below it the source is as it was.
            let within = area.top * width..(area.top + area.height) * width;
            self.source[within.clone()].copy_from_slice(&frame[within]);
            area
        };
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

/// Pixels with their relation to the previous frame, row by row.
struct PixelList<'a> {
    pixels: &'a mut Vec<Pixel>,
    /// Pixels of a run that are still to be appended: it may go on in the next row.
    run: usize,
}

impl<'a> PixelList<'a> {
    fn new(pixels: &'a mut Vec<Pixel>) -> Self {
        Self { pixels, run: 0 }
    }

    fn push_row(&mut self, new: &[[u8; 4]], old: &[[u8; 4]], shown: &[u8]) {
        let mut at = 0;
        while at < new.len() {
            if new[at] != old[at] {
                self.push(new[at], shown[at], PixelChange::Changed);
                at += 1;
                continue;
            }
            let same = same_at_start(&new[at..], &old[at..]);
            if same >= STRETCH {
                self.run += same;
            } else {
                for k in at..at + same {
                    self.push(new[k], shown[k], PixelChange::Same);
                }
            }
            at += same;
        }
    }

    #[inline]
    fn push(&mut self, wanted: [u8; 4], shown: u8, change: PixelChange) {
        self.end_run();
        self.pixels.push(Pixel {
            wanted,
            shown,
            change,
        });
    }

    /// Appends the run, whose end is known now.
    #[inline]
    fn end_run(&mut self) {
        if self.run > 0 {
            let end = self.pixels.len() + self.run;
            self.pixels.resize(end, Pixel::of_run_to(end));
            self.run = 0;
        }
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
