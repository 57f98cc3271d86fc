//! The nearest of up to 256 points, by looking at several of them at a time.
//!
//! The points are sorted along one axis. Those next to the place on this axis are looked at first, and the others only while
//! their distance along the axis alone is no greater than that of the nearest so far: rounding never makes a larger number
//! the smaller one.

use crate::sorting::sort_by_number;

/// Lanes compared at once; the loop is written so that the compiler vectorises it.
const LANES: usize = 8;
const BLOCKS: usize = 256 / LANES;

/// Coordinate of unused places: farther than any colour, and its square is finite.
const FAR: f32 = 1e9;

/// Up to 256 points, stored by coordinate, in the order of the second one.
#[derive(Clone)]
pub struct PalettePoints {
    x: [[f32; LANES]; BLOCKS],
    y: [[f32; LANES]; BLOCKS],
    z: [[f32; LANES]; BLOCKS],
    /// The number of each point.
    number: [[u32; LANES]; BLOCKS],
    blocks: usize,
}

/// The nearest point so far: its squared distance and its number.
type Nearest = (f32, u32);

impl PalettePoints {
    /// Takes the first 256 of `points`.
    pub fn new(points: &[[f32; 3]]) -> Self {
        let mut this = Self {
            x: [[FAR; LANES]; BLOCKS],
            y: [[FAR; LANES]; BLOCKS],
            z: [[FAR; LANES]; BLOCKS],
            number: [[u32::MAX; LANES]; BLOCKS],
            blocks: points.len().min(256).div_ceil(LANES),
        };
        let mut order: Vec<usize> = (0..points.len().min(256)).collect();
        sort_by_number(&mut order, |i| f64::from(points[*i][1]));
        for (i, number) in order.into_iter().enumerate() {
            let (block, lane) = (i / LANES, i % LANES);
            let p = points[number];
            this.x[block][lane] = p[0];
            this.y[block][lane] = p[1];
            this.z[block][lane] = p[2];
            this.number[block][lane] = number as u32;
        }
        this
    }

    /// Index of the point nearest to `at`; the lowest of equals; 0 if there are none.
    pub fn find(&self, at: [f32; 3]) -> u8 {
        let blocks = self.blocks.min(BLOCKS);
        let mut nearest = (f32::MAX, 0);
        // The first block that ends beyond the place, then up and down from there.
        let start = self.y[..blocks].partition_point(|y| y[LANES - 1] < at[1]);
        for block in start..blocks {
            let gap = self.y[block][0] - at[1];
            if gap > 0.0 && gap * gap > nearest.0 {
                break;
            }
            self.look_at(block, at, &mut nearest);
        }
        for block in (0..start).rev() {
            let gap = self.y[block][LANES - 1] - at[1];
            if gap * gap > nearest.0 {
                break;
            }
            self.look_at(block, at, &mut nearest);
        }
        nearest.1 as u8
    }

    /// Compares the points of a block with the nearest so far.
    #[inline(always)]
    fn look_at(&self, block: usize, at: [f32; 3], nearest: &mut Nearest) {
        let (x, y, z) = (&self.x[block], &self.y[block], &self.z[block]);
        let mut squares = [0.0; LANES];
        for lane in 0..LANES {
            let (dx, dy, dz) = (x[lane] - at[0], y[lane] - at[1], z[lane] - at[2]);
            squares[lane] = dx * dx + dy * dy + dz * dz;
        }
        let least = squares
            .iter()
            .fold(f32::MAX, |a, b| if *b < a { *b } else { a });
        if least > nearest.0 {
            return;
        }
        for (square, number) in squares.into_iter().zip(self.number[block]) {
            let is_nearer = square < nearest.0 || (square == nearest.0 && number < nearest.1);
            if is_nearer {
                *nearest = (square, number);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    #[test]
    fn agrees_with_the_plain_search_for_any_count() {
        let mut state = 1u32;
        let mut number = || {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            // Coarse, so that equal distances occur.
            (state >> 28) as f32
        };
        for count in [1, 2, 7, 8, 9, 100, 255, 256] {
            let points: Vec<[f32; 3]> =
                (0..count).map(|_| [number(), number(), number()]).collect();
            let nearest = PalettePoints::new(&points);
            for _ in 0..200 {
                let q = [number(), number(), number()];
                let d = |p: &[f32; 3]| (0..3).map(|i| (p[i] - q[i]) * (p[i] - q[i])).sum::<f32>();
                let least = points.iter().map(d).fold(f32::MAX, f32::min);
                let first = points.iter().position(|p| d(p) == least).unwrap();
                assert_eq!(usize::from(nearest.find(q)), first);
            }
        }
    }
}
