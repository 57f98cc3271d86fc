//! Gaussian elimination with row pivots for one regular square system: a Newton step at half the price of a QR.

use super::lanes::{LaneMatrix, Lanes, add_scaled, dot, groups};

/// Pivots whose ratio is below this call for the factorisation that sees ranks: six of sixteen digits would be lost.
const SMALLEST_RATIO: f64 = 1e-6;

/// Buffers of an elimination.
#[derive(Clone, Debug, Default)]
pub struct Elimination {
    /// The matrix, and the right side as its last column.
    matrix: LaneMatrix,
    solution: Vec<Lanes>,
}

impl Elimination {
    /// Solves `a x = b` with `a` column-major and square; returns the smallest pivot's magnitude, or `None` where the
    /// matrix is nearly singular or holds no numbers (`x` is then of no use).
    pub fn solve(&mut self, a: &[f64], b: &[f64], x: &mut [f64]) -> Option<f64> {
        let n = b.len();
        self.matrix.reset(n, n + 1);
        self.matrix.copy_columns_into(a, n);
        for (i, value) in b.iter().enumerate() {
            *self.matrix.at_mut(i, n) = *value;
        }
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for k in 0..n {
            let pivot = self.bring_pivot(k).abs();
            smallest = smallest.min(pivot);
            largest = largest.max(pivot);
            // Also where the pivot is not a number.
            if !(pivot > SMALLEST_RATIO * largest) {
                return None;
            }
            self.clear_below(k);
        }
        if !(smallest > SMALLEST_RATIO * largest) && n > 0 {
            return None;
        }
        self.solution.clear();
        self.solution.resize(groups(n + 1), [0.0; 4]);
        for k in (0..n).rev() {
            // What stands before the diagonal, and the right side itself, meet zeros.
            let known = dot(&self.matrix.row(k)[k / 4..], &self.solution[k / 4..]);
            let value = (self.matrix.at(k, n) - known) / self.matrix.at(k, k);
            self.solution[k / 4][k % 4] = value;
            x[k] = value;
        }
        Some(smallest)
    }

    /// Brings the largest entry of column `k` below the diagonal to row `k` and returns it.
    fn bring_pivot(&mut self, k: usize) -> f64 {
        let (mut best, mut value) = (k, self.matrix.at(k, k));
        for (i, row) in self.matrix.rows().enumerate().skip(k + 1) {
            let entry = row[k / 4][k % 4];
            if entry.abs() > value.abs() {
                (best, value) = (i, entry);
            }
        }
        self.matrix.swap_rows(k, best);
        value
    }

    fn clear_below(&mut self, k: usize) {
        let (start, stride) = (k / 4, self.matrix.stride());
        let (above, below) = self.matrix.split_at_row(k + 1);
        let row = &above[k * stride + start..];
        let reciprocal = 1.0 / row[0][k % 4];
        for other in below.chunks_exact_mut(stride) {
            let other = &mut other[start..];
            let factor = other[0][k % 4] * reciprocal;
            add_scaled(other, -factor, row);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn solves_what_is_regular_and_refuses_what_is_not() {
        let a = [0.0, 1.0, 4.0, 2.0, 0.5, 1.0, 1.0, -3.0, 0.25];
        let mut x = [0.0; 3];
        let mut elimination = Elimination::default();
        let smallest = elimination.solve(&a, &[7.0, -7.0, 6.75], &mut x);
        assert!(smallest.is_some_and(|s| s > 0.5 && s < 4.0));
        for (x, expected) in x.iter().zip([1.0, 2.0, 3.0]) {
            assert!((x - expected).abs() < 1e-14);
        }
        let singular = [1.0, 2.0, 2.0, 4.0 + 1e-9];
        assert_eq!(elimination.solve(&singular, &[1.0, 1.0], &mut x), None);
        let none = [f64::NAN, 2.0, 2.0, 4.0];
        assert_eq!(elimination.solve(&none, &[1.0, 1.0], &mut x), None);
    }
}
