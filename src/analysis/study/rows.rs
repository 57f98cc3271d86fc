//! A formula pose by pose: its values along a track, or its derivatives by an input; at which poses, with which signs,
//! and how the values are reduced to a number.

use super::family::ParametricMechanism;
use crate::kinematics::measures::reduce::{norm_bends, reduce_values};
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource, Taking};
use std::ops::Range;

/// The same formula at several poses, as `sign · factor · formula + shift` for every sign.
pub(super) struct StudyRows<'a> {
    pub formula: &'a Expression,
    pub per: Option<usize>,
    pub poses: Range<usize>,
    /// The signs to be considered.
    pub signs: &'static [f64],
    pub factor: f64,
    pub shift: f64,
    /// Number of slots that a pose must have for the formula.
    pub reach: usize,
    /// The formula depends on coordinates and outputs of coordinates only.
    pub is_free_of_traces: bool,
}

/// Values of rows, and their derivatives by the variables if asked for; sign after sign, pose after pose.
#[derive(Default)]
pub(super) struct Listed {
    pub values: Vec<f64>,
    pub slopes: Vec<Vec<f64>>,
    /// Of one number made of many: its second derivatives as far as they follow from the slopes of the many.
    pub bend: Option<Vec<Vec<f64>>>,
}

impl<'f> StudyRows<'f> {
    /// The rows of a measure that is the largest or smallest value over poses.
    pub fn of(family: &'f ParametricMechanism, measure: &'f Measure) -> Option<Self> {
        let MeasureSource::Over {
            of, per, taking, ..
        } = &measure.source
        else {
            return None;
        };
        // The largest less the smallest is no largest of some rows.
        if !taking.is_extreme() || *taking == Taking::Range {
            return None;
        }
        let poses = family.poses_taken(&measure.source);
        Some(Self::rows_along(
            family,
            poses,
            &of[0],
            *per,
            taking.sides(),
        ))
    }

    /// The rows of a measure that is reduced to one number from one value per pose, and the reduction.
    pub fn reduced(
        family: &'f ParametricMechanism,
        measure: &'f Measure,
    ) -> Option<(Self, Reduction)> {
        // Only measures over poses have rows, ...
        let MeasureSource::Over {
            of,
            per,
            taking,
            power,
            ..
        } = &measure.source
        else {
            return None;
        };
        // ... and a reduction takes a single formula: one value per pose.
        let [formula] = of.as_slice() else {
            return None;
        };
        let reduction = Reduction {
            taking: *taking,
            power: *power,
        };
        // The values as they are; other signs only turn minima and magnitudes into maxima.
        let poses = family.poses_taken(&measure.source);
        let rows = Self::rows_along(family, poses, formula, *per, &[1.0]);
        Some((rows, reduction))
    }

    fn rows_along(
        family: &'f ParametricMechanism,
        poses: Range<usize>,
        formula: &'f Expression,
        per: Option<usize>,
        signs: &'static [f64],
    ) -> Self {
        let (reach, is_free_of_traces) = needed_rows(family, formula);
        Self {
            formula,
            per,
            poses,
            signs,
            factor: 1.0,
            shift: 0.0,
            reach,
            is_free_of_traces,
        }
    }

    /// The rows times `factor`, and then more by `shift`.
    pub fn scaled(self, factor: f64, shift: f64) -> Self {
        Self {
            factor: self.factor * factor,
            shift: self.shift * factor + shift,
            ..self
        }
    }
}

/// The reduction of a list of values to one number.
#[derive(Clone, Copy, Debug)]
pub(super) struct Reduction {
    taking: Taking,
    power: f64,
}

impl Reduction {
    /// The one number, and its slope if those of the values are known.
    pub fn of(self, listed: Listed) -> Listed {
        let Listed { values, slopes, .. } = listed;
        let rows = [values];
        let Some(reduced) = reduce_values(self.taking, self.power, &rows, &[]) else {
            return Listed::default();
        };
        let [weights] = reduced.weights.as_slice() else {
            return Listed::default();
        };
        let mut whole = vec![0.0; slopes.first().map_or(0, Vec::len)];
        for (slope, weight) in slopes.iter().zip(weights).filter(|(_, w)| **w != 0.0) {
            // The slope of the one number is the weighted sum of the slopes of the values.
            let entries = whole.iter_mut().zip(slope);
            entries.for_each(|(entry, d)| *entry += weight * d);
        }
        let own = match self.taking {
            Taking::Norm => norm_bends(&rows[0], self.power, reduced.value),
            _ => None,
        };
        Listed {
            bend: own.map(|own| self.gauss_newton(&own, &slopes, &whole, reduced.value)),
            values: vec![reduced.value],
            slopes: if slopes.is_empty() {
                Vec::new()
            } else {
                vec![whole]
            },
        }
    }

    /// Second derivatives of a norm whose values are linear, with these `slopes` (Gauss-Newton).
    fn gauss_newton(
        self,
        own: &[f64],
        slopes: &[Vec<f64>],
        whole: &[f64],
        norm: f64,
    ) -> Vec<Vec<f64>> {
        let n = whole.len();
        let entry = |i: usize, j: usize| {
            let pairs = own.iter().zip(slopes);
            let sum: f64 = pairs.map(|(own, slope)| own * slope[i] * slope[j]).sum();
            sum - (self.power - 1.0) / norm * whole[i] * whole[j]
        };
        (0..n)
            .map(|i| (0..n).map(|j| entry(i, j)).collect())
            .collect()
    }
}

/// The number of slots needed for a formula, and whether no trace is among the relevant ones.
fn needed_rows(family: &ParametricMechanism, formula: &Expression) -> (usize, bool) {
    let mechanism = family.mechanism();
    let coordinates = mechanism.coordinate_count();
    let base = coordinates + 3 * mechanism.traces.len();
    let mut slots = formula.slots();
    let reach = slots.last().map_or(0, |last| last + 1);
    let mut free = true;
    while let Some(slot) = slots.pop() {
        // An output depends on everything that its formula uses.
        if slot >= base {
            slots.extend(mechanism.outputs[slot - base].slots(mechanism));
        } else if slot >= coordinates {
            free = false;
        }
    }
    (reach, free)
}
