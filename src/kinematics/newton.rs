//! Newton's method block by block, with the tangent of the motion from the same factorisation.

use super::closure::{BlockWorkspace, Want};
use super::qr::PivotedQr;
use super::rank::{Conditioning, RANK_TOLERANCE, conditioning};
use super::structure::Structure;
use crate::model::mechanism::Mechanism;

/// Most iterations of one correction. From a predicted pose three suffice; a slow one means a bad prediction.
const MAX_ITERATIONS: u32 = 12;

/// A correction that shrinks less than this from one iteration to the next is not converging quadratically.
const CONTRACTION: f64 = 0.5;

/// Most iterations of a patient correction: next to a singular pose every step only halves the error.
const PATIENT_ITERATIONS: u32 = 80;

/// Slowest shrinking of a patient correction.
const PATIENT_CONTRACTION: f64 = 0.9;

/// How long a correction may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Quadratic convergence or nothing: what a good prediction deserves.
    Brisk,
    /// Linear convergence is accepted: singular poses are reached no faster.
    Patient,
}

/// Residuals are sums of a few dozen products of order one, so they cannot be made smaller than about this.
const ROUNDING_FLOOR: f64 = 4e-15;

/// Largest residual of a returned pose, relative to the mechanism's size. Rounding leaves about 1e-15; what is
/// above this has not converged.
pub const CLOSURE_TOLERANCE: f64 = 1e-11;

/// Buffers and factorisations, one per block. All iterations reuse them.
#[derive(Clone, Debug)]
pub struct Corrector {
    blocks: Vec<BlockBuffers>,
}

#[derive(Clone, Debug, Default)]
struct BlockBuffers {
    workspace: BlockWorkspace,
    qr: PivotedQr,
    right_side: Vec<f64>,
    step: Vec<f64>,
}

/// What a correction did.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Correction {
    /// All blocks converged and close.
    pub converged: bool,
    /// Newton iterations, summed over the blocks.
    pub iterations: u32,
    /// Largest first step of a block in scaled unknowns: the error of the prediction.
    pub first_step: f64,
    /// Largest entry of the final residual.
    pub residual: f64,
}

impl Corrector {
    /// Buffers for `structure`.
    pub fn new(structure: &Structure) -> Self {
        Self {
            blocks: vec![BlockBuffers::default(); structure.blocks.len()],
        }
    }

    /// Corrects the unknowns in `coordinates` until all loops close; the inputs stay.
    ///
    /// Stops at the first block that does not converge; `coordinates` are then of no use.
    pub fn correct(
        &mut self,
        mechanism: &Mechanism,
        structure: &Structure,
        coordinates: &mut [f64],
        pace: Pace,
    ) -> Correction {
        let mut total = Correction {
            converged: true,
            iterations: 0,
            first_step: 0.0,
            residual: 0.0,
        };
        for index in 0..structure.blocks.len() {
            let part = self.correct_block(mechanism, structure, index, coordinates, pace);
            total.iterations += part.iterations;
            total.first_step = total.first_step.max(part.first_step);
            total.residual = total.residual.max(part.residual);
            if !part.converged {
                return Correction {
                    converged: false,
                    ..total
                };
            }
        }
        total
    }

    /// Newton's method on one block.
    pub fn correct_block(
        &mut self,
        mechanism: &Mechanism,
        structure: &Structure,
        index: usize,
        coordinates: &mut [f64],
        pace: Pace,
    ) -> Correction {
        let block = &structure.blocks[index];
        let buffers = &mut self.blocks[index];
        let (most, contraction) = match pace {
            Pace::Brisk => (MAX_ITERATIONS, CONTRACTION),
            Pace::Patient => (PATIENT_ITERATIONS, PATIENT_CONTRACTION),
        };
        let mut first_step = 0.0;
        let mut last_step = f64::INFINITY;
        let mut done = false;
        let mut iterations = 0;
        while !done && iterations < most && !block.unknowns.is_empty() {
            iterations += 1;
            buffers
                .workspace
                .evaluate(mechanism, block, coordinates, Want::Jacobian);
            let at_floor = buffers.workspace.residual_norm() <= ROUNDING_FLOOR;
            let size = buffers.newton_step(block.rows(), block.unknowns.len());
            if iterations == 1 {
                first_step = size;
            }
            let shrinking = size <= contraction * last_step || at_floor;
            if !size.is_finite() || !shrinking {
                return Correction {
                    converged: false,
                    iterations,
                    first_step,
                    residual: f64::INFINITY,
                };
            }
            for (column, unknown) in block.unknowns.iter().enumerate() {
                coordinates[*unknown] += mechanism.scale_of(*unknown) * buffers.step[column];
            }
            // Quadratic convergence: what is left after this step is about step²/σ.
            done = at_floor || size * size <= ROUNDING_FLOOR * buffers.qr.smallest_pivot();
            last_step = size;
        }
        buffers
            .workspace
            .evaluate(mechanism, block, coordinates, Want::Residual);
        let residual = buffers.workspace.residual_norm();
        let converged = (done || block.unknowns.is_empty()) && residual <= CLOSURE_TOLERANCE;
        Correction {
            converged,
            iterations,
            first_step,
            residual,
        }
    }

    /// Rates of all coordinates for the given rates of the inputs, at a closed pose.
    ///
    /// `rates` holds the inputs' rates in its tail; the head is filled block by block from J q' = -∂r/∂u u'.
    pub fn tangent(
        &mut self,
        mechanism: &Mechanism,
        structure: &Structure,
        coordinates: &[f64],
        rates: &mut [f64],
    ) {
        for (block, buffers) in structure.blocks.iter().zip(&mut self.blocks) {
            buffers
                .workspace
                .evaluate(mechanism, block, coordinates, Want::Drift(rates));
            let (rows, columns) = (block.rows(), block.unknowns.len());
            buffers
                .qr
                .factor(&buffers.workspace.jacobian, rows, columns, RANK_TOLERANCE);
            buffers.right_side.clear();
            buffers
                .right_side
                .extend(buffers.workspace.drift.iter().map(|d| -d));
            buffers.step.resize(columns, 0.0);
            buffers.qr.solve(&mut buffers.right_side, &mut buffers.step);
            for (column, unknown) in block.unknowns.iter().enumerate() {
                rates[*unknown] = mechanism.scale_of(*unknown) * buffers.step[column];
            }
        }
    }

    /// Singular values of every block at a closed pose, and the sign of its determinant on `basis` rows.
    pub fn conditions(
        &mut self,
        mechanism: &Mechanism,
        structure: &Structure,
        coordinates: &[f64],
        mut each: impl FnMut(usize, &[f64], Conditioning),
    ) {
        for (index, (block, buffers)) in structure.blocks.iter().zip(&mut self.blocks).enumerate() {
            buffers
                .workspace
                .evaluate(mechanism, block, coordinates, Want::Jacobian);
            let jacobian = &buffers.workspace.jacobian;
            each(
                index,
                jacobian,
                conditioning(jacobian, block.rows(), block.unknowns.len()),
            );
        }
    }
}

impl BlockBuffers {
    /// Solves for the step that cancels the residual; returns its largest entry in scaled unknowns.
    fn newton_step(&mut self, rows: usize, columns: usize) -> f64 {
        self.qr
            .factor(&self.workspace.jacobian, rows, columns, RANK_TOLERANCE);
        self.right_side.clear();
        self.right_side
            .extend(self.workspace.residual.iter().map(|r| -r));
        self.step.resize(columns, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.step);
        self.step.iter().fold(0.0, |m: f64, s| {
            if s.is_nan() {
                f64::INFINITY
            } else {
                m.max(s.abs())
            }
        })
    }
}
