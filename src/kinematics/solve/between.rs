//! Tests whether the Jacobian stays regular from one closed pose to the next. Determinants of equal sign do not show
//! this: a drive may take two singular values through zero at once, and the branch is then another one afterwards.
//!
//! On the straight line from one Jacobian A to the other, B, no matrix is singular if ‖B − A‖ is less than the sum of
//! their smallest singular values (Weyl), or if the eigenvalues of E = 1 − B⁻¹A are small. Steps that pass neither test
//! are halved; the Jacobians between two poses then lie near that line. This is a check, not a proof; proofs use tubes.

use super::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::{
    LaneMatrix, Lanes, combine_rows, dot_lanes, lane_groups, square_of_difference,
};

/// Largest change of a Jacobian, as a fraction of the sum of the smallest singular values: the rest allows for the
/// distance of the Jacobians between two poses from the line.
const SHARE_OF_SIGMAS: f64 = 0.5;

/// Largest eigenvalue of E, with the same margin.
pub const MOST_CHANGE: f64 = 0.8;

/// Number of times that E is squared: the norm of a power bounds the eigenvalues better than that of E.
const SQUARINGS: i32 = 3;

/// Number of unknowns from which on a product of matrices costs more than the pose, and the largest eigenvalue is
/// iterated instead.
const LARGE: usize = 48;

/// Iterations of the largest eigenvalue.
const ITERATIONS: usize = 8;

/// The Jacobians of the last pose on a path, for comparison with those of the next one.
#[derive(Clone, Debug, Default)]
pub struct KeptJacobians {
    at: Vec<f64>,
    blocks: Vec<Vec<f64>>,
    change: Vec<Lanes>,
    square: Vec<Lanes>,
}

impl KeptJacobians {
    /// Keeps those at `coordinates`.
    pub fn keep(&mut self, system: &System, corrector: &mut Corrector, coordinates: &[f64]) {
        self.at.clear();
        self.at.extend_from_slice(coordinates);
        self.blocks.resize_with(system.blocks().len(), Vec::new);
        let blocks = &mut self.blocks;
        corrector.block_jacobians(system, coordinates, |index, jacobian| {
            blocks[index].clear();
            blocks[index].extend_from_slice(jacobian);
        });
    }

    /// Whether no block becomes singular between two regular poses, whose smallest singular values have this sum.
    pub fn stay_regular(
        &mut self,
        system: &System,
        corrector: &mut Corrector,
        [from, to]: [&[f64]; 2],
        sigmas: f64,
    ) -> bool {
        if self.at != from {
            self.keep(system, corrector, from);
        }
        corrector.prepare(system, to);
        // Weyl: singular values change by no more than the norm of the Jacobian's change.
        let most = SHARE_OF_SIGMAS * sigmas;
        (0..self.blocks.len()).all(|index| {
            let change = square_of_difference(corrector.jacobian(index), &self.blocks[index]);
            change <= most * most || self.changes_little(index, corrector)
        })
    }

    /// The second test. A pose without an inverse is known to be singular, and no step is judged by it.
    fn changes_little(&mut self, index: usize, corrector: &Corrector) -> bool {
        let Some(inverse) = corrector.inverse(index) else {
            return true;
        };
        let before = &self.blocks[index];
        let rows = inverse.rows().len();
        let columns = before.len() / rows.max(1);
        if columns >= LARGE {
            return power_iteration(inverse, before, rows, columns) <= MOST_CHANGE;
        }
        let stride = lane_groups(columns);
        // The change I - A J is squared until its norm tells the spectral radius.
        change_into(&mut self.change, inverse, before, rows);
        for power in 0..=SQUARINGS {
            let size = dot_lanes(&self.change, &self.change).sqrt();
            if size <= MOST_CHANGE.powi(1 << power) {
                return true;
            }
            self.square.resize(self.change.len(), [0.0; 4]);
            let targets = self.square.chunks_exact_mut(stride.max(1));
            for (target, column) in targets.zip(self.change.chunks_exact(stride.max(1))) {
                combine_rows(target, &column.as_flattened()[..columns], &self.change);
            }
            std::mem::swap(&mut self.square, &mut self.change);
        }
        false
    }
}

impl Corrector {
    /// The Jacobian of every block (column-major) at `coordinates`.
    fn block_jacobians(
        &mut self,
        system: &System,
        coordinates: &[f64],
        mut each: impl FnMut(usize, &[f64]),
    ) {
        let mechanism = system.mechanism();
        let blocks = system.blocks().iter().zip(&mut self.blocks);
        for (index, (block, buffers)) in blocks.enumerate() {
            buffers.evaluate(mechanism, block, coordinates);
            each(index, &buffers.workspace.jacobian);
        }
    }

    /// The Jacobian of a block at the last evaluation, column-major.
    fn jacobian(&self, block: usize) -> &[f64] {
        self.blocks
            .get(block)
            .map_or(&[], |buffers| &buffers.workspace.jacobian)
    }
}

/// E, column by column.
fn change_into(change: &mut Vec<Lanes>, inverse: &LaneMatrix, before: &[f64], rows: usize) {
    let stride = inverse.stride();
    let columns = before.chunks_exact(rows.max(1));
    change.clear();
    change.resize(columns.len() * stride, [0.0; 4]);
    let targets = change.chunks_exact_mut(stride.max(1));
    for (index, (target, column)) in targets.zip(columns).enumerate() {
        combine_rows(target, column, inverse.groups());
        subtract_from_unit(target, index);
    }
}

fn subtract_from_unit(column: &mut [Lanes], index: usize) {
    for (k, value) in column.as_flattened_mut().iter_mut().enumerate() {
        *value = f64::from(k == index) - *value;
    }
}

/// Largest eigenvalue of E, from the effect of its powers on a pseudo-random vector.
fn power_iteration(inverse: &LaneMatrix, before: &[f64], rows: usize, columns: usize) -> f64 {
    // Power iteration on I - A J, from a vector without symmetry.
    let mut vector: Vec<f64> = (1..=columns).map(|k| libm::sin(k as f64 * 2.4)).collect();
    let mut image = vec![[0.0; 4]; inverse.stride()];
    let mut grown = 0.0;
    for _ in 0..ITERATIONS {
        let mut product = vec![0.0; rows];
        for (column, factor) in before.chunks_exact(rows).zip(&vector) {
            for (sum, entry) in product.iter_mut().zip(column) {
                *sum += factor * entry;
            }
        }
        // v - A (J v), and how much longer it got.
        combine_rows(&mut image, &product, inverse.groups());
        let size = |v: &[f64]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let next: Vec<f64> = vector
            .iter()
            .zip(image.as_flattened())
            .map(|(v, i)| v - i)
            .collect();
        grown = size(&next) / size(&vector);
        if grown == 0.0 || !grown.is_finite() {
            break;
        }
        vector = next;
        let scale = 1.0 / size(&vector);
        vector.iter_mut().for_each(|v| *v *= scale);
    }
    grown
}
