//! Gauss-Jordan inverses of regular square matrices, at half the cost of a QR. A nearly singular matrix is rejected and
//! left to the factorisation that determines ranks.

use super::lanes::{LaneMatrix, Lanes, all_lanes, clear_column, scale_lanes};
use wide::f64x4;

/// Below this ratio of pivots the rank-revealing factorisation is used: six of sixteen digits would be lost.
pub const SMALLEST_RATIO: f64 = 1e-6;

/// Results of an elimination in addition to the inverse.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pivots {
    /// Sign of the determinant.
    pub sign: i8,
    /// Smallest magnitude of a pivot.
    pub smallest: f64,
    largest: f64,
}

impl Pivots {
    /// Before the first pivot.
    pub const NONE: Self = Self {
        sign: 1,
        smallest: f64::INFINITY,
        largest: 0.0,
    };

    /// The result for a matrix that is not square: it has no determinant.
    pub fn without_sign(self) -> Self {
        Self { sign: 0, ..self }
    }

    /// Records a pivot and whether rows were exchanged for it; false if it is zero or too small.
    #[inline]
    pub fn take(&mut self, pivot: f64, exchanged: bool, ratio: f64) -> bool {
        let size = pivot.abs();
        (self.smallest, self.largest) = (self.smallest.min(size), self.largest.max(size));
        if exchanged != (pivot < 0.0) {
            self.sign = -self.sign;
        }
        size > 0.0 && size.is_finite() && self.smallest > ratio * self.largest
    }
}

/// Buffers of an elimination.
#[derive(Clone, Debug, Default)]
pub struct GaussJordan {
    matrix: LaneMatrix,
    pivot_row: Vec<Lanes>,
    order: Vec<usize>,
}

impl GaussJordan {
    /// Inverts a square column-major matrix into `inverse`, which is written column by column as well; `None` where it is
    /// nearly singular or holds no numbers.
    pub fn invert(&mut self, a: &[f64], n: usize, inverse: &mut LaneMatrix) -> Option<Pivots> {
        self.matrix.copy_columns(a, n, n);
        self.invert_rows(n, SMALLEST_RATIO, inverse, true)
    }

    /// The same for a matrix in rows, however small its pivots; the inverse is in rows too.
    pub fn invert_matrix(&mut self, a: &LaneMatrix, inverse: &mut LaneMatrix) -> Option<Pivots> {
        self.matrix.copy(a);
        self.invert_rows(a.rows().len(), 0.0, inverse, false)
    }

    fn invert_rows(
        &mut self,
        n: usize,
        ratio: f64,
        inverse: &mut LaneMatrix,
        transposed: bool,
    ) -> Option<Pivots> {
        self.order.clear();
        self.order.extend(0..n);
        let order = &mut self.order[..];
        // The usual sizes are compiled separately, so that the pivot's row stays in registers.
        let pivots = match self.matrix.stride() {
            1 => invert_fixed::<1>(self.matrix.fixed_rows(), ratio, order),
            2 => invert_fixed::<2>(self.matrix.fixed_rows(), ratio, order),
            3 => invert_fixed::<3>(self.matrix.fixed_rows(), ratio, order),
            4 => invert_fixed::<4>(self.matrix.fixed_rows(), ratio, order),
            _ => self.invert_any(n, ratio),
        }?;
        // The exchanged rows are exchanged columns of the inverse.
        inverse.reset(n, n);
        let width = 4 * inverse.stride();
        let (down, along) = if transposed { (1, width) } else { (width, 1) };
        let target = inverse.groups_mut().as_flattened_mut();
        for (k, row) in self.matrix.rows().enumerate() {
            for (value, column) in row.as_flattened().iter().zip(&self.order) {
                target[k * down + column * along] = *value;
            }
        }
        Some(pivots)
    }

    fn invert_any(&mut self, n: usize, ratio: f64) -> Option<Pivots> {
        let mut pivots = Pivots::NONE;
        for k in 0..n {
            let (place, value) = self.largest_below(k);
            if !pivots.take(value, place != k, ratio) {
                return None;
            }
            self.matrix.swap_rows(k, place);
            self.order.swap(k, place);
            // In place: the pivot's column becomes a column of the inverse.
            *self.matrix.at_mut(k, k) = 1.0;
            let row = self.matrix.row_mut(k);
            scale_lanes(row, 1.0 / value);
            self.pivot_row.clear();
            self.pivot_row.extend_from_slice(row);
            let (above, rest) = self.matrix.split_at_row(k);
            clear_column(above, &self.pivot_row, k);
            clear_column(&mut rest[self.pivot_row.len()..], &self.pivot_row, k);
        }
        Some(pivots)
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

/// Gauss and Jordan in place on rows of `G` groups; `order` says which column of the inverse each column became.
fn invert_fixed<const G: usize>(
    rows: &mut [[Lanes; G]],
    ratio: f64,
    order: &mut [usize],
) -> Option<Pivots> {
    let mut pivots = Pivots::NONE;
    for k in 0..rows.len() {
        let (group, lane) = (k / 4 % G, k % 4);
        // Partial pivoting: the largest entry of the column that is left.
        let (mut place, mut largest) = (k, rows[k][group][lane].abs());
        for (i, row) in (k + 1..).zip(&rows[k + 1..]) {
            let size = row[group][lane].abs();
            (place, largest) = if size > largest {
                (i, size)
            } else {
                (place, largest)
            };
        }
        let value = rows[place][group][lane];
        if !pivots.take(value, place != k, ratio) {
            return None;
        }
        exchange_rows(rows, k, place);
        order.swap(k, place);
        // The pivot's row becomes a row of the inverse; the column is cleared above and below it.
        let reciprocal = 1.0 / value;
        let (above, rest) = rows.split_at_mut(k);
        let Some((own, below)) = rest.split_first_mut() else {
            break;
        };
        own[group][lane] = 1.0;
        let mut pivot = [f64x4::ZERO; G];
        for (pivot, part) in pivot.iter_mut().zip(own) {
            *pivot = f64x4::new(*part) * all_lanes(reciprocal);
            *part = pivot.to_array();
        }
        for part in [above, below] {
            match group {
                0 => clear_fixed::<G, 0>(part, &pivot, lane),
                1 => clear_fixed::<G, 1>(part, &pivot, lane),
                2 => clear_fixed::<G, 2>(part, &pivot, lane),
                _ => clear_fixed::<G, 3>(part, &pivot, lane),
            }
        }
    }
    Some(pivots)
}

/// Exchanges row `k` with one below it, group by group.
#[inline(always)]
fn exchange_rows<const G: usize>(rows: &mut [[Lanes; G]], k: usize, below: usize) {
    let (upper, lower) = rows.split_at_mut(below);
    if let (Some(a), Some(b)) = (upper.get_mut(k), lower.first_mut()) {
        a.iter_mut().zip(b).for_each(|(a, b)| std::mem::swap(a, b));
    }
}

/// Puts zero into every row's entry `lane` of group `K` and subtracts the pivot's row times what was there.
#[inline(always)]
fn clear_fixed<const G: usize, const K: usize>(
    rows: &mut [[Lanes; G]],
    pivot: &[f64x4; G],
    lane: usize,
) {
    let mut kept = [f64::from_bits(u64::MAX); 4];
    kept[lane] = 0.0;
    let kept = f64x4::new(kept);
    for row in rows {
        // The group always exists: the number of the pivot's group is below G.
        let factor = all_lanes(row[K % G][lane]);
        for g in 0..G {
            let entries = f64x4::new(row[g]);
            let entries = if g == K { entries & kept } else { entries };
            row[g] = (entries - factor * pivot[g]).to_array();
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;

    #[test]
    fn inverse_times_matrix_is_the_identity_and_its_sign_the_determinants() {
        let a = [0.0, 2.0, 1.0, 1.0, 0.5, -3.0, 4.0, 1.0, 0.25];
        let determinant = 0.0 * (0.5 * 0.25 + 3.0) - 2.0 * (0.25 + 12.0) + (1.0 - 2.0);
        let mut buffers = GaussJordan::default();
        let mut inverse = LaneMatrix::default();
        for flipped in [1.0_f64, -1.0] {
            let a = a.map(|v| flipped * v);
            let pivots = buffers.invert(&a, 3, &mut inverse).unwrap();
            assert_eq!(f64::from(pivots.sign), (flipped * determinant).signum());
            assert!(pivots.smallest > 0.1 && pivots.smallest < 4.0);
            for i in 0..3 {
                for j in 0..3 {
                    let entry: f64 = (0..3).map(|k| inverse.at(k, i) * a[j * 3 + k]).sum();
                    assert!((entry - f64::from(i == j)).abs() < 1e-15);
                }
            }
        }
        assert_eq!(buffers.invert(&[1.0, 2.0, 2.0, 4.0], 2, &mut inverse), None);
    }

    #[test]
    fn inverts_all_sizes_and_refuses_what_is_nearly_singular() {
        let (mut elimination, mut inverse) = (GaussJordan::default(), LaneMatrix::default());
        // Sizes go down after they went up, so that stale numbers would show.
        for n in (1..20).chain([13, 6, 5, 2]) {
            let a: Vec<f64> = (0..n * n)
                .map(|k| (0.7 * (k * k + n) as f64).sin())
                .collect();
            let pivots = elimination.invert(&a, n, &mut inverse).unwrap();
            let mut by_rows = LaneMatrix::default();
            by_rows.copy_columns(&a, n, n);
            let mut rows_inverse = LaneMatrix::default();
            let again = elimination.invert_matrix(&by_rows, &mut rows_inverse);
            assert_eq!(again.unwrap().sign, pivots.sign, "{n}");
            // What an inverse leaves of the identity is rounding times the condition number.
            let square = |m: &[f64]| m.iter().map(|v| v * v).sum::<f64>();
            let condition = (square(&a) * square(inverse.groups().as_flattened())).sqrt();
            let allowed = 4e-16 * condition;
            for i in 0..n {
                for j in 0..n {
                    let identity = f64::from(i == j);
                    let entry: f64 = (0..n).map(|k| inverse.at(k, i) * a[j * n + k]).sum();
                    assert!((entry - identity).abs() < allowed, "{n}: {entry}");
                    let entry: f64 = (0..n).map(|k| rows_inverse.at(i, k) * a[j * n + k]).sum();
                    assert!(
                        (entry - identity).abs() < allowed,
                        "{n}: {entry} of {condition}"
                    );
                }
            }
            // Lanes beyond the matrix are zero: sums may run over them.
            assert!(
                inverse
                    .rows()
                    .all(|row| row.as_flattened()[n..].iter().all(|v| *v == 0.0))
            );
        }
        let singular = [1.0, 2.0, 2.0, 4.0 + 1e-9];
        assert_eq!(elimination.invert(&singular, 2, &mut inverse), None);
        let none = [f64::NAN, 2.0, 2.0, 4.0];
        assert_eq!(elimination.invert(&none, 2, &mut inverse), None);
    }
}
