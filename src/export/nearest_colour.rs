//! The nearest of up to 256 points, by looking at all of them several at a time.

/// Lanes compared at once; the loop is written so that the compiler vectorises it.
const LANES: usize = 8;

/// Coordinate of unused places: farther than any colour, and its square is finite.
const FAR: f32 = 1e9;

/// Up to 256 points, stored by coordinate.
#[derive(Clone)]
pub struct PalettePoints {
    x: [[f32; LANES]; 256 / LANES],
    y: [[f32; LANES]; 256 / LANES],
    z: [[f32; LANES]; 256 / LANES],
    blocks: usize,
}

impl PalettePoints {
    /// Takes the first 256 of `points`.
    pub fn new(points: &[[f32; 3]]) -> Self {
        let mut this = Self {
            x: [[FAR; LANES]; 256 / LANES],
            y: [[FAR; LANES]; 256 / LANES],
            z: [[FAR; LANES]; 256 / LANES],
            blocks: points.len().min(256).div_ceil(LANES),
        };
        for (i, p) in points.iter().take(256).enumerate() {
            let (block, lane) = (i / LANES, i % LANES);
            this.x[block][lane] = p[0];
            this.y[block][lane] = p[1];
            this.z[block][lane] = p[2];
        }
        this
    }

    /// Index of the point nearest to `at`; the lowest of equals; 0 if there are none.
    pub fn find(&self, at: [f32; 3]) -> u8 {
        let mut best = [f32::MAX; LANES];
        let mut place = [0u32; LANES];
        for block in 0..self.blocks.min(self.x.len()) {
            let (x, y, z) = (&self.x[block], &self.y[block], &self.z[block]);
            for lane in 0..LANES {
                let (dx, dy, dz) = (x[lane] - at[0], y[lane] - at[1], z[lane] - at[2]);
                let d = dx * dx + dy * dy + dz * dz;
                let closer = d < best[lane];
                best[lane] = if closer { d } else { best[lane] };
                place[lane] = if closer { block as u32 } else { place[lane] };
            }
        }
        let mut winner = (best[0], place[0] * LANES as u32);
        for lane in 1..LANES {
            let candidate = (best[lane], place[lane] * LANES as u32 + lane as u32);
            let closer = candidate.0 < winner.0;
            if closer || (candidate.0 == winner.0 && candidate.1 < winner.1) {
                winner = candidate;
            }
        }
        winner.1 as u8
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
