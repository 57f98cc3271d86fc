//! Residual, Jacobian, factors and inverse of one block at a pose, shared by everything that needs them there.

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::linalg::gauss_jordan::{GaussJordan, Pivots};
use crate::linalg::lanes::{
    LaneMatrix, Lanes, add_scaled, combine_rows, dot_lanes, lane_groups, square_of_difference,
};
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::singular_values::Extremes;
use crate::linalg::sparse_lu::SparseLu;
use crate::linalg::svd::{Conditioning, RANK_TOLERANCE, jacobian_conditioning};
use crate::model::mechanism::Mechanism;

/// Smallest ratio of singular values that are iterated from an inverse: half of its digits are then correct, enough for
/// the documented accuracy. Below it, and wherever the rank may drop, the Jacobian is decomposed.
const ITERATED_RATIO: f64 = 1e-7;

/// An inverse is reused at a neighbouring pose while the change of the Jacobian times the inverse, both in the
/// Frobenius norm, is at most this: singular values then differ by no more than this fraction of themselves, and no
/// determinant changes its sign.
const SAME_INVERSE: f64 = 5e-7;

/// Number of refinements after which a solution by such an inverse is accurate to rounding.
pub(crate) const REFINEMENTS: usize = 2;

/// The state of the linearisation of a block.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
enum LinearStage {
    /// Nothing, or a linearisation at another pose.
    #[default]
    Stale,
    /// Residual and Jacobian are in the workspace.
    Evaluated,
    /// The Jacobian, or that of a neighbouring pose, is factorised, and inverted if possible.
    Factored,
}

/// Buffers of one block.
#[derive(Clone, Debug, Default)]
pub(crate) struct Linearisation {
    pub(crate) workspace: BlockWorkspace,
    qr: PivotedQr,
    elimination: GaussJordan,
    sparse: SparseLu,
    stage: LinearStage,
    /// Values of the block's unknowns, then of the coordinates from outside, at the linearisation.
    at: Vec<f64>,
    /// Inverse (of a tall matrix the pseudo-inverse) with one row per equation, so that a solution is a sum of rows.
    inverse: LaneMatrix,
    has_inverse: bool,
    /// The factorisation belongs to a neighbouring pose and is reused.
    beside: bool,
    /// The inverse comes from an elimination.
    eliminated: bool,
    /// The Jacobian that was factorised.
    factored: Vec<f64>,
    /// Smallest pivot.
    pivot: f64,
    /// Sign of the determinant, zero unless square and regular.
    sign: i8,
    transposed: LaneMatrix,
    extremes: Extremes,
    right_side: Vec<f64>,
    solution: Vec<f64>,
    /// Step of the block's unknowns, in whole groups of lanes.
    step: Vec<Lanes>,
    rough: Vec<Lanes>,
}

/// Whether the coordinates `slots` have the values `at`.
fn are_at(slots: &[usize], coordinates: &[f64], at: &[f64]) -> bool {
    slots
        .iter()
        .zip(at)
        .all(|(slot, at)| coordinates[*slot] == *at)
}

impl Linearisation {
    /// Residual and Jacobian at `coordinates`, unless they are there already.
    pub(crate) fn evaluate(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) {
        let (own, outer) = (&block.unknowns, &block.plan.outer);
        // The block depends on its own unknowns and on those of earlier blocks; nothing else can have changed it.
        let known = self.stage >= LinearStage::Evaluated
            && self.at.len() == own.len() + outer.len()
            && are_at(own, coordinates, &self.at[..own.len()])
            && are_at(outer, coordinates, &self.at[own.len()..]);
        if !known {
            self.at.clear();
            for slots in [own, outer] {
                self.at.extend(slots.iter().map(|slot| coordinates[*slot]));
            }
            self.workspace
                .evaluate(mechanism, block, coordinates, Want::Jacobian);
            self.stage = LinearStage::Evaluated;
        }
    }

    /// Evaluates and factorises at `coordinates`, unless that is done or the factors of a neighbouring pose suffice.
    pub(crate) fn linearise(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) {
        self.evaluate(mechanism, block, coordinates);
        if self.stage < LinearStage::Factored && self.inverse_serves() {
            self.stage = LinearStage::Factored;
            self.beside = true;
        }
        self.factor(block);
    }

    /// Whether the present inverse is close enough to that of the Jacobian in the workspace.
    fn inverse_serves(&self) -> bool {
        let jacobian = &self.workspace.jacobian;
        if !self.has_inverse || self.factored.len() != jacobian.len() {
            return false;
        }
        let change = square_of_difference(jacobian, &self.factored);
        let size = dot_lanes(self.inverse.groups(), self.inverse.groups());
        change * size <= SAME_INVERSE * SAME_INVERSE
    }

    /// Factorises the Jacobian in the workspace, unless that is done.
    fn factor(&mut self, block: &Block) {
        if self.stage == LinearStage::Factored {
            return;
        }
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let jacobian = &self.workspace.jacobian;
        self.factored.clone_from(jacobian);
        self.beside = false;
        // A square block is inverted: sparse elimination if it fills in little, else Gauss-Jordan in lanes.
        let pivots = match rows == columns {
            true => (self.sparse.invert(jacobian, rows, &mut self.inverse))
                .or_else(|| self.elimination.invert(jacobian, rows, &mut self.inverse)),
            false => {
                let shape = [rows, columns];
                let pivots = self
                    .sparse
                    .pseudo_invert(jacobian, shape, &mut self.inverse);
                pivots.map(Pivots::without_sign)
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
        self.stage = LinearStage::Factored;
    }

    /// Singular values at the linearisation: iterated where that is reliable, else decomposed.
    pub(super) fn singular_values(&mut self, block: &Block) -> Conditioning {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let jacobian = &self.workspace.jacobian;
        // Of two unknowns they are a formula.
        let is_small = [rows, columns] == [2, 2];
        if self.has_inverse && columns > 0 && !is_small {
            self.transposed.copy_rows(jacobian, columns, rows);
            // Power iterations with J and its inverse are reliable well away from a loss of rank.
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
    pub(super) fn newton_step(&mut self, block: &Block) -> (f64, f64) {
        self.factor(block);
        self.right_side.clear();
        self.right_side.extend_from_slice(&self.workspace.residual);
        self.solve(self.eliminated);
        // Convergence is judged by the maximum norm; a step with NaN counts as infinitely long.
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

    /// Moves the block's unknowns by the step, away from the linearisation.
    pub(super) fn take_step(&mut self, block: &Block, coordinates: &mut [f64]) {
        self.stage = LinearStage::Stale;
        for (unknown, change) in self.changes(block) {
            coordinates[unknown] += change;
        }
    }

    /// The inverse of the Jacobian, or of one right beside it, if it has one.
    pub(super) fn inverse(&self) -> Option<&LaneMatrix> {
        (self.stage == LinearStage::Factored && self.has_inverse).then_some(&self.inverse)
    }

    /// Sign of the determinant, zero unless square and regular.
    pub(super) fn sign(&self) -> i8 {
        self.sign
    }

    /// Solves J step = -drift at the linearisation.
    pub(crate) fn solve_drift(&mut self) {
        let rows = self.workspace.residual.len();
        self.right_side.clear();
        self.right_side
            .extend_from_slice(&self.workspace.drift.as_flattened()[..rows]);
        self.solve(self.has_inverse);
    }

    /// Refines the last solution for the drift if the inverse is that of a neighbouring pose.
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
            // Iterative refinement: the residual of the linear system, with the exact Jacobian, is solved for again.
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

    /// Solves J step = -right-hand side, by the inverse or by the factors.
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
