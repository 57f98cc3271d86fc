//! Measures of a stand: what every pose shows, reduced along the tracks, put into the measures' formulas.

use super::reduce::{Reduced, reduce};
use super::{Evaluator, Rejection, Stand};
use crate::kinematics::rates::rates;
use crate::kinematics::taylor::Series;
use crate::model::mechanism::Mechanism;

/// The numbers of a stand.
#[derive(Clone, Debug, PartialEq)]
pub struct Measured {
    /// Every measure of the study.
    pub measures: Vec<f64>,
}

/// What a pose shows: coordinates, traces, outputs, rates.
pub(super) fn slots_at(evaluator: &Evaluator, pose: &[f64]) -> Vec<f64> {
    let family = evaluator.family;
    let mut slots = shown(&family.mechanism, pose);
    if family.study.rates.is_empty() {
        return slots;
    }
    for rate in &family.study.rates {
        let series = along(evaluator, pose, &[rate.input], 1);
        slots.push(series.map_or(f64::NAN, |all| all[rate.slot].coefficients()[1]));
    }
    slots
}

/// Coordinates, x, y, z of the traces, outputs.
fn shown(mechanism: &Mechanism, pose: &[f64]) -> Vec<f64> {
    let arguments = mechanism.argument_values(pose);
    let mut slots = pose.to_vec();
    for trace in &mechanism.traces {
        let frame = mechanism.bodies[trace.body]
            .world_from_body
            .pose(&arguments);
        slots.extend(frame.transform_point(trace.point).to_array());
    }
    let mut scratch = Vec::new();
    for output in &mechanism.outputs {
        let value = output.expression.value_with(&slots, &mut scratch);
        slots.push(value);
    }
    slots
}

/// Series of coordinates, traces and outputs when the inputs `moving` change at unit rate.
pub(super) fn along(
    evaluator: &Evaluator,
    pose: &[f64],
    moving: &[usize],
    order: usize,
) -> Option<Vec<Series>> {
    let family = evaluator.family;
    let mechanism = &family.mechanism;
    let n = mechanism.unknowns.len();
    let inputs: Vec<Series> = (0..mechanism.inputs.len())
        .map(|k| {
            let rate = moving.iter().filter(|m| **m == k).count() as f64;
            Series::linear(pose[n + k], rate, order)
        })
        .collect();
    let coordinates = rates(mechanism, &family.structure, pose, &inputs, order)?;
    Some(crate::kinematics::rates::all_slots(
        mechanism,
        &coordinates,
        order,
    ))
}

impl Evaluator<'_> {
    /// The measures of a stand.
    ///
    /// # Errors
    /// A measure that has no value (names it).
    pub fn measure(&self, stand: &Stand) -> Result<Measured, Rejection> {
        let slots: Vec<Vec<f64>> = stand.poses.iter().map(|p| slots_at(self, p)).collect();
        let reduced = self.reductions(&slots);
        let numbers = self.formulas(stand, &reduced);
        let first = stand.values.len() + reduced.len();
        let measures = numbers[first..].to_vec();
        match measures.iter().position(|v| !v.is_finite()) {
            Some(bad) => {
                let name = self.family.study.measures[bad].name.clone();
                Err(Rejection::NoValue(name))
            }
            None => Ok(Measured { measures }),
        }
    }

    /// All reductions, from what the poses show.
    pub(super) fn reductions(&self, slots: &[Vec<f64>]) -> Vec<Reduced> {
        let study = &self.family.study;
        let mut scratch = Vec::new();
        let mut reduced = Vec::with_capacity(study.reductions.len());
        for reduction in &study.reductions {
            let poses = self.poses_of(reduction.track);
            let values: Vec<Vec<f64>> = reduction
                .arguments
                .iter()
                .map(|formula| {
                    let at = |s: &Vec<f64>| formula.value_with(s, &mut scratch);
                    slots[poses.clone()].iter().map(at).collect()
                })
                .collect();
            reduced.push(reduce(reduction.reducer, &values));
        }
        reduced
    }

    /// Variables, reductions and measures: the slots of the measures' formulas.
    pub(super) fn formulas(&self, stand: &Stand, reduced: &[Reduced]) -> Vec<f64> {
        let mut numbers = stand.values.clone();
        numbers.extend(reduced.iter().map(|r| r.value));
        let mut scratch = Vec::new();
        for measure in &self.family.study.measures {
            let value = measure.expression.value_with(&numbers, &mut scratch);
            numbers.push(value);
        }
        numbers
    }

    /// Which of all poses belong to a track.
    pub(super) fn poses_of(&self, track: usize) -> std::ops::Range<usize> {
        let tracks = &self.family.study.tracks;
        let start: usize = tracks[..track].iter().map(|t| t.inputs.len()).sum();
        start..start + tracks[track].inputs.len()
    }
}
