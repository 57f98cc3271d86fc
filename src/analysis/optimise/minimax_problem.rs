//! The problem of a minimax search: many functions at once, their derivatives, and the merit of their values.

use nalgebra::DMatrix;

/// Values at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakValues {
    /// The functions whose maximum is minimised.
    pub peaks: Vec<f64>,
    /// The constraints: none may be positive.
    pub limits: Vec<f64>,
}

/// Derivatives at a point: a row for each peak and for each limit.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakGradients {
    /// Of the peaks.
    pub peaks: Vec<Vec<f64>>,
    /// Of the limits.
    pub limits: Vec<Vec<f64>>,
    /// Second derivatives of a single peak, as far as they are known; symmetric and positive semidefinite.
    pub bend: Option<Vec<Vec<f64>>>,
}

impl PeakGradients {
    /// The known second derivatives in scaled variables.
    pub(super) fn scaled_bend(&self, scales: &[f64]) -> DMatrix<f64> {
        let n = scales.len();
        match &self.bend {
            Some(bend) => DMatrix::from_fn(n, n, |i, j| bend[i][j] * scales[i] * scales[j]),
            None => DMatrix::zeros(n, n),
        }
    }
}

/// Many functions at once.
pub trait MinimaxProblem {
    /// Values at `x`; `None` if `x` is rejected.
    fn values_at(&mut self, x: &[f64]) -> Option<PeakValues>;

    /// Values and derivatives at `x`; `None` if `x` is rejected.
    fn gradients_at(&mut self, x: &[f64]) -> Option<(PeakValues, PeakGradients)>;

    /// The constraint that rejected `x`, if it has a value and gradients only outside the feasible region.
    fn edge(&mut self, _x: &[f64]) -> Option<TrustEdge> {
        None
    }

    /// Whether a function may have kinks that its derivatives at a point do not tell: where the search would end, it looks around then.
    fn hides_kinks(&self) -> bool {
        false
    }

    /// Called before every step and every evaluation: whether to end the search with the best point so far.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Called after every accepted step; `false` ends the search.
    fn progress(&mut self, _iteration: usize, _x: &[f64], _value: f64) -> bool {
        true
    }
}

/// A rejected point: the violation of a constraint, and its gradient.
#[derive(Clone, Debug, PartialEq)]
pub struct TrustEdge {
    /// The point.
    pub x: Vec<f64>,
    /// Positive: how much is missed there.
    pub value: f64,
    /// Its derivatives.
    pub slope: Vec<f64>,
}

impl TrustEdge {
    /// The linearised constraint at `x`, seen from the rejected point; an accepted point satisfies it.
    pub(super) fn at(&self, x: &[f64]) -> f64 {
        let moves = x.iter().zip(&self.x).zip(&self.slope);
        let value: f64 = moves.map(|((to, from), d)| (to - from) * d).sum();
        (self.value + value).min(0.0)
    }
}

pub(super) fn largest_value(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

pub(super) fn merit_value(peak_values: &PeakValues, weight: f64) -> f64 {
    largest_value(&peak_values.peaks) + weight * largest_value(&peak_values.limits).max(0.0)
}
