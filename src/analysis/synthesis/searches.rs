//! Searches from many starts, in batches of a fixed size: the result of a start does not depend on the number of
//! threads.

use super::basins::Basins;
use super::found::FinishedStart;
use super::plan::{From, Listener, SearchPlan};
use super::starts::{MovingStart, StartOrigin, begin_starts};
use super::touching::Touching;
use crate::analysis::optimise::minimax;
use crate::analysis::study::{Evaluator, ParametricMechanism, Peaks, TrackPoses};
use crate::jobs::share_work;
use std::time::Instant;

/// Number of starts that are searched independently of each other.
const BATCH: usize = 4;

/// First radius of the trust region, as a fraction of the variables: with 0.02 narrow valleys take many more steps.
const RADIUS: f64 = 0.1;

/// Radius at which a search is over.
const SMALLEST_RADIUS: f64 = 1e-8;

/// A search ends when the predicted decrease is below this fraction.
const PROMISE: f64 = 1e-9;

/// Share of the time for searching; the rest is for polishing.
const SEARCHING: f64 = 0.75;

/// The purpose of a search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Phase {
    /// One start among many.
    Searching,
    /// More patience with one of the best.
    Polishing,
    /// Keeping limits between the samples: short, and needed for any result.
    DrawingIn,
}

/// Everything that the searches share.
pub struct SynthesisRun<'r> {
    pub family: &'r ParametricMechanism,
    pub touching: Touching<'r>,
    pub plan: SearchPlan,
    pub listener: &'r Listener<'r>,
    pub begun: Instant,
    pub least_sigma: f64,
    pub sizes: Vec<f64>,
}

impl SynthesisRun<'_> {
    /// Whether a phase has time left and was not cancelled.
    pub fn goes_on(&self, phase: Phase) -> bool {
        let share = match phase {
            Phase::Searching => SEARCHING,
            Phase::Polishing => 1.0,
            Phase::DrawingIn => f64::INFINITY,
        };
        let limit = self.plan.limit.unwrap_or(f64::INFINITY);
        self.begun.elapsed().as_secs_f64() < share * limit && (self.listener.goes_on)()
    }

    /// The next starts, at most `most`; each uses only the results of the starts `before` them.
    pub fn batch(&self, before: &[FinishedStart], most: usize) -> Vec<FinishedStart> {
        let first = before.len();
        let mut basins = Basins::new(before, &self.sizes);
        let origins: Vec<StartOrigin> = (first..first + most.min(BATCH))
            .map_while(|index| self.origin(index, &mut basins))
            .collect();
        self.shared(first, origins.len(), &|index| {
            self.start(origins[index], (first + index) as u64, before)
        })
    }

    /// Where start `index` begins; `None` if it must wait for a minimum.
    fn origin(&self, index: usize, basins: &mut Basins) -> Option<StartOrigin> {
        let from = self.plan.from;
        if index == 0 && from != From::Random {
            return Some(StartOrigin::Scene);
        }
        // Every other start is a random one.
        let may_be_near = from == From::Scene || index.is_multiple_of(2);
        match may_be_near.then(|| basins.next()).flatten() {
            Some(near) => Some(StartOrigin::Near(near)),
            None if from == From::Scene => None,
            None => Some(StartOrigin::Random),
        }
    }

    /// Work on `count` starts from number `first` on, shared among the threads.
    pub fn shared(
        &self,
        first: usize,
        count: usize,
        one: &(dyn Fn(usize) -> FinishedStart + Sync),
    ) -> Vec<FinishedStart> {
        let threads = self.plan.threads;
        let found = share_work(
            count,
            threads,
            || (),
            |(), index| {
                let start = one(index);
                (self.listener.done)(first + index, &start);
                Some(start)
            },
        );
        found.into_iter().map(|(_, start)| start).collect()
    }

    fn start(&self, origin: StartOrigin, item: u64, before: &[FinishedStart]) -> FinishedStart {
        let clock = Instant::now();
        let ended = || !self.goes_on(Phase::Searching);
        // The first one is needed for any result.
        if item > 0 && ended() {
            return FinishedStart::none(origin);
        }
        let near = match origin {
            StartOrigin::Near(index) => before[index].minimum.as_ref().map_or(&[][..], |m| &m.x),
            _ => &[],
        };
        let drawn = (origin, self.plan.seed, item);
        let (begun, rejected) =
            begin_starts(self.family, self.touching, drawn, near, &self.sizes, &ended);
        let mut start = match begun {
            Some(begun) => {
                let how = (Phase::Searching, self.plan.iterations);
                self.descend(origin, begun, how)
            }
            None => FinishedStart::none(origin),
        };
        start.rejected = rejected;
        start.seconds = clock.elapsed().as_secs_f64();
        start
    }

    /// The minimum reached from the start `begun`.
    pub fn descend(
        &self,
        origin: StartOrigin,
        begun: MovingStart,
        (phase, iterations): (Phase, usize),
    ) -> FinishedStart {
        let family = &begun.family;
        let goes_on = || self.goes_on(phase);
        let watch = |_: usize, _: &[f64], _: f64| true;
        let blank = FinishedStart::none(origin);
        let evaluator = Evaluator::new(family);
        // The objective where the search begins.
        let first = evaluator
            .measure_sought(&begun.track_poses)
            .ok()
            .and_then(|m| {
                let objective = family.study.objective?;
                m.measures.get(objective).copied()
            });
        let Some(first) = first else { return blank };
        let Ok(peaks) = Peaks::new(family, evaluator, begun.track_poses, Box::new(watch)) else {
            return blank;
        };
        // A point is rejected if bodies penetrate that may only touch.
        let guard = |track_poses: &TrackPoses| {
            self.touching
                .depth(family, &track_poses.values, &track_poses.poses)
        };
        let mut peaks = peaks
            .with_least_sigma(self.least_sigma)
            .guarded_by(Box::new(guard))
            .while_it(&goes_on);
        let bounds = peaks.bounds();
        let search = minimax::MinimaxSearch {
            radius: RADIUS,
            smallest_radius: SMALLEST_RADIUS,
            tolerance: PROMISE,
            iterations,
        };
        let minimum =
            minimax::minimise_largest(&mut peaks, &family.start(), &self.sizes, &bounds, search);
        let found = minimum.value.is_finite();
        FinishedStart {
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
