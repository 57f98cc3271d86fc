//! The results of a synthesis.

use super::starts::{Rejected, StartOrigin};
use crate::analysis::optimise::{Minimum, StopReason};
use crate::analysis::study::{KEPT, Refusals};

/// The result of one start.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedStart {
    /// Where it was.
    pub origin: StartOrigin,
    /// The objective at the start; NaN if no draw can move.
    pub first: f64,
    /// The minimum; `None` if no draw can move.
    pub minimum: Option<Minimum>,
    /// Draws that were rejected before it.
    pub rejected: Rejected,
    /// Rejected candidates: not reached or without a value, and interpenetrating.
    pub refusals: Refusals,
    /// The second kind.
    pub interpenetrating: usize,
    /// Wall time.
    pub seconds: f64,
    /// The largest violation of a limit, as a fraction of it.
    pub excess: f64,
    /// Unknowns at the start of the drive, if a track begins there.
    pub(super) unknowns: Option<Vec<f64>>,
}

impl FinishedStart {
    /// A start without a minimum.
    pub(super) fn none(origin: StartOrigin) -> Self {
        Self {
            origin,
            first: f64::NAN,
            minimum: None,
            rejected: Rejected::default(),
            refusals: Refusals::default(),
            interpenetrating: 0,
            seconds: 0.0,
            unknowns: None,
            excess: f64::INFINITY,
        }
    }

    /// The objective found; infinite if there is none, or limits are violated.
    pub fn value(&self) -> f64 {
        let kept = self.minimum.as_ref().filter(|_| self.excess <= KEPT);
        kept.map_or(f64::INFINITY, |m| m.value)
    }
}

/// What a synthesis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Synthesis {
    /// All starts, then the polished best ones.
    pub starts: Vec<FinishedStart>,
    /// Number of starts without polishing.
    pub searched: usize,
    /// Values of the variables, in internal units.
    pub best: Vec<f64>,
    /// Unknowns at the start of the drive with them, if known: start values that select this assembly.
    pub unknowns: Option<Vec<f64>>,
    /// The objective.
    pub value: f64,
    /// Whether it was cancelled, or ran out of time.
    pub stopped: bool,
    /// Wall time.
    pub seconds: f64,
}

impl Synthesis {
    /// Number of poses evaluated over all starts, including gradients.
    pub fn evaluations(&self) -> usize {
        let minima = self.starts.iter().filter_map(|s| s.minimum.as_ref());
        minima.map(|m| m.evaluations + m.gradients).sum()
    }

    /// Draws that were rejected.
    pub fn rejected(&self) -> Rejected {
        self.starts.iter().fold(Rejected::default(), |mut all, s| {
            all.add(s.rejected);
            all
        })
    }
}

/// The end of a search in words.
pub const fn ending_word(ended: StopReason) -> &'static str {
    match ended {
        StopReason::Converged => "converged",
        StopReason::Stalled => "stuck",
        StopReason::OutOfBudget => "iteration limit reached",
        StopReason::Stopped => "stopped",
    }
}
