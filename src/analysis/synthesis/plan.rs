//! What is asked of a synthesis.

use super::found::Start;

/// Steps of a finer track for each of the study's.
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

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SearchPlan {
    /// Number of starts.
    pub starts: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Iterations of the search from one start.
    pub iterations: usize,
    /// Seconds: after most of them no start is begun, and after it searches end.
    pub limit: Option<f64>,
    /// Where searches may start.
    pub from: From,
    /// Worker threads.
    pub threads: usize,
}

/// What is told while it goes on; `false` from `goes_on` ends it with the best so far.
pub struct Listener<'l> {
    /// A start is done: its number and what it found.
    pub done: &'l (dyn Fn(usize, &Start) + Sync),
    /// Whether to go on.
    pub goes_on: &'l (dyn Fn() -> bool + Sync),
}
