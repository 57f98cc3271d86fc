//! On which side of its singular poses an assembly is: one determinant sign per block.
//!
//! Along a motion without singular poses no sign can change, so a change between two samples proves that a
//! singular pose or a jump lies between them. Equal signs alone do not prove the same branch.

use super::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::Conditioning;
use smallvec::SmallVec;

/// Keeps the row basis of over-determined blocks, so that signs at different poses can be compared.
#[derive(Clone, Debug, Default)]
pub struct BranchWatch {
    rows: Vec<Vec<usize>>,
    /// By block: converts signs of the present row basis into those of the first.
    turned: Vec<i8>,
    qr: PivotedQr,
    square: Vec<f64>,
}

/// Rows of an over-determined block are replaced when their smallest pivot falls below this share of the block's
/// smallest singular value; well-chosen rows have several times it.
const WORN: f64 = 0.1;

/// State of an assembly at a pose.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BranchState {
    /// Determinant sign of every block; 0 at a singular pose.
    pub signs: SmallVec<[i8; 16]>,
    /// Worst block.
    pub sigma_min: f64,
    /// Largest ratio of singular values.
    pub condition: f64,
    /// Total rank.
    pub rank: usize,
}

impl BranchState {
    /// `+-0`, one character a block.
    pub fn signature(&self) -> String {
        self.signs
            .iter()
            .map(|s| {
                if *s > 0 {
                    '+'
                } else if *s < 0 {
                    '-'
                } else {
                    '0'
                }
            })
            .collect()
    }
}

impl BranchWatch {
    /// Rows of every block that determine its sign; empty before the first observation.
    pub fn bases(&self) -> &[Vec<usize>] {
        &self.rows
    }

    /// Signs and singular values at a closed pose. The first call fixes the row basis.
    pub fn observe(
        &mut self,
        system: &System,
        corrector: &mut Corrector,
        coordinates: &[f64],
    ) -> BranchState {
        let mut state = BranchState::default();
        self.observe_into(system, corrector, coordinates, &mut state);
        state
    }

    /// The same into a state whose storage is reused.
    pub fn observe_into(
        &mut self,
        system: &System,
        corrector: &mut Corrector,
        coordinates: &[f64],
        state: &mut BranchState,
    ) {
        let structure = system.structure();
        state.signs.clear();
        state.sigma_min = f64::INFINITY;
        state.condition = 1.0;
        state.rank = 0;
        let (rows_of, qr, square) = (&mut self.rows, &mut self.qr, &mut self.square);
        let turned = &mut self.turned;
        corrector.conditions(
            system,
            coordinates,
            |index, jacobian, c: Conditioning, square_sign| {
                let (rows, columns) = (
                    structure.blocks[index].rows(),
                    structure.blocks[index].unknowns.len(),
                );
                // Rows that span the block at the first pose; the sign of their determinant tells branches apart.
                if rows_of.len() == index {
                    rows_of.push(row_basis(jacobian, rows, columns, qr));
                    // Which rows these are is no property of the assembly: it is `+` where the motion begins.
                    let first = match columns == 0 || rows == columns {
                        true => 1,
                        false => branch_sign(jacobian, rows, columns, &rows_of[index], square, qr),
                    };
                    turned.push(if first == 0 { 1 } else { first });
                }
                state.signs.push(if columns == 0 {
                    1
                } else if rows == columns {
                    square_sign
                } else {
                    turned[index]
                        * branch_sign(jacobian, rows, columns, &rows_of[index], square, qr)
                });
                state.sigma_min = state.sigma_min.min(c.sigma_min);
                state.condition = state.condition.max(if columns == 0 {
                    1.0
                } else {
                    c.sigma_max / c.sigma_min
                });
                state.rank += c.rank;
            },
        );
    }
}

impl BranchWatch {
    /// Chooses other rows for over-determined blocks whose present rows are nearly dependent though the block as a
    /// whole is regular. Signs stay comparable, so the pose must lie on the motion.
    pub fn renew_rows(&mut self, system: &System, corrector: &mut Corrector, coordinates: &[f64]) {
        let structure = system.structure();
        if structure
            .blocks
            .iter()
            .all(|b| b.rows() == b.unknowns.len())
        {
            return;
        }
        let (rows_of, turned) = (&mut self.rows, &mut self.turned);
        let (qr, square) = (&mut self.qr, &mut self.square);
        corrector.conditions(
            system,
            coordinates,
            |index, jacobian, c: Conditioning, _| {
                let block = &structure.blocks[index];
                let (rows, columns) = (block.rows(), block.unknowns.len());
                if rows == columns || columns == 0 || rows_of.len() <= index {
                    return;
                }
                let old = branch_sign(jacobian, rows, columns, &rows_of[index], square, qr);
                // Rows serve as long as their smallest pivot is a fair share of the block's smallest singular value.
                if old == 0 || qr.smallest_pivot() >= WORN * c.sigma_min {
                    return;
                }
                let basis = row_basis(jacobian, rows, columns, qr);
                let new = branch_sign(jacobian, rows, columns, &basis, square, qr);
                // The pose is on the motion, so both determinants belong to one assembly: their product relates the
                // signs.
                if new != 0 {
                    turned[index] *= old * new;
                    rows_of[index] = basis;
                }
            },
        );
    }
}

/// The rows of every block that are the most independent at a pose.
pub fn best_rows(
    system: &System,
    corrector: &mut Corrector,
    coordinates: &[f64],
) -> Vec<Vec<usize>> {
    let mut watch = BranchWatch::default();
    watch.observe(system, corrector, coordinates);
    watch.rows
}

/// Rows that are independent at this pose: pivots of the transposed matrix.
fn row_basis(jacobian: &[f64], rows: usize, columns: usize, qr: &mut PivotedQr) -> Vec<usize> {
    if rows == columns {
        return (0..rows).collect();
    }
    let mut transposed = vec![0.0; rows * columns];
    for j in 0..columns {
        for i in 0..rows {
            transposed[i * columns + j] = jacobian[j * rows + i];
        }
    }
    // Column pivoting of the transposed matrix puts the most independent rows first.
    qr.factor(&transposed, columns, rows, 0.0);
    let mut basis: Vec<usize> = qr.column_order()[..columns.min(rows)].to_vec();
    basis.sort_unstable();
    basis
}

/// Sign of the determinant of the rows `basis`.
fn branch_sign(
    jacobian: &[f64],
    rows: usize,
    columns: usize,
    basis: &[usize],
    square: &mut Vec<f64>,
    qr: &mut PivotedQr,
) -> i8 {
    square.clear();
    for j in 0..columns {
        square.extend(basis.iter().map(|i| jacobian[j * rows + i]));
    }
    // The sign of the determinant follows from the reflections and exchanges of the factorisation.
    qr.factor(
        square,
        basis.len(),
        columns,
        crate::linalg::svd::RANK_TOLERANCE,
    );
    qr.determinant_sign()
}
