//! What rounding hides of the values of a motion: changes of a quantity that are smaller than it, and rates that lead to no
//! larger ones. Each sample has its own, since an output may be large near a pole and small elsewhere.

use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::OPERATION;
use crate::numbers::scalar::Scalar;

/// A change by less than so many roundings is none.
pub(super) const RESOLVED: f64 = 16.0;

/// An output is constant if its values differ by no more than so many times the rounding of one of them.
const ROUNDINGS: f64 = 1e3;

/// Roundings of all unknowns and outputs at all samples. Quantities are the unknowns and then the outputs.
pub(super) struct ValueRoundings<'m> {
    mechanism: &'m Mechanism,
    samples: &'m [Sample],
    /// Those of the outputs, at every sample that has a pose.
    outputs: Vec<Vec<f64>>,
}

impl<'m> ValueRoundings<'m> {
    pub(super) fn new(mechanism: &'m Mechanism, samples: &'m [Sample]) -> Self {
        let outputs = samples.iter().map(|sample| match &sample.pose {
            Some(pose) => {
                output_roundings(mechanism, &[&pose.unknowns[..], &sample.inputs].concat())
            }
            None => Vec::new(),
        });
        Self {
            mechanism,
            samples,
            outputs: outputs.collect(),
        }
    }

    /// The rounding of a quantity at a sample, zero where it has no value.
    fn at(&self, quantity: usize, sample: usize) -> f64 {
        let of_pose = |pose: &ClosedPose| match self.mechanism.unknowns.get(quantity) {
            Some(unknown) => {
                unknown_rounding(self.mechanism, unknown.kind, pose.unknowns[quantity])
            }
            None => {
                let output = quantity - self.mechanism.unknowns.len();
                let size = Some(pose.outputs[output].abs()).filter(|size| size.is_finite());
                self.outputs[sample][output].max(OPERATION * size.unwrap_or(0.0))
            }
        };
        self.samples[sample].pose.as_ref().map_or(0.0, of_pose)
    }

    /// The rate at a sample below which rounding hides in which direction the quantity goes to its neighbours.
    pub(super) fn least_rate(&self, quantity: usize, sample: usize) -> f64 {
        let last = self.samples.len() - 1;
        let ends = [sample.saturating_sub(1), (sample + 1).min(last)];
        let span = self.samples[ends[1]].time - self.samples[ends[0]].time;
        let interval = span / (ends[1] - ends[0]).max(1) as f64;
        RESOLVED * self.at(quantity, sample) / interval
    }

    /// Whether an output changes by no more than rounding.
    pub(super) fn is_constant(&self, quantity: usize) -> bool {
        let output = quantity - self.mechanism.unknowns.len();
        let poses = self.samples.iter().filter_map(|s| s.pose.as_ref());
        let values = poses.map(|pose| pose.outputs[output]);
        let ends = values
            .filter(|v| v.is_finite())
            .fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], v| {
                [low.min(v), high.max(v)]
            });
        let roundings = (0..self.samples.len()).map(|k| self.at(quantity, k));
        ends[1] - ends[0] <= ROUNDINGS * roundings.fold(0.0, f64::max)
    }
}

/// The rounding of each output at a pose, that of the unknowns included; zero where it cannot be told. Terms may cancel:
/// intervals tell what it is.
pub(super) fn output_roundings(mechanism: &Mechanism, coordinates: &[f64]) -> Vec<f64> {
    let first = mechanism.coordinate_count() + 3 * mechanism.traces.len();
    let rounded = |(k, value): (usize, &f64)| match mechanism.unknowns.get(k) {
        Some(unknown) => {
            let rounding = unknown_rounding(mechanism, unknown.kind, *value);
            Interval::new(value - rounding, value + rounding)
        }
        None => Interval::point(*value),
    };
    let coordinates: Vec<Interval> = coordinates.iter().enumerate().map(rounded).collect();
    let slots = observed_slots(mechanism, &coordinates);
    let width = |value: &Interval| match value.is_finite() {
        true => value.hi - value.lo,
        false => 0.0,
    };
    slots[first..].iter().map(width).collect()
}

/// The rounding of an unknown: a small angle follows from lengths and angles that are not.
fn unknown_rounding(mechanism: &Mechanism, kind: Kind, value: f64) -> f64 {
    OPERATION * value.abs().max(mechanism.natural_size(kind))
}
