//! Damped least squares by their normal equations: cheap, and good enough where the damping is strong.

use super::lanes::{LaneMatrix, dot_lanes};
use nalgebra::{Cholesky, DMatrix, DVector};

/// Damping, as a share of the matrix's sum of squares, from which the normal equations serve: squaring costs the solution no
/// more than its seventh digit then.
const WELL_DAMPED: f64 = 1e-9;

/// Solves (AᵀA + `damping`) x = Aᵀ b, where the rows of `columns` are the columns of A; false where the damping is too weak.
pub fn damped_solution(
    columns: &LaneMatrix,
    right: &[f64],
    damping: f64,
    solution: &mut Vec<f64>,
) -> bool {
    let squares: f64 = columns.rows().map(|c| dot_lanes(c, c)).sum();
    if damping.is_nan() || damping < WELL_DAMPED * squares {
        return false;
    }
    let n = columns.rows().len();
    // Of a symmetric matrix the factorisation reads the lower half.
    let mut normal = DMatrix::zeros(n, n);
    for (j, column) in columns.rows().enumerate() {
        for (i, other) in columns.rows().enumerate().skip(j) {
            normal[(i, j)] = dot_lanes(column, other);
        }
        normal[(j, j)] += damping;
    }
    let Some(factored) = Cholesky::new(normal) else {
        return false;
    };
    let products = columns.rows().map(|column| {
        let pairs = column.as_flattened().iter().zip(right);
        pairs.map(|(a, b)| a * b).sum()
    });
    let mut image = DVector::from_iterator(n, products);
    factored.solve_mut(&mut image);
    solution.clear();
    solution.extend_from_slice(image.as_slice());
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
            let mut lanes = LaneMatrix::default();
            lanes.reset(columns, rows);
            for j in 0..columns {
                (0..rows).for_each(|i| *lanes.at_mut(j, i) = entry(i, j));
            }
            let side: Vec<f64> = (0..rows).map(right).collect();
            let is_solved = damped_solution(&lanes, &side, damping, &mut solution);
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
