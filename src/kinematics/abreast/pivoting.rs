//! Triangular factors of eight matrices at once, each with its own order of rows from partial pivoting.

use super::factors::{OctetElimination, clear_below, substitute};
use crate::linalg::gauss_jordan::SMALLEST_RATIO;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Factors of square matrices.
#[derive(Clone, Debug, Default)]
pub(super) struct PivotedFactors {
    n: usize,
    /// Column-major; below the diagonal the factors of the elimination.
    entries: Vec<Octet>,
    /// Of the pivots.
    reciprocals: Vec<Octet>,
    /// The lanes in which a row was exchanged with each one below it, pivot after pivot.
    exchanged: Vec<LaneMask>,
    step: Vec<Octet>,
}

impl PivotedFactors {
    /// Exchanges rows until every lane has its largest entry of column `k` in row `k`.
    fn exchange_rows(&mut self, k: usize) {
        let n = self.n;
        for i in k + 1..n {
            let column = &self.entries[k * n..(k + 1) * n];
            // Partial pivoting lane by lane: rows change places only in the lanes that ask for it.
            let is_larger = column[i].magnitude().above(column[k].magnitude());
            self.exchanged.push(is_larger);
            if !is_larger.any() {
                continue;
            }
            for column in self.entries.chunks_exact_mut(n) {
                let (a, b) = (column[k], column[i]);
                column[k] = is_larger.choose(b, a);
                column[i] = is_larger.choose(a, b);
            }
        }
    }
}

impl OctetElimination for PivotedFactors {
    fn factor(&mut self, matrix: &[Octet]) -> (LaneMask, Octet) {
        let n = matrix.len().isqrt();
        self.n = n;
        self.entries.clear();
        self.entries.extend_from_slice(matrix);
        self.reciprocals.clear();
        self.exchanged.clear();
        let mut smallest = Octet::splat(f64::INFINITY);
        let mut largest = Octet::ZERO;
        let mut good = LaneMask::first(LANES);
        for k in 0..n {
            self.exchange_rows(k);
            let (done, rest) = self.entries.split_at_mut((k + 1) * n);
            let column = &mut done[k * n..];
            let size = column[k].magnitude();
            smallest = size.at_most(smallest).choose(size, smallest);
            largest = largest.larger_magnitude(size);
            // NaN is not above anything.
            good = good.and(smallest.above(largest * SMALLEST_RATIO));
            self.reciprocals.push(clear_below(column, rest, k));
        }
        (good, smallest)
    }

    fn solve(&mut self, right: &[Octet]) {
        let (n, step) = (self.n, &mut self.step);
        step.clear();
        step.extend(right.iter().map(|r| -*r));
        // The right-hand side is permuted like the rows.
        let mut exchanged = self.exchanged.iter();
        for k in 0..n {
            for (i, lanes) in (k + 1..n).zip(&mut exchanged) {
                let (a, b) = (step[k], step[i]);
                step[k] = lanes.choose(b, a);
                step[i] = lanes.choose(a, b);
            }
        }
        substitute(&self.entries, &self.reciprocals, step);
    }

    fn step(&self) -> &[Octet] {
        &self.step
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Matrices that have nothing in common, one of them singular.
    #[test]
    fn every_lane_has_an_order_of_its_own() {
        let n = 6;
        let entry = |k: usize, lane: usize| match lane {
            5 => (k % n) as f64,
            _ => (0.7 * (k * k + 3 * lane + lane * lane * k) as f64).sin(),
        };
        let eight = |k: usize| Octet::new(std::array::from_fn(|lane| entry(k, lane)));
        let matrix: Vec<Octet> = (0..n * n).map(eight).collect();
        let right: Vec<Octet> = (0..n).map(|k| Octet::splat(k as f64 - 2.0)).collect();
        let mut factors = PivotedFactors::default();
        let (good, smallest) = factors.factor(&matrix);
        factors.solve(&right);
        for lane in (0..LANES).filter(|lane| *lane != 5) {
            assert!(good.has(lane) && smallest.lane(lane) > 0.0);
            for (row, right) in right.iter().enumerate() {
                let sum: f64 = (0..n)
                    .map(|j| entry(j * n + row, lane) * factors.step()[j].lane(lane))
                    .sum();
                assert!(
                    (sum + right.lane(lane)).abs() < 1e-12,
                    "{lane} {row}: {sum}"
                );
            }
        }
        assert!(!good.has(5));
    }
}
