//! Whether all matrices in an interval matrix are regular.

use super::system::IntervalSystem;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::LaneMatrix;
use crate::numbers::rounding::{GROW, OPERATION, largest_or_nan};

/// Steps of the iteration for the spectral radius.
const STEPS: usize = 200;

/// What is added to every component: all stay positive, and the bound is hardly any larger.
const POSITIVE: f64 = 1e-9;

/// A bound of the spectral radius of |mid A⁻¹| rad A: below one all matrices are regular. Infinite if the midpoint is
/// singular.
///
/// By Collatz and Wielandt the largest (M x)ᵢ / xᵢ is a bound for every positive x. The inverse is rounded; the
/// difference between R mid A and the identity is added to M.
pub fn spectral_bound(system: &IntervalSystem) -> f64 {
    let n = system.unknowns();
    if system.b.len() != n {
        return f64::INFINITY;
    }
    let (mut middle, mut inverse) = (LaneMatrix::default(), LaneMatrix::default());
    middle.reset(n, n);
    for (i, row) in system.a.iter().enumerate() {
        for (j, a) in row.iter().enumerate() {
            *middle.at_mut(i, j) = a.middle();
        }
    }
    if GaussJordan::default()
        .invert_matrix(&middle, &mut inverse)
        .is_none()
    {
        return f64::INFINITY;
    }
    let matrix: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            (0..n)
                .map(|j| {
                    let (mut off, mut size, mut wide) = (if i == j { -1.0 } else { 0.0 }, 0.0, 0.0);
                    for (l, row) in system.a.iter().enumerate() {
                        let (r, a) = (inverse.at(i, l), row[j]);
                        off += r * a.middle();
                        size += (r * a.middle()).abs();
                        wide += r.abs() * (a.radius() + OPERATION * a.magnitude());
                    }
                    let rounding = (n as f64 + 4.0) * OPERATION * (size + 1.0);
                    (wide + off.abs() + rounding) * GROW
                })
                .collect()
        })
        .collect();
    let (mut x, mut least) = (vec![1.0; n], f64::INFINITY);
    for _ in 0..STEPS {
        let y: Vec<f64> = matrix
            .iter()
            .map(|row| row.iter().zip(&x).map(|(m, x)| m * x).sum::<f64>() * GROW)
            .collect();
        // An overflow says nothing.
        let bound = largest_or_nan(y.iter().zip(&x).map(|(y, x)| y / x)) * GROW;
        least = least.min(bound);
        let size = y.iter().fold(f64::MIN_POSITIVE, |s, v| s.max(*v));
        // A positive part of all components keeps every quotient defined.
        x = y.iter().map(|v| v / size + POSITIVE).collect();
    }
    least
}

/// The share of random matrices whose determinant is positive, of `count`; `random` gives numbers from 0 to 1.
pub fn positive_share(
    system: &IntervalSystem,
    count: usize,
    mut random: impl FnMut() -> f64,
) -> f64 {
    let mut positive = 0_usize;
    for _ in 0..count {
        let matrix: Vec<Vec<f64>> = system
            .a
            .iter()
            .map(|row| {
                row.iter()
                    .map(|a| a.lo + (a.hi - a.lo) * random())
                    .collect()
            })
            .collect();
        positive += usize::from(determinant(&matrix) > 0.0);
    }
    positive as f64 / count.max(1) as f64
}

/// A determinant, by elimination.
pub fn determinant(matrix: &[Vec<f64>]) -> f64 {
    let mut matrix = matrix.to_vec();
    let (n, mut product) = (matrix.len(), 1.0);
    // Gaussian elimination with partial pivoting; an exchange of rows changes the sign.
    for k in 0..n {
        let place = (k..n).max_by(|i, j| matrix[*i][k].abs().total_cmp(&matrix[*j][k].abs()));
        let place = place.unwrap_or(k);
        if place != k {
            matrix.swap(place, k);
            product = -product;
        }
        let pivot = matrix[k][k];
        product *= pivot;
        if pivot == 0.0 {
            return 0.0;
        }
        // The pivot's row is subtracted from those below.
        let row = matrix[k].clone();
        for below in &mut matrix[k + 1..] {
            let factor = below[k] / pivot;
            below
                .iter_mut()
                .zip(&row)
                .skip(k)
                .for_each(|(b, r)| *b -= factor * r);
        }
    }
    product
}
