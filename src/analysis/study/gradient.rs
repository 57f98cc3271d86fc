//! Exact derivatives of measures by the variables: Taylor series through the loops, then the chain rule.

use super::measure::{along, slots_at};
use super::{Evaluator, Rejection, Stand};
use crate::model::study::Rate;

/// Poses for which a thread of its own pays.
const LEAST_PORTION: usize = 32;

/// Measures of a stand and their derivatives.
#[derive(Clone, Debug, PartialEq)]
pub struct Gradients {
    /// Every measure of the study.
    pub measures: Vec<f64>,
    /// d(measure)/d(variable): one row per measure.
    pub rows: Vec<Vec<f64>>,
}

impl Evaluator<'_> {
    /// Measures and their exact gradients.
    ///
    /// Where a maximum, minimum or bow changes its pose the gradient is that of one side.
    ///
    /// # Errors
    /// A measure without a value or derivative (names it), or a singular pose.
    pub fn gradients(&self, stand: &Stand) -> Result<Gradients, Rejection> {
        let study = &self.family.study;
        let count = study.variables.len();
        let slots: Vec<Vec<f64>> = stand.poses.iter().map(|p| slots_at(self, p)).collect();
        let reduced = self.reductions(&slots);
        let numbers = self.formulas(stand, &reduced);
        // Derivatives of the slots of the measures' formulas: variables, reductions, measures.
        let mut rows: Vec<Vec<f64>> = (0..count).map(|k| unit(count, k)).collect();
        let changes = self.slot_changes(stand)?;
        for (reduction, reduced) in study.reductions.iter().zip(&reduced) {
            let mut row = vec![0.0; count];
            let poses = self.poses_of(reduction.track);
            for (formula, weights) in reduction.arguments.iter().zip(&reduced.weights) {
                for (pose, weight) in poses.clone().zip(weights) {
                    if *weight != 0.0 {
                        add(formula, &slots[pose], *weight, &changes[pose], &mut row);
                    }
                }
            }
            rows.push(row);
        }
        for measure in &study.measures {
            let mut row = vec![0.0; count];
            add(&measure.expression, &numbers, 1.0, &rows, &mut row);
            rows.push(row);
        }
        let first = count + reduced.len();
        let (measures, rows) = (numbers[first..].to_vec(), rows.split_off(first));
        for (index, measure) in study.measures.iter().enumerate() {
            let finite = measures[index].is_finite() && rows[index].iter().all(|v| v.is_finite());
            if !finite {
                return Err(Rejection::NoValue(measure.name.clone()));
            }
        }
        Ok(Gradients { measures, rows })
    }

    /// d(slot)/d(variable) of everything every pose shows: one row per slot.
    pub(super) fn slot_changes(&self, stand: &Stand) -> Result<Vec<Vec<Vec<f64>>>, Rejection> {
        let workers = std::thread::available_parallelism().map_or(1, usize::from);
        let portion = stand.poses.len().div_ceil(workers).max(LEAST_PORTION);
        let work =
            |poses: &[Vec<f64>]| -> Vec<_> { poses.iter().map(|p| self.changes_at(p)).collect() };
        let found: Vec<Option<Vec<Vec<f64>>>> = std::thread::scope(|scope| {
            let portions = stand.poses.chunks(portion);
            let workers: Vec<_> = portions.map(|p| scope.spawn(move || work(p))).collect();
            let results = workers.into_iter().map(|w| w.join().unwrap_or_default());
            results.flatten().collect()
        });
        let places = found.into_iter().enumerate();
        let changes = places.map(|(index, changes)| {
            changes.ok_or_else(|| {
                let (track, pose) = self.family.place_of(index);
                let track = self.family.study.tracks[track].name.clone();
                Rejection::NotReached { track, pose }
            })
        });
        changes.collect()
    }

    fn changes_at(&self, pose: &[f64]) -> Option<Vec<Vec<f64>>> {
        let study = &self.family.study;
        let (first, count) = (self.family.own_inputs(), study.variables.len());
        let mut rows: Vec<Vec<f64>> = Vec::new();
        let order = if study.rates.is_empty() { 1 } else { 2 };
        let mut alone: Vec<Vec<f64>> = Vec::with_capacity(count);
        for variable in 0..count {
            let series = along(self, pose, &[first + variable], order)?;
            rows.resize(series.len(), vec![0.0; count]);
            for (row, s) in rows.iter_mut().zip(&series) {
                row[variable] = s.coefficients()[1];
            }
            let second = |rate: &Rate| series[rate.slot].coefficients()[2];
            alone.push(study.rates.iter().map(second).collect());
        }
        // The mixed second derivative is the second coefficient of both moving less those of each alone.
        for (number, rate) in study.rates.iter().enumerate() {
            let second = |moving: &[usize]| -> Option<f64> {
                let series = along(self, pose, moving, 2)?;
                Some(series[rate.slot].coefficients()[2])
            };
            let input = second(&[rate.input])?;
            let mut row = vec![0.0; count];
            for (variable, entry) in row.iter_mut().enumerate() {
                let both = second(&[rate.input, first + variable])?;
                *entry = both - input - alone[variable][number];
            }
            rows.push(row);
        }
        Some(rows)
    }
}

fn unit(count: usize, k: usize) -> Vec<f64> {
    let mut row = vec![0.0; count];
    row[k] = 1.0;
    row
}

/// Adds `scale` times the derivative of a formula, whose slots change by `changes`, to `row`.
pub(super) fn add(
    formula: &crate::model::expression::Expression,
    slots: &[f64],
    scale: f64,
    changes: &[Vec<f64>],
    row: &mut [f64],
) {
    let mut gradient = vec![0.0; slots.len()];
    formula.add_gradient(
        slots,
        scale,
        &mut gradient,
        &mut Vec::new(),
        &mut Vec::new(),
    );
    for slot in formula.slots() {
        for (entry, change) in row.iter_mut().zip(&changes[slot]) {
            *entry += gradient[slot] * change;
        }
    }
}
