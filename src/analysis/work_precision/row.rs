//! The measurements of a route: its errors and its time.

use crate::analysis::routes::Route;
use std::time::Instant;

/// A run is repeated for this many seconds; the fastest run counts.
const ENOUGH: f64 = 0.03;

/// Most repetitions of a run.
const MOST_RUNS: usize = 20;

/// A pose that deviates by more than this fraction of the mechanism's size is another assembly, or lost.
const LOST: f64 = 0.25;

/// The measurements of one route.
#[derive(Clone, Debug, PartialEq)]
pub struct PrecisionRow {
    /// Name of the group it belongs to; a curve of the chart.
    pub family: &'static str,
    /// The route; `None` for the program's own solver, and for those that move the points of a linkage.
    pub route: Option<Route>,
    /// Steps over the whole motion.
    pub steps: usize,
    /// Microseconds per pose delivered.
    pub time: f64,
    /// Newton iterations per pose, summed over blocks.
    pub iterations: f64,
    /// Largest coordinate difference to the reference at the end of the motion, in the scene's unit.
    pub end_error: f64,
    /// The same, at the worst instant.
    pub error: f64,
    /// Largest closure error at any instant, relative to the size.
    pub closure: f64,
    /// Instants without a pose, or with one of another motion.
    pub lost: usize,
}

impl PrecisionRow {
    /// The row of a route with these errors at the instants after the start, of which there are `wanted`; those after a
    /// failure are missing. `size` is the mechanism's.
    pub(super) fn new(
        errors: &[f64],
        closures: impl Iterator<Item = f64>,
        (wanted, size): (usize, f64),
    ) -> Self {
        // An error of this size means another assembly, not inaccuracy.
        let limit = LOST * size;
        let strayed = errors.iter().filter(|e| **e > limit || e.is_nan()).count();
        // After a failure no poses follow, so that there is no error at the end.
        let last = errors.last().copied().filter(|_| errors.len() == wanted);
        Self {
            family: "",
            route: None,
            steps: 0,
            time: 0.0,
            iterations: 0.0,
            end_error: last.unwrap_or(f64::NAN),
            error: errors.iter().copied().fold(0.0, f64::max),
            closure: closures.fold(0.0, f64::max),
            lost: wanted - errors.len() + strayed,
        }
    }
}

/// The result of `run`, and the shortest time in seconds it took.
pub(super) fn fastest_run<T>(mut run: impl FnMut() -> T) -> (T, f64) {
    let begin = Instant::now();
    let mut result = run();
    let mut best = begin.elapsed().as_secs_f64();
    for _ in 1..MOST_RUNS {
        if begin.elapsed().as_secs_f64() > ENOUGH {
            break;
        }
        let start = Instant::now();
        result = run();
        best = best.min(start.elapsed().as_secs_f64());
    }
    (result, best)
}
