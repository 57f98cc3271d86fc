//! Newton's method block by block, with the tangent of the motion from the same factorisation.
//!
//! A correction ends with an evaluation of the pose that it returns. That linearisation is kept, with its factors and
//! its inverse once they are needed, so that tangent, prediction, rank and branch sign of the pose share it.

use super::closure::{hold_beside_terms, is_closed, is_rounding};
use super::linearisation::{Linearisation, REFINEMENTS};
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::LaneMatrix;
use crate::linalg::svd::Conditioning;

/// Most iterations of one correction. From a predicted pose three suffice; a slow one shows a bad prediction.
const MAX_ITERATIONS: u32 = 12;

/// A correction that decreases by less than this factor per iteration does not converge quadratically.
pub const CONTRACTION: f64 = 0.5;

/// Most iterations of a patient correction: close to a singular pose every step only halves the error.
const PATIENT_ITERATIONS: u32 = 80;

/// Slowest decrease of a patient correction.
const PATIENT_CONTRACTION: f64 = 0.9;

/// The permitted speed of convergence.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Pace {
    /// Quadratic convergence only: for a good prediction.
    Brisk,
    /// Linear convergence is accepted: singular poses are not reached faster.
    Patient,
}

/// A last step that is longer than this, in scaled unknowns, although the residual is rounding: the terms of an equation vanish
/// there, as those of exp(x) do far from any root. A root of order four is known to a tenth of it.
const LONG_STEP: f64 = 1e-3;

/// Residuals are sums of a few dozen products of order one, so they cannot be made smaller than about this.
pub const ROUNDING_FLOOR: f64 = 4e-15;

/// Buffers and factorisations, one per block. All iterations reuse them.
#[derive(Clone, Debug)]
pub struct Corrector {
    pub(crate) blocks: Vec<Linearisation>,
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
    /// Buffers for the blocks of `system`.
    pub fn new(system: &System) -> Self {
        Self {
            blocks: vec![Linearisation::default(); system.blocks().len()],
        }
    }

    /// Corrects the unknowns in `coordinates` until all loops close; the inputs stay.
    ///
    /// Stops at the first block that does not converge; `coordinates` are then of no use.
    pub fn correct(&mut self, system: &System, coordinates: &mut [f64], pace: Pace) -> Correction {
        let mut total = Correction {
            converged: true,
            iterations: 0,
            first_step: 0.0,
            residual: 0.0,
        };
        // Block by block: a block's unknowns are inputs of the later ones.
        for index in 0..system.blocks().len() {
            let part = self.correct_block(system, index, coordinates, pace);
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
        system: &System,
        index: usize,
        coordinates: &mut [f64],
        pace: Pace,
    ) -> Correction {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let block = &structure.blocks[index];
        let buffers = &mut self.blocks[index];
        let (most, contraction) = match pace {
            Pace::Brisk => (MAX_ITERATIONS, CONTRACTION),
            Pace::Patient => (PATIENT_ITERATIONS, PATIENT_CONTRACTION),
        };
        let mut first_step = 0.0;
        let mut last_step = f64::INFINITY;
        let mut done = block.unknowns.is_empty();
        let mut iterations = 0;
        let mut last_residual = f64::INFINITY;
        loop {
            buffers.evaluate(mechanism, block, coordinates);
            let left = buffers.workspace.residual_norm();
            let at_floor = left <= ROUNDING_FLOOR;
            // Where two poses almost meet, an error of the residual means an error of its square root: a patient
            // correction continues as long as the residual decreases.
            let falls = pace == Pace::Patient && left <= 0.5 * last_residual;
            // The residual at rounding level is noise, and would influence the count of iterations: a brisk correction
            // ends by its last step alone.
            let rests = pace == Pace::Patient && at_floor && !falls && iterations > 0;
            if done || rests {
                break;
            }
            last_residual = left;
            if iterations == most && pace == Pace::Patient && at_floor {
                // Closed to rounding, though the unknowns still move slowly: towards a zero of higher order.
                break;
            }
            if iterations == most {
                // Far from the origin rounding leaves more.
                if is_rounding(mechanism, block, coordinates, &buffers.workspace.residual) {
                    break;
                }
                return Correction::failed(iterations, first_step);
            }
            iterations += 1;
            let (size, pivot) = buffers.newton_step(block);
            if iterations == 1 {
                first_step = size;
            }
            let shrinking = size <= contraction * last_step || at_floor;
            if !size.is_finite() || !shrinking {
                // A pose that rounding does not let come nearer stays as it is.
                let residual = &buffers.workspace.residual;
                if size.is_finite() && is_rounding(mechanism, block, coordinates, residual) {
                    break;
                }
                return Correction::failed(iterations, first_step);
            }
            buffers.take_step(block, coordinates);
            // Quadratic convergence: the error after this step is about step²/σ.
            done = (at_floor && !falls) || size * size <= ROUNDING_FLOOR * pivot;
            last_step = size;
        }
        let residual = buffers.workspace.residual_norm();
        let is_root = !(last_step.is_finite() && last_step > LONG_STEP)
            || hold_beside_terms(mechanism, block, coordinates);
        Correction {
            converged: is_root && is_closed(mechanism, block, coordinates, &buffers.workspace),
            iterations,
            first_step,
            residual,
        }
    }

    /// Rates of all coordinates for the given rates of the inputs, at a closed pose.
    ///
    /// `rates` holds the inputs' rates in its tail; the head is filled block by block from J q' = -∂r/∂u u'.
    pub fn tangent(&mut self, system: &System, coordinates: &[f64], rates: &mut [f64]) {
        self.tangent_before(system, self.blocks.len(), coordinates, rates);
    }

    /// The same for the first `count` blocks.
    pub(super) fn tangent_before(
        &mut self,
        system: &System,
        count: usize,
        coordinates: &[f64],
        rates: &mut [f64],
    ) {
        let mechanism = system.mechanism();
        let blocks = &system.structure().blocks;
        for (block, buffers) in blocks.iter().zip(&mut self.blocks).take(count) {
            buffers.linearise(mechanism, block, coordinates);
            // Right-hand side: the effect of the inputs and earlier blocks on this block's equations.
            buffers.workspace.drift_along(&block.plan, rates);
            buffers.solve_drift();
            buffers.refine(REFINEMENTS);
            for (unknown, change) in buffers.changes(block) {
                rates[unknown] = change;
            }
        }
    }

    /// Linearises every block at `coordinates`, unless that is done; users of the linearisation rely on it.
    pub fn prepare(&mut self, system: &System, coordinates: &[f64]) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        for (block, buffers) in structure.blocks.iter().zip(&mut self.blocks) {
            buffers.linearise(mechanism, block, coordinates);
        }
    }

    /// The inverse of a block's Jacobian at the last linearisation, or at a neighbouring pose, if it has one; one row
    /// per equation.
    pub fn inverse(&self, block: usize) -> Option<&LaneMatrix> {
        self.blocks.get(block)?.inverse()
    }

    /// Jacobian (column-major), singular values and sign of the determinant (zero unless square) of every block at a
    /// closed pose.
    pub fn conditions(
        &mut self,
        system: &System,
        coordinates: &[f64],
        mut each: impl FnMut(usize, &[f64], Conditioning, i8),
    ) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        for (index, (block, buffers)) in structure.blocks.iter().zip(&mut self.blocks).enumerate() {
            buffers.linearise(mechanism, block, coordinates);
            let values = buffers.singular_values(block);
            each(index, &buffers.workspace.jacobian, values, buffers.sign());
        }
    }
}

impl Correction {
    fn failed(iterations: u32, first_step: f64) -> Self {
        Self {
            converged: false,
            iterations,
            first_step,
            residual: f64::INFINITY,
        }
    }
}
