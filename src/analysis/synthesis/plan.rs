//! The options of a synthesis.

use super::found::FinishedStart;

/// Factor by which finer tracks divide those of the study.
pub const FINER: usize = 4;

/// Where searches may start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum From {
    /// The scene's own values, the whole box, and near the minima found.
    Everywhere,
    /// The scene's own values, and near the minima found.
    Scene,
    /// The whole box, and near the minima found.
    Random,
}

/// The settings of a search.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchPlan {
    /// Number of starts.
    pub starts: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Iterations of the search from one start.
    pub iterations: usize,
    /// Seconds: most of them for new starts, the rest for ending the searches.
    pub limit: Option<f64>,
    /// Where searches may start.
    pub from: From,
    /// Worker threads.
    pub threads: usize,
}

/// Receives the progress; `false` from `goes_on` ends the synthesis with the best result so far.
pub struct Listener<'l> {
    /// A start is finished: its number and result.
    pub done: &'l (dyn Fn(usize, &FinishedStart) + Sync),
    /// Whether to go on.
    pub goes_on: &'l (dyn Fn() -> bool + Sync),
}
