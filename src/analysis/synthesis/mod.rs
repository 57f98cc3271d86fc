//! Synthesis: a study's objective is minimised from many starts by the minimax search, the best minima are polished,
//! and the result is verified by an independent motion. This file determines the order of the stages.

mod basins;
mod found;
mod plan;
mod polishing;
mod searches;
mod starts;
pub mod target;
pub mod touching;
pub mod verify;

use crate::analysis::study::{Evaluator, FamilyError, ParametricMechanism, Peaks, StudySearch};
pub use found::{FinishedStart, Synthesis, ending_word};
pub use plan::{FINER, From, Listener, SearchPlan};
use searches::{Phase, SynthesisRun};
pub use starts::{Rejected, StartOrigin};
use std::time::Instant;
use touching::Touching;

/// Searches the study of `family` from many starts.
///
/// # Errors
/// A study that minimax cannot minimise, or without bounds, or that cannot move with the file's own values.
pub fn synthesise_path(
    family: &ParametricMechanism,
    touching: Touching,
    plan: SearchPlan,
    listener: &Listener,
) -> Result<Synthesis, FamilyError> {
    let mut evaluator = Evaluator::new(family);
    let own = evaluator.nominal(family.nominal()?.poses);
    let search = StudySearch::new(family, Box::new(|_, _, _| true))?;
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
    let run = SynthesisRun {
        family,
        touching,
        plan,
        listener,
        begun: Instant::now(),
        least_sigma: peaks.least_sigma(),
        sizes: search.scales(),
    };
    // Starts in batches until there are enough or the time for searching is over.
    let mut starts: Vec<FinishedStart> = Vec::with_capacity(plan.starts + 1);
    while starts.len() < plan.starts && (starts.is_empty() || run.goes_on(Phase::Searching)) {
        let found = run.batch(&starts, plan.starts - starts.len());
        starts.extend(found);
    }
    // The best of them are polished.
    let searched = starts.len();
    let stopped = !run.goes_on(Phase::Searching);
    let best = polishing::finish_polishing(&run, &mut starts);
    let Some((best, minimum)) = best.and_then(|b| b.minimum.clone().map(|m| (b, m))) else {
        let mut rejected = Rejected::default();
        starts.iter().for_each(|s| rejected.add(s.rejected));
        return Err(FamilyError::Lacks(format!(
            "no start can be followed: of {} draws {} cannot be assembled, {} cannot be followed along the tracks, {} interpenetrate",
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
