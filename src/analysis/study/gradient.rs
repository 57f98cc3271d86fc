//! Exact derivatives of measures by the variables: rates of the poses, then the chain rule. A measure that contains a
//! derivative by an input needs the mixed second derivative, from Taylor series through the loops.

use super::measure::ShownMeasure;
use super::slopes::MeasureSlopes;
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::jobs;
use crate::kinematics::loops::observed::dependencies;
use crate::kinematics::measures::reduce::Reduced;
use crate::kinematics::measures::values_along;
use crate::model::expression::Expression;
use crate::model::measure::MeasureSource;
use crate::numbers::series::TaylorSeries;

/// Number of poses with mixed derivatives from which on another thread pays.
const LEAST_PORTION: usize = 32;

/// Measures at given poses and their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// Every measure of the mechanism.
    pub measures: Vec<f64>,
    /// d(measure)/d(variable): one row per measure.
    pub rows: Vec<Vec<f64>>,
}

impl Gradients {
    /// Whether a measure has derivatives by all variables.
    pub fn has_derivatives(&self, measure: usize) -> bool {
        self.rows[measure].iter().all(|slope| slope.is_finite())
    }
}

/// Derivatives of a pose's quantities by the variables.
pub(super) struct Changes {
    slopes: MeasureSlopes,
    /// Series along every variable to second order, for measures with derivatives by an input.
    variables: Vec<Vec<TaylorSeries>>,
    /// Series along an input by which measures are differentiated, alone and together with every variable.
    mixed: Vec<Mixed>,
}

/// Series to second order.
struct Mixed {
    input: usize,
    alone: Vec<TaylorSeries>,
    together: Vec<Vec<TaylorSeries>>,
}

impl Changes {
    /// Of all slots: one row per variable.
    pub(super) fn slopes(&self) -> &[Vec<f64>] {
        &self.slopes.rows
    }

    /// Adds `scale` times the derivative of a formula (or of its derivative by an input) to `row`.
    pub fn add(
        &self,
        formula: &Expression,
        per: Option<usize>,
        shown: &ShownMeasure,
        scale: f64,
        row: &mut [f64],
    ) {
        if let Some(mixed) = per.and_then(|k| self.mixed.iter().find(|m| m.input == k)) {
            // The mixed second derivative: the second coefficient of both moving minus those of each moving alone.
            let second = |series: &[TaylorSeries]| formula.value(series).coefficients()[2];
            let alone = second(&mixed.alone);
            let pairs = mixed.together.iter().zip(&self.variables);
            for (entry, (both, variable)) in row.iter_mut().zip(pairs) {
                *entry += scale * (second(both) - alone - second(variable));
            }
            return;
        }
        let slots = &shown.slots;
        let mut gradient = vec![0.0; slots.len()];
        formula.add_gradient(
            slots,
            scale,
            &mut gradient,
            &mut Vec::new(),
            &mut Vec::new(),
        );
        for slot in formula.slots() {
            for (entry, slopes) in row.iter_mut().zip(&self.slopes.rows) {
                *entry += gradient[slot] * slopes[slot];
            }
        }
    }
}

impl Evaluator<'_> {
    /// Measures and their exact gradients; NaN for measures without them that a search does not look at.
    ///
    /// Where a maximum, minimum or bow passes from one pose to another, the gradient is one-sided.
    ///
    /// # Errors
    /// An objective or a limited measure without a value or derivative (names it), or a singular pose.
    pub fn gradients(&self, track_poses: &TrackPoses) -> Result<Gradients, Rejection> {
        let found = self.gradients_with_gaps(track_poses)?;
        let list = self.family.measures.list.iter().enumerate();
        for (index, measure) in list.filter(|(index, _)| self.family.is_sought(*index)) {
            if !found.measures[index].is_finite() {
                return Err(Rejection::NoValue(measure.name.clone()));
            }
            if !found.has_derivatives(index) {
                return Err(Rejection::NoDerivative(measure.name.clone()));
            }
        }
        Ok(found)
    }

    /// The same, with NaN for what has no value or derivative.
    ///
    /// # Errors
    /// The evaluation was cancelled.
    pub fn gradients_with_gaps(&self, track_poses: &TrackPoses) -> Result<Gradients, Rejection> {
        let list = &self.family.measures.list;
        let count = track_poses.values.len();
        let shown = self.shown(track_poses);
        let (numbers, reductions) = self.numbers(track_poses, &shown);
        let changes = self.changes(track_poses, &shown)?;
        let mut rows = self.family.input_rows();
        for (measure, reduced) in list.iter().zip(&reductions) {
            let mut row = vec![0.0; count];
            match (&measure.source, reduced) {
                (MeasureSource::Formula(formula), _) => {
                    chain_rule(formula, &numbers, &rows, &mut row)
                }
                (source, Some(reduced)) => {
                    self.add_reduction(source, reduced, (&changes, &shown), &mut row)
                }
                _ => {}
            }
            rows.push(row);
        }
        let first = self.family.mechanism().inputs.len();
        let (measures, rows) = (numbers[first..].to_vec(), rows.split_off(first));
        Ok(Gradients { measures, rows })
    }

    /// Adds the derivatives of a measure over a track; NaN where a pose that counts has none.
    fn add_reduction(
        &self,
        source: &MeasureSource,
        reduced: &Reduced,
        (changes, shown): (&[Option<Changes>], &[ShownMeasure]),
        row: &mut [f64],
    ) {
        let MeasureSource::Over { track, of, per, .. } = source else {
            return;
        };
        let poses = self.family.poses_of(*track);
        for (formula, weights) in of.iter().zip(&reduced.weights) {
            for (pose, weight) in poses.clone().zip(weights) {
                if *weight == 0.0 {
                    continue;
                }
                match &changes[pose] {
                    Some(known) => known.add(formula, *per, &shown[pose], *weight, row),
                    None => row.fill(f64::NAN),
                }
            }
        }
    }

    /// Derivatives of the quantities `shown` of every pose by the variables; NaN for those of unknowns at singular poses.
    pub(super) fn changes(
        &self,
        track_poses: &TrackPoses,
        shown: &[ShownMeasure],
    ) -> Result<Vec<Option<Changes>>, Rejection> {
        let settled;
        let sensitivities = match track_poses.sensitivities() {
            Some(known) => known,
            None => {
                settled = self.clone().settled(track_poses.clone());
                settled.sensitivities().unwrap_or_default()
            }
        };
        let mechanism = self.family.mechanism();
        let variables = self.variables();
        let needed = self.needed_slots();
        let work = |index: usize| {
            // At a singular pose the unknowns have no derivatives; what does not depend on them has.
            let own = &sensitivities[index];
            let unknown;
            let own = match track_poses.is_singular(index) {
                true => {
                    unknown = vec![f64::NAN; own.len()];
                    &unknown
                }
                false => own,
            };
            let slots = &shown[index].slots;
            let slots = (&slots[..], &needed[..]);
            let slopes = MeasureSlopes::new(mechanism, &variables, slots, own);
            self.changes_at(index, &track_poses.poses[index], slopes)
        };
        let poses = track_poses.poses.len();
        // Only series through the loops are worth another thread.
        let threads = match self.derives_by_inputs() {
            true => jobs::core_count().min(poses.div_ceil(LEAST_PORTION)),
            false => 1,
        };
        let work = |(): &mut (), index| (!self.is_cancelled()).then(|| work(index));
        let found = jobs::share_work(poses, threads, || (), work);
        // Work that was cut short lacks some.
        if let Some(missing) = (0..poses).find(|k| found.get(*k).is_none_or(|(at, _)| at != k)) {
            let (track, pose) = self.family.place_of(missing);
            return Err(Rejection::NotReached { track, pose });
        }
        Ok(found.into_iter().map(|(_, changes)| changes).collect())
    }

    /// The slots that measures depend on.
    fn needed_slots(&self) -> Vec<bool> {
        let list = self.family.measures.list.iter();
        let formulas = list.flat_map(|measure| match &measure.source {
            MeasureSource::Over { of, .. } => &of[..],
            MeasureSource::Formula(_) => &[],
        });
        let slots: Vec<usize> = formulas.flat_map(Expression::slots).collect();
        dependencies(self.family.mechanism(), &slots)
    }

    fn changes_at(&self, index: usize, pose: &[f64], slopes: MeasureSlopes) -> Option<Changes> {
        let family = self.family;
        let (first, count) = (family.own_inputs(), family.study.variables.len());
        let inputs = self.derived_by(index);
        if inputs.is_empty() {
            return Some(Changes {
                slopes,
                variables: Vec::new(),
                mixed: Vec::new(),
            });
        }
        let series = |moving: &[usize]| values_along(family.system(), pose, moving, 2);
        let variables: Option<Vec<_>> = (0..count).map(|k| series(&[first + k])).collect();
        // Mixed derivatives by an input and a variable, for measures that contain derivatives by that input.
        let mixed: Option<Vec<Mixed>> = inputs
            .into_iter()
            .map(|input| {
                let together: Option<Vec<_>> =
                    (0..count).map(|k| series(&[input, first + k])).collect();
                Some(Mixed {
                    input,
                    alone: series(&[input])?,
                    together: together?,
                })
            })
            .collect();
        Some(Changes {
            slopes,
            variables: variables?,
            mixed: mixed?,
        })
    }
}

/// Adds the derivative of a formula of earlier numbers, whose derivatives are `rows`.
pub(super) fn chain_rule(
    formula: &Expression,
    numbers: &[f64],
    rows: &[Vec<f64>],
    row: &mut [f64],
) {
    let mut gradient = vec![0.0; numbers.len()];
    formula.add_gradient(
        numbers,
        1.0,
        &mut gradient,
        &mut Vec::new(),
        &mut Vec::new(),
    );
    // d(formula) = sum of partial derivatives times rows of the earlier numbers. What it does not depend on here may have none.
    for slot in formula.slots() {
        if gradient[slot] == 0.0 {
            continue;
        }
        for (entry, change) in row.iter_mut().zip(&rows[slot]) {
            *entry += gradient[slot] * change;
        }
    }
}
