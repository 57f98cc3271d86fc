//! Smallest and largest singular value of a regular matrix from its inverse and itself, by iteration from the vectors of
//! the pose before.
//!
//! Power iteration on A Aᵀ with a Rayleigh quotient θ and its residual ρ. The sum of all eigenvalues is the squared
//! Frobenius norm of A, so that all but the largest are at most b = sum - θ; where b is below θ, the largest is at most
//! θ + ρ² / (θ - b) (Temple's inequality; Parlett, The Symmetric Eigenvalue Problem, chapter 10). The sums of their second and
//! fourth powers, the Frobenius norms of A Aᵀ and of its square, give a better b where it is needed. Where the second eigenvalue is too
//! near for any b, two vectors are iterated (`ritz_pair`). So the smallest singular value is proved; where neither decides, the caller
//! decomposes exactly. The largest has no such proof: its iteration starts at every pose from a vector that has a
//! part in every direction, so that it cannot stay with a value that has been overtaken.

use super::lanes::{
    LaneMatrix, Lanes, all_lanes, combine_rows, dot_lanes, lane_groups, lane_sum, scale_lanes,
};
use super::ritz_pair::RitzPair;
use wide::f64x4;

/// Relative error of the smallest singular value. The eigenvalue, its square, may have twice as much. Using the inverse
/// of a neighbouring pose adds as much again: together a millionth.
pub const SMALLEST_ERROR: f64 = 5e-7;

/// Relative error of the largest singular value, and with it of the condition number.
pub const LARGEST_ERROR: f64 = 1e-3;

/// Iterations after which the exact decomposition of a small matrix is cheaper.
const MOST_ITERATIONS: usize = 24;

/// For a larger one the decomposition costs about a dozen times its size in iterations: that many are made.
const TIMES_OF_SIZE: usize = 4;

/// Weight of a fixed vector that is mixed into the start of the largest value.
const MIXED: f64 = 0.01;

/// Below this fraction of the largest eigenvalue, the bound on all others is good enough.
const CLEAR_SHARE: f64 = 0.9;

/// Above this fraction of it, the second one is called near: a single vector would not do at the next pose.
const NEAR_SHARE: f64 = 0.7;

/// Entry of a vector without a preferred direction; signs alternate in no regular way.
fn spread_angle(k: usize) -> f64 {
    let size = 1.0 + 0.37 * ((k * 7) % 5) as f64;
    if (k * k + k / 3) % 4 < 2 { size } else { -size }
}

/// Vectors that a block's iterations start from.
#[derive(Clone, Debug, Default)]
pub struct Extremes {
    small: PowerIteration,
    large: PowerIteration,
    powers: PowerSums,
    pair: RitzPair,
    /// Whether two values were near at the last pose.
    are_near: bool,
}

impl Extremes {
    /// Smallest and largest singular value of a matrix from itself and its inverse (or pseudo-inverse), either of which
    /// may be transposed. `None` where the iterations do not decide.
    pub fn of(&mut self, matrix: &LaneMatrix, inverse: &LaneMatrix) -> Option<(f64, f64)> {
        let sum: f64 = inverse.rows().map(|row| dot_lanes(row, row)).sum();
        self.powers.known.clear();
        let followed = match self.are_near {
            true => self.of_two_near(inverse, true),
            false => None,
        };
        let small = followed
            .or_else(|| self.smallest(inverse, sum))
            .or_else(|| self.of_two_near(inverse, false))?;
        self.large.mix();
        let allowed = 4.0 * LARGEST_ERROR * LARGEST_ERROR;
        let large = self.large.largest(matrix, |value, residual| {
            (residual <= allowed * value * value).then_some(true)
        })?;
        Some((1.0 / small.sqrt(), large.sqrt()))
    }

    /// The largest eigenvalue of the inverse, if the others are proved to be smaller; `sum` is that of all.
    fn smallest(&mut self, inverse: &LaneMatrix, sum: f64) -> Option<f64> {
        self.small.largest(inverse, |value, residual| {
            let mut others = sum - value;
            if others > CLEAR_SHARE * value {
                others = self.powers.others(0, inverse, value);
            }
            if others > CLEAR_SHARE * value {
                others = self.powers.others(1, inverse, value);
            }
            // Rounding of the sums is far below this margin.
            let is_clear = others <= CLEAR_SHARE * value;
            let left = if is_clear {
                value - others
            } else {
                (1.0 - CLEAR_SHARE) * value
            };
            let is_settled = residual <= 2.0 * SMALLEST_ERROR * value * left;
            is_settled.then_some(is_clear)
        })
    }

    /// The largest eigenvalue of the inverse beside which another one is near; from the vector of the single iteration, or from
    /// where the last search for two ended.
    fn of_two_near(&mut self, inverse: &LaneMatrix, is_followed: bool) -> Option<f64> {
        self.powers.others(1, inverse, 0.0);
        let (gram, fourth) = (&self.powers.gram, self.powers.known[1]);
        let asked = [CLEAR_SHARE, 2.0 * SMALLEST_ERROR];
        let first = (!is_followed).then_some(&self.small.vector[..]);
        let found = self.pair.largest(gram, first, fourth, asked);
        // The second value alone decides whether one vector would do at the next pose.
        self.are_near = found.is_some_and(|[high, low]| low > NEAR_SHARE * high);
        found.map(|[high, _]| high)
    }
}

/// Sums of the second and the fourth powers of the eigenvalues of A Aᵀ, computed on demand.
#[derive(Clone, Debug, Default)]
struct PowerSums {
    known: Vec<f64>,
    gram: LaneMatrix,
}

impl PowerSums {
    /// Bound of all eigenvalues but the largest, which is at least `value`, from power 2 or 4 (`level` 0 or 1).
    fn others(&mut self, level: usize, a: &LaneMatrix, value: f64) -> f64 {
        while self.known.len() <= level {
            let sum = match self.known.len() {
                0 => gram_into(&mut self.gram, a),
                _ => square_norm_of_gram(&self.gram),
            };
            self.known.push(sum);
        }
        // The trace of a power is the sum of the powers of all eigenvalues; less the known one it bounds the rest.
        let of_others = (0..=level).fold(value, |power, _| power * power);
        let rest = (self.known[level] - of_others).max(0.0);
        (0..=level).fold(rest, |root, _| root.sqrt())
    }
}

/// A Aᵀ, and the sum of the squares of its entries.
fn gram_into(gram: &mut LaneMatrix, a: &LaneMatrix) -> f64 {
    let n = a.rows().len();
    gram.reset(n, n);
    for (i, row) in a.rows().enumerate() {
        // The lower half; the matrix is symmetric.
        for (j, other) in a.rows().enumerate().take(i + 1) {
            let entry = dot_lanes(row, other);
            *gram.at_mut(i, j) = entry;
            *gram.at_mut(j, i) = entry;
        }
    }
    gram.rows().map(|row| dot_lanes(row, row)).sum()
}

/// Sum of the squares of the entries of G Gᵀ.
fn square_norm_of_gram(g: &LaneMatrix) -> f64 {
    let mut sum = 0.0;
    for (i, row) in g.rows().enumerate() {
        let beside = g.rows().take(i).map(|other| dot_lanes(row, other).powi(2));
        sum += dot_lanes(row, row).powi(2) + 2.0 * beside.sum::<f64>();
    }
    sum
}

/// One eigenvector.
#[derive(Clone, Debug, Default)]
struct PowerIteration {
    vector: Vec<Lanes>,
    image: Vec<Lanes>,
    inner: Vec<Lanes>,
    size: usize,
}

impl PowerIteration {
    /// An eigenvalue of A Aᵀ, nearly always the largest, once its Rayleigh quotient and the square of its residual are
    /// judged: accepted, or given up.
    fn largest(
        &mut self,
        a: &LaneMatrix,
        mut judge: impl FnMut(f64, f64) -> Option<bool>,
    ) -> Option<f64> {
        let n = a.rows().len();
        if self.size != n {
            self.start(n);
        }
        for _ in 0..MOST_ITERATIONS.max(TIMES_OF_SIZE * n) {
            self.multiply(a);
            let value = dot_lanes(&self.vector, &self.image);
            let square = dot_lanes(&self.image, &self.image);
            if !(value > 0.0 && square.is_finite()) {
                self.size = 0;
                return None;
            }
            // By Pythagoras, rounding included.
            let residual = (square - value * value).abs() + 4.0 * f64::EPSILON * square;
            std::mem::swap(&mut self.vector, &mut self.image);
            scale_lanes(&mut self.vector, 1.0 / square.sqrt());
            if let Some(is_accepted) = judge(value, residual) {
                return is_accepted.then_some(value);
            }
        }
        None
    }

    /// Gives the vector a component in every direction, so that it cannot stay with an eigenvalue that is no longer the
    /// largest.
    fn mix(&mut self) {
        for (k, v) in self.vector.as_flattened_mut()[..self.size]
            .iter_mut()
            .enumerate()
        {
            // A pattern that no eigenvector has.
            *v += MIXED * spread_angle(k);
        }
        let length = dot_lanes(&self.vector, &self.vector).sqrt();
        if length > 0.0 {
            scale_lanes(&mut self.vector, 1.0 / length);
        }
    }

    /// A vector without a preferred direction.
    fn start(&mut self, n: usize) {
        self.size = n;
        super::lanes::pack_lanes(&mut self.vector, (0..n).map(spread_angle));
        let length = dot_lanes(&self.vector, &self.vector).sqrt();
        scale_lanes(&mut self.vector, 1.0 / length);
    }

    fn multiply(&mut self, a: &LaneMatrix) {
        self.image.clear();
        self.image.resize(lane_groups(self.size), [0.0; 4]);
        let vector = &self.vector.as_flattened()[..self.size];
        let image = self.image.as_flattened_mut();
        match a.stride() {
            1 => multiply_fixed::<1>(a.groups(), vector, image),
            2 => multiply_fixed::<2>(a.groups(), vector, image),
            3 => multiply_fixed::<3>(a.groups(), vector, image),
            4 => multiply_fixed::<4>(a.groups(), vector, image),
            stride => {
                self.inner.resize(stride, [0.0; 4]);
                combine_rows(&mut self.inner, vector, a.groups());
                for (row, y) in a.rows().zip(image) {
                    *y = dot_lanes(row, &self.inner);
                }
            }
        }
    }
}

/// `image = A Aᵀ vector` for rows of `G` groups, so that the sums stay in registers.
#[inline(always)]
fn multiply_fixed<const G: usize>(rows: &[Lanes], vector: &[f64], image: &mut [f64]) {
    let rows = rows.as_chunks::<G>().0;
    let mut inner = [f64x4::ZERO; G];
    for (row, factor) in rows.iter().zip(vector) {
        for g in 0..G {
            inner[g] += f64x4::new(row[g]) * all_lanes(*factor);
        }
    }
    for (row, y) in rows.iter().zip(image) {
        let mut sum = f64x4::ZERO;
        for g in 0..G {
            sum += f64x4::new(row[g]) * inner[g];
        }
        *y = lane_sum(sum.to_array());
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::pivoted_qr::PivotedQr;
    use crate::linalg::svd::jacobian_conditioning;

    /// A repeatable matrix with entries in -1..1; the last column leaves the span of the others by `gap`.
    fn matrix(rows: usize, columns: usize, seed: u64, gap: f64) -> Vec<f64> {
        let mut state = seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1;
        let mut random = move || {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
        };
        let mut a: Vec<f64> = (0..rows * columns).map(|_| random()).collect();
        if gap < 1.0 && columns > 1 {
            for i in 0..rows {
                let last = (columns - 1) * rows + i;
                a[last] = a[i] + gap * a[last];
            }
        }
        a
    }

    #[test]
    fn iterated_values_are_those_of_the_exact_decomposition() {
        let (mut decided, mut tried, mut worst) = (0, 0, 0.0_f64);
        let mut qr = PivotedQr::default();
        let (mut inverse, mut transposed) = (LaneMatrix::default(), LaneMatrix::default());
        for (rows, columns) in [(1, 1), (3, 3), (6, 6), (6, 4), (12, 12), (18, 18)] {
            for gap in [1.0, 1e-2, 1e-4, 1e-6] {
                let mut extremes = Extremes::default();
                for seed in 0..50 {
                    let a = matrix(rows, columns, seed, gap);
                    qr.factor(&a, rows, columns, 1e-12);
                    assert!(qr.invert(&mut inverse));
                    transposed.copy_rows(&a, columns, rows);
                    let exact = jacobian_conditioning(&a, rows, columns);
                    tried += 1;
                    let Some((small, large)) = extremes.of(&transposed, &inverse) else {
                        continue;
                    };
                    decided += 1;
                    let small = (small / exact.sigma_min - 1.0).abs();
                    let large = (large / exact.sigma_max - 1.0).abs();
                    // The inverse of a matrix with condition 1e8 has lost half of its digits.
                    assert!(
                        small <= SMALLEST_ERROR,
                        "{rows}x{columns} {gap} {seed}: {small:e}"
                    );
                    assert!(
                        large <= LARGEST_ERROR,
                        "{rows}x{columns} {gap} {seed}: {large:e}"
                    );
                    worst = worst.max(large);
                }
            }
        }
        assert!(worst > 0.0);
        assert!(10 * decided > 8 * tried, "{decided} of {tried}");
    }

    /// Two small singular values at any ratio, the others far away; also the same one twice.
    #[test]
    fn two_near_values_are_told_apart_from_the_others() {
        let mut qr = PivotedQr::default();
        let (mut inverse, mut transposed) = (LaneMatrix::default(), LaneMatrix::default());
        let mut decided = 0;
        for n in [3, 6, 12, 18] {
            let mut extremes = Extremes::default();
            for seed in 0..60 {
                let ratio = [0.0, 1e-9, 1e-5, 1e-3, 0.03][seed as usize % 5];
                // Of the diagonal matrix D, turned from both sides: Q D P.
                let turns = [2 * seed, 2 * seed + 1].map(|seed| {
                    let whole = nalgebra::DMatrix::from_vec(n, n, matrix(n, n, seed, 1.0));
                    whole.qr().q()
                });
                let values = (0..n).map(|k| match k {
                    0 => 1e-3,
                    1 => 1e-3 * (1.0 + ratio),
                    _ => 1.0 + k as f64,
                });
                let values = nalgebra::DVector::from_iterator(n, values);
                let a = &turns[0] * nalgebra::DMatrix::from_diagonal(&values) * &turns[1];
                qr.factor(a.as_slice(), n, n, 1e-12);
                assert!(qr.invert(&mut inverse));
                transposed.copy_rows(a.as_slice(), n, n);
                let Some((small, _)) = extremes.of(&transposed, &inverse) else {
                    continue;
                };
                decided += 1;
                assert!(
                    (small / 1e-3 - 1.0).abs() <= SMALLEST_ERROR,
                    "{n} {seed} {small}"
                );
            }
        }
        assert!(decided > 225, "{decided} of 240");
    }
}
