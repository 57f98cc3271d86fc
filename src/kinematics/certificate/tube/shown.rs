//! Formulas of a pose (coordinates, traced points, outputs) over a tube, as Taylor models.

use super::shown_value::{Line, ShownValue};
use super::stretches::Tube;
use super::taylor_model::TaylorModel;
use crate::kinematics::loops::observed::observed_slots;
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;

/// The slots that formulas use, over one tube.
pub struct TubeSlots {
    slots: Vec<ShownValue>,
}

impl Tube {
    /// The slots of the motion in it.
    pub fn shown(&self, mechanism: &Mechanism) -> TubeSlots {
        let [middle, everywhere] = self.path.series();
        let unknowns = mechanism.unknowns.len();
        let coordinates = self.coordinates(mechanism);
        let slot = |(k, coordinate): (usize, &TaylorModel)| {
            // The inputs' own remainder is part of the series.
            let off = if k < unknowns { coordinate.rest } else { 0.0 };
            ShownValue {
                middle: middle[k],
                everywhere: everywhere[k],
                beside: Line::linear(coordinate.range(), Interval::around_zero(off), 1),
            }
        };
        let slots: Vec<ShownValue> = coordinates.iter().enumerate().map(slot).collect();
        TubeSlots {
            slots: observed_slots(mechanism, &slots),
        }
    }
}

impl TubeSlots {
    /// A formula over the stretch.
    pub fn value(&self, formula: &Expression) -> TaylorModel {
        formula.value(&self.slots).model()
    }
}
