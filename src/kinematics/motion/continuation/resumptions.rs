//! Resumption after a gap.
//!
//! The motion is followed backwards from the pose that was found until it ends: the gap's end is located like its
//! beginning. A pose from which the motion can be followed back past the beginning of the gap belongs to another
//! assembly, which the motion cannot reach; continuing there would be a jump.

use super::gaps::gap_instant;
use super::recorder::Recorder;
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, Unwatched};
use crate::kinematics::motion::tracker::singular::SingularTarget;
use crate::kinematics::results::trajectory::{Ending, EventKind};
use crate::kinematics::solve::assembly::{Assembled, NotClosed, shake_start};

/// Displacement of start values, in scaled unknowns, if those of the last pose lead to no pose.
const ASIDE: f64 = 0.3;

/// Steps that a search at one sample after the end of a motion may cost: two descents.
const STEPS_OF_SEARCH: usize = 400;

impl Recorder<'_> {
    /// Assembles from `start`, and from displaced values if that fails: no correction leaves the line of collinear
    /// links.
    pub(crate) fn assembled_from_beside(&mut self, start: &[f64]) -> Result<Assembled, NotClosed> {
        let solver = &mut self.tracker.solver;
        let attempt = self.samples.len();
        solver.assembled(start, None).or_else(|gap| {
            let mut beside = start.to_vec();
            shake_start(solver.system().mechanism(), attempt, ASIDE, &mut beside);
            let found = solver.assembled(&beside, None).map_err(|_| gap)?;
            Ok(Assembled { start: 1, ..found })
        })
    }

    /// After a gap: assembles again from the last pose, without searching.
    pub(crate) fn resume(
        &mut self,
        last: PathPoint,
        time: f64,
    ) -> Result<PathPoint, Option<PathPoint>> {
        let Ok(inputs) = self.tracker.inputs(time) else {
            return Err(None);
        };
        if !self.tracker.budget.take_all(STEPS_OF_SEARCH) {
            self.gaps.give_up(Ending::NotFound);
            return Err(None);
        }
        let unknowns = &last.coordinates[..self.tracker.unknowns()];
        let start = [unknowns, &inputs].concat();
        // Any pose at this time, from the last one.
        match self.assembled_from_beside(&start) {
            Ok(found) => {
                self.tracker.solver.iterations += found.iterations;
                let point = self.tracker.point(time, found.coordinates);
                if self.gaps.is_known_elsewhere(&mut self.tracker, &point) {
                    return Err(None);
                }
                self.re_enter(&last, point)
            }
            Err(best) => {
                self.gaps.note_lack(&self.tracker, time, best);
                Err(None)
            }
        }
    }

    /// The first pose of a motion whose drive begins where there is none.
    pub(crate) fn enter(&mut self, found: PathPoint) -> Result<PathPoint, Option<PathPoint>> {
        let target = self.samples.first().map_or(found.time, |s| s.time);
        let (time, beginning) = match self.walk_back(&found, SingularTarget::Time(target)) {
            Some((first, beginning)) => {
                self.keep_edge(&first);
                (first.time, Some(beginning))
            }
            None => (found.time, None),
        };
        self.close_gap(&found, (time, beginning), true);
        Ok(self.restart(found))
    }

    /// Resumes the motion at `found`, on the branch of `last` if possible.
    fn re_enter(
        &mut self,
        last: &PathPoint,
        found: PathPoint,
    ) -> Result<PathPoint, Option<PathPoint>> {
        let gap = self.gaps.list.last();
        let began = gap.and_then(|g| g.from.as_ref()).map(|from| from.time);
        let target = match (began, self.samples.first()) {
            (Some(time), _) => SingularTarget::Gap(time),
            (None, first) => SingularTarget::Time(first.map_or(found.time, |s| s.time)),
        };
        // Back in time to where the motion begins.
        let Some((first, beginning)) = self.walk_back(&found, target) else {
            self.gaps.elsewhere = Some(found);
            return Err(None);
        };
        let wanted = &last.branch.signs;
        let found = if found.branch.signs == *wanted {
            found
        } else {
            let other = self.tracker.other_branch(&first, &found, wanted);
            other.unwrap_or(found)
        };
        let same_branch = found.branch.signs == *wanted;
        self.keep_edge(&first);
        self.close_gap(&found, (first.time, Some(beginning)), same_branch);
        Ok(self.restart(found))
    }

    fn close_gap(
        &mut self,
        found: &PathPoint,
        (time, beginning): (f64, Option<Ending>),
        same_branch: bool,
    ) {
        self.gaps.measure(&self.tracker, self.proof.is_some());
        let until = gap_instant(&self.tracker, time);
        if let Some(gap) = self.gaps.list.last_mut() {
            gap.until = Some(until);
            gap.beginning = beginning;
        }
        self.fill_back(found, time);
        self.event(time, EventKind::MotionResumes { same_branch });
    }

    /// Lost samples after the end of a gap have poses after all: the search from before the gap missed them.
    fn fill_back(&mut self, found: &PathPoint, time: f64) {
        let mut here = found.clone();
        for index in (0..self.samples.len()).rev() {
            let sample = &self.samples[index];
            if sample.pose.is_some() || sample.time < time {
                return;
            }
            // The branch is that of the pose found behind the gap.
            self.tracker.anchor = Some(here.clone());
            match self.tracker.follow(here, sample.time, &mut Unwatched) {
                Ok(point) => {
                    self.samples[index].pose = self.closed_pose(&point);
                    here = point;
                }
                Err(_) => return,
            }
        }
    }

    /// The motion continues from `point`; earlier poses no longer serve for comparison.
    fn restart(&mut self, point: PathPoint) -> PathPoint {
        self.tracker.anchor = None;
        self.events.crossing = None;
        self.events.singular_sample = None;
        self.tracker.keep(point, &mut self.events)
    }
}
