//! Following the motion along the drive on one assembly branch: predictor, corrector, step control, events.
//!
//! The drive is always evaluated at a time computed from the sample's own time, never accumulated. Single steps are
//! in `step`, what is kept of a pose in `record`, and what ball joints need in `gimbal`.

mod gaps;
mod gimbal;
mod leaps;
mod locate;
mod record;
mod step;

use crate::kinematics::ball::chart::Chart;
use crate::kinematics::certificate::Certifier;
use crate::kinematics::results::trajectory::{Event, EventKind, Trajectory};
use crate::kinematics::solve::assembly::{NotClosed, smallest_gap};
use crate::kinematics::solve::branch::{BranchState, BranchWatch};
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::predictor::Predictor;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;

/// Smallest step as a fraction of the interval between two samples: locates the end of a motion to about 1e-12
/// of that interval.
const SMALLEST_STEP: f64 = 1e-12;

/// A step that moves no unknown by more (radians, sizes) gets nowhere.
const CREEPING: f64 = 1e-7;

/// Most such steps in a row from one sample to the next: beyond this the motion has come to rest before a singular pose.
const MOST_CREEPING: usize = 1_000;

/// Condition above which the first pose is called singular: a pose where assemblies meet is found to half of the
/// digits, which leaves a condition of about 1e8.
const SINGULAR_START: f64 = 1e7;

/// Solves `system` along `actuation` at the given ascending times. A pose that does not exist is an event in the
/// trajectory.
pub fn solve(system: &System, actuation: &Actuation, times: &[f64]) -> Trajectory {
    Follower::new(system, actuation).run(times)
}

/// The same with certificates or without, which then say that nobody asked for them. Stops early, with the samples it
/// has, when `cancelled` says so.
pub fn solve_until(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
    proved: bool,
    cancelled: &dyn Fn() -> bool,
) -> Trajectory {
    let mut follower = Follower::new(system, actuation);
    follower.cancelled = cancelled;
    if !proved {
        follower.certifier = None;
    }
    follower.run(times)
}

/// [`solve`] without certificates of the poses.
pub fn solve_unproved(system: &System, actuation: &Actuation, times: &[f64]) -> Trajectory {
    solve_until(system, actuation, times, false, &|| false)
}

/// The motion without certificates, if it has no gap; ends at the first one.
pub fn solve_whole(system: &System, actuation: &Actuation, times: &[f64]) -> Option<Trajectory> {
    let mut follower = Follower::new(system, actuation);
    follower.certifier = None;
    follower.ends_at_gap = true;
    let motion = follower.run(times);
    let mut ends = motion.events.iter();
    let broken = ends.any(|e| matches!(e.kind, EventKind::MotionEnds));
    let all = motion.samples.len() == times.len() && motion.missing() == 0;
    (all && !broken).then_some(motion)
}

/// A regular or singular pose on the way, with what is needed to go on from it.
#[derive(Clone, Debug)]
struct Stand {
    time: f64,
    coordinates: Vec<f64>,
    branch: BranchState,
}

/// Why a step from one time to the next could not be made.
enum Stop {
    /// No pose beyond; the last good stand.
    Ends(Stand),
    /// The input has no value at this time.
    Undefined(usize, Stand),
}

struct Follower<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    cancelled: &'m dyn Fn() -> bool,
    /// Nobody asks what comes behind a gap.
    ends_at_gap: bool,
    corrector: Corrector,
    predictor: Predictor,
    watch: BranchWatch,
    certifier: Option<Certifier<'m>>,
    /// Another description of ball joints, used where their angles are nearly locked; `None` without such joints.
    chart: Option<Chart<'m>>,
    /// The stand before, as far as it is watched for locked angles.
    last_kept: Option<Stand>,
    /// The one before that.
    kept_before: Option<Stand>,
    /// Last pose that is well away from singular ones: where crossings start from.
    anchor: Option<Stand>,
    /// Time of a sample that lies on a singular pose, until it is known how the motion goes on.
    singular_sample: Option<f64>,
    /// Whether it is being found out if two poses are joined.
    is_judging: bool,
    /// A crossing that has been made and not been located yet.
    crossing: Option<locate::Crossing>,
    /// After the end of a motion: a pose of another assembly at the last sample, which the motion cannot reach.
    elsewhere: Option<Stand>,
    /// Of the samples of the present gap the one that is farthest from closing.
    widest: Option<(f64, NotClosed)>,
    best_sigma: f64,
    interval: f64,
    iterations: u32,
    trajectory: Trajectory,
}

impl<'m> Follower<'m> {
    fn new(system: &'m System, actuation: &'m Actuation) -> Self {
        Self {
            system,
            actuation,
            cancelled: &|| false,
            ends_at_gap: false,
            corrector: Corrector::new(system),
            predictor: Predictor::default(),
            watch: BranchWatch::default(),
            certifier: Some(Certifier::new(system)),
            chart: Chart::new(system),
            last_kept: None,
            kept_before: None,
            anchor: None,
            singular_sample: None,
            is_judging: false,
            crossing: None,
            elsewhere: None,
            widest: None,
            best_sigma: 0.0,
            interval: actuation.duration,
            iterations: 0,
            trajectory: Trajectory::default(),
        }
    }

    fn run(mut self, times: &[f64]) -> Trajectory {
        let mut stand: Option<Stand> = None;
        let mut lost = false;
        for (index, &time) in times.iter().enumerate() {
            if (self.cancelled)() {
                break;
            }
            self.interval = if index > 0 {
                (time - times[index - 1]).abs()
            } else {
                self.actuation.duration
            };
            self.iterations = 0;
            let reached = match (&stand, lost) {
                (None, _) => self.start(time),
                (Some(last), true) => self.resume(last.clone(), time),
                (Some(last), false) => self.advance(last.clone(), time),
            };
            match reached {
                Ok(new) => {
                    self.record(&new);
                    stand = Some(new);
                    lost = false;
                }
                Err(last) => {
                    self.record_missing(time);
                    if self.ends_at_gap {
                        break;
                    }
                    lost = true;
                    stand = last.or(stand);
                }
            }
        }
        self.measure_gap();
        self.trajectory
    }

    /// Inputs at `time`, or the index of one that has no value.
    fn inputs(&self, time: f64) -> Result<Vec<f64>, usize> {
        let inputs = self.actuation.inputs_at(time);
        match inputs.iter().position(|v| !v.is_finite()) {
            None => Ok(inputs),
            Some(index) => Err(index),
        }
    }

    fn event(&mut self, time: f64, kind: EventKind) {
        let inputs = self.actuation.inputs_at(time);
        self.trajectory.events.push(Event { time, inputs, kind });
    }

    fn undefined(&mut self, time: f64, index: usize) {
        let name = self.system.mechanism().inputs[index].name.clone();
        let known = self
            .trajectory
            .events
            .iter()
            .any(|e| matches!(&e.kind, EventKind::InputUndefined { name: n } if *n == name));
        if !known {
            self.event(time, EventKind::InputUndefined { name });
        }
    }

    /// First pose, from the start values.
    fn start(&mut self, time: f64) -> Result<Stand, Option<Stand>> {
        let inputs = self.inputs(time).map_err(|index| {
            self.undefined(time, index);
            None
        })?;
        let start = [self.actuation.guess.clone(), inputs].concat();
        // Perturbed starts are worth their time once, not at every sample of a range without poses.
        let persist = self.trajectory.samples.is_empty();
        let found = match persist {
            true => self.assembled(&start, true),
            false => self.assembled_from_beside(&start),
        };
        match found {
            Ok(found) => {
                self.iterations += found.iterations;
                if found.start > 0 {
                    self.event(time, EventKind::OtherStart);
                }
                let stand = self.stand(time, found.coordinates);
                if persist && stand.branch.condition >= SINGULAR_START {
                    self.event(time, EventKind::StartSingular);
                }
                let stand = self.keep(stand);
                if self.trajectory.samples.is_empty() {
                    return Ok(stand);
                }
                self.enter(stand)
            }
            Err(best) => {
                self.note_lack(time, best.clone());
                if persist {
                    let lack = smallest_gap(self.system, best);
                    let kind = EventKind::StartNotClosed {
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

    /// From the last sample to `time`, by as many steps as it takes.
    fn advance(&mut self, last: Stand, time: f64) -> Result<Stand, Option<Stand>> {
        let mut here = last;
        if self
            .inputs(time)
            .is_ok_and(|inputs| here.coordinates.ends_with(&inputs))
        {
            return Ok(Stand { time, ..here });
        }
        if let Some(beyond) = self.leave_singular_start(&here, time) {
            here = beyond;
        }
        loop {
            match self.follow(here, time) {
                Ok(stand) => return Ok(stand),
                Err(Stop::Undefined(index, stand)) => {
                    self.undefined(time, index);
                    return Err(Some(stand));
                }
                Err(Stop::Ends(stand)) => match self
                    .leap(&stand)
                    .or_else(|| self.settle(&stand, time))
                    .or_else(|| self.cross(&stand, time))
                {
                    Some(beyond) if beyond.time == time && !self.is_usable(&beyond.branch) => {
                        self.singular_sample = Some(time);
                        return Ok(beyond);
                    }
                    Some(beyond) => {
                        // Steps also end at kinks of formulas, which have two sides but no other branch.
                        let is_other_side = beyond.branch.signs != stand.branch.signs;
                        if is_other_side && self.jump_after(&stand).is_none() {
                            self.passed(stand.time);
                        }
                        here = self.keep(beyond);
                    }
                    None => {
                        if let Some(beyond) = self.leave_start(&stand, time) {
                            return Ok(beyond);
                        }
                        self.event(stand.time, EventKind::MotionEnds);
                        if self.ends_at_gap {
                            return Err(Some(stand));
                        }
                        self.open_gap(Some(stand.time));
                        // The drive may be feasible again before the next sample.
                        return self.resume(stand, time);
                    }
                },
            }
        }
    }

    /// A motion that starts at a fold has no tangent to leave it by: the next pose is assembled from the start values,
    /// which say on which of the branches that meet there the motion goes on.
    fn leave_start(&mut self, stand: &Stand, time: f64) -> Option<Stand> {
        let is_start = self.trajectory.samples.len() == 1;
        if !is_start || stand.time > self.trajectory.samples[0].time {
            return None;
        }
        let inputs = self.inputs(time).ok()?;
        let start = [self.actuation.guess.clone(), inputs].concat();
        let found = self.assembled(&start, false).ok()?;
        self.iterations += found.iterations;
        let beyond = self.stand(time, found.coordinates);
        Some(self.keep(beyond))
    }

    /// Steps with halving until `time`, before or after, or until the steps become too small.
    fn follow(&mut self, mut here: Stand, time: f64) -> Result<Stand, Stop> {
        let smallest = SMALLEST_STEP * self.interval;
        let direction = (time - here.time).signum();
        let mut step = (time - here.time).abs();
        let mut creeping = 0;
        while here.time != time {
            if creeping > MOST_CREEPING || (self.cancelled)() {
                return Err(Stop::Ends(here));
            }
            let next = if step >= (time - here.time).abs() {
                time
            } else {
                here.time + direction * step
            };
            let length = (next - here.time).abs();
            match self.step(&here, next) {
                Ok(Some(stand)) => {
                    step = (2.0 * length).max(smallest);
                    let moved = self.apart(&stand.coordinates, &here.coordinates);
                    creeping = if moved < CREEPING { creeping + 1 } else { 0 };
                    here = self.keep(stand);
                }
                Ok(None) => step = 0.5 * length,
                Err(index) => return Err(Stop::Undefined(index, here)),
            }
            if step < smallest || here.time + direction * step == here.time {
                return Err(Stop::Ends(here));
            }
        }
        Ok(here)
    }
}
