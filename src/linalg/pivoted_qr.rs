//! Householder QR with column pivoting, in place and without allocation: least squares, inverse, numerical rank.
//!
//! Golub and Van Loan, Matrix Computations, 4th ed., algorithm 5.4.1. Matrices come in column by column and are kept
//! by rows, so that reflections add rows to rows.

use super::lanes::{
    LaneMatrix, Lanes, add_scaled, add_squares, dot_lanes, lane_groups, scale_lanes,
};

/// A factorisation in reusable buffers.
#[derive(Clone, Debug, Default)]
pub struct PivotedQr {
    rows: usize,
    columns: usize,
    /// R above the diagonal; below it nothing of meaning.
    factors: LaneMatrix,
    /// One reflector a row: zeros, one, the rest of the vector.
    reflectors: LaneMatrix,
    scalars: Vec<f64>,
    order: Vec<usize>,
    /// Squares of the remaining column norms; only the pivot's root is taken.
    squares: Vec<Lanes>,
    scratch: Vec<Lanes>,
    unit: LaneMatrix,
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
        self.factors
            .copy_columns(&a[..rows * columns], rows, columns);
        self.reflectors.reset(columns.min(rows), rows);
        self.order.clear();
        self.order.extend(0..columns);
        self.scalars.clear();
        self.scalars.resize(columns.min(rows), 0.0);
        self.squares.clear();
        self.squares.resize(lane_groups(columns), [0.0; 4]);
        for row in self.factors.rows() {
            add_squares(&mut self.squares, row);
        }
        self.swaps = 0;
        self.rank = 0;
        let mut largest = 0.0;
        for k in 0..columns.min(rows) {
            let pivot = self.largest_column(k);
            self.swap_columns(k, pivot);
            let norm = self.squares[k / 4][k % 4].sqrt();
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
            rank => self.factors.at(rank - 1, rank - 1).abs(),
        }
    }

    /// Magnitude of the first pivot, which no other exceeds.
    pub fn largest_pivot(&self) -> f64 {
        match self.rank {
            0 => 0.0,
            _ => self.factors.at(0, 0).abs(),
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
            .filter(|k| self.factors.at(*k, *k) < 0.0)
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
        super::lanes::pack_lanes(&mut self.scratch, b.iter().copied());
        let reflected = &mut self.scratch[..];
        for k in 0..self.rank {
            let reflector = &self.reflectors.row(k)[k / 4..];
            let rest = &mut reflected[k / 4..];
            let factor = self.scalars[k] * dot_lanes(reflector, rest);
            add_scaled(rest, -factor, reflector);
        }
        for (b, value) in b.iter_mut().zip(self.scratch.as_flattened()) {
            *b = *value;
        }
        x[..self.columns].fill(0.0);
        // From here on the scratch holds the solution in the order of the pivots.
        self.scratch.clear();
        self.scratch.resize(lane_groups(self.columns), [0.0; 4]);
        for k in (0..self.rank).rev() {
            let known = dot_lanes(&self.factors.row(k)[k / 4..], &self.scratch[k / 4..]);
            // Entries below the diagonal meet zeros only where nothing is solved yet: k itself and before.
            let value = (b[k] - known) / self.factors.at(k, k);
            self.scratch[k / 4][k % 4] = value;
            x[self.order[k]] = value;
        }
    }

    /// Writes the inverse (of a tall matrix the pseudo-inverse), row-major; false where the rank is not full.
    pub fn invert(&mut self, inverse: &mut LaneMatrix) -> bool {
        let (m, n) = (self.rows, self.columns);
        if self.rank < n {
            return false;
        }
        self.unit.reset(m, m);
        for k in 0..m {
            *self.unit.at_mut(k, k) = 1.0;
        }
        // Qᵀ: the reflections one after the other on the identity.
        let stride = self.unit.stride();
        for k in 0..n {
            self.scratch.clear();
            self.scratch.resize(stride, [0.0; 4]);
            let tau = self.scalars[k];
            for i in k..m {
                let v = self.reflectors.at(k, i);
                add_scaled(&mut self.scratch, tau * v, self.unit.row(i));
            }
            for i in k..m {
                let v = self.reflectors.at(k, i);
                add_scaled(self.unit.row_mut(i), -v, &self.scratch);
            }
        }
        // Back substitution with R, all right sides at once.
        for k in (0..n).rev() {
            let (above, below) = self.unit.split_at_row(k + 1);
            let row = &mut above[k * stride..];
            for j in k + 1..n {
                let solved = &below[(j - k - 1) * stride..(j - k) * stride];
                add_scaled(row, -self.factors.at(k, j), solved);
            }
            let reciprocal = 1.0 / self.factors.at(k, k);
            scale_lanes(&mut row[..stride], reciprocal);
        }
        // Undo the exchange of columns.
        inverse.reset(n, m);
        for k in 0..n {
            inverse
                .row_mut(self.order[k])
                .copy_from_slice(self.unit.row(k));
        }
        true
    }

    fn largest_column(&self, k: usize) -> usize {
        let squares = self.squares.as_flattened();
        let mut best = k;
        for j in k + 1..self.columns {
            if squares[j] > squares[best] {
                best = j;
            }
        }
        best
    }

    fn swap_columns(&mut self, a: usize, b: usize) {
        if a == b {
            return;
        }
        self.factors.swap_columns(a, b);
        self.order.swap(a, b);
        self.squares.as_flattened_mut().swap(a, b);
        self.swaps += 1;
    }

    /// Makes column `k` zero below the diagonal, applies the reflection to the columns to the right, and measures what
    /// remains of them (small matrices: cheaper than careful downdating).
    fn reflect(&mut self, k: usize, norm: f64) {
        let alpha = self.factors.at(k, k);
        let beta = if alpha > 0.0 { -norm } else { norm };
        // A column that is already zero below the diagonal needs no reflection.
        let is_zero = (k + 1..self.rows).all(|i| self.factors.at(i, k) == 0.0);
        let (tau, share) = match is_zero {
            true => (0.0, 0.0),
            false => ((beta - alpha) / beta, 1.0 / (alpha - beta)),
        };
        let start = k / 4;
        let stride = self.factors.stride();
        let reflector = self.reflectors.row_mut(k).as_flattened_mut();
        reflector[k] = 1.0;
        let (above, below) = self.factors.split_at_row(k + 1);
        let row = &mut above[k * stride + start..];
        let sums = &mut self.scratch;
        sums.clear();
        sums.extend_from_slice(row);
        for (v, other) in reflector[k + 1..]
            .iter_mut()
            .zip(below.chunks_exact(stride))
        {
            *v = other[start][k % 4] * share;
            // Of a matrix with a diagonal below it half of the rows are still zero here.
            if *v != 0.0 {
                add_scaled(sums, *v, &other[start..]);
            }
        }
        scale_lanes(sums, tau);
        // Columns that are done keep what they have.
        sums[0][..=k % 4].fill(0.0);
        add_scaled(row, -1.0, sums);
        if !is_zero {
            row[0][k % 4] = beta;
        }
        let squares = &mut self.squares[start..];
        squares.fill([0.0; 4]);
        for (v, other) in reflector[k + 1..]
            .iter()
            .zip(below.chunks_exact_mut(stride))
        {
            let other = &mut other[start..];
            if *v != 0.0 {
                add_scaled(other, -v, sums);
            }
            add_squares(squares, other);
        }
        self.scalars[k] = tau;
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
    fn inverse_and_pseudo_inverse_undo_the_matrix() {
        for (rows, columns) in [(1, 1), (6, 6), (12, 12), (9, 5), (4, 3)] {
            let a = matrix(rows, columns, 11);
            let mut qr = PivotedQr::default();
            qr.factor(&a, rows, columns, 1e-12);
            let mut inverse = LaneMatrix::default();
            assert!(qr.invert(&mut inverse));
            for i in 0..columns {
                for j in 0..columns {
                    let entry: f64 = (0..rows).map(|k| inverse.at(i, k) * a[j * rows + k]).sum();
                    assert!((entry - f64::from(i == j)).abs() < 1e-13, "{i} {j} {entry}");
                }
            }
        }
        let mut qr = PivotedQr::default();
        qr.factor(&[1.0, 2.0, 2.0, 4.0], 2, 2, 1e-12);
        assert!(!qr.invert(&mut LaneMatrix::default()));
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
