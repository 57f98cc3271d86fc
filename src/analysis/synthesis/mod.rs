//! Synthesis: a study's objective made small from many starts by the minimax search, the best polished, and the result
//! proved by an independent motion. What is asked, what is answered, and the order of its stages.

mod basins;
mod polishing;
mod searches;
mod starts;
pub mod touching;
pub mod verify;

use crate::analysis::optimise::{Ended, Minimum};
use crate::analysis::study::{Evaluator, Family, FamilyError, Peaks, Refusals, Search};
use searches::{Phase, Run};
pub use starts::{Origin, Rejected};
use std::time::{Duration, Instant};
use touching::Touching;

/// Violation of a limit, as a share of it, with which a minimum still counts.
const KEPT: f64 = 1e-6;

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
pub struct Plan {
    /// Number of starts.
    pub starts: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Iterations of the search from one start.
    pub iterations: usize,
    /// After most of this time no start is begun, and after it searches end.
    pub limit: Option<Duration>,
    /// Where searches may start.
    pub from: From,
    /// Worker threads.
    pub threads: usize,
}

/// What became of one start.
#[derive(Clone, Debug, PartialEq)]
pub struct Start {
    /// Where it was.
    pub origin: Origin,
    /// The objective there; NaN where no draw moved.
    pub first: f64,
    /// The minimum; `None` where no draw moved.
    pub minimum: Option<Minimum>,
    /// Draws that were rejected before it.
    pub rejected: Rejected,
    /// Candidates that were refused: not reached or without a value, and interpenetrating.
    pub refusals: Refusals,
    /// The second kind.
    pub interpenetrating: usize,
    /// Wall time.
    pub seconds: f64,
    /// The largest missed limit, as a share of it.
    pub excess: f64,
    /// Unknowns at the start of the drive, where a track begins there.
    unknowns: Option<Vec<f64>>,
}

impl Start {
    /// A start without a minimum.
    fn none(origin: Origin) -> Self {
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

    /// The objective found; infinite where there is none, or where limits are not kept.
    pub fn value(&self) -> f64 {
        let kept = self.minimum.as_ref().filter(|_| self.excess <= KEPT);
        kept.map_or(f64::INFINITY, |m| m.value)
    }
}

/// What a synthesis found.
#[derive(Clone, Debug, PartialEq)]
pub struct Synthesis {
    /// All starts, then the polishings of the best ones.
    pub starts: Vec<Start>,
    /// How many of them are no polishing.
    pub searched: usize,
    /// Values of the variables, in internal units.
    pub best: Vec<f64>,
    /// Unknowns at the start of the drive with them, where known: start values that choose this assembly.
    pub unknowns: Option<Vec<f64>>,
    /// The objective.
    pub value: f64,
    /// It was told to stop, or out of time.
    pub stopped: bool,
    /// Wall time.
    pub seconds: f64,
}

impl Synthesis {
    /// Poses of all tracks that were asked for, over all starts: evaluations and gradients.
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

/// What is told while it goes on; `false` from `goes_on` ends it with the best so far.
pub struct Listener<'l> {
    /// A start is done: its number and what it found.
    pub done: &'l (dyn Fn(usize, &Start) + Sync),
    /// Whether to go on.
    pub goes_on: &'l (dyn Fn() -> bool + Sync),
}

/// Searches the study of `family` from many starts.
///
/// # Errors
/// A study that is not of the form minimax searches, without bounds, or that does not move with the file's own values.
pub fn synthesise(
    family: &Family,
    touching: Touching,
    plan: Plan,
    listener: &Listener,
) -> Result<Synthesis, FamilyError> {
    let mut evaluator = Evaluator::new(family);
    let own = evaluator.nominal(family.nominal()?.poses);
    let search = Search::new(family, Box::new(|_, _, _| true))?;
    let bounds = search.bounds();
    if !bounds
        .lower
        .iter()
        .chain(&bounds.upper)
        .all(|b| b.is_finite())
    {
        let message = "synthesis searches a box: give every variable a range";
        return Err(FamilyError::Lacks(message.to_owned()));
    }
    let peaks = Peaks::new(family, evaluator, own, Box::new(|_, _, _| true))?;
    let run = Run {
        family,
        touching,
        plan,
        listener,
        begun: Instant::now(),
        least_sigma: peaks.least_sigma(),
        sizes: search.scales(),
    };
    let mut starts: Vec<Start> = Vec::with_capacity(plan.starts + 1);
    while starts.len() < plan.starts && (starts.is_empty() || run.goes_on(Phase::Searching)) {
        let found = run.batch(&starts, plan.starts - starts.len());
        starts.extend(found);
    }
    let searched = starts.len();
    let stopped = !run.goes_on(Phase::Searching);
    let best = polishing::finish(&run, &mut starts);
    let Some((best, minimum)) = best.and_then(|b| b.minimum.clone().map(|m| (b, m))) else {
        let mut rejected = Rejected::default();
        starts.iter().for_each(|s| rejected.add(s.rejected));
        return Err(FamilyError::Lacks(format!(
            "no start moves: of {} draws {} do not assemble, {} do not move along the tracks, {} interpenetrate",
            rejected.count(),
            rejected.not_assembled,
            rejected.not_moving,
            rejected.interpenetrating
        )));
    };
    Ok(Synthesis {
        best: minimum.x,
        unknowns: best.unknowns,
        value: minimum.value,
        searched,
        stopped,
        seconds: run.begun.elapsed().as_secs_f64(),
        starts,
    })
}

/// The end of a search in words.
pub const fn ended(ended: Ended) -> &'static str {
    match ended {
        Ended::Converged => "converged",
        Ended::Stalled => "stuck",
        Ended::OutOfBudget => "iterations used up",
        Ended::Stopped => "stopped",
    }
}
