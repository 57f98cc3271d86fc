//! Measures at given poses: the quantities of every pose, reduced along the tracks, inserted into the measures'
//! formulas.

use super::family_error::FamilyError;
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::kinematics::measures::reduce::{Reduced, reduce_values};
use crate::kinematics::measures::values_along;
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource};
use crate::model::mechanism::Mechanism;
use crate::numbers::series::TaylorSeries;

/// The values of all measures and quantities at given poses.
#[derive(Clone, Debug, PartialEq)]
pub struct MeasureValues {
    /// Every measure of the mechanism.
    pub measures: Vec<f64>,
}

/// The quantities of a pose: coordinates, traces, outputs, and their series along the inputs by which measures are
/// differentiated.
pub(super) struct ShownMeasure {
    pub slots: Vec<f64>,
    along: Vec<(usize, Option<Vec<TaylorSeries>>)>,
}

impl ShownMeasure {
    /// The value of a formula, or its derivative by an input.
    pub fn value(&self, formula: &Expression, per: Option<usize>, scratch: &mut Vec<f64>) -> f64 {
        let Some(input) = per else {
            return formula.value_with(&self.slots, scratch);
        };
        let series = self.along.iter().find(|(k, _)| *k == input);
        match series {
            Some((_, Some(series))) => formula.value(series).coefficients()[1],
            _ => f64::NAN,
        }
    }
}

/// Coordinates, x, y, z of the traces, outputs.
fn measure_slots(mechanism: &Mechanism, pose: &[f64]) -> Vec<f64> {
    let arguments = mechanism.argument_values(pose);
    let mut slots = pose.to_vec();
    // Traced points, then outputs, which may use them and earlier outputs.
    for trace in &mechanism.traces {
        let frame = mechanism.bodies[trace.body]
            .world_from_body
            .pose(&arguments);
        slots.extend(frame.transform_point(trace.point).to_array());
    }
    let mut scratch = Vec::new();
    for output in &mechanism.outputs {
        let value = output.value_with(mechanism, &slots, &mut scratch);
        slots.push(value);
    }
    slots
}

impl Evaluator<'_> {
    /// The quantities of every pose.
    pub(super) fn shown(&self, track_poses: &TrackPoses) -> Vec<ShownMeasure> {
        let poses = track_poses.poses.iter().enumerate();
        poses
            .map(|(index, pose)| self.shown_at(index, pose))
            .collect()
    }

    fn shown_at(&self, index: usize, pose: &[f64]) -> ShownMeasure {
        let family = self.family;
        let system = family.system();
        let inputs = self.derived_by(index);
        let series = |input: usize| (input, values_along(system, pose, &[input], 1));
        ShownMeasure {
            slots: measure_slots(system.mechanism(), pose),
            along: inputs.into_iter().map(series).collect(),
        }
    }

    /// Inputs by which measures are differentiated at pose `index`.
    pub(super) fn derived_by(&self, index: usize) -> Vec<usize> {
        let mut inputs = Vec::new();
        for measure in &self.family.measures.list {
            if let MeasureSource::Over {
                track,
                per: Some(input),
                ..
            } = measure.source
                && self.family.poses_of(track).contains(&index)
                && !inputs.contains(&input)
            {
                inputs.push(input);
            }
        }
        inputs
    }

    /// Whether any measure contains a derivative by an input.
    pub(super) fn derives_by_inputs(&self) -> bool {
        let measures = self.family.measures.list.iter();
        let derives = |m: &Measure| matches!(m.source, MeasureSource::Over { per: Some(_), .. });
        measures.into_iter().any(derives)
    }

    /// The measures at the poses of the tracks.
    ///
    /// # Errors
    /// A measure that has no value (names it).
    pub fn measure(&self, track_poses: &TrackPoses) -> Result<MeasureValues, Rejection> {
        self.measured(track_poses, |_| true)
    }

    /// The same for a search, which looks at the objective and the limited measures only: others may have no value, and are NaN then.
    ///
    /// # Errors
    /// One of those has no value (names it).
    pub fn measure_sought(&self, track_poses: &TrackPoses) -> Result<MeasureValues, Rejection> {
        self.measured(track_poses, |index| self.family.is_sought(index))
    }

    /// All measures, of which those that count must have values.
    fn measured(
        &self,
        track_poses: &TrackPoses,
        counts: impl Fn(usize) -> bool,
    ) -> Result<MeasureValues, Rejection> {
        let shown = self.shown(track_poses);
        let (numbers, _) = self.numbers(track_poses, &shown);
        let measures = numbers[self.family.mechanism().inputs.len()..].to_vec();
        let mut values = measures.iter().enumerate();
        match values.find(|(index, value)| !value.is_finite() && counts(*index)) {
            Some((bad, _)) => {
                let name = self.family.measures.list[bad].name.clone();
                Err(Rejection::NoValue(name))
            }
            None => Ok(MeasureValues { measures }),
        }
    }

    /// Why the file's own values cannot be studied.
    pub fn refused_start(&self, poses: &TrackPoses, rejection: &Rejection) -> FamilyError {
        let why = match rejection {
            Rejection::NoValue(name) => self.why(poses, name),
            Rejection::NotReached { .. }
            | Rejection::BranchLost { .. }
            | Rejection::NoDerivative(_) => String::new(),
        };
        FamilyError::Lacks(format!("at the file's own values: {rejection}{why}"))
    }

    /// Why the measure called `name` has no value: which operation fails, at which pose.
    fn why(&self, track_poses: &TrackPoses, name: &str) -> String {
        let (measures, shown) = (&self.family.measures.list, self.shown(track_poses));
        let (numbers, _) = self.numbers(track_poses, &shown);
        let source = measures.iter().find(|m| m.name == name).map(|m| &m.source);
        let fault = match source {
            None => None,
            Some(MeasureSource::Formula(formula)) => formula.fault(&numbers),
            Some(MeasureSource::Over { track, of, .. }) => {
                let mut poses = self.family.poses_of(*track);
                poses.find_map(|pose| {
                    let fault = of.iter().find_map(|f| f.fault(&shown[pose].slots))?;
                    let (track, number) = self.family.place_of(pose);
                    Some(format!("{fault}, at pose {number} of {track}"))
                })
            }
        };
        fault.map_or_else(String::new, |fault| format!(": {fault}"))
    }

    /// Inputs and measures, the slots of the measures' formulas; and how those over tracks were computed.
    pub(super) fn numbers(
        &self,
        track_poses: &TrackPoses,
        shown: &[ShownMeasure],
    ) -> (Vec<f64>, Vec<Option<Reduced>>) {
        let mut numbers = self.family.actuation.inputs_at(0.0);
        let own = self.family.own_inputs();
        numbers[own..].copy_from_slice(&track_poses.values);
        let mut scratch = Vec::new();
        let mut reductions = Vec::with_capacity(self.family.measures.list.len());
        // Measures in the order of the scene: formulas may use those before them.
        for measure in &self.family.measures.list {
            let (value, reduced) = match &measure.source {
                MeasureSource::Formula(formula) => {
                    (formula.value_with(&numbers, &mut scratch), None)
                }
                MeasureSource::Over {
                    of,
                    per,
                    taking,
                    power,
                    ..
                } => {
                    let poses = &shown[self.family.poses_taken(&measure.source)];
                    let rows: Vec<Vec<f64>> = of
                        .iter()
                        .map(|f| {
                            poses
                                .iter()
                                .map(|s| s.value(f, *per, &mut scratch))
                                .collect()
                        })
                        .collect();
                    let reduced = reduce_values(*taking, *power, &rows, &[]);
                    (reduced.as_ref().map_or(f64::NAN, |r| r.value), reduced)
                }
            };
            numbers.push(value);
            reductions.push(reduced);
        }
        (numbers, reductions)
    }
}
