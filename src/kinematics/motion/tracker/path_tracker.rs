//! The motion along a drive, step by step, until it ends.
//!
//! The drive is always evaluated at a time computed from the sample's own time, never accumulated.

use super::bounded_formulas::BoundedFormula;
use super::jump_sites::{FormulaBehaviour, JumpSite};
use super::regularity::Regularity;
use super::step_bounds::StepBound;
use super::steps::{StepBudget, Steps};
use crate::kinematics::solve::branch::BranchState;
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::solve::predictor::HIGHEST_ORDER;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use std::rc::Rc;

/// Smallest step as a fraction of the interval between two samples; it locates the end of a motion to about 1e-12
/// of that interval.
pub(crate) const SMALLEST_STEP: f64 = 1e-12;

/// Over a step this short, as a fraction of that interval, a possible jump is accepted as none: it vanished with the step. So is
/// a kink: poses right before and behind it tell whether the motion ends there.
const CLOSE_TO_JUMP: f64 = 1e-9;

/// Number of steps, accepted or rejected, that must together advance by [`LEAST_PROGRESS`]: otherwise the tracker is stuck at a
/// singular pose, where rounding lets a tiny step pass now and then.
const PATIENCE: usize = 1_000;

/// Smallest advance in that many steps, as a fraction of the interval: even over a hundred thousand turns it is 1/2000.
const LEAST_PROGRESS: f64 = 1e-6;

/// A closed pose on the path, with the data needed to continue from it.
#[derive(Clone, Debug)]
pub struct PathPoint {
    /// Seconds.
    pub time: f64,
    /// Unknowns, then inputs; shared with whatever keeps the pose.
    pub coordinates: Rc<[f64]>,
    /// Signs of the blocks' determinants, and the distance from singular poses.
    pub branch: BranchState,
}

/// Why a motion cannot be followed farther.
#[derive(Clone, Debug)]
pub enum Stop {
    /// No further step is reliable; the last good pose.
    Ends(PathPoint),
    /// An input is undefined.
    Undefined {
        /// Its index.
        input: usize,
        /// Where, seconds.
        time: f64,
        /// The last good pose.
        last: PathPoint,
    },
}

impl Stop {
    /// The last good pose.
    pub fn last(self) -> PathPoint {
        match self {
            Self::Ends(last) | Self::Undefined { last, .. } => last,
        }
    }
}

/// What a watcher hears of a motion while it is followed.
pub trait PathWatcher {
    /// Whether singular poses may be passed; else the motion ends at the first one.
    fn crosses(&self) -> bool {
        true
    }

    /// A pose was accepted; the tracker's recent poses are still those before it.
    fn accepted(&mut self, _: &mut PathTracker, _: &PathPoint) {}

    /// It is well away from singular poses.
    fn regular(&mut self, _: &mut PathTracker, _: &PathPoint) {}

    /// The motion went through a singular pose near this time.
    fn passed(&mut self, _: &PathTracker, _: f64) {}

    /// It left a singular pose on the side on which it came there, because the drive turned back.
    fn turned_back(&mut self, _: &PathTracker) {}
}

/// Ignores everything.
pub struct Unwatched;

impl PathWatcher for Unwatched {}

/// Ignores everything, and the motion ends at the first singular pose.
pub struct UpToSingular;

impl PathWatcher for UpToSingular {
    fn crosses(&self) -> bool {
        false
    }
}

/// Follows one motion.
#[derive(Clone)]
pub struct PathTracker<'s> {
    /// Predicts and corrects.
    pub solver: PoseSolver<'s>,
    actuation: &'s Actuation,
    cancelled: &'s dyn Fn() -> bool,
    /// Steps that may still be taken; the scouts of a tracker draw on the same.
    pub(crate) budget: StepBudget,
    /// Seconds between two samples: what steps are small against.
    pub interval: f64,
    /// Last pose that is well away from singular ones: where crossings start from.
    pub(crate) anchor: Option<PathPoint>,
    /// The last accepted pose and the one before it, where ball joints need them.
    pub(crate) recent: [Option<PathPoint>; 2],
    /// The smallest singular values that were met.
    pub(crate) regularity: Regularity,
    /// What may jump in its loops and equations.
    pub(crate) jump_sites: Rc<[JumpSite]>,
    /// Whether each drive may turn back within a step.
    pub(super) turning: Rc<[bool]>,
    /// How far a step may take each input.
    pub(super) bounds: Rc<[StepBound]>,
    /// Formulas of inputs in its loops and equations, and formulas of unknowns in its loops, that may stray within a step.
    pub(super) driven: Rc<[BoundedFormula]>,
    pub(super) bent: Rc<[BoundedFormula]>,
}

impl<'s> PathTracker<'s> {
    /// For a motion of `system` along `actuation`, which ends early where `cancelled` says so.
    pub fn new(
        system: &'s System,
        actuation: &'s Actuation,
        cancelled: &'s dyn Fn() -> bool,
    ) -> Self {
        let drives = actuation.drives.iter();
        Self {
            solver: PoseSolver::new(system),
            actuation,
            cancelled,
            budget: StepBudget::of_cost(system.path_step_cost()),
            interval: actuation.duration,
            anchor: None,
            recent: [None, None],
            regularity: Regularity::default(),
            jump_sites: JumpSite::all(system.mechanism()).into(),
            turning: drives.map(Drive::may_turn_back).collect(),
            bounds: StepBound::of_inputs(system.mechanism()).into(),
            driven: BoundedFormula::of_inputs(system.mechanism(), actuation).into(),
            bent: BoundedFormula::of_unknowns(system.mechanism()).into(),
        }
    }

    /// Whose motion it is.
    pub fn system(&self) -> &'s System {
        self.solver.system()
    }

    /// What drives it.
    pub fn actuation(&self) -> &'s Actuation {
        self.actuation
    }

    /// Whether the motion is to end early.
    pub fn is_cancelled(&self) -> bool {
        (self.cancelled)()
    }

    /// Number of unknowns: where the inputs of a pose begin.
    pub fn unknowns(&self) -> usize {
        self.system().mechanism().unknowns.len()
    }

    /// Inputs at `time`, or the index of one that has no value.
    pub fn inputs(&self, time: f64) -> Result<Vec<f64>, usize> {
        let inputs = self.actuation.inputs_at(time);
        match inputs.iter().position(|v| !v.is_finite()) {
            None => Ok(inputs),
            Some(index) => Err(index),
        }
    }

    /// Observes a closed pose.
    pub fn point(&mut self, time: f64, coordinates: impl Into<Rc<[f64]>>) -> PathPoint {
        let coordinates = coordinates.into();
        let branch = self.solver.observe(&coordinates);
        self.regularity.observe(branch.sigma_min);
        PathPoint {
            time,
            coordinates,
            branch,
        }
    }

    /// Accepts a pose; it is an anchor from then on if it is well away from singular ones.
    pub fn keep(&mut self, point: PathPoint, watcher: &mut dyn PathWatcher) -> PathPoint {
        self.solver.keep_jacobians(&point.coordinates);
        self.regularity.accept(point.time, point.branch.sigma_min);
        watcher.accepted(self, &point);
        if self.solver.chart().is_some() {
            self.recent = [Some(point.clone()), self.recent[0].take()];
        }
        if self.is_usable(&point.branch) {
            self.solver.renew_rows(&point.coordinates);
        }
        // An anchor is a pose that later branches are compared with.
        if self.is_trusted(&point.branch) {
            watcher.regular(self, &point);
            self.anchor = Some(point.clone());
        }
        point
    }

    /// From `here` to `time`, before or after, by as many steps as it takes.
    ///
    /// # Errors
    /// The motion ends before `time`.
    pub fn follow(
        &mut self,
        mut here: PathPoint,
        time: f64,
        watcher: &mut dyn PathWatcher,
    ) -> Result<PathPoint, Stop> {
        let way = (time - here.time).abs();
        let mut steps = Steps::new(here.time, time, way, SMALLEST_STEP * self.interval);
        let mut looked_at = here.time;
        let mut undefined = None;
        self.budget.spend_if_short(self.least_steps(&here, time));
        for count in 1.. {
            if steps.is_done() {
                return Ok(here);
            }
            // Steps that hardly advance have met something: checked every so many steps.
            if count % PATIENCE == 0 {
                if (here.time - looked_at).abs() < LEAST_PROGRESS * way {
                    break;
                }
                looked_at = here.time;
            }
            let target = steps.target();
            let inputs = match self.inputs(target) {
                Ok(inputs) => inputs,
                // Nearer, until it is known where the input has no value.
                Err(input) => {
                    undefined = Some((input, target));
                    steps.refuse();
                    if steps.is_stuck() {
                        break;
                    }
                    continue;
                }
            };
            // What is too far is refused without a step.
            let strays = self.strays(&here, target, &inputs);
            if !strays && !self.budget.take() || self.budget.is_spent() || self.is_cancelled() {
                break;
            }
            // Predict and correct; a refused step is halved, an accepted one lengthens the next.
            let reached = (!strays).then(|| self.step(&here, (target, &inputs), watcher));
            match reached.flatten() {
                Some(point) => {
                    steps.take();
                    here = self.keep(point, watcher);
                }
                None => {
                    undefined = None;
                    steps.refuse();
                }
            }
            if steps.is_stuck() {
                break;
            }
        }
        Err(match undefined {
            Some((input, time)) => Stop::Undefined {
                input,
                time,
                last: here,
            },
            None => Stop::Ends(here),
        })
    }

    /// One predictor-corrector step to the inputs at a time; `None` where it cannot be trusted.
    ///
    /// From a singular pose no tangent is usable; the prediction then starts from the last trusted pose,
    /// which leads straight through, and the determinant may change its sign.
    fn step(
        &mut self,
        here: &PathPoint,
        (time, inputs): (f64, &[f64]),
        watcher: &mut dyn PathWatcher,
    ) -> Option<PathPoint> {
        let usable = self.is_usable(&here.branch);
        let way = [here.time, time];
        if usable && self.regularity.heads_for_zero(way, here.branch.sigma_min) {
            return None;
        }
        let base = match &self.anchor {
            Some(anchor) if !usable => anchor.clone(),
            _ => here.clone(),
        };
        let order = if usable && self.is_trusted(&base.branch) {
            HIGHEST_ORDER
        } else {
            1
        };
        let mut coordinates = self.solver.step(&base.coordinates, inputs, order)?;
        self.rename(&base, time, &mut coordinates);
        let longest = match self.way_between(&here.coordinates, &coordinates) {
            FormulaBehaviour::Smooth => f64::INFINITY,
            FormulaBehaviour::Kink | FormulaBehaviour::Open => CLOSE_TO_JUMP,
            FormulaBehaviour::Jumps(_) => return None,
        };
        if (time - here.time).abs() > longest * self.interval
            || self.formulas_stray(here, time, &coordinates)
        {
            return None;
        }
        let point = self.point(time, coordinates);
        let same = point.branch.signs == base.branch.signs;
        let fine = match usable && self.is_usable(&point.branch) {
            true => same && self.stays_regular(&base, &point),
            false => true,
        };
        // Before a fold poses are nearly singular, too, and do not become better: here the singular pose is behind.
        if fine && !usable && self.is_usable(&point.branch) {
            if same && self.drive_turns([&base, here, &point]) {
                watcher.turned_back(self);
            } else if watcher.crosses() && self.is_joined(here, &point) {
                watcher.passed(self, here.time);
            } else {
                return None;
            }
        }
        fine.then_some(point)
    }

    /// Whether there is no sign of a singular pose between two regular ones.
    fn stays_regular(&mut self, from: &PathPoint, to: &PathPoint) -> bool {
        let sigmas = from.branch.sigma_min + to.branch.sigma_min;
        let poses = [&from.coordinates[..], &to.coordinates];
        self.solver.stays_regular(poses, sigmas)
    }

    /// Whether an input turns back at the second of three poses.
    fn drive_turns(&self, [before, at, behind]: [&PathPoint; 3]) -> bool {
        let mut inputs = self.unknowns()..at.coordinates.len();
        inputs.any(|k| {
            let [a, b, c] = [before, at, behind].map(|point| point.coordinates[k]);
            (b - a) * (c - b) < 0.0
        })
    }

    /// Whether the tangent of a pose is worth anything.
    pub fn is_usable(&self, branch: &BranchState) -> bool {
        self.regularity.is_usable(branch.sigma_min)
    }

    /// Whether a pose is far enough from singular ones to predict from across one.
    pub(crate) fn is_trusted(&self, branch: &BranchState) -> bool {
        self.regularity.is_trusted(branch.sigma_min)
    }

    /// Gives angles that are nearly locked the values in which they go on smoothly from the poses before.
    pub(crate) fn rename(&self, base: &PathPoint, time: f64, coordinates: &mut [f64]) {
        let chart = self.solver.chart().filter(|c| c.is_needed(coordinates));
        let Some(chart) = chart else { return };
        let near: Vec<f64> = match &self.recent[1] {
            Some(before) if before.time != base.time => {
                let part = (time - base.time) / (base.time - before.time);
                let pairs = base.coordinates.iter().zip(before.coordinates.iter());
                pairs.map(|(q, p)| q + part * (q - p)).collect()
            }
            _ => base.coordinates.to_vec(),
        };
        chart.rename(coordinates, &near);
    }

    /// Rates of the unknowns per second at a pose: the tangent along the drive's own rate.
    pub fn rates(&mut self, point: &PathPoint) -> Vec<f64> {
        let n = self.unknowns();
        let mut rates = vec![0.0; n];
        rates.extend(self.actuation.rates_at(point.time));
        self.solver.tangent(&point.coordinates, &mut rates);
        rates.truncate(n);
        rates
    }

    /// The closed pose at `time` near `coordinates`, whose inputs are overwritten.
    pub fn corrected(
        &mut self,
        time: f64,
        mut coordinates: Vec<f64>,
        pace: Pace,
    ) -> Option<PathPoint> {
        let inputs = self.inputs(time).ok()?;
        let n = self.unknowns();
        coordinates.truncate(n);
        coordinates.extend(inputs);
        let closed = self.solver.closed(&mut coordinates, pace);
        closed.then(|| self.point(time, coordinates))
    }
}
