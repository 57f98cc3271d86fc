//! Wall time per stage, for `--timings`.

use super::Term;
use std::time::Instant;

/// Measures the time of each stage.
pub struct Clock {
    wanted: bool,
    start: Instant,
    laps: Vec<(&'static str, f64)>,
}

impl Clock {
    /// Starts it; `wanted` if it is to be printed at the end.
    pub fn new(wanted: bool) -> Self {
        Self {
            wanted,
            start: Instant::now(),
            laps: Vec::new(),
        }
    }

    /// Ends a stage.
    pub fn end_stage(&mut self, stage: &'static str) {
        let now = Instant::now();
        self.laps.push((stage, (now - self.start).as_secs_f64()));
        self.start = now;
    }

    /// Prints all stages and their sum.
    pub fn print(&self, term: &Term) {
        if !self.wanted {
            return;
        }
        for (stage, seconds) in &self.laps {
            term.note(&format!("{:>9.1} ms  {stage}", seconds * 1e3));
        }
        let total: f64 = self.laps.iter().map(|(_, s)| s).sum();
        term.note(&format!("{:>9.1} ms  in all", total * 1e3));
    }
}
