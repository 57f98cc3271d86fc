//! Singular values: how far a pose is from a singular one, and which coordinates are free.

use crate::sorting::sort_by;
use nalgebra::{DMatrix, SVD};

/// Below this ratio to the largest singular value a direction counts as lost. The pose then has lost about ten
/// of its sixteen digits, and the next Newton step along that direction is noise.
pub const RANK_TOLERANCE: f64 = 1e-10;

/// Off-diagonal entries below this share of their neighbours end the decomposition.
const SVD_CONVERGENCE: f64 = f64::EPSILON;

/// Bound on the sweeps of the decomposition: a hundred times what matrices of our sizes need. Entries near the
/// limits of f64 can keep it from converging at all.
const SVD_SWEEPS: usize = 10_000;

/// Singular values of a block's Jacobian.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Conditioning {
    /// Smallest singular value: zero at a singular pose.
    pub sigma_min: f64,
    /// Largest singular value.
    pub sigma_max: f64,
    /// Number of singular values above the tolerance.
    pub rank: usize,
}

/// Singular values of the column-major `rows` × `columns` matrix; `columns` zero gives the neutral value.
pub fn jacobian_conditioning(jacobian: &[f64], rows: usize, columns: usize) -> Conditioning {
    if columns == 0 {
        return Conditioning {
            sigma_min: f64::INFINITY,
            sigma_max: 0.0,
            rank: 0,
        };
    }
    let matrix = DMatrix::from_column_slice(rows, columns, &jacobian[..rows * columns]);
    if !matrix.iter().all(|v| v.is_finite()) {
        return Conditioning {
            sigma_min: 0.0,
            sigma_max: f64::INFINITY,
            rank: 0,
        };
    }
    let scale = matrix.amax();
    let scale = if scale > 0.0 { scale } else { 1.0 };
    if let ([rows, columns], [a, b, c, d]) = ([rows, columns], matrix.as_slice())
        && rows == columns
    {
        return conditioning_of_two([a, b, c, d].map(|v| v / scale), scale);
    }
    let Some(values) = SVD::try_new(matrix / scale, false, false, SVD_CONVERGENCE, SVD_SWEEPS)
        .map(|svd| svd.singular_values * scale)
    else {
        return Conditioning {
            sigma_min: 0.0,
            sigma_max: f64::INFINITY,
            rank: 0,
        };
    };
    let sigma_max = values.max();
    let rank = values
        .iter()
        .filter(|s| **s > RANK_TOLERANCE * sigma_max && **s > 0.0)
        .count();
    // With fewer rows than columns the missing singular values are zero.
    let sigma_min = if rows < columns { 0.0 } else { values.min() };
    Conditioning {
        sigma_min,
        sigma_max,
        rank,
    }
}

/// Singular values of `scale` times the matrix with columns (a, b) and (c, d), whose entries are at most one: half the sum of two
/// lengths, and the determinant over that. A point that two bars hold needs no more.
fn conditioning_of_two([a, b, c, d]: [f64; 4], scale: f64) -> Conditioning {
    let length = |x: f64, y: f64| (x * x + y * y).sqrt();
    let largest = 0.5 * (length(a + d, b - c) + length(a - d, b + c));
    let determinant = (a * d - b * c).abs();
    let least = if largest > 0.0 {
        determinant / largest
    } else {
        0.0
    };
    let regular = [largest, least];
    let regular = regular
        .iter()
        .filter(|s| **s > RANK_TOLERANCE * largest && **s > 0.0);
    Conditioning {
        sigma_min: least * scale,
        sigma_max: largest * scale,
        rank: regular.count(),
    }
}

/// Orthonormal basis of the null space of a matrix of the given rank.
pub fn null_space(jacobian: &[f64], rows: usize, columns: usize, rank: usize) -> Vec<Vec<f64>> {
    // Rows of zeros make the decomposition return all right singular vectors.
    let tall = rows.max(columns);
    let mut matrix = DMatrix::zeros(tall, columns);
    for j in 0..columns {
        for i in 0..rows {
            matrix[(i, j)] = jacobian[j * rows + i];
        }
    }
    let all = || vec![vec![1.0; columns]; columns - rank.min(columns)];
    // The decomposition must see neither a NaN nor squares that overflow.
    let largest = matrix.amax();
    if !matrix.iter().all(|v| v.is_finite()) {
        return all();
    }
    if largest > 0.0 {
        matrix /= largest;
    }
    let Some(svd) = SVD::try_new(matrix, false, true, SVD_CONVERGENCE, SVD_SWEEPS) else {
        return all();
    };
    let Some(v_t) = svd.v_t else {
        return all();
    };
    let mut by_size: Vec<usize> = (0..columns).collect();
    sort_by(&mut by_size, |a, b| {
        svd.singular_values[*b].total_cmp(&svd.singular_values[*a])
    });
    let vector = |k: &usize| v_t.row(*k).iter().copied().collect();
    by_size[rank.min(columns)..].iter().map(vector).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn diagonal_matrices_show_their_entries() {
        let c = jacobian_conditioning(&[3.0, 0.0, 0.0, 0.5], 2, 2);
        assert_eq!((c.sigma_max, c.sigma_min, c.rank), (3.0, 0.5, 2));
        assert_eq!(jacobian_conditioning(&[1.0, 0.0, 0.0, 0.0], 2, 2).rank, 1);
    }

    #[test]
    fn two_by_two_is_decomposed_as_a_part_of_three_by_three() {
        for k in 0..200 {
            let [b, c] = [0.7, 2.1].map(|f| (f * f64::from(k)).sin());
            // Nearly singular ones, too, of all sizes.
            let gap = 10.0_f64.powi(-(k % 9));
            let size = 10.0_f64.powi(k % 13 - 6);
            let two = [1.0, b, c, b * c + gap].map(|v| v * size);
            let found = jacobian_conditioning(&two, 2, 2);
            let middle = (found.sigma_min * found.sigma_max).sqrt();
            let [a, b, c, d] = two;
            let three = [a, b, 0.0, c, d, 0.0, 0.0, 0.0, middle];
            let wanted = jacobian_conditioning(&three, 3, 3);
            let rounding = 1e-14 * wanted.sigma_max;
            assert!(
                (found.sigma_max - wanted.sigma_max).abs() <= rounding,
                "{k}"
            );
            assert!(
                (found.sigma_min - wanted.sigma_min).abs() <= rounding,
                "{k}"
            );
            assert_eq!((found.rank, wanted.rank), (2, 3), "{k}");
        }
    }

    #[test]
    fn values_that_are_none_or_overflow_make_no_decomposition_fail() {
        for bad in [f64::NAN, f64::INFINITY, 1e200, 1e308, 1e-320] {
            let c = jacobian_conditioning(&[1.0, bad, 0.0, 0.5], 2, 2);
            assert!(c.rank <= 2 && !c.sigma_min.is_nan());
            assert_eq!(null_space(&[1.0, bad, 0.0, 0.5], 2, 2, 1).len(), 1);
        }
    }
}
