//! Triangular factors of eight matrices at once, with a common order of rows that is known beforehand.

use crate::numbers::octet::{LaneMask, Octet};

/// Largest block that is solved side by side: larger ones are sparse, or overflow the cache.
pub(super) const LARGEST_BLOCK: usize = 32;

/// The order of the rows, and the smallest acceptable pivots.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct PivotOrder {
    /// The row of every pivot.
    rows: Vec<usize>,
    /// Magnitudes below which a pivot is rejected.
    least: Vec<f64>,
}

/// A pivot may be this fraction of the corresponding one of the neighbouring matrix: below it another order would be
/// better, and multipliers of the elimination may grow as much.
const LEAST_PART: f64 = 0.1;

/// An elimination of eight matrices.
pub(super) trait OctetElimination {
    /// Factorises column-major matrices: returns the lanes whose pivots are large enough, and the smallest pivot.
    fn factor(&mut self, matrix: &[Octet]) -> (LaneMask, Octet);

    /// Solves matrix · step = -`right`.
    fn solve(&mut self, right: &[Octet]);

    /// The last solution.
    fn step(&self) -> &[Octet];
}

/// An elimination in a known order.
pub(super) struct Ordered<'f> {
    pub factors: &'f mut Factors,
    pub order: &'f PivotOrder,
}

impl OctetElimination for Ordered<'_> {
    fn factor(&mut self, matrix: &[Octet]) -> (LaneMask, Octet) {
        self.factors.factor(matrix, self.order)
    }

    fn solve(&mut self, right: &[Octet]) {
        self.factors.solve(right, self.order);
    }

    fn step(&self) -> &[Octet] {
        &self.factors.step
    }
}

/// Factors of square matrices.
#[derive(Clone, Debug, Default)]
pub(super) struct Factors {
    /// Column-major, in the order of the pivots; below the diagonal the factors of the elimination.
    entries: Vec<Octet>,
    /// Of the pivots.
    reciprocals: Vec<Octet>,
    /// The last solution.
    pub step: Vec<Octet>,
}

impl PivotOrder {
    /// The order of partial pivoting for a column-major matrix; `None` if a pivot is zero or NaN.
    pub fn of(matrix: &[f64], n: usize) -> Option<Self> {
        let mut rest = matrix.to_vec();
        let mut rows: Vec<usize> = (0..n).collect();
        let mut least = Vec::with_capacity(n);
        for k in 0..n {
            let size = |row: &usize| rest[k * n + rows[*row]].abs();
            // The largest remaining entry of the column.
            let best = (k..n).max_by(|a, b| size(a).total_cmp(&size(b)))?;
            rows.swap(k, best);
            let pivot = rest[k * n + rows[k]];
            if pivot == 0.0 || !pivot.is_finite() {
                return None;
            }
            least.push(LEAST_PART * pivot.abs());
            for row in &rows[k + 1..] {
                let factor = rest[k * n + row] / pivot;
                for j in k + 1..n {
                    rest[j * n + row] -= factor * rest[j * n + rows[k]];
                }
            }
        }
        Some(Self { rows, least })
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }
}

impl Factors {
    /// Factorises column-major matrices: returns the lanes whose pivots are all large enough, and the smallest pivot.
    pub fn factor(&mut self, matrix: &[Octet], order: &PivotOrder) -> (LaneMask, Octet) {
        let n = order.rows.len();
        self.entries.clear();
        for column in matrix.chunks_exact(n.max(1)) {
            self.entries
                .extend(order.rows.iter().map(|row| column[*row]));
        }
        self.reciprocals.clear();
        let mut good = LaneMask::first(crate::numbers::octet::LANES);
        let mut smallest = Octet::splat(f64::INFINITY);
        for k in 0..n {
            let (done, rest) = self.entries.split_at_mut((k + 1) * n);
            let column = &mut done[k * n..];
            let size = column[k].magnitude();
            good = good.and(Octet::splat(order.least[k]).at_most(size));
            smallest = size.at_most(smallest).choose(size, smallest);
            self.reciprocals.push(clear_below(column, rest, k));
        }
        (good, smallest)
    }

    /// Solves matrix · step = -`right`.
    pub fn solve(&mut self, right: &[Octet], order: &PivotOrder) {
        let step = &mut self.step;
        step.clear();
        step.extend(order.rows.iter().map(|row| -right[*row]));
        substitute(&self.entries, &self.reciprocals, step);
    }
}

/// Solves for a right-hand side with rows in the order of the pivots: forward substitution below the diagonal, then
/// backward.
pub(super) fn substitute(entries: &[Octet], reciprocals: &[Octet], right: &mut [Octet]) {
    let n = right.len();
    for k in 0..n {
        let (value, column) = (right[k], &entries[k * n..(k + 1) * n]);
        for (left, factor) in right[k + 1..].iter_mut().zip(&column[k + 1..]) {
            *left -= *factor * value;
        }
    }
    for k in (0..n).rev() {
        let value = right[k] * reciprocals[k];
        right[k] = value;
        for (left, entry) in right[..k].iter_mut().zip(&entries[k * n..]) {
            *left -= *entry * value;
        }
    }
}

/// Eliminates with the pivot in row `k` of a column: entries below become multipliers, and later columns are updated.
/// Returns the reciprocal of the pivot.
#[inline]
pub(super) fn clear_below(column: &mut [Octet], behind: &mut [Octet], k: usize) -> Octet {
    let n = column.len();
    let reciprocal = Octet::splat(1.0) / column[k];
    let factors = &mut column[k + 1..];
    factors.iter_mut().for_each(|f| *f = *f * reciprocal);
    for column in behind.chunks_exact_mut(n) {
        let by = column[k];
        for (entry, factor) in column[k + 1..].iter_mut().zip(&*factors) {
            *entry -= *factor * by;
        }
    }
    reciprocal
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::numbers::octet::LANES;

    /// Matrices near a common one, each solved in its lane; a vanishing pivot is reported, and its neighbours keep
    /// their bits.
    #[test]
    fn every_lane_solves_its_own_matrix() {
        let n = 7;
        let entry = |k: usize, lane: usize| {
            (0.7 * (k * k + 3) as f64).sin() + 0.01 * ((k + 5 * lane) as f64).cos()
        };
        let plain = |lane| (0..n * n).map(|k| entry(k, lane)).collect::<Vec<f64>>();
        let order = PivotOrder::of(&plain(0), n).unwrap();
        let octets = |broken: Option<usize>| -> Vec<Octet> {
            let one = |k: usize, lane: usize| match broken == Some(lane) {
                true => 0.0,
                false => entry(k, lane),
            };
            let eight = |k: usize| Octet::new(std::array::from_fn(|lane| one(k, lane)));
            (0..n * n).map(eight).collect()
        };
        let right: Vec<Octet> = (0..n).map(|k| Octet::splat(k as f64 - 2.0)).collect();
        let mut factors = Factors::default();
        let (good, _) = factors.factor(&octets(None), &order);
        factors.solve(&right, &order);
        let whole = factors.step.clone();
        for lane in 0..LANES {
            assert!(good.has(lane));
            let matrix = plain(lane);
            for row in 0..n {
                let sum: f64 = (0..n)
                    .map(|j| matrix[j * n + row] * whole[j].lane(lane))
                    .sum();
                assert!((sum + right[row].lane(lane)).abs() < 1e-13, "{lane} {row}");
            }
        }
        let (good, _) = factors.factor(&octets(Some(3)), &order);
        factors.solve(&right, &order);
        for lane in 0..LANES {
            assert_eq!(good.has(lane), lane != 3);
            let same = factors.step.iter().zip(&whole);
            let mut same = same.map(|(a, b)| a.lane(lane).to_bits() == b.lane(lane).to_bits());
            assert_eq!(same.all(|same| same), lane != 3);
        }
    }
}
