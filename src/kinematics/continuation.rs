//! Following the motion along the drive on one assembly branch: predictor, corrector, step control, events.
//!
//! The drive is always evaluated at a time computed from the sample's own time, never accumulated.

use super::assembly::{NotClosed, assemble};
use super::branch::{BranchState, BranchWatch};
use super::forward;
use super::newton::{Correction, Corrector, Pace};
use super::structure::{Structure, StructureError};
use super::trajectory::{ClosedPose, Event, EventKind, Sample, Trajectory};
use crate::model::mechanism::Mechanism;

/// Smallest step as a fraction of the interval between two samples: locates the end of a motion to about 1e-11
/// of that interval.
const SMALLEST_STEP: f64 = 1e-11;

/// Largest correction of a prediction, in scaled unknowns. A larger one could have reached another branch.
const MAX_CORRECTION: f64 = 0.05;

/// A correction may be this fraction of the predicted step (plus a floor for tiny steps): the tangent is
/// then a good picture of the path.
const CORRECTION_OF_STEP: f64 = 0.25;

/// Floor of the above: corrections of this size are rounding at a badly conditioned pose.
const CORRECTION_FLOOR: f64 = 1e-9;

/// A step across a singular pose starts from the last pose whose smallest singular value is above this fraction
/// of the best seen; nearer to the singular pose the tangent is noise.
const TRUSTED_SIGMA: f64 = 1e-4;

/// Below this fraction of the best smallest singular value no tangent is taken from a pose: it has lost its last
/// digits. Folds are approached to the square of it.
const USABLE_SIGMA: f64 = 1e-6;

/// A sample this close to the end of the steps, in intervals between samples, is the singular pose itself.
const BESIDE: f64 = 1e-6;

/// Longest stretch, in intervals between samples, over which a singular pose is crossed.
const LONGEST_CROSSING: f64 = 1.0;

/// Half width, in seconds relative to the interval, of the difference that gives the drive's rate.
const RATE_STEP: f64 = 1e-6;

/// Solves `mechanism` at the given ascending times.
///
/// # Errors
/// Only where the mechanism itself is ill-posed; a pose that does not exist is an event in the trajectory.
pub fn solve(mechanism: &Mechanism, times: &[f64]) -> Result<Trajectory, StructureError> {
    let structure = Structure::new(mechanism)?;
    Ok(Follower::new(mechanism, &structure).run(times))
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
    mechanism: &'m Mechanism,
    structure: &'m Structure,
    corrector: Corrector,
    watch: BranchWatch,
    /// Last pose that is well away from singular ones: where crossings start from.
    anchor: Option<Stand>,
    best_sigma: f64,
    interval: f64,
    iterations: u32,
    trajectory: Trajectory,
}

impl<'m> Follower<'m> {
    fn new(mechanism: &'m Mechanism, structure: &'m Structure) -> Self {
        Self {
            mechanism,
            structure,
            corrector: Corrector::new(structure),
            watch: BranchWatch::default(),
            anchor: None,
            best_sigma: 0.0,
            interval: mechanism.duration,
            iterations: 0,
            trajectory: Trajectory::default(),
        }
    }

    fn run(mut self, times: &[f64]) -> Trajectory {
        let mut stand: Option<Stand> = None;
        let mut lost = false;
        for (index, &time) in times.iter().enumerate() {
            self.interval = if index > 0 {
                (time - times[index - 1]).abs()
            } else {
                self.mechanism.duration
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
                    lost = true;
                    stand = last.or(stand);
                }
            }
        }
        self.trajectory
    }

    /// Inputs at `time`, or the index of one that has no value.
    fn inputs(&self, time: f64) -> Result<Vec<f64>, usize> {
        let inputs = self.mechanism.inputs_at(time);
        match inputs.iter().position(|v| !v.is_finite()) {
            None => Ok(inputs),
            Some(index) => Err(index),
        }
    }

    fn event(&mut self, time: f64, kind: EventKind) {
        let inputs = self.mechanism.inputs_at(time);
        self.trajectory.events.push(Event { time, inputs, kind });
    }

    fn undefined(&mut self, time: f64, index: usize) {
        let name = self.mechanism.inputs[index].name.clone();
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
        let start = [self.mechanism.guess.clone(), inputs].concat();
        // Perturbed starts are worth their time once, not at every sample of a range without poses.
        let persist = self.trajectory.samples.is_empty();
        match assemble(
            self.mechanism,
            self.structure,
            &mut self.corrector,
            &start,
            persist,
        ) {
            Ok(found) => {
                self.iterations += found.iterations;
                if found.start > 0 {
                    self.event(time, EventKind::OtherStart);
                }
                if !self.trajectory.samples.is_empty() {
                    self.event(time, EventKind::MotionResumes { same_branch: true });
                }
                let stand = self.stand(time, found.coordinates);
                Ok(self.keep(stand))
            }
            Err(NotClosed {
                name,
                angle,
                distance,
            }) => {
                if persist {
                    self.event(
                        time,
                        EventKind::StartNotClosed {
                            name,
                            angle,
                            distance,
                        },
                    );
                }
                Err(None)
            }
        }
    }

    /// After a gap: assembles again from the last pose, without searching.
    fn resume(&mut self, last: Stand, time: f64) -> Result<Stand, Option<Stand>> {
        let Ok(inputs) = self.inputs(time) else {
            return Err(None);
        };
        let unknowns = &last.coordinates[..self.mechanism.unknowns.len()];
        let start = [unknowns, &inputs].concat();
        match assemble(
            self.mechanism,
            self.structure,
            &mut self.corrector,
            &start,
            false,
        ) {
            Ok(found) => {
                self.iterations += found.iterations;
                let stand = self.stand(time, found.coordinates);
                let same_branch = stand.branch.signs == last.branch.signs;
                self.event(time, EventKind::MotionResumes { same_branch });
                Ok(self.keep(stand))
            }
            Err(_) => Err(None),
        }
    }

    /// From the last sample to `time`, by as many steps as it takes.
    fn advance(&mut self, last: Stand, time: f64) -> Result<Stand, Option<Stand>> {
        let mut here = last;
        loop {
            match self.follow(here, time) {
                Ok(stand) => return Ok(stand),
                Err(Stop::Undefined(index, stand)) => {
                    self.undefined(time, index);
                    return Err(Some(stand));
                }
                Err(Stop::Ends(stand)) => match self
                    .settle(&stand, time)
                    .or_else(|| self.cross(&stand, time))
                {
                    Some(beyond) if beyond.time == time && !self.is_usable(&beyond.branch) => {
                        return Ok(beyond);
                    }
                    Some(beyond) => {
                        self.event(stand.time, EventKind::SingularPosePassed);
                        here = self.keep(beyond);
                    }
                    None => {
                        self.event(stand.time, EventKind::MotionEnds);
                        return Err(Some(stand));
                    }
                },
            }
        }
    }

    /// Steps with halving until `time`, or until the steps become too small.
    fn follow(&mut self, mut here: Stand, time: f64) -> Result<Stand, Stop> {
        let smallest = SMALLEST_STEP * self.interval;
        let mut step = time - here.time;
        while here.time < time {
            let next = if here.time + step >= time {
                time
            } else {
                here.time + step
            };
            match self.step(&here, next) {
                Ok(Some(stand)) => {
                    step = (2.0 * (next - here.time)).max(smallest);
                    here = self.keep(stand);
                }
                Ok(None) => step = 0.5 * (next - here.time),
                Err(index) => return Err(Stop::Undefined(index, here)),
            }
            if step < smallest || here.time + step == here.time {
                return Err(Stop::Ends(here));
            }
        }
        Ok(here)
    }

    /// One predictor-corrector step; `Ok(None)` where it cannot be trusted.
    ///
    /// From a singular pose no tangent is usable; the prediction then starts from the last trusted pose,
    /// which leads straight through, and the determinant may change its sign.
    fn step(&mut self, here: &Stand, time: f64) -> Result<Option<Stand>, usize> {
        let inputs = self.inputs(time)?;
        let usable = self.is_usable(&here.branch);
        let base = match &self.anchor {
            Some(anchor) if !usable => anchor.clone(),
            _ => here.clone(),
        };
        let (mut coordinates, length) = self.predict(&base, &inputs);
        let correction = self.correct(&mut coordinates, Pace::Brisk);
        let allowed = (CORRECTION_OF_STEP * length + CORRECTION_FLOOR).min(MAX_CORRECTION);
        if !correction.converged || correction.first_step > allowed {
            return Ok(None);
        }
        let stand = self.stand(time, coordinates);
        let same = stand
            .branch
            .signs
            .iter()
            .zip(&base.branch.signs)
            .all(|(a, b)| a == b);
        let fine = same || !usable || !self.is_usable(&stand.branch);
        // On the way to a fold poses are hardly usable too; only a changed sign tells that the singular pose is behind.
        if fine && !usable && !same && self.is_usable(&stand.branch) {
            self.event(here.time, EventKind::SingularPosePassed);
        }
        Ok(fine.then_some(stand))
    }

    /// Whether the tangent of a pose is worth anything.
    fn is_usable(&self, branch: &BranchState) -> bool {
        branch.sigma_min >= USABLE_SIGMA * self.best_sigma
    }

    /// Whether a pose is far enough from singular ones to predict from across one.
    fn is_trusted(&self, branch: &BranchState) -> bool {
        branch.sigma_min >= TRUSTED_SIGMA * self.best_sigma
    }

    fn correct(&mut self, coordinates: &mut [f64], pace: Pace) -> Correction {
        let correction = self
            .corrector
            .correct(self.mechanism, self.structure, coordinates, pace);
        self.iterations += correction.iterations;
        correction
    }

    /// Tangent prediction to new inputs, and the length of the step in scaled unknowns.
    fn predict(&mut self, here: &Stand, inputs: &[f64]) -> (Vec<f64>, f64) {
        let n = self.mechanism.unknowns.len();
        let mut change: Vec<f64> = vec![0.0; here.coordinates.len()];
        for (k, input) in inputs.iter().enumerate() {
            change[n + k] = input - here.coordinates[n + k];
        }
        self.corrector.tangent(
            self.mechanism,
            self.structure,
            &here.coordinates,
            &mut change,
        );
        let length = (0..n)
            .map(|k| (change[k] / self.mechanism.scale_of(k)).abs())
            .fold(0.0, f64::max);
        let mut coordinates: Vec<f64> = here
            .coordinates
            .iter()
            .zip(&change)
            .map(|(q, d)| q + d)
            .collect();
        // The inputs are exactly the drive's, not the sum of differences.
        coordinates[n..].copy_from_slice(inputs);
        (coordinates, length)
    }

    /// A sample that lies on a singular pose itself is reached by a patient correction from right beside it.
    fn settle(&mut self, end: &Stand, time: f64) -> Option<Stand> {
        if time - end.time > BESIDE * self.interval {
            return None;
        }
        let inputs = self.inputs(time).ok()?;
        let n = self.mechanism.unknowns.len();
        let mut coordinates = [&end.coordinates[..n], &inputs].concat();
        let correction = self.correct(&mut coordinates, Pace::Patient);
        (correction.converged && correction.first_step <= MAX_CORRECTION)
            .then(|| self.stand(time, coordinates))
    }

    /// Tries to go straight through a singular pose next to `end`: along the tangent of the last trusted pose, to
    /// a pose beyond that lies where the tangent says.
    fn cross(&mut self, end: &Stand, time: f64) -> Option<Stand> {
        let anchor = self.anchor.clone().filter(|a| a.time < end.time)?;
        let mut reach = (end.time - anchor.time) * 2.0;
        let limit = (LONGEST_CROSSING * self.interval).min(time - anchor.time);
        while reach <= limit * (1.0 + 1e-12) {
            let beyond = (anchor.time + reach).min(time);
            let inputs = self.inputs(beyond).ok()?;
            let (mut coordinates, length) = self.predict(&anchor, &inputs);
            let correction = self.correct(&mut coordinates, Pace::Brisk);
            let allowed = (CORRECTION_OF_STEP * length).min(MAX_CORRECTION);
            if correction.converged && correction.first_step <= allowed && beyond > end.time {
                return Some(self.stand(beyond, coordinates));
            }
            reach = if reach < limit {
                (reach * 2.0).min(limit)
            } else {
                reach * 2.0
            };
        }
        None
    }

    /// Observes a closed pose.
    fn stand(&mut self, time: f64, coordinates: Vec<f64>) -> Stand {
        let branch = self.watch.observe(
            self.mechanism,
            self.structure,
            &mut self.corrector,
            &coordinates,
        );
        if branch.sigma_min.is_finite() {
            self.best_sigma = self.best_sigma.max(branch.sigma_min);
        }
        Stand {
            time,
            coordinates,
            branch,
        }
    }

    /// Remembers an accepted pose as an anchor if it is well away from singular ones.
    fn keep(&mut self, stand: Stand) -> Stand {
        if self.is_trusted(&stand.branch) {
            self.anchor = Some(stand.clone());
        }
        stand
    }

    fn record_missing(&mut self, time: f64) {
        let inputs = self.mechanism.inputs_at(time);
        self.trajectory.samples.push(Sample {
            time,
            inputs,
            pose: None,
        });
    }

    fn record(&mut self, stand: &Stand) {
        let n = self.mechanism.unknowns.len();
        let coordinates = &stand.coordinates;
        let bodies = forward::body_poses(self.mechanism, coordinates);
        let traces = forward::trace_points(self.mechanism, &bodies);
        let outputs = forward::outputs(self.mechanism, coordinates, &traces);
        let closure_error = forward::closure_error(self.mechanism, coordinates);
        let finite = bodies.iter().all(|p| p.is_finite()) && closure_error.is_finite();
        if !finite {
            return self.record_missing(stand.time);
        }
        let pose = ClosedPose {
            unknowns: coordinates[..n].to_vec(),
            bodies,
            traces,
            outputs,
            rates: self.rates(stand),
            closure_error,
            sigma_min: stand.branch.sigma_min,
            condition: stand.branch.condition,
            rank: stand.branch.rank,
            branch: stand.branch.signature(),
            iterations: self.iterations,
        };
        let inputs = coordinates[n..].to_vec();
        self.trajectory.samples.push(Sample {
            time: stand.time,
            inputs,
            pose: Some(pose),
        });
    }

    /// Rates of the unknowns per second: the tangent along the drive's own rate.
    fn rates(&mut self, stand: &Stand) -> Vec<f64> {
        let n = self.mechanism.unknowns.len();
        let h = RATE_STEP * self.mechanism.duration;
        let (before, after) = (
            self.mechanism.inputs_at(stand.time - h),
            self.mechanism.inputs_at(stand.time + h),
        );
        let mut rates = vec![0.0; stand.coordinates.len()];
        for k in 0..before.len() {
            rates[n + k] = (after[k] - before[k]) / (2.0 * h);
        }
        self.corrector.tangent(
            self.mechanism,
            self.structure,
            &stand.coordinates,
            &mut rates,
        );
        rates.truncate(n);
        rates
    }
}
