//! The best candidate of a search that keeps all constraints, whatever way the search goes on from there.

/// Accepted violation of a constraint, as a fraction of its bound: ten times less than what counts as kept in a report, so that the
/// rounding of a motion that is solved again makes no difference.
pub const LET_PASS: f64 = 1e-7;

/// The end of a search stands if it violates no constraint by more than this multiple of the accepted violation: the last digits of an
/// iteration are not worth going back for.
const MARGIN: f64 = 10.0;

/// The best candidate so far whose constraints are kept.
pub(super) struct BestKept {
    tolerance: f64,
    best: Option<(Vec<f64>, f64)>,
}

impl BestKept {
    /// None yet; `tolerance` is the accepted violation.
    pub fn within(tolerance: f64) -> Self {
        Self {
            tolerance,
            best: None,
        }
    }

    /// A candidate with its value and its largest violation.
    pub fn offer(&mut self, x: &[f64], value: f64, violation: f64) {
        let is_better = self.best.as_ref().is_none_or(|(_, best)| value < *best);
        if violation <= self.tolerance && value.is_finite() && is_better {
            self.best = Some((x.to_vec(), value));
        }
    }

    /// What to return instead of the end of a search with such a violation: the candidate and its value; `None` where the end stands
    /// or no candidate keeps the constraints.
    pub fn instead_of(self, violation: f64) -> Option<(Vec<f64>, f64)> {
        self.best
            .filter(|_| violation.is_nan() || violation > MARGIN * self.tolerance)
    }
}
