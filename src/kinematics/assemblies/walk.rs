//! Continuation from a closed pose: Euler-Newton steps of equal length along a curve of one block's solutions.
//!
//! A direction v of the equations is released: F(u) = s v defines a curve through the pose, and wherever s returns to
//! zero there is another assembly, whatever folds lie between (a Newton homotopy through known solutions). Without a
//! released direction a curve exists only if the solutions themselves form one.

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::random_starts::random_unit;
use crate::kinematics::structure::block::Block;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::TAU;

/// Length of a step in scaled unknowns.
const STEP: f64 = 0.1;

/// Shortest step before a walk is given up.
const SHORTEST: f64 = STEP / 32.0;

/// Steps in either direction: about ten turns of a joint.
const MOST_STEPS: usize = 600;

/// Newton iterations of a step.
const ITERATIONS: usize = 6;

/// Residual of a point of the curve. Solutions are closed to rounding afterwards; a point of a continuous set must not
/// be a near miss.
const ON_CURVE: f64 = 1e-10;

/// A corrector that moves farther than this fraction of the step has reached another curve.
const STRAY: f64 = 0.5;

/// The walk is abandoned when the released residual (radians, sizes) is larger.
const LOST: f64 = 4.0;

/// A walk whose residual vanishes within this distance of its start (scaled unknowns) has returned: a chord differs
/// from an arc of one step by less.
const BACK: f64 = 0.02;

/// Largest number of columns of a block that is walked: a step costs the cube.
pub const WIDEST: usize = 64;

/// Below this share of the first pivot a column depends on the others.
const DEPENDENT: f64 = 1e-9;

/// A point of a curve with the data for the next step.
pub struct BranchPath<'a> {
    mechanism: &'a Mechanism,
    block: &'a Block,
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    released: Vec<f64>,
    /// s above.
    pub amount: f64,
    /// The direction of the curve, then others that steps must not take.
    tangents: Vec<Vec<f64>>,
    workspace: BlockWorkspace,
    qr: PivotedQr,
    matrix: Vec<f64>,
    right_side: Vec<f64>,
    solution: Vec<f64>,
}

impl<'a> BranchPath<'a> {
    /// A path of solutions from a pose along the first of `tangents` (scaled unknowns), which span all directions in
    /// which the solutions go on.
    pub fn of_solutions(
        mechanism: &'a Mechanism,
        block: &'a Block,
        pose: &[f64],
        tangents: Vec<Vec<f64>>,
    ) -> Self {
        Self {
            mechanism,
            block,
            coordinates: pose.to_vec(),
            released: Vec::new(),
            amount: 0.0,
            tangents,
            workspace: BlockWorkspace::default(),
            qr: PivotedQr::default(),
            matrix: Vec::new(),
            right_side: Vec::new(),
            solution: Vec::new(),
        }
    }

    /// A path from a regular pose with a random direction of the equations released; `None` if it is not regular.
    fn release_equations(
        mechanism: &'a Mechanism,
        block: &'a Block,
        pose: &[f64],
        key: u64,
        sense: f64,
    ) -> Option<Self> {
        let rows = block.rows() as u64;
        let mut path = Self::of_solutions(mechanism, block, pose, Vec::new());
        path.released = (0..rows).map(|row| random_unit(key, row)).collect();
        let mut along = vec![0.0; block.unknowns.len() + 1];
        // The homotopy r(q) = a v starts at a = 0, in the given sense.
        along[block.unknowns.len()] = sense;
        path.tangents.push(along);
        path.linearise();
        path.turn().then_some(path)
    }

    fn width(&self) -> usize {
        self.block.unknowns.len() + usize::from(!self.released.is_empty())
    }

    /// Factorises [J -v; T] here.
    fn linearise(&mut self) {
        let (rows, columns) = (self.block.rows(), self.block.unknowns.len());
        self.workspace.evaluate(
            self.mechanism,
            self.block,
            &self.coordinates,
            Want::Jacobian,
        );
        let (width, height) = (self.width(), rows + self.tangents.len());
        self.matrix.clear();
        for j in 0..width {
            if j < columns {
                let column = &self.workspace.jacobian[j * rows..(j + 1) * rows];
                self.matrix.extend_from_slice(column);
            } else {
                self.matrix.extend(self.released.iter().map(|v| -v));
            }
            // The bordered system: rows of the tangents below the Jacobian make it regular at folds.
            self.matrix.extend(self.tangents.iter().map(|t| t[j]));
        }
        self.qr.factor(&self.matrix, height, width, DEPENDENT);
    }

    /// The direction of the curve here, with the orientation of the previous one; false if there is none.
    fn turn(&mut self) -> bool {
        let (rows, width) = (self.block.rows(), self.width());
        if self.qr.rank() < width {
            return false;
        }
        self.right_side.clear();
        self.right_side.resize(rows + self.tangents.len(), 0.0);
        // No residual, and one step along the last tangent.
        self.right_side[rows] = 1.0;
        self.solution.resize(width, 0.0);
        self.qr.solve(&mut self.right_side, &mut self.solution);
        let length = self.solution.iter().map(|x| x * x).sum::<f64>().sqrt();
        let unit = self.solution.iter().map(|x| x / length);
        self.tangents[0] = unit.collect();
        length.is_finite() && length > 0.0
    }

    fn advance(&mut self, step: &[f64], factor: f64) {
        for (unknown, x) in self.block.unknowns.iter().zip(step) {
            self.coordinates[*unknown] += factor * x * self.mechanism.scale_of(*unknown);
        }
        if let Some(x) = step.get(self.block.unknowns.len()) {
            self.amount += factor * x;
        }
    }

    /// Newton's method perpendicular to the tangents; false if it does not reach the curve nearby.
    fn correct(&mut self, near: f64) -> bool {
        let mut moved = 0.0;
        for _ in 0..ITERATIONS {
            self.linearise();
            let pairs = self.workspace.residual.iter().enumerate();
            let released = |k: usize| self.released.get(k).map_or(0.0, |v| v * self.amount);
            self.right_side.clear();
            self.right_side.extend(pairs.map(|(k, r)| released(k) - r));
            let left = self.right_side.iter().fold(0.0_f64, |m, r| m.max(r.abs()));
            if left <= ON_CURVE {
                return true;
            }
            self.right_side
                .resize(self.block.rows() + self.tangents.len(), 0.0);
            self.solution.resize(self.width(), 0.0);
            self.qr.solve(&mut self.right_side, &mut self.solution);
            let step = std::mem::take(&mut self.solution);
            moved += step.iter().map(|x| x * x).sum::<f64>().sqrt();
            self.advance(&step, 1.0);
            self.solution = step;
            // A large correction leads to another curve.
            if !(moved <= near && self.qr.rank() == self.width()) {
                return false;
            }
        }
        false
    }

    /// One step of the given length; false, with everything unchanged, if the curve cannot be followed.
    pub fn step(&mut self, length: f64) -> bool {
        let before = (
            self.coordinates.clone(),
            self.amount,
            self.tangents[0].clone(),
        );
        let along = before.2.clone();
        self.advance(&along, length);
        // Predictor along the tangent, corrector at right angles to it, new tangent.
        if self.correct(STRAY * length) && self.turn() {
            return true;
        }
        (self.coordinates, self.amount, self.tangents[0]) = before;
        false
    }

    /// One step, of at most `length`, which is shortened as needed and grows again.
    fn careful_step(&mut self, length: &mut f64) -> bool {
        while *length >= SHORTEST {
            if self.step(*length) {
                *length = (2.0 * *length).min(STEP);
                return true;
            }
            *length *= 0.5;
        }
        false
    }

    /// Where it returns to zero on the way, nearly closed, and whether the curve is closed.
    fn closed_crossings(
        &mut self,
        start: &[f64],
        cancelled: &(dyn Fn() -> bool + Sync),
    ) -> (Vec<Vec<f64>>, bool) {
        let (mut zeros, mut length) = (Vec::new(), STEP);
        for count in 0..MOST_STEPS {
            let (before, amount) = (self.coordinates.clone(), self.amount);
            if cancelled() || !self.careful_step(&mut length) || self.amount.abs() > LOST {
                return (zeros, false);
            }
            if count > 0 && amount * self.amount <= 0.0 {
                // Linear interpolation to a = 0 is a start near another closed pose.
                let share = amount / (amount - self.amount);
                let between = before.iter().zip(&self.coordinates);
                let zero: Vec<f64> = between.map(|(a, b)| a + share * (b - a)).collect();
                if block_distance(self.mechanism, self.block, &zero, start) < BACK {
                    return (zeros, true);
                }
                zeros.push(zero);
            }
        }
        (zeros, false)
    }
}

/// Distance of two poses in scaled unknowns, whole turns aside.
fn block_distance(mechanism: &Mechanism, block: &Block, a: &[f64], b: &[f64]) -> f64 {
    let squares = block.unknowns.iter().map(|unknown| {
        let off = (a[*unknown] - b[*unknown]) / mechanism.scale_of(*unknown);
        let turns = match mechanism.unknowns[*unknown].kind {
            Kind::Angle => TAU * (off / TAU).round(),
            Kind::Length | Kind::Number => 0.0,
        };
        (off - turns) * (off - turns)
    });
    squares.sum::<f64>().sqrt()
}

/// Starts near other solutions of a block, met on a walk from a regular closed pose; which one depends on `key`.
pub fn branch_neighbours(
    mechanism: &Mechanism,
    block: &Block,
    pose: &[f64],
    key: u64,
    cancelled: &(dyn Fn() -> bool + Sync),
) -> Vec<Vec<f64>> {
    let mut starts = Vec::new();
    for sense in [1.0, -1.0] {
        let Some(mut path) = BranchPath::release_equations(mechanism, block, pose, key, sense)
        else {
            break;
        };
        let (zeros, is_closed) = path.closed_crossings(pose, cancelled);
        starts.extend(zeros);
        // A closed curve has been followed completely: the other direction finds the same poses.
        if is_closed {
            break;
        }
    }
    starts
}
