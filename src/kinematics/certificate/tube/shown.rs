//! Formulas of a pose (coordinates, traced points, outputs) over a tube, as Taylor models.

use super::shown_value::{LineSeries, ShownValue};
use super::stretches::Tube;
use super::taylor_model::TaylorModel;
use crate::kinematics::loops::observed::formula_value;
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;

impl Tube {
    /// A formula over the motion in it; `needed` are its dependencies.
    pub fn formula(
        &self,
        mechanism: &Mechanism,
        (formula, needed): (&Expression, &[bool]),
    ) -> TaylorModel {
        let [middle, everywhere] = self.path.series();
        let unknowns = mechanism.unknowns.len();
        let coordinates = self.coordinates(mechanism);
        let shown = |(k, coordinate): (usize, &TaylorModel)| {
            // The inputs' own remainder is part of the series.
            let off = if k < unknowns { coordinate.rest } else { 0.0 };
            ShownValue {
                middle: middle[k],
                everywhere: everywhere[k],
                beside: LineSeries::linear(coordinate.range(), Interval::around_zero(off), 1),
            }
        };
        let coordinates: Vec<ShownValue> = coordinates.iter().enumerate().map(shown).collect();
        formula_value(mechanism, &coordinates, (formula, needed)).model()
    }

    /// All values of a formula over the motion in it, as far as the ranges of the coordinates tell them.
    pub fn formula_range(
        &self,
        mechanism: &Mechanism,
        formula: (&Expression, &[bool]),
    ) -> Interval {
        let coordinates = self.coordinates(mechanism);
        let ranges: Vec<Interval> = coordinates.iter().map(TaylorModel::range).collect();
        formula_value(mechanism, &ranges, formula)
    }
}
