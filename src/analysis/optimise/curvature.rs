//! Second derivatives learnt from steps and gradients: BFGS with Powell's damping, which keeps them convex (Nocedal and
//! Wright, Numerical Optimization, 2nd ed., procedure 18.2).

use nalgebra::{DMatrix, DVector};

/// Smallest fraction of the known curvature that an update keeps along its step (Powell).
const DAMPED: f64 = 0.2;

/// Second derivatives of the Lagrangian in scaled variables, as learnt from the steps.
pub(super) struct Curvature {
    /// Symmetric and positive semidefinite; zero before anything is known.
    pub matrix: DMatrix<f64>,
    is_known: bool,
}

impl Curvature {
    /// No curvature in this many variables.
    pub fn none(count: usize) -> Self {
        Self {
            matrix: DMatrix::zeros(count, count),
            is_known: false,
        }
    }

    /// Damped BFGS update by a step and the change of the Lagrangian's gradient.
    pub fn damped_update(&mut self, step: &DVector<f64>, change: DVector<f64>) {
        let along = step.dot(&change);
        let square = step.norm_squared();
        if square == 0.0 || !along.is_finite() {
            return;
        }
        if !self.is_known {
            if along <= 0.0 {
                return;
            }
            self.matrix = DMatrix::identity(step.len(), step.len()) * (along / square);
            self.is_known = true;
        }
        let bent = &self.matrix * step;
        // Powell's damping: the change is mixed with the matrix's own, so that it stays positive definite.
        let old = step.dot(&bent);
        let change = if along >= DAMPED * old {
            change
        } else {
            let share = (1.0 - DAMPED) * old / (old - along);
            change * share + &bent * (1.0 - share)
        };
        let along = step.dot(&change);
        if along > 0.0 && old > 0.0 {
            self.matrix += &change * change.transpose() / along;
            self.matrix -= &bent * bent.transpose() / old;
        }
    }
}
