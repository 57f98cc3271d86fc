//! Measures whose derivative differs from one side to the other: at a kink or a jump of a formula, or where several poses share an
//! extreme.

use super::gradient::{Changes, Gradients};
use super::measure::ShownMeasure;
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::model::expression::Expression;
use crate::model::measure::{MeasureSource, Taking};
use crate::model::mechanism::{Mechanism, OutputSource};

/// Step of the differences on both sides, as a fraction of a variable's unit: far above rounding, far below what bends a formula.
const STEP: f64 = 1e-7;

/// Differences that disagree by more than this fraction, or by more than this for values of size 1, are those of a kink.
const APART: f64 = 1e-3;

/// Values that agree to this fraction share an extreme.
const SHARED: f64 = 1e-10;

/// A formula at some slots that move with a variable.
struct Moved<'m> {
    slots: &'m [f64],
    slopes: &'m [f64],
    step: f64,
}

impl Moved<'_> {
    /// Whether the formula has different slopes on both sides, or its gradient is that of neither.
    fn is_kinked(&self, formula: &Expression) -> bool {
        let at = |by: f64| {
            let moved = self.slots.iter().zip(self.slopes);
            let slots: Vec<f64> = moved.map(|(slot, slope)| slot + by * slope).collect();
            formula.value(&slots)
        };
        let [before, here, after] = [-self.step, 0.0, self.step].map(at);
        let [left, right] = [here - before, after - here];
        let gradient = formula.gradient(self.slots);
        let along = gradient.iter().zip(self.slopes);
        let told: f64 = along
            .map(|(by_slot, slope)| by_slot * slope * self.step)
            .sum();
        let size = left.abs() + right.abs() + here.abs().max(1.0) * self.step;
        (right - left).abs() > APART * size || (right - told).abs() > APART * size
    }
}

impl Evaluator<'_> {
    /// For every measure whether its derivatives, which are known, are those of one side only.
    ///
    /// # Errors
    /// The evaluation was cancelled.
    pub fn one_sided(
        &self,
        track_poses: &TrackPoses,
        gradients: &Gradients,
    ) -> Result<Vec<bool>, Rejection> {
        let family = self.family;
        let mechanism = family.mechanism();
        let shown = self.shown(track_poses);
        let (numbers, reductions) = self.numbers(track_poses, &shown);
        let changes = self.changes(track_poses, &shown)?;
        let steps = self.variable_steps();
        let mut found: Vec<bool> = Vec::with_capacity(reductions.len());
        for (measure, reduced) in family.measures.list.iter().zip(&reductions) {
            let is_one_sided = match (&measure.source, reduced) {
                _ if !gradients.has_derivatives(found.len()) => false,
                (MeasureSource::Formula(formula), _) => {
                    let first = mechanism.inputs.len();
                    let used = formula.slots();
                    let mut earlier = used.iter().filter_map(|slot| slot.checked_sub(first));
                    earlier.any(|index| found[index])
                        || (0..steps.len()).any(|k| {
                            // Inputs at the start, the variables among them, then measures.
                            let mut slopes = vec![0.0; first];
                            slopes[family.own_inputs() + k] = 1.0;
                            slopes.extend(gradients.rows.iter().map(|row| row[k]));
                            let moved = Moved {
                                slots: &numbers,
                                slopes: &slopes,
                                step: steps[k],
                            };
                            moved.is_kinked(formula)
                        })
                }
                (MeasureSource::Over { per: Some(_), .. }, _) | (_, None) => false,
                (
                    MeasureSource::Over {
                        track, of, taking, ..
                    },
                    Some(reduced),
                ) => {
                    let poses = family.poses_of(*track);
                    let known = poses.map(|pose| (&shown[pose], &changes[pose]));
                    let known: Vec<_> = known.collect();
                    // Only poses that count: of an extreme a single one.
                    let is_kinked = of.iter().zip(&reduced.weights).any(|(formula, weights)| {
                        let mut counted = known.iter().zip(weights).filter(|(_, w)| **w != 0.0);
                        counted.any(|((shown, changes), _)| {
                            kinked_at(mechanism, formula, shown, changes, &steps)
                        })
                    });
                    let shares = |formula| shares_extreme(*taking, formula, &known);
                    is_kinked || of.first().is_some_and(shares)
                }
            };
            found.push(is_one_sided);
        }
        Ok(found)
    }

    /// Steps of all variables.
    fn variable_steps(&self) -> Vec<f64> {
        let mechanism = self.family.mechanism();
        let unknowns = mechanism.unknowns.len();
        let variables = self.variables().into_iter();
        variables
            .map(|input| STEP * mechanism.scale_of(unknowns + input))
            .collect()
    }
}

/// Whether a formula of a pose, or an output in it, has a kink along a variable there.
fn kinked_at(
    mechanism: &Mechanism,
    formula: &Expression,
    shown: &ShownMeasure,
    changes: &Option<Changes>,
    steps: &[f64],
) -> bool {
    let slots = &shown.slots;
    let Some(changes) = changes else {
        return false;
    };
    let first = slots.len() - mechanism.outputs.len();
    // The formula, and those of the outputs that it uses.
    let mut formulas = vec![formula];
    let mut next = 0;
    while let Some(formula) = formulas.get(next) {
        let used = formula.slots().into_iter();
        let outputs = used.filter_map(|slot| mechanism.outputs.get(slot.checked_sub(first)?));
        for output in outputs.collect::<Vec<_>>() {
            if let OutputSource::Formula(own) = &output.source
                && !formulas.contains(&own)
            {
                formulas.push(own);
            }
        }
        next += 1;
    }
    let rows = changes.slopes().iter().zip(steps);
    rows.into_iter().any(|(slopes, step)| {
        let moved = Moved {
            slots,
            slopes,
            step: *step,
        };
        formulas.iter().any(|formula| moved.is_kinked(formula))
    })
}

/// Whether two poses share the extreme of a formula with different derivatives.
fn shares_extreme(
    taking: Taking,
    formula: &Expression,
    poses: &[(&ShownMeasure, &Option<Changes>)],
) -> bool {
    let ways: &[f64] = match taking {
        Taking::Min => &[-1.0],
        Taking::Max => &[1.0],
        Taking::Range | Taking::Largest => &[1.0, -1.0],
        _ => return false,
    };
    let valued = poses.iter().filter_map(|(shown, changes)| {
        let value = formula.value(&shown.slots);
        Some((value, *shown, changes.as_ref()?))
    });
    let valued: Vec<_> = valued.collect();
    let row = |sign: f64, shown: &ShownMeasure, changes: &Changes| {
        let mut row = vec![0.0; changes.slopes().len()];
        changes.add(formula, None, shown, sign, &mut row);
        row
    };
    // Signed values: of a largest magnitude both ways compete.
    let signed = ways.iter().flat_map(|sign| {
        valued
            .iter()
            .map(move |(v, s, c)| (sign * v, *sign, *s, *c))
    });
    let signed: Vec<_> = signed.collect();
    let groups: Vec<Vec<_>> = match taking {
        Taking::Range => ways
            .iter()
            .map(|way| signed.iter().filter(|item| item.1 == *way).collect())
            .collect(),
        _ => vec![signed.iter().collect()],
    };
    groups.into_iter().any(|group| {
        let Some(best) = group.iter().max_by(|a, b| a.0.total_cmp(&b.0)) else {
            return false;
        };
        let own = row(best.1, best.2, best.3);
        let size = own.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let mut rivals = group
            .iter()
            .filter(|item| best.0 - item.0 <= SHARED * best.0.abs());
        rivals.any(|item| {
            let other = row(item.1, item.2, item.3);
            let mut pairs = own.iter().zip(&other);
            pairs.any(|(a, b)| (a - b).abs() > APART * size.max(b.abs()))
        })
    })
}
