//! Gaussian elimination with row pivots for regular square matrices: one Newton step, or the inverse, at half the price
//! of a QR. What is nearly singular is refused and left to the factorisation that sees ranks.

use super::lanes::{LaneMatrix, Lanes, clear_column, dot, groups, scale};

/// Pivots whose ratio is below this call for the factorisation that sees ranks: six of sixteen digits would be lost.
const SMALLEST_RATIO: f64 = 1e-6;

/// Buffers of an elimination.
#[derive(Clone, Debug, Default)]
pub struct Elimination {
    /// The matrix, and the right side as its last column.
    matrix: LaneMatrix,
    solution: Vec<Lanes>,
    pivot_row: Vec<Lanes>,
    order: Vec<usize>,
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
            // False also where the pivot is not a number.
            let is_regular = pivot > 0.0 && smallest > SMALLEST_RATIO * largest;
            if !is_regular {
                return None;
            }
            self.clear_below(k);
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
        let (place, value) = self.largest_below(k);
        self.matrix.swap_rows(k, place);
        value
    }

    fn clear_below(&mut self, k: usize) {
        let stride = self.matrix.stride();
        let reciprocal = 1.0 / self.matrix.at(k, k);
        self.pivot_row.clear();
        self.pivot_row.extend_from_slice(self.matrix.row(k));
        scale(&mut self.pivot_row, reciprocal);
        let (_, below) = self.matrix.split_at_row(k + 1);
        clear_column(&mut below[..], &self.pivot_row[..stride], k, false);
    }

    /// Inverts a square column-major matrix by Gauss and Jordan into `inverse`, row-major; returns the sign of its
    /// determinant, or `None` where it is nearly singular.
    pub fn invert(&mut self, a: &[f64], n: usize, inverse: &mut LaneMatrix) -> Option<i8> {
        self.matrix.copy_columns(a, n, n);
        self.invert_rows(n, SMALLEST_RATIO, inverse)
    }

    /// The same for a matrix that is already in rows, however small its pivots.
    pub fn invert_matrix(&mut self, a: &LaneMatrix, inverse: &mut LaneMatrix) -> Option<i8> {
        self.matrix.copy(a);
        self.invert_rows(a.rows().len(), 0.0, inverse)
    }

    fn invert_rows(&mut self, n: usize, ratio: f64, inverse: &mut LaneMatrix) -> Option<i8> {
        self.order.clear();
        self.order.extend(0..n);
        let mut sign = 1;
        let (mut smallest, mut largest) = (f64::INFINITY, 0.0_f64);
        for k in 0..n {
            let (place, value) = self.largest_below(k);
            (smallest, largest) = (smallest.min(value.abs()), largest.max(value.abs()));
            let is_regular = value != 0.0 && value.is_finite() && smallest > ratio * largest;
            if !is_regular {
                return None;
            }
            self.matrix.swap_rows(k, place);
            self.order.swap(k, place);
            if (place != k) != (value < 0.0) {
                sign = -sign;
            }
            *self.matrix.at_mut(k, k) = 1.0;
            let row = self.matrix.row_mut(k);
            scale(row, 1.0 / value);
            self.pivot_row.clear();
            self.pivot_row.extend_from_slice(row);
            let (above, rest) = self.matrix.split_at_row(k);
            clear_column(above, &self.pivot_row, k, true);
            clear_column(&mut rest[self.pivot_row.len()..], &self.pivot_row, k, true);
        }
        inverse.reset(n, n);
        for (k, column) in self.order.iter().enumerate() {
            for i in 0..n {
                *inverse.at_mut(i, *column) = self.matrix.at(i, k);
            }
        }
        Some(sign)
    }

    /// Place and value of the largest entry of column `k` from its diagonal down.
    fn largest_below(&self, k: usize) -> (usize, f64) {
        let (mut best, mut value) = (k, self.matrix.at(k, k));
        for (i, row) in self.matrix.rows().enumerate().skip(k + 1) {
            let entry = row[k / 4][k % 4];
            if entry.abs() > value.abs() {
                (best, value) = (i, entry);
            }
        }
        (best, value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_identity_and_its_sign_the_determinants() {
        let a = [0.0, 2.0, 1.0, 1.0, 0.5, -3.0, 4.0, 1.0, 0.25];
        let determinant = 0.0 * (0.5 * 0.25 + 3.0) - 2.0 * (0.25 + 12.0) + (1.0 - 2.0);
        let mut buffers = Elimination::default();
        let mut inverse = LaneMatrix::default();
        for flipped in [1.0_f64, -1.0] {
            let a = a.map(|v| flipped * v);
            let sign = buffers.invert(&a, 3, &mut inverse);
            assert_eq!(sign.map(f64::from), Some((flipped * determinant).signum()));
            for i in 0..3 {
                for j in 0..3 {
                    let entry: f64 = (0..3).map(|k| inverse.at(i, k) * a[j * 3 + k]).sum();
                    assert!((entry - f64::from(i == j)).abs() < 1e-15);
                }
            }
        }
        assert_eq!(buffers.invert(&[1.0, 2.0, 2.0, 4.0], 2, &mut inverse), None);
    }

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
