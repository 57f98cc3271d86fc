//! The measures of eight designs at once from their poses.

use super::family::ParametricMechanism;
use crate::kinematics::measures::reduce::reduce_values;
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource};
use crate::numbers::octet::Octet;

/// Measures that are formulas of coordinates, traces and outputs.
#[derive(Clone, Copy, Debug)]
pub struct LaneMeasures<'f> {
    family: &'f ParametricMechanism,
}

/// Values of a formula: an entry per pose.
type Row = Vec<Octet>;

impl<'f> LaneMeasures<'f> {
    /// `None` if a measure needs more than that: a derivative, a rate, or a distance of bodies.
    pub fn new(family: &'f ParametricMechanism) -> Option<Self> {
        let is_formula = |measure: &Measure| match &measure.source {
            MeasureSource::Formula(_) => true,
            MeasureSource::Over { per, rates, .. } => per.is_none() && rates.is_empty(),
        };
        let are_formulas =
            family.mechanism().has_plain_outputs() && family.measures.list.iter().all(is_formula);
        are_formulas.then_some(Self { family })
    }

    /// The measures of each design, which has these values of the variables. `slots` are those of formulas at every pose,
    /// track by track and last those along the drive.
    pub fn of(self, slots: &[&[Vec<Octet>]], designs: &[Vec<f64>]) -> Vec<Vec<f64>> {
        let list = self.family.measures.list.iter();
        let rows = list.map(|measure| self.rows_of(measure, slots));
        let rows: Vec<Vec<Row>> = rows.collect();
        let one = |(lane, values): (usize, &Vec<f64>)| self.reduced(&rows, lane, values);
        designs.iter().enumerate().map(one).collect()
    }

    /// The measures of one lane.
    fn reduced(self, rows: &[Vec<Row>], lane: usize, values: &[f64]) -> Vec<f64> {
        let family = self.family;
        let (mut numbers, mut scratch) = (family.actuation.inputs_at(0.0), Vec::new());
        numbers[family.own_inputs()..].copy_from_slice(values);
        for (measure, rows) in family.measures.list.iter().zip(rows) {
            numbers.push(match &measure.source {
                MeasureSource::Formula(formula) => formula.value_with(&numbers, &mut scratch),
                MeasureSource::Over { taking, power, .. } => {
                    let row = |row: &Row| row.iter().map(|v| v.lane(lane)).collect();
                    let rows: Vec<Vec<f64>> = rows.iter().map(row).collect();
                    reduce_values(*taking, *power, &rows, &[]).map_or(f64::NAN, |r| r.value)
                }
            });
        }
        numbers.split_off(family.mechanism().inputs.len())
    }

    /// The values of a measure's formulas at its poses; none for a formula of other measures.
    fn rows_of(self, measure: &Measure, slots: &[&[Vec<Octet>]]) -> Vec<Row> {
        let MeasureSource::Over { track, of, .. } = &measure.source else {
            return Vec::new();
        };
        let poses = slots[track.unwrap_or(slots.len() - 1)];
        let is_left_out =
            self.family.ends_apart() && track.is_none() && !measure.source.reaches_end();
        let poses = &poses[..poses.len() - usize::from(is_left_out)];
        let mut scratch = Vec::new();
        let mut row = |formula: &Expression| -> Row {
            let values = poses.iter();
            values
                .map(|slots| formula.value_with(slots, &mut scratch))
                .collect()
        };
        of.iter().map(&mut row).collect()
    }
}
