//! Householder QR with column pivoting, in place and without allocation: least squares and numerical rank.
//!
//! Golub and Van Loan, Matrix Computations, 4th ed., algorithm 5.4.1. Matrices are column-major.

/// A factorisation in reusable buffers.
#[derive(Clone, Debug, Default)]
pub struct PivotedQr {
    rows: usize,
    columns: usize,
    /// R above the diagonal, the reflectors (without their leading one) below it.
    factors: Vec<f64>,
    scalars: Vec<f64>,
    order: Vec<usize>,
    /// Squares of the remaining column norms; only the pivot's root is taken.
    squares: Vec<f64>,
    scratch: Vec<f64>,
    swaps: usize,
    rank: usize,
}

impl PivotedQr {
    /// Factors the `rows` × `columns` matrix `a` (column-major).
    ///
    /// Columns whose remaining norm falls below `tolerance` times the largest first pivot end the rank.
    pub fn factor(&mut self, a: &[f64], rows: usize, columns: usize, tolerance: f64) {
        self.rows = rows;
        self.columns = columns;
        self.factors.clear();
        self.factors.extend_from_slice(&a[..rows * columns]);
        self.order.clear();
        self.order.extend(0..columns);
        self.scalars.clear();
        self.scalars.resize(columns.min(rows), 0.0);
        self.swaps = 0;
        self.rank = 0;
        let mut largest = 0.0;
        for k in 0..columns.min(rows) {
            let pivot = self.largest_column(k);
            self.swap_columns(k, pivot);
            let norm = self.squares[k].sqrt();
            if k == 0 {
                largest = norm;
            }
            // A NaN norm also ends here: the comparison is false for it.
            if !(norm > tolerance * largest && norm > 0.0) {
                return;
            }
            self.reflect(k, norm);
            self.rank = k + 1;
        }
    }

    /// Number of columns that are independent within the tolerance.
    pub fn rank(&self) -> usize {
        self.rank
    }

    /// Magnitude of the last pivot: within a modest factor the smallest singular value of the independent columns.
    pub fn smallest_pivot(&self) -> f64 {
        match self.rank {
            0 => 0.0,
            rank => self.factors[(rank - 1) * self.rows + rank - 1].abs(),
        }
    }

    /// Column of the original matrix that became column `k`.
    pub fn column_order(&self) -> &[usize] {
        &self.order
    }

    /// Sign of the determinant of a square matrix: +1, -1, or 0 where the rank is not full.
    pub fn determinant_sign(&self) -> i8 {
        if self.rows != self.columns || self.rank < self.columns {
            return 0;
        }
        let negative_diagonal = (0..self.rank)
            .filter(|k| self.factors[k * self.rows + k] < 0.0)
            .count();
        // Every reflection and every swap changes the sign once.
        let reflections = self.scalars.iter().filter(|tau| **tau != 0.0).count();
        if (negative_diagonal + reflections + self.swaps).is_multiple_of(2) {
            1
        } else {
            -1
        }
    }

    /// Solves `min |a x - b|`; the coordinates of dependent columns are zero. `b` is overwritten.
    pub fn solve(&mut self, b: &mut [f64], x: &mut [f64]) {
        let m = self.rows;
        for k in 0..self.rank {
            let column = &self.factors[k * m..(k + 1) * m];
            let dot: f64 = b[k]
                + column[k + 1..]
                    .iter()
                    .zip(&b[k + 1..m])
                    .map(|(v, b)| v * b)
                    .sum::<f64>();
            let factor = self.scalars[k] * dot;
            b[k] -= factor;
            for (b, v) in b[k + 1..m].iter_mut().zip(&column[k + 1..]) {
                *b -= factor * v;
            }
        }
        x[..self.columns].fill(0.0);
        self.scratch.clear();
        self.scratch.extend_from_slice(&b[..self.rank]);
        for k in (0..self.rank).rev() {
            let value = self.scratch[k] / self.factors[k * m + k];
            x[self.order[k]] = value;
            for i in 0..k {
                self.scratch[i] -= value * self.factors[k * m + i];
            }
        }
    }

    /// Recomputes the remaining column norms (small matrices: cheaper than careful downdating) and finds the largest.
    fn largest_column(&mut self, k: usize) -> usize {
        let m = self.rows;
        self.squares.resize(self.columns, 0.0);
        let mut best = k;
        for j in k..self.columns {
            let tail = &self.factors[j * m + k..(j + 1) * m];
            self.squares[j] = tail.iter().map(|v| v * v).sum::<f64>();
            if self.squares[j] > self.squares[best] {
                best = j;
            }
        }
        best
    }

    fn swap_columns(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        let m = self.rows;
        let (left, right) = self.factors.split_at_mut(b * m);
        left[a * m..(a + 1) * m].swap_with_slice(&mut right[..m]);
        self.order.swap(a, b);
        self.squares.swap(a, b);
        self.swaps += 1;
    }

    /// Makes column `k` zero below the diagonal and applies the reflection to the columns to the right.
    fn reflect(&mut self, k: usize, norm: f64) {
        let m = self.rows;
        let (left, right) = self.factors.split_at_mut((k + 1) * m);
        let column = &mut left[k * m..];
        let alpha = column[k];
        let beta = if alpha > 0.0 { -norm } else { norm };
        // A column that is already zero below the diagonal needs no reflection.
        if column[k + 1..].iter().all(|v| *v == 0.0) {
            self.scalars[k] = 0.0;
            return;
        }
        let tau = (beta - alpha) / beta;
        let scale = 1.0 / (alpha - beta);
        column[k + 1..].iter_mut().for_each(|v| *v *= scale);
        column[k] = beta;
        self.scalars[k] = tau;
        for other in right.chunks_exact_mut(m) {
            let dot = other[k]
                + column[k + 1..]
                    .iter()
                    .zip(&other[k + 1..])
                    .map(|(v, o)| v * o)
                    .sum::<f64>();
            let factor = tau * dot;
            other[k] -= factor;
            for (o, v) in other[k + 1..].iter_mut().zip(&column[k + 1..]) {
                *o -= factor * v;
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A repeatable matrix with entries in -1..1.
    fn matrix(rows: usize, columns: usize, seed: u64) -> Vec<f64> {
        let mut state = seed;
        (0..rows * columns)
            .map(|_| {
                state = state
                    .wrapping_mul(6364136223846793005)
                    .wrapping_add(1442695040888963407);
                (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
            })
            .collect()
    }

    fn multiply(a: &[f64], rows: usize, x: &[f64]) -> Vec<f64> {
        (0..rows)
            .map(|i| x.iter().enumerate().map(|(j, x)| a[j * rows + i] * x).sum())
            .collect()
    }

    #[test]
    fn solves_square_and_tall_consistent_systems() {
        for (rows, columns) in [(1, 1), (6, 6), (12, 12), (9, 5)] {
            let a = matrix(rows, columns, 7);
            let x: Vec<f64> = (0..columns).map(|k| k as f64 - 1.5).collect();
            let mut b = multiply(&a, rows, &x);
            let mut qr = PivotedQr::default();
            qr.factor(&a, rows, columns, 1e-12);
            let mut found = vec![0.0; columns];
            qr.solve(&mut b, &mut found);
            assert_eq!(qr.rank(), columns);
            for (f, x) in found.iter().zip(&x) {
                assert!((f - x).abs() < 1e-12, "{found:?}");
            }
        }
    }

    #[test]
    fn least_squares_residual_is_normal_to_the_columns() {
        let (rows, columns) = (8, 3);
        let a = matrix(rows, columns, 3);
        let b = matrix(rows, 1, 4);
        let mut qr = PivotedQr::default();
        qr.factor(&a, rows, columns, 1e-12);
        let mut x = vec![0.0; columns];
        qr.solve(&mut b.clone(), &mut x);
        let fitted = multiply(&a, rows, &x);
        for j in 0..columns {
            let dot: f64 = (0..rows)
                .map(|i| a[j * rows + i] * (b[i] - fitted[i]))
                .sum();
            assert!(dot.abs() < 1e-14);
        }
    }

    #[test]
    fn determinant_sign_matches_cofactors_and_rank_is_revealed() {
        for seed in 1..40 {
            let a = matrix(3, 3, seed);
            let det = a[0] * (a[4] * a[8] - a[5] * a[7]) - a[3] * (a[1] * a[8] - a[2] * a[7])
                + a[6] * (a[1] * a[5] - a[2] * a[4]);
            let mut qr = PivotedQr::default();
            qr.factor(&a, 3, 3, 1e-12);
            assert_eq!(
                f64::from(qr.determinant_sign()),
                det.signum(),
                "seed {seed}"
            );
        }
        let mut a = matrix(5, 4, 9);
        for i in 0..5 {
            a[15 + i] = 2.0 * a[i] - a[5 + i];
        }
        let mut qr = PivotedQr::default();
        qr.factor(&a, 5, 4, 1e-10);
        assert_eq!(qr.rank(), 3);
    }
}
