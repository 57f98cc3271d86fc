//! Extremes along the drive between the poses of a study: their times are found from the rates of the motion, so that their values
//! and derivatives are those of the whole motion. The derivative of an extreme is that of the formula at its pose: what its time
//! changes is of second order.

use super::family::{Nominal, ParametricMechanism};
use super::family_error::FamilyError;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::rates::columns::{RateVariable, slot_series};
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource};

/// Most Newton steps to an extreme: from a neighbouring pose five are the rule.
const STEPS: usize = 20;

/// A step below this fraction of the distance of two poses ends the search: the derivative is off by as much.
const SMALL_STEP: f64 = 1e-12;

/// Extremes between poses exceed the poses by at most this many times what a parabola through three of them does.
const ALLOWANCE: f64 = 4.0;

/// Extremes of a study along the drive.
pub struct RefinedExtremes {
    /// Times to add to those of the study.
    pub times: Vec<f64>,
    /// For every measure whether it is of the whole motion then, and not only of some poses.
    pub is_whole: Vec<bool>,
}

/// An extreme along the drive: a formula, and whether the greatest or the least value.
struct SoughtExtreme<'a> {
    formula: &'a Expression,
    sign: f64,
}

impl ParametricMechanism {
    /// Where the extremes of measures along the drive are.
    pub(super) fn refined_extremes(&self, drawn: &Nominal) -> RefinedExtremes {
        let list = &self.measures.list;
        let mut found = RefinedExtremes {
            times: Vec::new(),
            is_whole: Vec::with_capacity(list.len()),
        };
        let mut solver = PoseSolver::new(self.system());
        for measure in list {
            let is_whole = match &measure.source {
                MeasureSource::Formula(formula) => self.uses_whole(formula, &found.is_whole),
                source if source.is_of_ends() => true,
                // Of a track, means and sums are those of its poses.
                source if source.track().is_some() => !source.is_extreme(),
                _ => match self.times_of(measure, drawn, &mut solver) {
                    Some(times) => {
                        found.times.extend(times);
                        true
                    }
                    None => false,
                },
            };
            found.is_whole.push(is_whole);
        }
        found
    }

    /// The same family with poses at the extremes of measures along the drive.
    ///
    /// # Errors
    /// A pose that does not exist.
    pub fn with_extremes(self) -> Result<Self, FamilyError> {
        let found = self.refined_extremes(&self.nominal()?);
        Ok(self.at_more_times(found.times))
    }

    /// Whether all measures in a formula of measures are of the whole motion.
    fn uses_whole(&self, formula: &Expression, is_whole: &[bool]) -> bool {
        let first = self.mechanism().inputs.len();
        let measures = formula.slots().into_iter().filter(|slot| *slot >= first);
        measures.into_iter().all(|slot| is_whole[slot - first])
    }

    /// Times at which a measure has its extremes, if they are not at the ends of the drive; `None` if they are not found.
    fn times_of(
        &self,
        measure: &Measure,
        drawn: &Nominal,
        solver: &mut PoseSolver,
    ) -> Option<Vec<f64>> {
        let MeasureSource::Over {
            of,
            taking,
            per: None,
            rates,
            ..
        } = &measure.source
        else {
            return None;
        };
        let formula = of
            .first()
            .filter(|_| taking.is_extreme() && rates.is_empty())?;
        let range = self.poses_taken(&measure.source);
        let start = self.poses_of(None).start;
        let poses = drawn.poses.get(range.clone())?;
        let times = &self.drive_times()[range.start - start..range.end - start];
        let mut found = Vec::new();
        for sign in taking.sides() {
            let sought = SoughtExtreme {
                formula,
                sign: *sign,
            };
            found.extend(self.extreme_times(&sought, (times, poses), solver)?);
        }
        Some(found)
    }

    /// Times of all local extremes that may be the sought one; `None` if there is none that is found, or one that is not.
    fn extreme_times(
        &self,
        sought: &SoughtExtreme,
        (times, poses): (&[f64], &[Vec<f64>]),
        solver: &mut PoseSolver,
    ) -> Option<Vec<f64>> {
        let value = |pose: &Vec<f64>| {
            let slots = observed_slots(self.mechanism(), pose);
            sought.sign * sought.formula.value(&slots)
        };
        let values: Vec<f64> = poses.iter().map(value).collect();
        let best = values.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        let duration = self.actuation.duration;
        let last = values.len().checked_sub(1)?;
        let mut found = Vec::new();
        // A motion that goes on from its end to its start has no pose at its end.
        let goes_on = times[last] < duration;
        for (k, here) in values.iter().enumerate() {
            let [before, after] = match goes_on {
                true => [(k + last) % (last + 1), (k + 1) % (last + 1)],
                false => [k.saturating_sub(1), (k + 1).min(last)],
            };
            let drop = (here - values[before]).max(here - values[after]);
            let is_peak = *here >= values[before] && *here >= values[after];
            if !is_peak || here + ALLOWANCE * drop < best {
                continue;
            }
            let from = if k == 0 { 0.0 } else { times[before] };
            let until = if k == last { duration } else { times[after] };
            let bracket = [from, until];
            let is_end = k == 0 || times[k] == duration;
            match self.peak_near(sought, (times[k], &poses[k]), bracket, solver) {
                Some(time) => found.push(time),
                None if k == 0 && goes_on => {
                    let bracket = [times[last], duration];
                    let place = (times[last], &poses[last][..]);
                    found.push(self.peak_near(sought, place, bracket, solver)?);
                }
                // An end of the drive is a pose of the study.
                None if is_end && self.is_greatest_at_end(sought, times[k], &poses[k]) => {}
                None => return None,
            }
        }
        Some(found)
    }

    /// Whether the formula falls from an end of the drive.
    fn is_greatest_at_end(&self, sought: &SoughtExtreme, time: f64, pose: &[f64]) -> bool {
        let drive = (&self.actuation, time);
        let slots = slot_series(self.system(), pose, RateVariable::Time, drive, 1);
        let slope = slots.map(|slots| sought.sign * sought.formula.value(&slots).coefficients()[1]);
        slope.is_some_and(|slope| {
            if time == 0.0 {
                slope <= 0.0
            } else {
                slope >= 0.0
            }
        })
    }

    /// The time near that of a pose at which the formula stops growing.
    fn peak_near(
        &self,
        sought: &SoughtExtreme,
        (mut time, pose): (f64, &[f64]),
        [from, until]: [f64; 2],
        solver: &mut PoseSolver,
    ) -> Option<f64> {
        let mut pose = pose.to_vec();
        let unknowns = self.mechanism().unknowns.len();
        for _ in 0..STEPS {
            let drive = (&self.actuation, time);
            let slots = slot_series(self.system(), &pose, RateVariable::Time, drive, 2)?;
            let along = sought.formula.value(&slots);
            let [_, slope, bend] = std::array::from_fn(|k| sought.sign * along.coefficients()[k]);
            let step = -slope / (2.0 * bend);
            let next = time + step;
            if !(bend < 0.0 && (from..=until).contains(&next)) {
                return None;
            }
            if step.abs() <= SMALL_STEP * (until - from) {
                return Some(next);
            }
            for (slot, coordinate) in pose[..unknowns].iter_mut().enumerate() {
                *coordinate = slots[slot].value_at(step);
            }
            pose[unknowns..].copy_from_slice(&self.actuation.inputs_at(next));
            if !solver.closed(&mut pose, Pace::Brisk) {
                return None;
            }
            time = next;
        }
        None
    }
}
