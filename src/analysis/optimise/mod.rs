//! Minimisers of functions of a few variables: values may be rejected, and gradients may be requested. They do not
//! depend on mechanisms.

mod beside;
pub mod bfgs;
pub mod constraints;
mod curvature;
pub mod evolution;
mod kept;
pub mod least_squares;
pub mod minimax;
mod minimax_poll;
mod minimax_problem;
mod minimax_step;
pub mod nelder_mead;
pub mod quadratic;

pub use kept::LET_PASS;

/// A function to be made small.
pub trait Objective {
    /// The value at `x`; infinite if `x` is rejected.
    fn value(&mut self, x: &[f64]) -> f64;

    /// The value and gradient at `x`; `None` if `x` is rejected.
    fn gradient(&mut self, x: &[f64]) -> Option<(f64, Vec<f64>)>;

    /// Called after every iteration with the best point so far; `false` ends the search.
    fn progress(&mut self, _iteration: usize, _x: &[f64], _value: f64) -> bool {
        true
    }
}

/// A box for the variables.
#[derive(Clone, Debug, PartialEq)]
pub struct VariableBounds {
    /// Smallest values.
    pub lower: Vec<f64>,
    /// Largest values.
    pub upper: Vec<f64>,
}

impl VariableBounds {
    /// No bounds on `count` variables.
    pub fn none(count: usize) -> Self {
        Self {
            lower: vec![f64::NEG_INFINITY; count],
            upper: vec![f64::INFINITY; count],
        }
    }

    /// The point of the box that is nearest to `x`.
    pub fn clamp(&self, x: &mut [f64]) {
        for ((x, low), high) in x.iter_mut().zip(&self.lower).zip(&self.upper) {
            *x = x.clamp(*low, *high);
        }
    }
}

/// Why a search ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum StopReason {
    /// The tolerances are met.
    Converged,
    /// No step decreases the value any more: rounding, a kink, or rejected points all around.
    Stalled,
    /// The allowed number of evaluations or iterations is used up.
    OutOfBudget,
    /// [`Objective::progress`] said so.
    Stopped,
}

/// What a search found.
#[derive(Clone, Debug, PartialEq)]
pub struct Minimum {
    /// Best point.
    pub x: Vec<f64>,
    /// Its value.
    pub value: f64,
    /// Iterations made.
    pub iterations: usize,
    /// Values asked for.
    pub evaluations: usize,
    /// Gradients asked for.
    pub gradients: usize,
    /// Why it ended.
    pub ended: StopReason,
}

#[cfg(test)]
mod tests;
