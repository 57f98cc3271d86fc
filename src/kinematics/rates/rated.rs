//! Values of formulas that contain rates, at the poses of a motion.

use super::columns::{RateVariable, slot_series};
use crate::kinematics::loops::forward::Observation;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::expression::Expression;
use crate::model::mechanism::OutputSource;
use crate::model::rate::RateOrder;
use crate::numbers::series::{HIGHEST_ORDER, TaylorSeries};

/// Rates of formulas at a pose of the motion with this actuation, at its time; NaN if they are infinite or
/// undetermined.
pub fn rate_values(
    system: &System,
    driven: (&Actuation, f64),
    coordinates: &[f64],
    rates: &[(Expression, RateOrder)],
) -> Vec<f64> {
    // Series are shared by rates of one kind.
    let mut known: Vec<(RateOrder, Option<Vec<TaylorSeries>>)> = Vec::new();
    let mut derivative = |formula: &Expression, kind: RateOrder, order: usize| {
        let place = known.iter().position(|(known, _)| *known == kind);
        let place = place.unwrap_or_else(|| {
            let by = RateVariable::from(kind.per);
            let series = slot_series(system, coordinates, by, driven, kind.order);
            known.push((kind, series));
            known.len() - 1
        });
        let series = known[place].1.as_ref();
        series.map_or(f64::NAN, |s| formula.value(s).derivative(order))
    };
    let value = |(formula, rate): &(Expression, RateOrder)| {
        let mut of_order = |order| derivative(formula, RateOrder { order, ..*rate }, rate.order);
        // At zeros of roots a rate depends on higher orders.
        let found = of_order(rate.order);
        match found.is_nan() && rate.order < HIGHEST_ORDER {
            true => of_order(HIGHEST_ORDER),
            false => found,
        }
    };
    rates.iter().map(value).collect()
}

/// Fills in the outputs of a pose that contain rates, and those that use them.
pub fn fill_rated_outputs(
    system: &System,
    driven: (&Actuation, f64),
    coordinates: &[f64],
    seen: &mut Observation,
) {
    let list = &system.mechanism().outputs;
    let is_rated = |source: &OutputSource| matches!(source, OutputSource::Rated(_));
    if !list.iter().any(|output| is_rated(&output.source)) {
        return;
    }
    // Outputs may use those before them: their values are appended one by one.
    let mut slots = coordinates.to_vec();
    slots.extend(seen.traces.iter().flat_map(|p| p.to_array()));
    let mut scratch = Vec::new();
    for (output, value) in list.iter().zip(&mut seen.outputs) {
        match &output.source {
            OutputSource::Rated(formula) => {
                let rates = rate_values(system, driven, coordinates, &formula.rates);
                *value = formula
                    .expression
                    .value(&[slots.as_slice(), &rates].concat());
            }
            OutputSource::Formula(formula) => *value = formula.value_with(&slots, &mut scratch),
            OutputSource::Distance(_) => {}
        }
        slots.push(*value);
    }
}
