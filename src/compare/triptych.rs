//! Two pictures and their difference side by side, row by row.

use super::{Comparison, compare_rows};
use crate::import::{FramePicture, ImportError, PictureRows};

/// Levels by which the middle picture of a triptych amplifies differences: one level must be seen.
const AMPLIFY: u8 = 8;

/// Width in pixels of the bars between the pictures of a triptych.
const GAP: u32 = 4;

/// Distance in pixels of the mark from the differences that it surrounds.
const MARK_DISTANCE: u32 = 3;

/// Colour of the bars, of the mark, and of places that only one picture has.
const FILL: [u8; 4] = [255, 0, 255, 255];

/// Expected, amplified difference and actual picture side by side, each given the larger width and height; what one
/// of them lacks is magenta, and so is the frame around the pixels that differ by more than a tolerance.
pub struct TriptychRows<'p> {
    expected: PictureRows<'p>,
    actual: PictureRows<'p>,
    /// Of what differs: left, top, right, bottom.
    bounds: Option<[u32; 4]>,
    /// Of each of the three pictures.
    panel: [u32; 2],
    row: Vec<u8>,
    count: u32,
}

impl<'p> TriptychRows<'p> {
    /// Of two pictures, and the levels above which they differ.
    ///
    /// Errors: a file is damaged.
    pub fn new(
        expected: &'p FramePicture,
        actual: &'p FramePicture,
        tolerance: u8,
    ) -> Result<Self, ImportError> {
        let bounds = match compare_rows(expected.rows()?, actual.rows()?, tolerance)? {
            Comparison::SameSize(difference) => difference.bounds,
            Comparison::SizeMismatch { .. } => None,
        };
        let [[w, h], [other_w, other_h]] = [expected.size(), actual.size()];
        Ok(Self {
            expected: expected.rows()?,
            actual: actual.rows()?,
            bounds,
            panel: [w.max(other_w), h.max(other_h)],
            row: Vec::new(),
            count: 0,
        })
    }

    /// Width and height in pixels.
    pub fn size(&self) -> [u32; 2] {
        let [width, height] = self.panel;
        [width.saturating_mul(3).saturating_add(2 * GAP), height]
    }

    /// The next row, RGBA; `None` behind the last.
    ///
    /// Errors: a file is damaged.
    pub fn next_row(&mut self) -> Result<Option<&[u8]>, ImportError> {
        let y = self.count;
        if y >= self.panel[1] {
            return Ok(None);
        }
        self.count += 1;
        let expected = self.expected.next_row()?.unwrap_or_default();
        let expected = expected.as_chunks::<4>().0;
        let actual = self.actual.next_row()?.unwrap_or_default();
        let actual = actual.as_chunks::<4>().0;
        self.row.clear();
        let mut push = |pixel: Option<[u8; 4]>| self.row.extend(pixel.unwrap_or(FILL));
        let columns = 0..self.panel[0];
        let at = |row: &[[u8; 4]], x: u32| row.get(x as usize).copied();
        columns.clone().for_each(|x| push(at(expected, x)));
        (0..GAP).for_each(|_| push(None));
        for x in columns.clone() {
            let is_mark = self.bounds.is_some_and(|bounds| is_on_mark(bounds, x, y));
            let pair = at(expected, x).zip(at(actual, x));
            push(pair.filter(|_| !is_mark).map(|(e, a)| amplify(e, a)));
        }
        (0..GAP).for_each(|_| push(None));
        columns.for_each(|x| push(at(actual, x)));
        Ok(Some(&self.row))
    }
}

/// Whether a pixel is on the frame that surrounds `bounds` (left, top, right, bottom) at a small distance.
fn is_on_mark([left, top, right, bottom]: [u32; 4], x: u32, y: u32) -> bool {
    // Distances outwards from the bounds; zero inside.
    let across = left.saturating_sub(x).max(x.saturating_sub(right));
    let down = top.saturating_sub(y).max(y.saturating_sub(bottom));
    across.max(down) == MARK_DISTANCE
}

/// Black where equal, brighter with the difference of each channel.
fn amplify(e: [u8; 4], a: [u8; 4]) -> [u8; 4] {
    let [r, g, b] = std::array::from_fn(|c| e[c].abs_diff(a[c]).saturating_mul(AMPLIFY));
    [r, g, b, 255]
}
