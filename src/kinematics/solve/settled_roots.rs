//! Roots of equations told from places where an equation only becomes small.
//!
//! The terms of a formula may themselves vanish: exp(x) has no root, however small its value is beside the terms of other poses,
//! while x^4 has one that Newton's method approaches for ever. The steps tell one from the other. Towards a root of order m each
//! is (m - 1)/m of the one before, so that all further ones together are known; towards infinity they do not decrease.

use super::closure::hold_beside_terms;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::RANK_TOLERANCE;
use crate::model::mechanism::Mechanism;

/// A root is reached where all further steps together are shorter, in scaled unknowns: far below the distance of poses that can be
/// told apart.
const REACHED: f64 = 1e-12;

/// A pose that is within this of its root, in scaled unknowns, stays where it is: the root of rounding, as near as Newton's method
/// comes to a double root.
const BESIDE: f64 = 3e-8;

/// Largest ratio of successive steps that lead to a root: of one of order twenty. Those that lead to infinity approach one.
const SLOWEST: f64 = 0.95;

/// Ratio of successive steps above which all further ones are taken at once.
const SLOW: f64 = 0.3;

/// Most steps.
const MOST_STEPS: usize = 60;

/// Moves the unknowns of a block, which is closed beside the terms of the whole motion, to a root of its equations; false if there
/// is none nearby.
pub fn settle_block(mechanism: &Mechanism, block: &Block, coordinates: &mut [f64]) -> bool {
    if block.unknowns.is_empty() || hold_beside_terms(mechanism, block, coordinates) {
        return true;
    }
    let before: Vec<f64> = coordinates.to_vec();
    let mut path = RootSteps::default();
    let mut last: Option<f64> = None;
    for _ in 0..MOST_STEPS {
        let Some(length) = path.find(mechanism, block, coordinates) else {
            return false;
        };
        let ratio = match last {
            Some(last) => length / last,
            None if length <= REACHED * REACHED => 0.0,
            None => 1.0,
        };
        // The geometric series of all further steps.
        let left = length / (1.0 - ratio);
        let is_there =
            ratio <= SLOWEST && left <= REACHED || path.is_lost(mechanism, block, coordinates);
        let jumps = (SLOW..=SLOWEST).contains(&ratio);
        path.take(
            mechanism,
            block,
            coordinates,
            if jumps { left / length } else { 1.0 },
        );
        if is_there || hold_beside_terms(mechanism, block, coordinates) {
            let moved = |slot: &usize| {
                (coordinates[*slot] - before[*slot]).abs() / mechanism.scale_of(*slot)
            };
            if block.unknowns.iter().all(|slot| moved(slot) <= BESIDE) {
                coordinates.copy_from_slice(&before);
            }
            return true;
        }
        // After a jump the steps begin anew.
        last = (!jumps && length > 0.0).then_some(length);
    }
    false
}

/// Newton's steps with every row in units of its gradient, so that equations whose terms vanish count as much as others.
#[derive(Default)]
struct RootSteps {
    workspace: BlockWorkspace,
    factors: PivotedQr,
    step: Vec<f64>,
}

impl RootSteps {
    /// The step from a pose, and its largest entry in scaled unknowns; none where an equation has no gradient.
    fn find(&mut self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> Option<f64> {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let workspace = &mut self.workspace;
        workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
        let mut scales = vec![0.0_f64; rows];
        for (k, entry) in workspace.jacobian.iter().enumerate() {
            scales[k % rows] = scales[k % rows].max(entry.abs());
        }
        // Loops keep their units: their rows may vanish one by one at a singular pose.
        let first = rows - block.equations.len();
        scales[..first].fill(1.0);
        if !scales.iter().all(|scale| scale.is_normal()) {
            return None;
        }
        let entries = workspace.jacobian.iter().enumerate();
        let matrix: Vec<f64> = entries.map(|(k, v)| v / scales[k % rows]).collect();
        let residual = workspace.residual.iter().zip(&scales);
        let mut right: Vec<f64> = residual.map(|(r, scale)| -r / scale).collect();
        self.factors.factor(&matrix, rows, columns, RANK_TOLERANCE);
        self.step.resize(columns, 0.0);
        self.factors.solve(&mut right, &mut self.step);
        let length = self.step.iter().fold(0.0, |m: f64, s| m.max(s.abs()));
        let is_sound = self.step.iter().all(|s| s.is_finite());
        is_sound.then_some(length)
    }

    /// Whether the last step is less than the rounding of every unknown that it would move.
    fn is_lost(&self, mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> bool {
        let mut steps = block.unknowns.iter().zip(&self.step);
        steps.all(|(slot, step)| {
            let moved = step.abs() * mechanism.scale_of(*slot);
            moved <= f64::EPSILON * coordinates[*slot].abs()
        })
    }

    fn take(&self, mechanism: &Mechanism, block: &Block, coordinates: &mut [f64], share: f64) {
        for (slot, step) in block.unknowns.iter().zip(&self.step) {
            coordinates[*slot] += share * step * mechanism.scale_of(*slot);
        }
    }
}
