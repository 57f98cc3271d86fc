//! Measures of a motion: values over the poses of the drive or of a track, and formulas of them.

pub mod reduce;

use super::loops::observed::observed_slots;
use super::motion::continuation::solve_motion;
use super::rates::higher_order::higher_rates;
use super::rates::rated::rate_values;
use super::results::trajectory::{ClosedPose, Sample, Trajectory};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use crate::model::expression::Expression;
use crate::model::measure::{MeasureSource, MeasuredTrack, Measures};
use crate::model::rate::RateOrder;
use crate::numbers::series::{HIGHEST_ORDER, TaylorSeries};
use reduce::reduce_values;
use std::collections::HashMap;

/// The poses along a drive, or a track, that measures are taken at.
#[derive(Clone, Copy)]
pub struct DriveSamples<'s> {
    /// The samples.
    pub samples: &'s [Sample],
    /// The end of the motion, where it is none of them: that of a cyclic one.
    pub end: Option<&'s Sample>,
}

impl<'s> DriveSamples<'s> {
    /// Samples with the end of the motion.
    pub const fn all(samples: &'s [Sample]) -> Self {
        Self { samples, end: None }
    }

    /// The whole way.
    fn way(self) -> impl Iterator<Item = &'s Sample> {
        let last = self.samples.last().map_or(f64::INFINITY, |last| last.time);
        let end = self.end.filter(|end| end.time > last);
        self.samples.iter().chain(end)
    }

    /// Samples, the last of which is the end of the motion and none of the others if `is_apart`.
    pub fn with_end(samples: &'s [Sample], is_apart: bool) -> Self {
        match samples.split_last() {
            Some((end, samples)) if is_apart => Self {
                samples,
                end: Some(end),
            },
            _ => Self::all(samples),
        }
    }

    /// The first and the last pose.
    fn ends(self) -> [Option<&'s Sample>; 2] {
        [self.samples.first(), self.end.or(self.samples.last())]
    }
}

/// Values of all measures in internal units, in the order of the list; `None` if a pose on the way is missing or a
/// formula is undefined. `along` is the motion along `actuation`.
pub fn measure_motion(
    system: &System,
    actuation: &Actuation,
    measures: &Measures,
    along: DriveSamples,
) -> Vec<Option<f64>> {
    measure_watched(system, actuation, measures, along, &mut |_| ())
}

/// The same from the samples along the drive; `seen` is called with the motion along every track, including the way to
/// its first pose.
pub fn measure_watched(
    system: &System,
    actuation: &Actuation,
    measures: &Measures,
    along: DriveSamples,
    seen: &mut dyn FnMut(&Trajectory),
) -> Vec<Option<f64>> {
    let mut over = measure_over((system, actuation), measures, None, along);
    for (k, track) in measures.tracks.iter().enumerate() {
        // The poses of one track at a time: together they could fill the memory.
        let motion = motion_along(system, actuation, track);
        seen(&motion);
        let poses = poses_along(motion);
        let along = DriveSamples::all(&poses);
        over.extend(measure_over((system, actuation), measures, Some(k), along));
    }
    let inputs = actuation.inputs_at(0.0);
    let mut values: Vec<Option<f64>> = Vec::new();
    for (index, measure) in measures.list.iter().enumerate() {
        let value = match &measure.source {
            MeasureSource::Formula(formula) => {
                // An undefined slot makes everything that uses it undefined.
                let earlier = values.iter().map(|v| v.unwrap_or(f64::NAN));
                let slots: Vec<f64> = inputs.iter().copied().chain(earlier).collect();
                formula_value(formula, &slots)
            }
            MeasureSource::Over { .. } => over.get(&index).copied(),
        };
        values.push(value.filter(|v| v.is_finite()));
    }
    values
}

/// The value of a formula of the inputs and earlier measures; `None` where it has none.
pub fn formula_value(formula: &Expression, slots: &[f64]) -> Option<f64> {
    Some(formula.value(slots)).filter(|value| value.is_finite())
}

/// The values of the measures over one track, or over the drive, by their index.
fn measure_over(
    driven: (&System, &Actuation),
    measures: &Measures,
    wanted: Option<usize>,
    along: DriveSamples,
) -> HashMap<usize, f64> {
    let list = measures.list.iter().enumerate();
    let values = list.filter_map(|(index, measure)| match &measure.source {
        MeasureSource::Over {
            track,
            of,
            rates,
            per,
            taking,
            power,
            ..
        } if *track == wanted => {
            // Values of the formulas at all samples of the track, or at its ends, then their reduction to one number.
            let poses: Vec<&Sample> = match taking.is_of_ends() {
                true => along.ends().into_iter().flatten().collect(),
                false if measure.source.reaches_end() => along.way().collect(),
                false => along.samples.iter().collect(),
            };
            let at = |formula: &Expression| -> Option<Vec<f64>> {
                let one = |s: &&Sample| value_at(driven, s, (formula, rates), *per);
                poses.iter().map(one).collect()
            };
            if along.samples.iter().any(|sample| sample.pose.is_none()) {
                return None;
            }
            let rows: Option<Vec<Vec<f64>>> = of.iter().map(at).collect();
            let times: Vec<f64> = poses.iter().map(|sample| sample.time).collect();
            let reduced = reduce_values(*taking, *power, &rows?, &times)?;
            Some((index, reduced.value))
        }
        _ => None,
    });
    values.collect()
}

/// The value of a formula at a pose, or its derivative by an input.
fn value_at(
    (system, actuation): (&System, &Actuation),
    sample: &Sample,
    (formula, rates): (&Expression, &[(Expression, RateOrder)]),
    per: Option<usize>,
) -> Option<f64> {
    let pose = sample.pose.as_ref()?;
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let Some(input) = per else {
        let mut slots = pose_slots(pose, &sample.inputs);
        slots.extend(rate_values(
            system,
            (actuation, sample.time),
            &coordinates,
            rates,
        ));
        return Some(formula.value(&slots));
    };
    // The derivative by the input: a series of first order along it; at zeros of roots it depends on higher orders.
    let rate = |order: usize| {
        let series = values_along(system, &coordinates, &[input], order)?;
        Some(formula.value(&series).coefficients()[1])
    };
    rate(1)
        .filter(|known| !known.is_nan())
        .or_else(|| rate(HIGHEST_ORDER))
}

/// The slots of formulas of a pose: coordinates, x, y, z of the traces, outputs.
fn pose_slots(pose: &ClosedPose, inputs: &[f64]) -> Vec<f64> {
    let mut slots = [pose.unknowns.as_slice(), inputs].concat();
    slots.extend(pose.traces.iter().flat_map(|p| p.to_array()));
    slots.extend(&pose.outputs);
    slots
}

/// Series of coordinates, traces and outputs at a closed pose when the inputs `moving` change at unit rate (an input
/// named twice, at twice that); `None` at a singular pose.
pub fn values_along(
    system: &System,
    coordinates: &[f64],
    moving: &[usize],
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let n = mechanism.unknowns.len();
    let inputs: Vec<TaylorSeries> = (0..mechanism.inputs.len())
        .map(|k| {
            let rate = moving.iter().filter(|m| **m == k).count() as f64;
            TaylorSeries::linear(coordinates[n + k], rate, order)
        })
        .collect();
    let all = higher_rates(system, coordinates, &inputs, order)?;
    Some(observed_slots(mechanism, &all))
}

/// The poses of a track; samples that are not reached have none.
pub fn poses_of(system: &System, actuation: &Actuation, track: &MeasuredTrack) -> Vec<Sample> {
    poses_along(motion_along(system, actuation, track))
}

/// The motion from the start of the drive to the start of a track and along it, so that it stays on the branch. Its first sample
/// does not belong to the track.
pub fn motion_along(system: &System, actuation: &Actuation, track: &MeasuredTrack) -> Trajectory {
    let (moved, times) = driven_along(actuation, track);
    solve_motion(system, &moved, &times)
}

/// The poses of the track along a motion.
fn poses_along(motion: Trajectory) -> Vec<Sample> {
    let mut samples = motion.of_one_motion();
    samples.remove(0);
    samples
}

/// Drives from the start of `actuation` to the start of a track and along it, and the times: that of the start, then
/// those of the track's samples.
pub fn driven_along(actuation: &Actuation, track: &MeasuredTrack) -> (Actuation, Vec<f64>) {
    let start = actuation.inputs_at(0.0);
    let count = track.samples;
    let times: Vec<f64> = (0..=count).map(|k| k as f64).collect();
    // From the start of the drive to the start of the track in one second, then one second per sample.
    let drives = start.iter().enumerate().map(|(input, start)| {
        let steps = (0..count).map(|k| track.input_at(input, k));
        Drive::Keys {
            times: times.clone(),
            values: std::iter::once(*start).chain(steps).collect(),
            ease: Ease::Linear,
        }
    });
    let moved = Actuation {
        drives: drives.collect(),
        duration: count as f64,
        guess: actuation.guess.clone(),
        named: actuation.named.clone(),
    };
    (moved, times)
}
