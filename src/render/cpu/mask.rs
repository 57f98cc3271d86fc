//! Sets of pixels of a tile.

use super::window::{TILE, Window};

/// Some pixels of a tile: a word for each row, a bit for each pixel, from the corner of the tile's window on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct PixelMask([u32; TILE]);

/// A tile and those of its pixels that are drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct TilePart {
    pub(super) window: Window,
    pub(super) pixels: PixelMask,
}

impl PixelMask {
    pub(super) const NONE: Self = Self([0; TILE]);
    pub(super) const ALL: Self = Self([u32::MAX; TILE]);

    /// The pixels of a rectangle in the tile with this corner.
    pub(super) fn of(corner: [i32; 2], pixels: &Window) -> Self {
        let mut mask = Self::NONE;
        mask.add(corner, pixels);
        mask
    }

    /// Adds the pixels of a rectangle in the tile with this corner.
    #[inline]
    pub(super) fn add(&mut self, corner: [i32; 2], pixels: &Window) {
        let (rows, columns) = bits_of(corner, pixels);
        for row in &mut self.0[rows[0]..rows[1]] {
            *row |= columns;
        }
    }

    /// Whether it has any pixel of a rectangle in the tile with this corner.
    #[inline]
    pub(super) fn meets(&self, corner: [i32; 2], pixels: &Window) -> bool {
        let (rows, columns) = bits_of(corner, pixels);
        self.0[rows[0]..rows[1]]
            .iter()
            .any(|row| row & columns != 0)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.0.iter().all(|row| *row == 0)
    }

    /// Whether a row has any pixel.
    pub(super) fn has_row(&self, row: usize) -> bool {
        self.0[row] != 0
    }

    /// Whether a row has any pixel of these columns, first and last.
    #[inline(always)]
    pub(super) fn has_any(&self, row: i32, [first, last]: [i32; 2]) -> bool {
        let below = |column: i32| (1u64 << column.clamp(0, TILE as i32)) - 1;
        u64::from(self.0[row as usize % TILE]) & below(last + 1) & !below(first) != 0
    }

    /// First row with a pixel, and the row after the last one.
    pub(super) fn rows(&self) -> [usize; 2] {
        let first = self.0.iter().position(|row| *row != 0).unwrap_or(TILE);
        let last = self.0.iter().rposition(|row| *row != 0);
        [first, last.map_or(first, |last| last + 1)]
    }

    /// All pixels that are at most so many columns and rows away.
    pub(super) fn grown(&self, by: i32) -> Self {
        let mut rows = self.0;
        for _ in 0..by {
            let mut above = 0;
            for k in 0..TILE {
                let below = rows.get(k + 1).copied().unwrap_or(0);
                let here = std::mem::replace(&mut above, rows[k]) | rows[k] | below;
                rows[k] = here | here << 1 | here >> 1;
            }
        }
        Self(rows)
    }

    /// The pixels of both.
    pub(super) fn and(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] & other.0[k]))
    }

    /// The pixels of either.
    pub(super) fn or(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] | other.0[k]))
    }

    /// The pixels that the other has not.
    pub(super) fn without(&self, other: &Self) -> Self {
        Self(std::array::from_fn(|k| self.0[k] & !other.0[k]))
    }

    /// Whether it has the pixel with this index in the tile.
    #[inline(always)]
    pub(super) fn contains(&self, pixel: usize) -> bool {
        self.0[pixel / TILE % TILE] >> (pixel % TILE) & 1 != 0
    }

    /// Adds the pixel with this index in the tile.
    #[inline(always)]
    pub(super) fn insert(&mut self, pixel: usize) {
        self.0[pixel / TILE % TILE] |= 1 << (pixel % TILE);
    }

    /// Calls `visit` with the first pixel of each run of pixels in a row, and the length of the run.
    #[inline(always)]
    pub(super) fn for_runs(&self, mut visit: impl FnMut(usize, usize)) {
        for (row, bits) in self.0.iter().enumerate() {
            let mut bits = *bits;
            while let Some([first, count]) = next_run(&mut bits) {
                visit(row * TILE + first, count);
            }
        }
    }

    /// The same in one row.
    #[inline(always)]
    pub(super) fn for_runs_of(&self, row: usize, mut visit: impl FnMut(usize, usize)) {
        let mut bits = self.0[row];
        while let Some([first, count]) = next_run(&mut bits) {
            visit(row * TILE + first, count);
        }
    }
}

/// Takes the first run out of a row: its first bit and its length.
#[inline(always)]
fn next_run(bits: &mut u32) -> Option<[usize; 2]> {
    let first = bits.trailing_zeros();
    let count = bits.checked_shr(first)?.trailing_ones();
    *bits &= !((u32::MAX >> (u32::BITS - count)) << first);
    Some([first, count].map(|k| k as usize))
}

impl TilePart {
    /// The first pixel of its window.
    pub(super) fn corner(&self) -> [i32; 2] {
        self.window.corner()
    }

    /// Calls `visit` with the index in the tile, x and y of every pixel, row by row.
    #[inline(always)]
    pub(super) fn for_each(&self, mut visit: impl FnMut(usize, i32, i32)) {
        self.for_runs(|first, count, x, y| {
            for k in 0..count {
                visit(first + k, x + k as i32, y);
            }
        });
    }

    /// Calls `visit` with index, x and y of the first pixel of each run, and its length after the index.
    #[inline(always)]
    pub(super) fn for_runs(&self, mut visit: impl FnMut(usize, usize, i32, i32)) {
        let [left, top] = self.corner();
        self.pixels.for_runs(|first, count| {
            let [x, y] = [first % TILE, first / TILE].map(|k| k as i32);
            visit(first, count, left + x, top + y);
        });
    }
}

/// First row, the row after the last, and the columns of a rectangle in the tile with this corner.
#[inline(always)]
fn bits_of(corner: [i32; 2], pixels: &Window) -> ([usize; 2], u32) {
    let range = |[first, last]: [i32; 2], start: i32| {
        let end = (last - start).min(TILE as i32 - 1) + 1;
        let first = (first - start).max(0);
        [first.min(end.max(0)), end.max(0)].map(|k| k as usize)
    };
    let [left, right] = range(pixels.x, corner[0]);
    let below = |column: usize| ((1u64 << column) - 1) as u32;
    (range(pixels.y, corner[1]), below(right) & !below(left))
}

#[cfg(test)]
mod tests {
    use super::*;

    const CORNER: [i32; 2] = [30, -60];

    fn rectangle(x: [i32; 2], y: [i32; 2]) -> Window {
        Window { x, y }
    }

    fn pixels(mask: PixelMask) -> Vec<[i32; 2]> {
        let window = rectangle([30, 61], [-60, -29]);
        let (mut all, part) = (
            Vec::new(),
            TilePart {
                window,
                pixels: mask,
            },
        );
        part.for_each(|pixel, x, y| {
            assert_eq!(pixel as i32, (y + 60) * 32 + x - 30);
            all.push([x, y]);
        });
        all
    }

    #[test]
    fn rectangles_are_cut_off_at_the_tile() {
        for (x, y) in [
            ([10, 31], [-70, -59]),
            ([60, 90], [-30, 0]),
            ([0, 99], [-99, 99]),
            ([40, 42], [-50, -50]),
            ([0, 29], [-50, -50]),
            ([62, 70], [-50, -50]),
            ([40, 42], [-99, -61]),
        ] {
            let mask = PixelMask::of(CORNER, &rectangle(x, y));
            let within = |c: i32, [first, last]: [i32; 2]| first <= c && c <= last;
            let expected: Vec<[i32; 2]> = (-60..-28)
                .flat_map(|y| (30..62).map(move |x| [x, y]))
                .filter(|at| within(at[0], x) && within(at[1], y))
                .collect();
            assert_eq!(pixels(mask), expected);
            assert_eq!(mask.is_empty(), expected.is_empty());
            assert_eq!(
                PixelMask::ALL.meets(CORNER, &rectangle(x, y)),
                !mask.is_empty()
            );
        }
    }

    #[test]
    fn sets_grow_and_are_combined() {
        let own = PixelMask::of(CORNER, &rectangle([40, 40], [-50, -50]));
        let more = PixelMask::of(CORNER, &rectangle([38, 42], [-52, -48]));
        assert_eq!(own.grown(2), more);
        assert_eq!(more.rows(), [8, 13]);
        let ring = more.without(&own);
        assert_eq!(pixels(ring).len(), 24);
        assert_eq!(ring.or(&own), more);
        assert!(ring.and(&own).is_empty());
        assert!(!ring.meets(CORNER, &rectangle([40, 40], [-50, -50])));
        let mut runs = 0;
        ring.for_runs(|_, _| runs += 1);
        assert_eq!(runs, 6);
    }
}
