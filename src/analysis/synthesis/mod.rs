//! Synthesis: a study's objective made small from many starts by the minimax search, the best polished, and the result
//! proved by an independent motion. Starts are searched in batches of a fixed size, so that what a start finds does not
//! depend on the number of threads.

mod basins;
mod starts;
pub mod touching;
pub mod verify;

use crate::analysis::optimise::{Ended, Minimum, minimax};
use crate::analysis::study::{Evaluator, Family, FamilyError, Peaks, Refusals, Search};
use basins::Basins;
use starts::begin;
pub use starts::{Origin, Rejected};
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};
use touching::Touching;

/// Starts that are searched without knowing of each other.
const BATCH: usize = 4;

/// First radius of the trust region, as a share of the variables.
const RADIUS: f64 = 0.02;

/// Radius at which a search is over.
const SMALLEST_RADIUS: f64 = 1e-8;

/// A search is over when a step promises less than this share.
const PROMISE: f64 = 1e-9;

/// The best is polished with this many times the iterations of a start.
const POLISHING: usize = 3;

/// Violation of a limit, as a share of it, with which a minimum still counts.
const KEPT: f64 = 1e-6;

/// How often the best is polished at most: limits that it misses between the samples are drawn in each time.
const ROUNDS: usize = 4;

/// Steps of a finer track for each of the study's.
pub const FINER: usize = 4;

/// By how many times of what it is missed by a limit is drawn in.
const DRAWN_IN: f64 = 1.5;

/// What is asked for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plan {
    /// Number of starts.
    pub starts: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// Iterations of the search from one start.
    pub iterations: usize,
    /// After this time no start is begun, and searches end.
    pub limit: Option<Duration>,
    /// Whether the scene's own values are no start, and nothing is known but the box.
    pub blind: bool,
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
    /// All starts, then the polishings of the best.
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

/// Everything that the searches share.
struct Run<'r> {
    family: &'r Family,
    touching: Touching<'r>,
    plan: Plan,
    listener: &'r Listener<'r>,
    begun: Instant,
    least_sigma: f64,
    sizes: Vec<f64>,
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
    while starts.len() < plan.starts && (starts.is_empty() || run.goes_on()) {
        let batch = BATCH.min(plan.starts - starts.len());
        let found = run.batch(batch, &starts);
        starts.extend(found);
    }
    let searched = starts.len();
    let mut tightened = family.clone();
    for round in 0..ROUNDS {
        let best = match round {
            0 => best_of(&starts).cloned(),
            _ => starts.last().cloned(),
        };
        let Some(best) = best.filter(|_| round > 0 || run.goes_on()) else {
            break;
        };
        let Some(missed) = tighten(&mut tightened, &best) else {
            break;
        };
        if round > 0 && !missed {
            break;
        }
        let polished = run.polish(&tightened, &best);
        (listener.done)(starts.len(), &polished);
        starts.push(polished);
    }
    let stopped = !run.goes_on();
    // The last one keeps its limits between the samples, too.
    let last = starts.last().filter(|s| s.value().is_finite());
    let best = last.or_else(|| best_of(&starts)).cloned();
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

/// The family at found values; the scene's start values choose the assembly, but those of the found one do better.
fn standing(family: &Family, found: &Start, values: &[f64]) -> Family {
    let mut family = family.with_start(values);
    if let Some(unknowns) = &found.unknowns {
        family.mechanism.guess.clone_from(unknowns);
    }
    family
}

/// Draws the limits that a found mechanism misses between the samples in by what they are missed by; whether there were
/// any. `None` where that cannot be said.
fn tighten(family: &mut Family, found: &Start) -> Option<bool> {
    let values = found.minimum.as_ref()?.x.clone();
    let fine = standing(family, found, &values).with_finer_tracks(FINER);
    let mut evaluator = Evaluator::new(&fine);
    let stand = evaluator.nominal(fine.nominal().ok()?.poses);
    let measures = evaluator.measure(&stand).ok()?.measures;
    let asked = &family.study.limits;
    let mut missed = false;
    for (index, [min, max]) in asked {
        let (value, measure) = (measures[*index], &mut family.mechanism.measures[*index]);
        if let (Some(max), Some(present)) = (max, &mut measure.max)
            && value > *max
        {
            *present -= DRAWN_IN * (value - max);
            missed = true;
        }
        if let (Some(min), Some(present)) = (min, &mut measure.min)
            && value < *min
        {
            *present += DRAWN_IN * (min - value);
            missed = true;
        }
    }
    Some(missed)
}

fn best_of(starts: &[Start]) -> Option<&Start> {
    let found = starts.iter().filter(|s| s.minimum.is_some());
    found.min_by(|a, b| a.value().total_cmp(&b.value()))
}

impl Run<'_> {
    fn goes_on(&self) -> bool {
        let in_time = self.plan.limit.is_none_or(|l| self.begun.elapsed() < l);
        in_time && (self.listener.goes_on)()
    }

    /// The next `count` starts, shared among the threads; all of them know of the starts `before` them only.
    fn batch(&self, count: usize, before: &[Start]) -> Vec<Start> {
        let first = before.len();
        let mut basins = Basins::new(before, &self.sizes);
        let origins: Vec<Origin> = (first..first + count)
            .map(|index| match basins.next(index) {
                _ if index == 0 && !self.plan.blind => Origin::Scene,
                Some(near) => Origin::Near(near),
                None => Origin::Random,
            })
            .collect();
        let next = AtomicUsize::new(0);
        let found: Mutex<Vec<(usize, Start)>> = Mutex::new(Vec::new());
        let work = || {
            loop {
                let index = next.fetch_add(1, Ordering::Relaxed);
                let Some(origin) = origins.get(index) else {
                    return;
                };
                let start = self.start(*origin, (first + index) as u64, before);
                (self.listener.done)(first + index, &start);
                let mut found = found.lock().unwrap_or_else(|e| e.into_inner());
                found.push((index, start));
            }
        };
        std::thread::scope(|scope| {
            for _ in 0..self.plan.threads.clamp(1, count) {
                scope.spawn(work);
            }
        });
        let mut found = found.into_inner().unwrap_or_else(|e| e.into_inner());
        found.sort_by_key(|(index, _)| *index);
        found.into_iter().map(|(_, start)| start).collect()
    }

    /// The best start's search taken up again with more iterations.
    fn polish(&self, family: &Family, best: &Start) -> Start {
        let x = best
            .minimum
            .as_ref()
            .map(|m| m.x.clone())
            .unwrap_or_default();
        let iterations = POLISHING * self.plan.iterations;
        let clock = Instant::now();
        let family = standing(family, best, &x);
        let Ok(nominal) = family.nominal() else {
            return best.clone();
        };
        let stand = Evaluator::new(&family).nominal(nominal.poses);
        let begun = starts::Begun { family, stand };
        let mut start = self.descend(best.origin, begun, iterations);
        start.seconds = clock.elapsed().as_secs_f64();
        start
    }

    fn start(&self, origin: Origin, item: u64, before: &[Start]) -> Start {
        let clock = Instant::now();
        let ended = || !self.goes_on();
        let near = match origin {
            Origin::Near(index) => before[index].minimum.as_ref().map_or(&[][..], |m| &m.x),
            _ => &[],
        };
        let drawn = (origin, self.plan.seed, item);
        let (begun, rejected) = begin(self.family, self.touching, drawn, near, &self.sizes, &ended);
        let mut start = match begun {
            Some(begun) => self.descend(origin, begun, self.plan.iterations),
            None => Start::none(origin),
        };
        start.rejected = rejected;
        start.seconds = clock.elapsed().as_secs_f64();
        start
    }

    fn descend(&self, origin: Origin, begun: starts::Begun, iterations: usize) -> Start {
        let family = &begun.family;
        let watch = |_: usize, _: &[f64], _: f64| self.goes_on();
        let blank = Start::none(origin);
        let evaluator = Evaluator::new(family);
        let first = evaluator.measure(&begun.stand).ok().and_then(|m| {
            let objective = family.study.objective?;
            m.measures.get(objective).copied()
        });
        let Some(first) = first else { return blank };
        let Ok(peaks) = Peaks::new(family, evaluator, begun.stand, Box::new(watch)) else {
            return blank;
        };
        let guard = |stand: &crate::analysis::study::Stand| {
            self.touching.depth(family, &stand.values, &stand.poses)
        };
        let mut peaks = peaks
            .with_least_sigma(self.least_sigma)
            .guarded_by(Box::new(guard));
        let bounds = peaks.bounds();
        let search = minimax::Search {
            radius: RADIUS,
            smallest_radius: SMALLEST_RADIUS,
            tolerance: PROMISE,
            iterations,
        };
        let minimum = minimax::minimise(&mut peaks, &family.start(), &self.sizes, &bounds, search);
        let found = minimum.value.is_finite();
        Start {
            first,
            refusals: peaks.refusals,
            interpenetrating: peaks.guarded,
            unknowns: peaks.unknowns_at_start(),
            excess: peaks.excess(),
            minimum: found.then_some(minimum),
            ..blank
        }
    }
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
