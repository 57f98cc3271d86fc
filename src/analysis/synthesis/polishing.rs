//! The end of a synthesis: the best minima are searched further, and limits that are violated between the samples are
//! tightened.

use super::basins::Basins;
use super::found::FinishedStart;
use super::plan::FINER;
use super::searches::{Phase, SynthesisRun};
use super::starts::MovingStart;
use crate::analysis::study::{Evaluator, ParametricMechanism};
use crate::sorting::sort_by_number;
use std::time::Instant;

/// Number of basins whose best minimum is polished.
const FINALISTS: usize = 4;

/// Polishing uses this many times the iterations of a start.
const PATIENCE: usize = 40;

/// Tightening a limit moves a minimum only a little; it may take this many times as long.
const PATIENCE_DRAWING_IN: usize = 4;

/// Maximum number of times that limits violated between the samples are tightened.
const ROUNDS: usize = 4;

/// A limit is tightened by this multiple of its violation.
const DRAWN_IN: f64 = 1.5;

/// Polishes the best of `starts` and appends the results; returns the best one that keeps its limits between the
/// samples or, if none does, at them.
pub fn finish_polishing(
    run: &SynthesisRun,
    starts: &mut Vec<FinishedStart>,
) -> Option<FinishedStart> {
    let mut finalists: Vec<FinishedStart> = Basins::new(starts, &run.sizes)
        .best(FINALISTS)
        .map(|k| starts[k].clone())
        .collect();
    if finalists.is_empty() {
        // No minimum keeps its limits yet: further iterations may.
        let moving = starts.iter().filter(|start| start.minimum.is_some());
        let nearest = moving.min_by(|a, b| a.excess.total_cmp(&b.excess));
        finalists.extend(nearest.cloned());
    }
    if run.goes_on(Phase::Polishing) {
        let polished = run.shared(starts.len(), finalists.len(), &|k| {
            polish_start(run, run.family, &finalists[k], Phase::Polishing)
        });
        starts.extend(polished);
    }
    let mut order: Vec<FinishedStart> = starts
        .iter()
        .filter(|s| s.value().is_finite())
        .cloned()
        .collect();
    sort_by_number(&mut order, |a| a.value());
    order.truncate(FINALISTS);
    let kept = order.iter().find_map(|start| drawn_in(run, start, starts));
    kept.or_else(|| order.first().cloned())
        .or_else(|| starts.iter().find(|s| s.minimum.is_some()).cloned())
}

/// The start with its limits kept between the samples; `None` if that fails.
fn drawn_in(
    run: &SynthesisRun,
    start: &FinishedStart,
    starts: &mut Vec<FinishedStart>,
) -> Option<FinishedStart> {
    let (mut family, mut best) = (run.family.clone(), start.clone());
    for _ in 0..ROUNDS {
        // Measuring finer tracks also takes time.
        if !run.goes_on(Phase::DrawingIn) {
            return None;
        }
        if !tighten_bounds(&mut family, run.family, &best)? {
            return Some(best);
        }
        best = polish_start(run, &family, &best, Phase::DrawingIn);
        (run.listener.done)(starts.len(), &best);
        starts.push(best.clone());
    }
    (run.goes_on(Phase::DrawingIn) && !tighten_bounds(&mut family, run.family, &best)?)
        .then_some(best)
}

/// Continues the search of a start with more iterations, under the limits of `family`.
fn polish_start(
    run: &SynthesisRun,
    family: &ParametricMechanism,
    start: &FinishedStart,
    phase: Phase,
) -> FinishedStart {
    let clock = Instant::now();
    // Nothing to polish: no time, no assembly, or a gap in a track.
    let family = standing_family(family, start).filter(|_| run.goes_on(phase));
    let Some(family) = family else {
        return start.clone();
    };
    let Ok(nominal) = family.nominal() else {
        return start.clone();
    };
    let track_poses = Evaluator::new(&family).nominal(nominal.poses);
    let begun = MovingStart {
        family,
        track_poses,
    };
    let patience = match phase {
        Phase::DrawingIn => PATIENCE_DRAWING_IN,
        Phase::Searching | Phase::Polishing => PATIENCE,
    };
    let how = (phase, patience * run.plan.iterations);
    let mut polished = run.descend(start.origin, begun, how);
    polished.seconds = clock.elapsed().as_secs_f64();
    polished
}

/// The family at the values found. The assembly is selected by the scene's start values, but more reliably by those
/// found.
fn standing_family(
    family: &ParametricMechanism,
    found: &FinishedStart,
) -> Option<ParametricMechanism> {
    let mut family = family.with_start(&found.minimum.as_ref()?.x);
    if let Some(unknowns) = &found.unknowns {
        family.actuation.guess.clone_from(unknowns);
    }
    Some(family)
}

/// Tightens the limits of `family` that a found mechanism violates between the samples, by its violation of those of
/// `asked`; returns whether there were any, `None` if unknown.
fn tighten_bounds(
    family: &mut ParametricMechanism,
    asked: &ParametricMechanism,
    found: &FinishedStart,
) -> Option<bool> {
    // Measured on finer tracks and at the extremes along the drive: the violations between the samples of the study.
    let standing = standing_family(asked, found)?;
    let finer = standing.with_finer_tracks(FINER).with_extremes().ok()?;
    let mut evaluator = Evaluator::new(&finer);
    let track_poses = evaluator.nominal(finer.nominal().ok()?.poses);
    let measures = evaluator.measure_sought(&track_poses).ok()?.measures;
    // Those that depend on the number of poses have no others.
    let inputs = asked.mechanism().inputs.len();
    let counted = asked.measures.depend_on_count(inputs);
    let mut missed = false;
    // Each violated limit is tightened by a multiple of its violation.
    let tightened = family.measures.list.iter_mut().zip(&asked.measures.list);
    let judged = tightened.zip(counted).zip(measures);
    for (((measure, asked), _), value) in judged.filter(|((_, counted), _)| !counted) {
        if let (Some(max), Some(present)) = (asked.max, &mut measure.max)
            && value > max
        {
            *present -= DRAWN_IN * (value - max);
            missed = true;
        }
        if let (Some(min), Some(present)) = (asked.min, &mut measure.min)
            && value < min
        {
            *present += DRAWN_IN * (min - value);
            missed = true;
        }
    }
    Some(missed)
}
