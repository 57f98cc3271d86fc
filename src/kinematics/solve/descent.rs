//! Levenberg-Marquardt on one block: from far away to where Newton's method converges.

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::{LaneMatrix, dot_lanes};
use crate::linalg::normal_equations::damped_solution;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::sparse_lu::{LEAST, SparseLu};
use crate::model::mechanism::Mechanism;

/// Most iterations per block and start.
const MAX_ITERATIONS: u32 = 200;

/// Longest step in scaled unknowns (radians, or mechanism sizes): beyond it the linear model is meaningless.
const MAX_STEP: f64 = 0.5;

/// Newton takes over below this residual.
const HAND_OVER: f64 = 1e-7;

/// Damping starts small, so that a good start converges like Newton's method from the first step.
const FIRST_DAMPING: f64 = 1e-3;

/// Its factors after a step that helps and after one that does not, ...
const CLOSER: f64 = 0.1;
const STEEPER: f64 = 8.0;

/// ... and the least of it: below that it is lost beside the equations.
const LEAST_DAMPING: f64 = 1e-15;

/// Damping at which no step reduces the residual any more: a local minimum.
const LAST_DAMPING: f64 = 1e10;

/// Damping below which Newton's step is tried first: it is reached after two successful steps.
const SMALL_DAMPING: f64 = 2e-5;

/// Accepted relative difference between the damped and Newton's step: far below the effect of curvature.
const NEGLIGIBLE: f64 = 1e-2;

/// Largest sum of squares of an inverse that counts as regular, a smallest singular value of about 0.01. Near a singular pose
/// the damped steps choose between the branches that meet.
const REGULAR: f64 = 1e4;

/// Buffers and options of a descent.
pub struct Descent {
    most: u32,
    /// It ends when no entry of the residual is larger.
    enough: f64,
    /// Rows of rotations count this many times.
    pub turn_weight: f64,
    weights: Vec<f64>,
    workspace: BlockWorkspace,
    trial: BlockWorkspace,
    qr: PivotedQr,
    sparse: SparseLu,
    elimination: GaussJordan,
    inverse: LaneMatrix,
    /// The weighted Jacobian, column-major.
    columns: LaneMatrix,
    matrix: Vec<f64>,
    right_side: Vec<f64>,
    step: Vec<f64>,
    /// The block's unknowns before the step.
    before: Vec<f64>,
}

impl Default for Descent {
    fn default() -> Self {
        Self {
            most: MAX_ITERATIONS,
            enough: HAND_OVER,
            turn_weight: 1.0,
            weights: Vec::new(),
            workspace: BlockWorkspace::default(),
            trial: BlockWorkspace::default(),
            qr: PivotedQr::default(),
            sparse: SparseLu::default(),
            elimination: GaussJordan::default(),
            inverse: LaneMatrix::default(),
            columns: LaneMatrix::default(),
            matrix: Vec::new(),
            right_side: Vec::new(),
            step: Vec::new(),
            before: Vec::new(),
        }
    }
}

impl Descent {
    /// One that ends when no entry of the residual is larger than `enough`, or after so many iterations.
    pub fn until(enough: f64, most: u32) -> Self {
        Self {
            most,
            enough,
            ..Self::default()
        }
    }

    /// Levenberg-Marquardt on one block until Newton's method can take over, or nothing helps. Returns the iterations
    /// and the largest entry of the residual.
    pub fn minimise(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        coordinates: &mut [f64],
    ) -> (u32, f64) {
        self.weigh_rows(block);
        let mut damping = FIRST_DAMPING;
        let mut iterations = 0;
        self.workspace
            .evaluate(mechanism, block, coordinates, Want::Jacobian);
        let mut value = self.norm(&self.workspace.residual);
        while iterations < self.most && damping < LAST_DAMPING && !block.unknowns.is_empty() {
            if value.is_nan() || self.workspace.residual_norm() <= self.enough {
                break;
            }
            iterations += 1;
            // Trial step: solve the damped normal equations, move, evaluate.
            self.damped_step(block, damping);
            self.advance_block(mechanism, block, coordinates);
            self.trial
                .evaluate(mechanism, block, coordinates, Want::Jacobian);
            let trial_value = self.norm(&self.trial.residual);
            if trial_value < value {
                // Accepted: closer to Gauss-Newton. Rejected: back, and closer to steepest descent.
                std::mem::swap(&mut self.workspace, &mut self.trial);
                value = trial_value;
                damping = (damping * CLOSER).max(LEAST_DAMPING);
            } else {
                let pairs = block.unknowns.iter().zip(&self.before);
                pairs.for_each(|(slot, value)| coordinates[*slot] = *value);
                damping *= STEEPER;
            }
        }
        (iterations, self.workspace.residual_norm())
    }

    /// Weights of the block's rows.
    fn weigh_rows(&mut self, block: &Block) {
        let turn_weight = self.turn_weight;
        let weight = |component: &usize| if *component < 3 { turn_weight } else { 1.0 };
        let components = block.loops.iter().flat_map(|part| &part.components);
        self.weights.clear();
        self.weights.extend(components.map(weight));
        self.weights.resize(block.rows(), 1.0);
    }

    /// Weighted sum of squares.
    fn norm(&self, residual: &[f64]) -> f64 {
        let pairs = residual.iter().zip(&self.weights);
        pairs.map(|(r, w)| (r * w) * (r * w)).sum()
    }

    /// Least squares of [J; √λ I] x = [-r; 0].
    fn damped_step(&mut self, block: &Block, damping: f64) {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let done = if columns < LEAST {
            (rows == columns && self.undamped_step(columns, damping))
                || self.well_damped_step(rows, columns, damping)
        } else {
            self.sparse_step(rows, columns, damping)
        };
        if !done {
            self.dense_step(rows, columns, damping);
        }
        // Trust region in scaled unknowns: no angle moves by more than the validity of the model.
        let longest = self.step.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
        if longest > MAX_STEP {
            self.step.iter_mut().for_each(|s| *s *= MAX_STEP / longest);
        }
    }

    /// Newton's step of a square block, at a quarter of the cost; false if damping would change it. The damped step is
    /// (1 + λ (JᵀJ)⁻¹)⁻¹ times Newton's: they differ by at most λ |J⁻¹|² of it.
    fn undamped_step(&mut self, n: usize, damping: f64) -> bool {
        if damping > SMALL_DAMPING || self.turn_weight != 1.0 {
            return false;
        }
        let jacobian = &self.workspace.jacobian;
        if self
            .elimination
            .invert(jacobian, n, &mut self.inverse)
            .is_none()
        {
            return false;
        }
        // |J⁻¹|² in the Frobenius norm bounds by how much damping would change the step.
        let square: f64 = self
            .inverse
            .rows()
            .map(|column| dot_lanes(column, column))
            .sum();
        if square > REGULAR || damping * square > NEGLIGIBLE {
            return false;
        }
        self.step.clear();
        self.step.resize(n, 0.0);
        // x = -J⁻¹ r, column by column.
        for (column, residual) in self.inverse.rows().zip(&self.workspace.residual) {
            for (value, entry) in self.step.iter_mut().zip(column.as_flattened()) {
                *value -= residual * entry;
            }
        }
        true
    }

    /// By the sparse system [I J; Jᵀ -λI] [s; x] = [-r; 0]; false where it is not sparse.
    fn sparse_step(&mut self, rows: usize, columns: usize, damping: f64) -> bool {
        let weights = &self.weights;
        let jacobian = &self.workspace.jacobian;
        self.sparse
            .begin_least_squares(jacobian, [rows, columns], |i| weights[i], damping);
        if self.sparse.eliminate_rows(0.0).is_none() {
            return false;
        }
        self.set_right_side();
        self.right_side.resize(rows + columns, 0.0);
        let solution = self.sparse.solve(&self.right_side);
        self.step.clear();
        self.step.extend_from_slice(&solution[rows..]);
        self.step.iter().all(|v| v.is_finite())
    }

    /// By the normal equations, at a tenth of the cost; false if the damping is too weak for them.
    fn well_damped_step(&mut self, rows: usize, columns: usize, damping: f64) -> bool {
        self.columns
            .copy_rows(&self.workspace.jacobian, columns, rows);
        for column in self.columns.rows_mut() {
            let entries = column.as_flattened_mut().iter_mut().zip(&self.weights);
            entries.for_each(|(entry, weight)| *entry *= weight);
        }
        self.set_right_side();
        damped_solution(&self.columns, &self.right_side, damping, &mut self.step)
    }

    /// The negated weighted residual.
    fn set_right_side(&mut self) {
        let residual = self.workspace.residual.iter().zip(&self.weights);
        self.right_side.clear();
        self.right_side.extend(residual.map(|(r, w)| -r * w));
    }

    fn dense_step(&mut self, rows: usize, columns: usize, damping: f64) {
        let tall = rows + columns;
        self.matrix.clear();
        self.matrix.resize(tall * columns, 0.0);
        // Levenberg and Marquardt as least squares: sqrt(damping) I below the weighted Jacobian.
        for j in 0..columns {
            let column = &self.workspace.jacobian[j * rows..(j + 1) * rows];
            let weighted = column.iter().zip(&self.weights).map(|(a, w)| a * w);
            for (entry, value) in self.matrix[j * tall..].iter_mut().zip(weighted) {
                *entry = value;
            }
            self.matrix[j * tall + rows + j] = damping.sqrt();
        }
        self.set_right_side();
        self.right_side.resize(tall, 0.0);
        self.step.resize(columns, 0.0);
        self.qr.factor(&self.matrix, tall, columns, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.step);
    }

    /// Applies the step, and stores the previous values of the block's unknowns.
    fn advance_block(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &mut [f64]) {
        self.before.clear();
        for (slot, step) in block.unknowns.iter().zip(&self.step) {
            self.before.push(coordinates[*slot]);
            coordinates[*slot] += mechanism.scale_of(*slot) * step;
        }
    }
}
