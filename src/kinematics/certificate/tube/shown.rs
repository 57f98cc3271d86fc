//! What formulas of a pose (coordinates, traced points, outputs) show over a tube, as Taylor models.

use super::model::{TaylorEnclosure, TaylorModel};
use super::stretches::Tube;
use crate::kinematics::loops::observed::observed_slots;
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;
use crate::numbers::series::Series;

/// From the path towards the motion: value and derivative along the line between them.
type Line = Series<Interval, 2>;

/// The slots that formulas use, over one tube.
pub struct Shown {
    /// About the middle of the stretch.
    middle: Vec<TaylorEnclosure>,
    /// About every place of it at once.
    everywhere: Vec<TaylorEnclosure>,
    /// Anywhere between path and motion, along any way from one to the other.
    beside: Vec<Line>,
}

impl Tube {
    /// The slots of the motion in it.
    pub fn shown(&self, mechanism: &Mechanism) -> Shown {
        let [middle, everywhere] = self.path.series();
        let unknowns = mechanism.unknowns.len();
        let beside: Vec<Line> = (self.coordinates(mechanism).iter().enumerate())
            .map(|(k, coordinate)| {
                // The inputs' own remainder is part of the series.
                let off = if k < unknowns { coordinate.rest } else { 0.0 };
                Line::linear(coordinate.range(), Interval::around_zero(off), 1)
            })
            .collect();
        Shown {
            middle: observed_slots(mechanism, middle),
            everywhere: observed_slots(mechanism, everywhere),
            beside: observed_slots(mechanism, &beside),
        }
    }
}

impl Shown {
    /// A formula over the stretch. By the mean value theorem its value on the motion is no farther from that on the path than
    /// its derivative on the way from one to the other.
    pub fn value(&self, formula: &Expression) -> TaylorModel {
        let [near, far] = [&self.middle, &self.everywhere].map(|slots| formula.value(slots));
        let [_, change] = *formula.value(&self.beside).coefficients();
        let mut model = TaylorModel::of(near, &far);
        model.rest += change.magnitude();
        model
    }
}
