//! The end of steps in time: the continuation, if there is one, otherwise the kind of the motion's end.

use super::domain_proof;
use super::fold_proof;
use super::recorder::{MOST_WAYS_ON, PathContinuation, Recorder};
use crate::kinematics::motion::tracker::arc_length::Onward;
use crate::kinematics::motion::tracker::jump_sites::FormulaBehaviour;
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, Unwatched};
use crate::kinematics::motion::tracker::singular::SingularTarget;
use crate::kinematics::results::trajectory::Ending;
use crate::kinematics::solve::closure::{TooLarge, too_large};

/// Fractions of the sampling interval at which a formula is evaluated beyond the end of a motion.
const BEYOND: [f64; 3] = [1e-11, 1e-9, 1e-7];

impl Recorder<'_> {
    /// A pose beyond the end of the steps: after a jump of the drive, on a singular pose, or through it. Otherwise the
    /// kind and place of the end.
    pub(super) fn way_on(
        &mut self,
        end: &PathPoint,
        time: f64,
    ) -> Result<PathContinuation, (PathPoint, Ending)> {
        let tracker = &mut self.tracker;
        // Steps also end at kinks of formulas, where the Jacobian is regular: no singular pose is passed there.
        let is_singular = !tracker.is_trusted(&end.branch);
        // A pose behind a jump of the formulas is not on the way, wherever it was found.
        let (to, is_passed) = if let Some(to) = tracker.leap(end, time) {
            (to, false)
        } else if let Some(to) = tracker.settle(end, time)
            && tracker.is_smooth(end, &to)
        {
            (to, false)
        } else if let Some(to) = tracker.cross(end, time)
            && tracker.continues(end, &to)
        {
            (to, is_singular)
        } else if let Some(to) = tracker.hop(end, time)
            && tracker.is_smooth(end, &to)
        {
            (to, false)
        } else {
            let onward = self.onward(end, time);
            (
                onward.or_else(|ending| self.flat(end, time).ok_or(ending))?,
                is_singular,
            )
        };
        Ok(PathContinuation { to, is_passed })
    }

    /// The pose beyond a singular one through which no tangent leads.
    fn flat(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let to = self.tracker.pass_flat(end, time)?;
        self.tracker.is_smooth(end, &to).then_some(to)
    }

    /// The pose to which the path leads in arc length.
    fn onward(&mut self, end: &PathPoint, time: f64) -> Result<PathPoint, (PathPoint, Ending)> {
        match self.tracker.onward(end, time) {
            Onward::Passed(to) if self.tracker.continues(end, &to) => Ok(to),
            Onward::Fold(fold) => {
                let asked = self.is_proof_wanted();
                // The direction in which time continues along the path.
                let sense = (time - end.time).signum();
                let (system, actuation) = (self.tracker.system(), self.tracker.actuation());
                let proved = asked && fold_proof::is_proved(system, actuation, &fold, sense);
                Err((fold.at, Ending::Fold { proved, asked }))
            }
            Onward::Passed(_) | Onward::Lost => Err((end.clone(), self.ending_at(end, time))),
        }
    }

    /// A proof is worth its time if poses are proved, and the motion after the gap matters.
    fn is_proof_wanted(&self) -> bool {
        self.proof.is_some() && !self.ends_at_gap && !self.tracker.is_cancelled()
    }

    /// The cause of an end that is not a fold.
    fn ending_at(&self, end: &PathPoint, time: f64) -> Ending {
        if let Some(ending) = self.ending_by_rounding(&end.coordinates) {
            return ending;
        }
        let beyond = self.beyond(end.time, time);
        let undefined = beyond
            .into_iter()
            .find_map(|at| self.tracker.inputs(at).err());
        if let Some(input) = undefined {
            return self.undefined_input(input, &beyond);
        }
        if let Some(name) = self.jumping_formula(end, time) {
            return Ending::Jump { name };
        }
        self.formula_ending(end, time).unwrap_or(Ending::GivenUp {
            sigma_min: end.branch.sigma_min,
        })
    }

    /// Instants right beyond the end of a motion, on the way to `time`.
    pub(super) fn beyond(&self, end: f64, time: f64) -> [f64; 3] {
        let (sense, far) = ((time - end).signum(), (time - end).abs());
        BEYOND.map(|share| end + sense * f64::min(share * self.tracker.interval, far))
    }

    /// The end of a motion beyond which an input has no value: proved if it has none at any of these times.
    pub(super) fn undefined_input(&self, input: usize, times: &[f64]) -> Ending {
        let drive = &self.tracker.actuation().drives[input];
        Ending::InputUndefined {
            name: self.tracker.system().mechanism().inputs[input].name.clone(),
            proved: times.iter().any(|at| !drive.may_have_value(*at)),
        }
    }

    /// The loop or equation whose formula jumps right beyond `end`, if one is found.
    fn jumping_formula(&self, end: &PathPoint, time: f64) -> Option<String> {
        let unknowns = &end.coordinates[..self.tracker.unknowns()];
        self.beyond(end.time, time).into_iter().find_map(|at| {
            let inputs = self.tracker.inputs(at).ok()?;
            let beyond = [unknowns, &inputs].concat();
            match self.tracker.way_between(&end.coordinates, &beyond) {
                FormulaBehaviour::Jumps(name) => Some(name.to_owned()),
                _ => None,
            }
        })
    }

    /// The equation that has no value beyond `end`, if one is found.
    fn formula_ending(&self, end: &PathPoint, time: f64) -> Option<Ending> {
        let times = self.beyond(end.time, time);
        let asked = self.is_proof_wanted();
        let (system, actuation) = (self.tracker.system(), self.tracker.actuation());
        let has_none = |equation: usize, time: f64| {
            asked && domain_proof::is_proved(system, (actuation, time), end, equation)
        };
        // With the unknowns of the last pose; otherwise an earlier loop may have moved them out of the domain.
        let mut undefined = times.iter().map(|time| self.undefined_equation(end, *time));
        let (equation, proved) = match undefined.find_map(|equation| equation) {
            Some(first) => (first, times.iter().any(|time| has_none(first, *time))),
            None => {
                let mut all = 0..system.mechanism().equations.len();
                (all.find(|k| has_none(*k, times[times.len() - 1]))?, true)
            }
        };
        Some(Ending::NoValue {
            name: system.mechanism().equations[equation].name.clone(),
            proved,
            asked,
        })
    }

    /// The end of a motion whose coordinates are so large that their rounding alone opens loops.
    pub(super) fn ending_by_rounding(&self, coordinates: &[f64]) -> Option<Ending> {
        let system = self.tracker.system();
        let large = too_large(system.mechanism(), system.blocks(), coordinates)?;
        Some(match large {
            TooLarge::Angles => Ending::AngleTooLarge,
            TooLarge::Places => Ending::PlaceTooFar,
        })
    }

    /// An equation that is undefined with the unknowns of `point` and the inputs of `time`.
    fn undefined_equation(&self, point: &PathPoint, time: f64) -> Option<usize> {
        let mechanism = self.tracker.system().mechanism();
        let n = self.tracker.unknowns();
        let inputs = self.tracker.inputs(time).ok()?;
        let coordinates = [&point.coordinates[..n], &inputs].concat();
        let mut equations = mechanism.equations.iter();
        equations.position(|e| !e.expression.value(&coordinates).is_finite())
    }

    /// Where the motion to `found` begins, and why; `None` if it can be followed back to the start of the gap, or to
    /// the first sample.
    pub(super) fn walk_back(
        &mut self,
        found: &PathPoint,
        target: SingularTarget,
    ) -> Option<(PathPoint, Ending)> {
        let (SingularTarget::Time(time) | SingularTarget::Gap(time)) = target;
        let mut from = found.clone();
        for _ in 0..MOST_WAYS_ON {
            let first = self.tracker.walk_back(&from, target, &mut Unwatched)?;
            match self.onward(&first, time) {
                Ok(before) => from = before,
                Err(end) => return Some(end),
            }
        }
        let sigma_min = from.branch.sigma_min;
        Some((from, Ending::GivenUp { sigma_min }))
    }
}
