//! Damped least squares by their normal equations: cheap, and good enough where the damping is strong.

use nalgebra::{Cholesky, DMatrix, DVector};

/// Damping, as a share of the matrix's sum of squares, from which the normal equations serve: squaring costs the solution no
/// more than its seventh digit then.
const WELL_DAMPED: f64 = 1e-9;

/// Solves (AᵀA + `damping`) x = Aᵀ b for the matrix and right side with these entries; false where the damping is too weak.
pub fn damped_solution(
    [rows, columns]: [usize; 2],
    matrix: impl Fn(usize, usize) -> f64,
    right: impl Fn(usize) -> f64,
    damping: f64,
    solution: &mut Vec<f64>,
) -> bool {
    let matrix = DMatrix::from_fn(rows, columns, matrix);
    if damping.is_nan() || damping < WELL_DAMPED * matrix.norm_squared() {
        return false;
    }
    let mut normal = matrix.tr_mul(&matrix);
    (0..columns).for_each(|j| normal[(j, j)] += damping);
    let Some(factored) = Cholesky::new(normal) else {
        return false;
    };
    let right = DVector::from_fn(rows, |i, _| right(i));
    solution.clear();
    solution.extend_from_slice(factored.solve(&matrix.tr_mul(&right)).as_slice());
    solution.iter().all(|x| x.is_finite())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::linalg::pivoted_qr::PivotedQr;

    /// The same as by orthogonal transformations of the matrix with the root of the damping below it; weak damping is left
    /// to those.
    #[test]
    fn solutions_are_those_of_a_factorisation() {
        let entry = |i: usize, j: usize| (1.3 * i as f64 + 0.7 * (j * j) as f64).sin();
        let right = |i: usize| (0.4 * i as f64).cos();
        let [rows, columns] = [7, 5];
        for damping in [1e-9, 1e-5, 1e-3, 0.5] {
            let mut solution = Vec::new();
            let is_solved = damped_solution([rows, columns], entry, right, damping, &mut solution);
            assert_eq!(is_solved, damping > 1e-8, "{damping}");
            if !is_solved {
                continue;
            }
            let tall = rows + columns;
            let mut matrix = vec![0.0; tall * columns];
            for j in 0..columns {
                (0..rows).for_each(|i| matrix[j * tall + i] = entry(i, j));
                matrix[j * tall + rows + j] = damping.sqrt();
            }
            let mut side: Vec<f64> = (0..rows).map(right).collect();
            side.resize(tall, 0.0);
            let mut other = vec![0.0; columns];
            let mut qr = PivotedQr::default();
            qr.factor(&matrix, tall, columns, 0.0);
            qr.solve(&mut side, &mut other);
            for (a, b) in solution.iter().zip(&other) {
                assert!(
                    (a - b).abs() <= 1e-9 * b.abs().max(1.0),
                    "{damping}: {a} {b}"
                );
            }
        }
    }
}
