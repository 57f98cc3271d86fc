//! From one sample to the next: start, continuation, end and resumption of the motion.

use super::events::Events;
use super::gaps::Gaps;
use crate::kinematics::certificate::Certifier;
use crate::kinematics::certificate::absence::has_no_pose;
use crate::kinematics::certificate::regular::RegularPoses;
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, PathTracker, Stop};
use crate::kinematics::motion::tracker::steps::StepBudget;
use crate::kinematics::results::passed::PassedPoses;
use crate::kinematics::results::trajectory::{Ending, EventKind, Sample, Trajectory};
use crate::kinematics::solve::assembly::smallest_gap;
use crate::kinematics::solve::branch::BranchState;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Kind;
use crate::model::printed::InputReading;
use glam::DVec3;

/// Condition above which the first pose is called singular: a pose where assemblies meet is found to half of the
/// digits, which leaves a condition of about 1e8.
pub(crate) const SINGULAR_START: f64 = 1e7;

/// Axes at a smaller angle (radians) count as parallel: a pose at which they are is double, and found to half its digits.
const PARALLEL: f64 = 1e-6;

/// Steps are small against the time between two samples. In a closer look samples may be so near to each other that such steps could
/// not be told apart: there they are small against this fraction of the motion.
const LEAST_INTERVAL: f64 = 1e-6;

/// Most singular poses through which a motion is followed back.
pub(super) const MOST_WAYS_ON: usize = 10_000;

/// A pose beyond the end of the steps.
pub(super) struct PathContinuation {
    /// The pose.
    pub to: PathPoint,
    /// A singular pose lies between, even if no sign shows it.
    pub is_passed: bool,
}

/// Follows a motion and stores its samples.
pub(crate) struct Recorder<'s> {
    pub(crate) tracker: PathTracker<'s>,
    pub(crate) events: Events,
    pub(crate) gaps: Gaps,
    pub(crate) samples: Vec<Sample>,
    pub(crate) proof: Option<(Certifier<'s>, InputReading)>,
    /// Whether the motion after a gap is not needed.
    pub(super) ends_at_gap: bool,
    /// The poses at which the motion ends and resumes, on request.
    pub(super) edges: Option<Vec<Sample>>,
    /// Seconds between two samples, at least.
    least_interval: f64,
}

impl<'s> Recorder<'s> {
    pub fn new(
        system: &'s System,
        actuation: &'s Actuation,
        cancelled: &'s dyn Fn() -> bool,
    ) -> Self {
        Self {
            tracker: PathTracker::new(system, actuation, cancelled),
            events: Events::default(),
            gaps: Gaps::default(),
            samples: Vec::new(),
            proof: None,
            ends_at_gap: false,
            edges: None,
            least_interval: 0.0,
        }
    }

    /// With a certificate of every pose, at its inputs as they are read, and the poses between them.
    pub fn proving(mut self, reading: InputReading) -> Self {
        self.proof = Some((Certifier::new(self.tracker.system()), reading));
        self.events.passed = Some(PassedPoses::default());
        self
    }

    /// With additional samples where the motion ends and resumes.
    pub fn with_edges(mut self) -> Self {
        self.edges = Some(Vec::new());
        self
    }

    /// With samples that may be as near to each other as times can be told apart, in so many steps at most.
    pub fn looking_closer(mut self, steps: usize) -> Self {
        self.tracker.budget = StepBudget::of_steps(steps);
        self.least_interval = LEAST_INTERVAL * self.tracker.actuation().duration;
        self
    }

    /// Without the motion after the first gap.
    pub fn up_to_gaps(mut self) -> Self {
        self.ends_at_gap = true;
        self
    }

    /// Largest rotation of an input from one sample to the next, in radians.
    fn turned(&self, before: Option<f64>, time: f64) -> f64 {
        let actuation = self.tracker.actuation();
        let Some(before) = before else {
            return 0.0;
        };
        let inputs = self.tracker.system().mechanism().inputs.iter();
        let ends = [before, time].map(|time| actuation.inputs_at(time));
        let ways = inputs.zip(ends[0].iter().zip(&ends[1]));
        let angles = ways.filter(|(input, _)| input.kind == Kind::Angle);
        angles.map(|(_, (a, b))| (b - a).abs()).fold(0.0, f64::max)
    }

    pub fn run(mut self, times: &[f64]) -> Trajectory {
        let mut last: Option<PathPoint> = None;
        let mut lost = false;
        let duration = self.tracker.actuation().duration;
        for (index, &time) in times.iter().enumerate() {
            if self.tracker.is_cancelled() {
                break;
            }
            // Every sample has its own budget of steps.
            self.tracker.interval = match index.checked_sub(1) {
                Some(before) => (time - times[before]).abs(),
                None => duration,
            };
            self.tracker.interval = self.tracker.interval.max(self.least_interval);
            self.tracker.solver.iterations = 0;
            let before = index.checked_sub(1).map(|before| times[before]);
            self.tracker.budget.refill(|| self.turned(before, time));
            // The first pose, the next one, or the first after a gap.
            let reached = match (&last, lost) {
                (None, _) => self.start(time),
                (Some(last), true) => self.resume(last.clone(), time),
                (Some(last), false) => self.advance(last.clone(), time),
            };
            match reached {
                Ok(new) => {
                    if let Some(passed) = &mut self.events.passed {
                        passed.forget_from(time);
                    }
                    self.record(&new);
                    last = Some(new);
                    lost = false;
                }
                Err(end) => {
                    self.record_missing(time);
                    if self.ends_at_gap {
                        break;
                    }
                    lost = true;
                    last = end.or(last);
                }
            }
        }
        self.gaps.measure(&self.tracker, self.proof.is_some());
        let mut samples = self.samples;
        let asked = samples.len();
        for edge in self.edges.into_iter().flatten() {
            let place = samples.partition_point(|s| s.time < edge.time);
            if samples.get(place).is_none_or(|s| s.time != edge.time) {
                samples.insert(place, edge);
            }
        }
        Trajectory {
            added: samples.len() - asked,
            samples,
            events: self.events.list,
            gaps: self.gaps.list,
            steps: self.tracker.budget.taken(),
            is_spent: self.tracker.budget.is_spent(),
            passed: self.events.passed.unwrap_or_default().into(),
            ..Trajectory::default()
        }
    }

    pub(crate) fn event(&mut self, time: f64, kind: EventKind) {
        self.events.add(self.tracker.actuation(), time, kind);
    }

    /// First pose, from the start values.
    fn start(&mut self, time: f64) -> Result<PathPoint, Option<PathPoint>> {
        let inputs = self.tracker.inputs(time).map_err(|index| {
            let proved = !self.tracker.actuation().drives[index].may_have_value(time);
            self.undefined(time, index, proved);
            None
        })?;
        let actuation = self.tracker.actuation();
        let start = [actuation.guess.clone(), inputs].concat();
        // Perturbed starts are worth their time once, not at every sample of a range without poses.
        let persist = self.samples.is_empty();
        let found = match persist {
            true => self
                .tracker
                .solver
                .assembled(&start, Some(&actuation.named)),
            false => self.assembled_from_beside(&start),
        };
        match found {
            Ok(found) => {
                self.tracker.solver.iterations += found.iterations;
                if found.start > 0 {
                    self.event(time, EventKind::OtherStart);
                }
                if persist {
                    self.note_parallel_axes(time, &found.coordinates);
                }
                let point = self.tracker.point(time, found.coordinates);
                if persist
                    && is_singular_start(&point.branch)
                    && !is_proved_regular(self.tracker.system(), &point.coordinates)
                {
                    self.event(time, EventKind::StartSingular);
                }
                // From here on branches are compared with this point.
                let point = self.tracker.keep(point, &mut self.events);
                if self.samples.is_empty() {
                    return Ok(point);
                }
                self.enter(point)
            }
            // No pose: is it proved that there is none, or was none found?
            Err(best) => {
                self.gaps.note_lack(&self.tracker, time, best.clone());
                let rounded = self.ending_by_rounding(&best.coordinates);
                if let Some(ending) = rounded.filter(|_| persist) {
                    self.gaps.give_up(ending.clone());
                    self.event(time, EventKind::MotionEnds(ending));
                } else if persist {
                    let given = best.coordinates[self.tracker.unknowns()..].to_vec();
                    let proved = has_no_pose(self.tracker.system(), &given);
                    if !proved {
                        self.gaps.give_up(Ending::NotFound);
                    }
                    let lack = smallest_gap(self.tracker.system(), best);
                    let kind = EventKind::StartNotClosed {
                        proved,
                        name: lack.name,
                        angle: lack.angle,
                        distance: lack.distance,
                    };
                    self.event(time, kind);
                }
                Err(None)
            }
        }
    }

    /// Reports cylinders that touch along a line although their axes were meant to cross.
    fn note_parallel_axes(&mut self, time: f64, pose: &[f64]) {
        let mechanism = self.tracker.system().mechanism();
        if mechanism.crossings.is_empty() {
            return;
        }
        let arguments = mechanism.argument_values(pose);
        for crossing in &mechanism.crossings {
            let axis = crossing.across.pose(&arguments).rotation.z_axis;
            if axis.cross(DVec3::Z).length() < PARALLEL {
                let contact = crossing.contact.clone();
                self.event(time, EventKind::AxesParallel { contact });
            }
        }
    }

    /// Reports once that an input has no value, and once more when that is proved.
    fn undefined(&mut self, time: f64, index: usize, proved: bool) {
        let name = self.tracker.system().mechanism().inputs[index].name.clone();
        let mut known = self.events.list.iter();
        let says_more = known.all(|e| {
            !matches!(&e.kind, EventKind::InputUndefined { name: n, proved: p } if *n == name && *p >= proved)
        });
        if says_more {
            self.event(time, EventKind::InputUndefined { proved, name });
        }
    }

    /// From the last sample to `time`, in as many steps as necessary.
    fn advance(&mut self, last: PathPoint, time: f64) -> Result<PathPoint, Option<PathPoint>> {
        let mut here = last;
        let given = &here.coordinates[self.tracker.unknowns()..];
        let is_same = self
            .tracker
            .actuation()
            .values_at(time)
            .eq(given.iter().copied());
        if is_same && !self.tracker.strays(&here, time, given) {
            return Ok(PathPoint { time, ..here });
        }
        if let Some(beyond) = self.leave_singular_start(&here, time) {
            here = beyond;
        }
        // Steps end at singular poses: beyond them the motion continues, or it ends here.
        for _ in 0..MOST_WAYS_ON {
            match self.tracker.follow(here, time, &mut self.events) {
                Ok(point) => return Ok(point),
                Err(Stop::Undefined {
                    input,
                    time: at,
                    last,
                }) => {
                    let [near, nearer, nearest] = self.beyond(last.time, time);
                    let ending = self.undefined_input(input, &[at, near, nearer, nearest]);
                    self.undefined(at, input, !ending.is_undecided());
                    return self.begin_gap(last.clone(), (last, ending), time);
                }
                Err(Stop::Ends(end)) if self.tracker.budget.is_spent() => {
                    let sigma_min = end.branch.sigma_min;
                    return self.end(end.clone(), (end, Ending::GivenUp { sigma_min }), time);
                }
                Err(Stop::Ends(end)) => match self.way_on(&end, time) {
                    Ok(PathContinuation { to, .. })
                        if to.time == time && !self.tracker.is_usable(&to.branch) =>
                    {
                        self.events.singular_sample = Some(time);
                        return Ok(to);
                    }
                    Ok(PathContinuation { to, is_passed }) => {
                        let is_other_side = to.branch.signs != end.branch.signs;
                        if (is_other_side || is_passed) && self.tracker.jump_after(&end).is_none() {
                            self.events.passed_at(&self.tracker, end.time);
                        }
                        here = self.tracker.keep(to, &mut self.events);
                    }
                    Err((at, ending)) => return self.end(end, (at, ending), time),
                },
            }
        }
        let sigma_min = here.branch.sigma_min;
        self.end(here.clone(), (here, Ending::GivenUp { sigma_min }), time)
    }

    /// The motion ends `at` the end of its path, unless it has only just begun there. Steps ended at `last`.
    fn end(
        &mut self,
        last: PathPoint,
        (at, ending): (PathPoint, Ending),
        time: f64,
    ) -> Result<PathPoint, Option<PathPoint>> {
        let has_steps = !self.tracker.budget.is_spent();
        if let Some(beyond) = has_steps.then(|| self.leave_start(&last, time)).flatten() {
            return Ok(beyond);
        }
        self.event(at.time, EventKind::MotionEnds(ending.clone()));
        self.begin_gap(last, (at, ending), time)
    }

    /// Behind the end of a motion: it is resumed, if that is possible before `time`.
    fn begin_gap(
        &mut self,
        last: PathPoint,
        (at, ending): (PathPoint, Ending),
        time: f64,
    ) -> Result<PathPoint, Option<PathPoint>> {
        if self.ends_at_gap {
            return Err(Some(last));
        }
        self.keep_edge(&at);
        self.gaps.open(&self.tracker, Some((at.time, ending)));
        if self.tracker.budget.is_spent() {
            return Err(Some(last));
        }
        // The drive may be feasible again before the next sample.
        self.resume(last, time)
    }
}

/// Whether a pose is proved to be regular, however small its singular value: the scale of an unknown may be far from its value.
fn is_proved_regular(system: &System, coordinates: &[f64]) -> bool {
    let mut poses = RegularPoses::new(system);
    poses.error_bound(coordinates).is_some()
}

/// Whether the first pose is singular. A single equation has no condition, and a singular value of its own.
pub(super) fn is_singular_start(branch: &BranchState) -> bool {
    branch.condition >= SINGULAR_START || branch.sigma_min * SINGULAR_START <= 1.0
}
