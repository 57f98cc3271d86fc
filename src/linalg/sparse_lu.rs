//! Elimination of large sparse matrices: Gaussian elimination with the order of rows and columns that causes least
//! fill-in.
//!
//! Markowitz' choice, column first: the column with the fewest entries, and among its entries that are not much smaller
//! than its largest the one in the shortest row (Duff, Erisman and Reid, Direct Methods for Sparse Matrices, chapter
//! 7).

use super::gauss_jordan::{Pivots, SMALLEST_RATIO};
use super::lanes::LaneMatrix;

/// Matrices with fewer rows are eliminated densely: whole rows are faster than lists.
pub const LEAST: usize = 64;

/// A matrix with more than one entry in this many is dense.
const SPARSE: usize = 8;

/// A pivot is at least this fraction of the largest entry of its column.
const THRESHOLD: f64 = 0.1;

/// Marks a row, or column, that is finished.
const DONE: usize = usize::MAX;

/// Factors of a square matrix, in reusable buffers.
#[derive(Clone, Debug, Default)]
pub struct SparseLu {
    /// The remaining row, by column; for a finished row its row of U without the pivot.
    rows: Vec<Vec<(usize, f64)>>,
    /// Rows not done yet with an entry in each column.
    columns: Vec<Vec<usize>>,
    /// Entries of each column, `DONE` once it had its pivot.
    counts: Vec<usize>,
    /// Row, column and value of the pivots in order.
    pivots: Vec<(usize, usize, f64)>,
    /// Eliminations in order: of pivot row `k` the rows below and their factors.
    below: Vec<(usize, f64)>,
    /// Where the eliminations of every pivot end.
    ends: Vec<usize>,
    merged: Vec<(usize, f64)>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    seen: Vec<bool>,
}

impl SparseLu {
    /// Inverts a square column-major matrix into `inverse`, written column by column as well; `None` where it is small,
    /// dense or nearly singular.
    pub fn invert(&mut self, a: &[f64], n: usize, inverse: &mut LaneMatrix) -> Option<Pivots> {
        self.invert_columns(a.chunks_exact(n.max(1)), n, inverse)
    }

    /// The same for a matrix given column by column.
    pub fn invert_columns<'a>(
        &mut self,
        columns: impl Iterator<Item = &'a [f64]> + Clone,
        n: usize,
        inverse: &mut LaneMatrix,
    ) -> Option<Pivots> {
        let pivots = self.factor(columns, n)?;
        inverse.reset(n, n);
        for k in 0..n {
            self.right_side.clear();
            self.right_side.resize(n, 0.0);
            // Column k of the inverse solves for unit vector k.
            self.right_side[k] = 1.0;
            self.substitute();
            let row = inverse.row_mut(k).as_flattened_mut();
            row[..n].copy_from_slice(&self.solution);
        }
        Some(pivots)
    }

    /// Factors a square column-major matrix; `None` where it is small, dense or nearly singular.
    pub fn factor_columns(&mut self, a: &[f64], n: usize) -> Option<Pivots> {
        self.factor(a.chunks_exact(n.max(1)), n)
    }

    fn factor<'a>(
        &mut self,
        columns: impl Iterator<Item = &'a [f64]> + Clone,
        n: usize,
    ) -> Option<Pivots> {
        if n < LEAST {
            return None;
        }
        // Small or dense matrices are faster in lanes.
        let columns = columns.take(n);
        let count = |column: &[f64]| column.iter().filter(|v| **v != 0.0).count();
        if columns.clone().map(count).sum::<usize>() > n * n / SPARSE {
            return None;
        }
        self.begin(n);
        for (j, column) in columns.enumerate() {
            for (i, value) in column.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                self.push(i, j, *value);
            }
        }
        self.eliminate_rows(SMALLEST_RATIO)
    }

    /// Writes the pseudo-inverse of a tall column-major matrix, one row an equation; `None` where it is small, dense or
    /// nearly singular.
    pub fn pseudo_invert(
        &mut self,
        a: &[f64],
        [rows, columns]: [usize; 2],
        inverse: &mut LaneMatrix,
    ) -> Option<Pivots> {
        let pivots = self.factor_tall(a, [rows, columns])?;
        inverse.reset(rows, columns);
        for k in 0..rows {
            self.right_side.clear();
            self.right_side.resize(rows + columns, 0.0);
            self.right_side[k] = 1.0;
            self.substitute();
            let row = inverse.row_mut(k).as_flattened_mut();
            row[..columns].copy_from_slice(&self.solution[rows..]);
        }
        Some(pivots)
    }

    /// Factors a tall column-major matrix for least squares, likewise.
    pub fn factor_tall(&mut self, a: &[f64], [rows, columns]: [usize; 2]) -> Option<Pivots> {
        let entries = a[..rows * columns].iter().filter(|v| **v != 0.0).count();
        if columns < LEAST || rows <= columns || entries > rows * columns / SPARSE {
            return None;
        }
        self.begin_least_squares(a, [rows, columns], |_| 1.0, 0.0);
        self.eliminate_rows(SMALLEST_RATIO)
    }

    /// Lays out [I A; Aᵀ -λI] for the weighted rows of a column-major matrix: of a right side (b, 0) the last part of the
    /// solution is the damped least squares one of A x = b.
    pub fn begin_least_squares(
        &mut self,
        a: &[f64],
        [rows, columns]: [usize; 2],
        weight: impl Fn(usize) -> f64,
        damping: f64,
    ) {
        self.begin(rows + columns);
        for i in 0..rows {
            self.push(i, i, 1.0);
        }
        for (j, column) in a.chunks_exact(rows.max(1)).take(columns).enumerate() {
            for (i, value) in column.iter().enumerate().filter(|(_, v)| **v != 0.0) {
                let value = value * weight(i);
                self.push(i, rows + j, value);
                self.push(rows + j, i, value);
            }
            self.push(rows + j, rows + j, -damping);
        }
    }

    /// Makes room for a matrix without entries.
    fn begin(&mut self, n: usize) {
        self.rows.resize(n, Vec::new());
        self.rows.iter_mut().for_each(Vec::clear);
        self.columns.resize(n, Vec::new());
        self.columns.iter_mut().for_each(Vec::clear);
    }

    /// Adds an entry; those of a row come in the order of their columns.
    fn push(&mut self, row: usize, column: usize, value: f64) {
        self.rows[row].push((column, value));
        self.columns[column].push(row);
    }

    /// Eliminates the entries added; `None` if it fills in, or pivots are smaller than `ratio` of the largest.
    pub fn eliminate_rows(&mut self, ratio: f64) -> Option<Pivots> {
        let n = self.rows.len();
        self.counts.clear();
        self.counts.extend(self.columns.iter().map(Vec::len));
        self.pivots.clear();
        self.below.clear();
        self.ends.clear();
        let mut pivots = Pivots::NONE;
        for _ in 0..n {
            // The column with the fewest entries left fills the least.
            let column = (0..n).min_by_key(|j| self.counts[*j])?;
            let (row, value) = self.pivot_of(column)?;
            if !pivots.take(value, false, ratio) {
                return None;
            }
            self.clear(row, column, value);
            if self.below.len() > n * n / SPARSE {
                return None;
            }
        }
        let odd = self.is_odd(|p| p.0) != self.is_odd(|p| p.1);
        pivots.sign *= if odd { -1 } else { 1 };
        Some(pivots)
    }

    /// Solves with the factors: `right_side` by rows, the solution by columns.
    pub fn solve(&mut self, right_side: &[f64]) -> &[f64] {
        self.right_side.clear();
        self.right_side.extend_from_slice(right_side);
        self.substitute();
        &self.solution
    }

    /// Row and value of the entry of a column that causes least fill-in.
    fn pivot_of(&self, column: usize) -> Option<(usize, f64)> {
        let value = |row: usize| {
            let entries = &self.rows[row];
            let place = entries.binary_search_by_key(&column, |e| e.0);
            place.map_or(0.0, |place| entries[place].1)
        };
        let rows = self.columns[column].iter();
        let largest = rows
            .clone()
            .fold(0.0_f64, |m, row| m.max(value(*row).abs()));
        // Markowitz: of entries that are large enough, the one whose row is shortest.
        let fit = rows.filter(|row| value(**row).abs() >= THRESHOLD * largest);
        let best = fit.min_by_key(|row| (self.rows[**row].len(), **row))?;
        Some((*best, value(*best)))
    }

    /// Eliminates with a pivot: clears its column below, and records the operations.
    fn clear(&mut self, row: usize, column: usize, pivot: f64) {
        let mut own = std::mem::take(&mut self.rows[row]);
        own.retain(|e| e.0 != column);
        let targets = std::mem::take(&mut self.columns[column]);
        self.counts[column] = DONE;
        for (j, _) in &own {
            self.columns[*j].retain(|i| *i != row);
            self.counts[*j] = self.columns[*j].len();
        }
        // Elimination of the column below; factors are kept for right sides to come.
        for target in targets.into_iter().filter(|i| *i != row) {
            let entries = &self.rows[target];
            let place = entries.binary_search_by_key(&column, |e| e.0);
            let factor = place.map_or(0.0, |place| entries[place].1) / pivot;
            self.below.push((target, factor));
            self.subtract(target, column, factor, &own);
        }
        self.rows[row] = own;
        self.pivots.push((row, column, pivot));
        self.ends.push(self.below.len());
    }

    /// Subtracts a multiple of the pivot's row, and drops the entry in its column.
    fn subtract(&mut self, target: usize, column: usize, factor: f64, own: &[(usize, f64)]) {
        self.merged.clear();
        let mut theirs = own.iter().peekable();
        for &(j, value) in self.rows[target].iter().filter(|e| e.0 != column) {
            while let Some(&&(k, v)) = theirs.peek().filter(|e| e.0 < j) {
                self.merged.push((k, -factor * v));
                self.columns[k].push(target);
                self.counts[k] += 1;
                theirs.next();
            }
            match theirs.next_if(|e| e.0 == j) {
                Some(&(_, v)) => self.merged.push((j, value - factor * v)),
                None => self.merged.push((j, value)),
            }
        }
        for &(k, v) in theirs {
            self.merged.push((k, -factor * v));
            self.columns[k].push(target);
            self.counts[k] += 1;
        }
        std::mem::swap(&mut self.rows[target], &mut self.merged);
    }

    /// Forward through the eliminations, then back through the pivots.
    fn substitute(&mut self) {
        let b = &mut self.right_side[..];
        let mut start = 0;
        for ((row, _, _), end) in self.pivots.iter().zip(&self.ends) {
            let value = b[*row];
            if value != 0.0 {
                for (target, factor) in &self.below[start..*end] {
                    b[*target] -= factor * value;
                }
            }
            start = *end;
        }
        self.solution.clear();
        self.solution.resize(b.len(), 0.0);
        for (row, column, pivot) in self.pivots.iter().rev() {
            let known = self.rows[*row].iter();
            let known: f64 = known.map(|(j, v)| v * self.solution[*j]).sum();
            self.solution[*column] = (b[*row] - known) / pivot;
        }
    }

    /// Whether the order of the pivots' rows, or columns, is an odd permutation.
    fn is_odd(&mut self, place: impl Fn(&(usize, usize, f64)) -> usize) -> bool {
        self.seen.clear();
        self.seen.resize(self.pivots.len(), false);
        let mut odd = false;
        for first in 0..self.pivots.len() {
            let mut at = first;
            let mut length = 0;
            while !self.seen[at] {
                self.seen[at] = true;
                at = place(&self.pivots[at]);
                length += 1;
            }
            odd ^= length > 0 && length % 2 == 0;
        }
        odd
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::linalg::gauss_jordan::GaussJordan;

    /// A band with a few entries far off it; the seed moves them, and turns signs.
    fn matrix(n: usize, seed: usize) -> Vec<f64> {
        let mut a = vec![0.0; n * n];
        for i in 0..n {
            for (k, far) in [0, 1, n - 2, (i * 7 + seed) % n].into_iter().enumerate() {
                let j = (i + far) % n;
                a[j * n + i] += (1.0 + (i * 13 + k * 5 + seed) as f64).sin() + f64::from(k == 0);
            }
        }
        a
    }

    #[test]
    fn inverse_and_sign_are_those_of_the_dense_elimination() {
        let (mut sparse, mut dense) = (SparseLu::default(), GaussJordan::default());
        let (mut found, mut exact) = (LaneMatrix::default(), LaneMatrix::default());
        for (n, seed) in [(64, 1), (101, 2), (90, 3), (150, 4), (77, 5)] {
            let a = matrix(n, seed);
            let pivots = sparse.invert(&a, n, &mut found).unwrap();
            let wanted = dense.invert(&a, n, &mut exact).unwrap();
            assert_eq!(pivots.sign, wanted.sign, "{n}");
            let largest = exact.groups().as_flattened().iter();
            let largest = largest.fold(0.0_f64, |m, v| m.max(v.abs()));
            for i in 0..n {
                for j in 0..n {
                    let off = (found.at(i, j) - exact.at(i, j)).abs();
                    assert!(off < 1e-12 * largest * largest, "{n}: {off}");
                }
            }
        }
    }

    #[test]
    fn pseudo_inverse_of_a_tall_matrix_is_that_of_the_qr() {
        let (columns, rows) = (96, 110);
        // A square one, and below it rows of others.
        let (top, below) = (matrix(columns, 1), matrix(columns, 2));
        let mut a = Vec::new();
        for j in 0..columns {
            a.extend_from_slice(&top[j * columns..(j + 1) * columns]);
            a.extend_from_slice(&below[j * columns..j * columns + rows - columns]);
        }
        let (mut found, mut exact) = (LaneMatrix::default(), LaneMatrix::default());
        let mut sparse = SparseLu::default();
        assert!(
            sparse
                .pseudo_invert(&a, [rows, columns], &mut found)
                .is_some()
        );
        let mut qr = crate::linalg::pivoted_qr::PivotedQr::default();
        qr.factor(&a, rows, columns, 1e-12);
        assert!(qr.invert(&mut exact));
        for i in 0..columns {
            for j in 0..rows {
                let off = (found.at(j, i) - exact.at(i, j)).abs();
                assert!(off < 1e-10, "{i} {j}: {off}");
            }
        }
    }

    #[test]
    fn refuses_what_is_small_dense_or_singular() {
        let mut sparse = SparseLu::default();
        assert!(sparse.factor_columns(&matrix(20, 1), 20).is_none());
        assert!(sparse.factor_columns(&vec![1.0; 100 * 100], 100).is_none());
        let mut a = matrix(80, 1);
        let (first, rest) = a.split_at_mut(80);
        rest[..80].copy_from_slice(first);
        assert!(sparse.factor_columns(&a, 80).is_none());
    }
}
