//! What a viewer of the animation sees so far, and what the next frame has to change.

use super::costs::{Change, Pixel};
use super::delta::Area;

/// Stretches of unchanged pixels at least this long are only ever coded as transparent. Shorter ones may also
/// repeat their colour where that continues a string (30 % of the file); in longer ones the choice only costs time.
const STRETCH: usize = 12;

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

    /// The smallest rectangle that changes in `frame` and its pixels, row by row; `None` if nothing does.
    pub(super) fn changes(&mut self, frame: &[[u8; 4]]) -> Option<(Area, &[Pixel])> {
        let width = self.size[0];
        self.pixels.clear();
        let area = if self.source.is_empty() {
            self.pixels.extend(frame.iter().map(|&wanted| Pixel {
                wanted,
                shown: self.transparent,
                change: Change::Changed,
            }));
            Area::whole(self.size)
        } else {
            let area = Area::changed(&self.source, frame, width)?;
            let rows = area.rows(frame, width).zip(area.rows(&self.source, width));
            for ((new, old), shown) in rows.zip(area.rows(&self.shown, width)) {
                self.pixels.extend(new.iter().zip(old).zip(shown).map(
                    |((&wanted, old), &shown)| {
                        let change = if wanted == *old {
                            Change::Same
                        } else {
                            Change::Changed
                        };
                        Pixel {
                            wanted,
                            shown,
                            change,
                        }
                    },
                ));
            }
            mark_stretches(&mut self.pixels);
            area
        };
        self.source.clear();
        self.source.extend_from_slice(frame);
        Some((area, &self.pixels))
    }

    /// Takes over the indices that were sent for `area`.
    pub(super) fn show(&mut self, area: &Area, sent: &[u8]) {
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

/// Turns long runs of `Same` into `Stretch`.
fn mark_stretches(pixels: &mut [Pixel]) {
    for run in pixels.chunk_by_mut(|a, b| a.change == b.change) {
        if run.len() >= STRETCH && run.first().is_some_and(|p| p.change == Change::Same) {
            run.iter_mut().for_each(|p| p.change = Change::Stretch);
        }
    }
}
