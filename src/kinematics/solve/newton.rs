//! Newton's method block by block, with the tangent of the motion from the same factorisation.
//!
//! A correction ends with an evaluation of the pose that it returns. That linearisation is kept, with its factors and
//! its inverse once somebody asks for them, so that tangent, prediction, rank and branch sign of the pose share it.

use super::closure::is_closed;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::gauss_jordan::{Elimination, Pivots};
use crate::linalg::lanes::{
    LaneMatrix, Lanes, add_scaled, combine_rows, dot_lanes, lane_groups, square_of_difference,
};
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::singular_values::Extremes;
use crate::linalg::sparse_lu::SparseLu;
use crate::linalg::svd::{Conditioning, RANK_TOLERANCE, jacobian_conditioning};
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

/// Least ratio of singular values that are iterated from an inverse: half of its digits are then right, enough for
/// the accuracy promised. Below it, and wherever a rank may be lost, the Jacobian is decomposed.
const ITERATED_RATIO: f64 = 1e-7;

/// An inverse serves a pose beside its own while the change of the Jacobian times the inverse, both in the Frobenius norm,
/// is at most this: singular values then differ by no more than this part of themselves, and no determinant changes its sign.
const SAME_INVERSE: f64 = 5e-7;

/// Refinements after which a solution by such an inverse is right to rounding.
pub(crate) const REFINEMENTS: usize = 2;

/// Buffers and factorisations, one per block. All iterations reuse them.
#[derive(Clone, Debug)]
pub struct Corrector {
    pub(crate) blocks: Vec<BlockBuffers>,
}

/// How far the linearisation of a block has come.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum NewtonStage {
    /// Nothing, or at another pose.
    #[default]
    Stale,
    /// Residual and Jacobian stand in the workspace.
    Evaluated,
    /// The Jacobian, or one beside it, is factored, and inverted where it can be.
    Factored,
}

/// Buffers of one block.
#[derive(Clone, Debug, Default)]
pub(crate) struct BlockBuffers {
    pub(crate) workspace: BlockWorkspace,
    qr: PivotedQr,
    elimination: Elimination,
    sparse: SparseLu,
    stage: NewtonStage,
    /// Values of the block's unknowns, then of the coordinates from outside, at the linearisation.
    at: Vec<f64>,
    /// Inverse (of a tall matrix the pseudo-inverse) with one row an equation, so that a solution is a sum of rows.
    inverse: LaneMatrix,
    has_inverse: bool,
    /// The factorisation belongs to a neighbouring pose and is reused.
    beside: bool,
    /// The inverse comes from an elimination.
    eliminated: bool,
    /// The Jacobian that was factored.
    factored: Vec<f64>,
    /// Smallest pivot.
    pivot: f64,
    /// Sign of the determinant, zero unless square and regular.
    sign: i8,
    transposed: LaneMatrix,
    extremes: Extremes,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    /// Step of the block's unknowns, in whole groups.
    step: Vec<Lanes>,
    rough: Vec<Lanes>,
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
            blocks: vec![BlockBuffers::default(); system.blocks().len()],
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
            // Where two poses almost meet, what the floor hides is worth its square root: a patient correction goes on
            // as long as the residual falls.
            let falls = pace == Pace::Patient && left <= 0.5 * last_residual;
            // The floor itself is noise, and would let the count of iterations depend on it: a brisk correction ends by its
            // last step alone.
            let rests = pace == Pace::Patient && at_floor && !falls && iterations > 0;
            if done || rests {
                break;
            }
            last_residual = left;
            if iterations == most && pace == Pace::Patient && at_floor {
                // Closed to rounding, though the unknowns still creep: towards a zero of higher order.
                break;
            }
            if iterations == most {
                return Correction::failed(iterations, first_step);
            }
            iterations += 1;
            let (size, pivot) = buffers.newton_step(block);
            if iterations == 1 {
                first_step = size;
            }
            let shrinking = size <= contraction * last_step || at_floor;
            if !size.is_finite() || !shrinking {
                return Correction::failed(iterations, first_step);
            }
            buffers.stage = NewtonStage::Stale;
            for (unknown, change) in buffers.changes(block) {
                coordinates[unknown] += change;
            }
            // Quadratic convergence: what is left after this step is about step²/σ.
            done = (at_floor && !falls) || size * size <= ROUNDING_FLOOR * pivot;
            last_step = size;
        }
        let residual = buffers.workspace.residual_norm();
        Correction {
            converged: is_closed(mechanism, block, coordinates, residual),
            iterations,
            first_step,
            residual,
        }
    }

    /// Rates of all coordinates for the given rates of the inputs, at a closed pose.
    ///
    /// `rates` holds the inputs' rates in its tail; the head is filled block by block from J q' = -∂r/∂u u'.
    pub fn tangent(&mut self, system: &System, coordinates: &[f64], rates: &mut [f64]) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        for (block, buffers) in structure.blocks.iter().zip(&mut self.blocks) {
            buffers.linearise(mechanism, block, coordinates);
            buffers.workspace.drift_along(&block.plan, rates);
            buffers.solve_drift();
            buffers.refine(REFINEMENTS);
            for (unknown, change) in buffers.changes(block) {
                rates[unknown] = change;
            }
        }
    }

    /// Linearises every block at `coordinates`, unless that is done: what shares the linearisation can rely on it.
    pub fn prepare(&mut self, system: &System, coordinates: &[f64]) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        for (block, buffers) in structure.blocks.iter().zip(&mut self.blocks) {
            buffers.linearise(mechanism, block, coordinates);
        }
    }

    /// The inverse of a block's Jacobian at the last linearisation, or right beside it, if it has one; a row an equation.
    pub fn inverse(&self, block: usize) -> Option<&LaneMatrix> {
        let buffers = self.blocks.get(block)?;
        (buffers.stage == NewtonStage::Factored && buffers.has_inverse).then_some(&buffers.inverse)
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
            each(index, &buffers.workspace.jacobian, values, buffers.sign);
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

impl BlockBuffers {
    /// Residual and Jacobian at `coordinates`, unless they stand there already.
    pub(crate) fn evaluate(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) {
        let values = block.unknowns.iter().chain(&block.plan.outer);
        let values = values.map(|slot| coordinates[*slot]);
        let known =
            self.stage >= NewtonStage::Evaluated && self.at.iter().copied().eq(values.clone());
        if !known {
            self.at.clear();
            self.at.extend(values);
            self.workspace
                .evaluate(mechanism, block, coordinates, Want::Jacobian);
            self.stage = NewtonStage::Evaluated;
        }
    }

    /// Evaluates and factors at `coordinates`, unless that is done or the factors serve from a pose right beside it.
    pub(crate) fn linearise(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) {
        self.evaluate(mechanism, block, coordinates);
        if self.stage < NewtonStage::Factored && self.inverse_serves() {
            self.stage = NewtonStage::Factored;
            self.beside = true;
        }
        self.factor(block);
    }

    /// Whether the inverse that stands is near enough to that of the Jacobian in the workspace.
    fn inverse_serves(&self) -> bool {
        let jacobian = &self.workspace.jacobian;
        if !self.has_inverse || self.factored.len() != jacobian.len() {
            return false;
        }
        let change = square_of_difference(jacobian, &self.factored);
        let size = dot_lanes(self.inverse.groups(), self.inverse.groups());
        change * size <= SAME_INVERSE * SAME_INVERSE
    }

    /// Factors the Jacobian in the workspace, unless that is done.
    fn factor(&mut self, block: &Block) {
        if self.stage == NewtonStage::Factored {
            return;
        }
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let jacobian = &self.workspace.jacobian;
        self.factored.clone_from(jacobian);
        self.beside = false;
        let pivots = match rows == columns {
            true => (self.sparse.invert(jacobian, rows, &mut self.inverse))
                .or_else(|| self.elimination.invert(jacobian, rows, &mut self.inverse)),
            false => {
                let shape = [rows, columns];
                let pivots = self
                    .sparse
                    .pseudo_invert(jacobian, shape, &mut self.inverse);
                pivots.map(Pivots::unsigned)
            }
        };
        self.eliminated = pivots.is_some();
        if let Some(pivots) = pivots {
            (self.sign, self.pivot) = (pivots.sign, pivots.smallest);
            self.has_inverse = true;
        } else {
            self.qr.factor(jacobian, rows, columns, RANK_TOLERANCE);
            self.has_inverse = self.qr.invert(&mut self.transposed);
            if self.has_inverse {
                self.inverse
                    .copy_transposed(&self.transposed, columns, rows);
            }
            (self.sign, self.pivot) = (self.qr.determinant_sign(), self.qr.smallest_pivot());
        }
        self.stage = NewtonStage::Factored;
    }

    /// Singular values at the linearisation: iterated where that is reliable, else decomposed.
    fn singular_values(&mut self, block: &Block) -> Conditioning {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let jacobian = &self.workspace.jacobian;
        if self.has_inverse && columns > 0 {
            self.transposed.copy_rows(jacobian, columns, rows);
            if let Some((sigma_min, sigma_max)) = self.extremes.of(&self.transposed, &self.inverse)
                && sigma_min > ITERATED_RATIO * sigma_max
            {
                return Conditioning {
                    sigma_min,
                    sigma_max,
                    rank: columns,
                };
            }
        }
        jacobian_conditioning(jacobian, rows, columns)
    }

    /// Solves for the step that cancels the residual; returns its largest entry in scaled unknowns and the smallest
    /// pivot.
    fn newton_step(&mut self, block: &Block) -> (f64, f64) {
        self.factor(block);
        self.right_side.clear();
        self.right_side.extend_from_slice(&self.workspace.residual);
        self.solve(self.eliminated);
        let size = self.step.as_flattened().iter().fold(0.0, |m: f64, s| {
            if s.is_nan() {
                f64::INFINITY
            } else {
                m.max(s.abs())
            }
        });
        (size, self.pivot)
    }

    /// The step as changes of the block's unknowns.
    pub(crate) fn changes<'a>(
        &'a self,
        block: &'a Block,
    ) -> impl Iterator<Item = (usize, f64)> + 'a {
        let scaled = block.plan.scales.iter().zip(self.step.as_flattened());
        let changes = scaled.map(|(scale, step)| scale * step);
        block.unknowns.iter().copied().zip(changes)
    }

    /// Solves J step = -drift at the linearisation.
    pub(crate) fn solve_drift(&mut self) {
        let rows = self.workspace.residual.len();
        self.right_side.clear();
        self.right_side
            .extend_from_slice(&self.workspace.drift.as_flattened()[..rows]);
        self.solve(self.has_inverse);
    }

    /// Refines the last solution for the drift where the inverse is of a pose beside.
    pub(crate) fn refine(&mut self, times: usize) {
        if !self.beside {
            return;
        }
        let rows = self.workspace.residual.len();
        for _ in 0..times {
            self.right_side.clear();
            self.right_side
                .extend_from_slice(&self.workspace.drift.as_flattened()[..rows]);
            let columns = self.workspace.jacobian.chunks_exact(rows.max(1));
            for (column, step) in columns.zip(self.step.as_flattened()) {
                for (left, entry) in self.right_side.iter_mut().zip(column) {
                    *left += step * entry;
                }
            }
            self.rough.clone_from(&self.step);
            self.solve(true);
            add_scaled(&mut self.step, 1.0, &self.rough);
        }
    }

    /// Solves J step = -right side, by the inverse or by the factors.
    fn solve(&mut self, by_inverse: bool) {
        if by_inverse {
            self.step.resize(self.inverse.stride(), [0.0; 4]);
            combine_rows(&mut self.step, &self.right_side, self.inverse.groups());
            for group in &mut self.step {
                *group = group.map(|v| -v);
            }
            return;
        }
        self.right_side.iter_mut().for_each(|r| *r = -*r);
        let columns = self.qr.column_order().len();
        self.solution.resize(columns, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.solution);
        self.step.clear();
        self.step.resize(lane_groups(columns), [0.0; 4]);
        for (s, value) in self.step.as_flattened_mut().iter_mut().zip(&self.solution) {
            *s = *value;
        }
    }
}
