//! The quantities that a page shows: their values at all frames, the least and the greatest.

use super::markup::{Cell, Table};
use crate::diag::decimals_of;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use crate::numbers::decimal::rounded_to;
use crate::report::sentences::beside_unit;

/// Quantities whose values follow the slider.
const MOST_VALUES: usize = 24;

/// A quantity of the motion: an input, an output or an unknown.
pub(super) struct ShownQuantity {
    pub name: String,
    pub unit: String,
    factor: f64,
    place: QuantityPlace,
}

#[derive(Clone, Copy)]
enum QuantityPlace {
    Input(usize),
    Output(usize),
    Unknown(usize),
}

impl ShownQuantity {
    /// Values at all frames in the scene's unit, in six digits.
    pub fn values(&self, shown: &Trajectory) -> Vec<Option<f64>> {
        self.exact_values(shown)
            .map(|v| v.map(rounded_to_six))
            .collect()
    }

    fn exact_values(&self, shown: &Trajectory) -> impl Iterator<Item = Option<f64>> {
        let value = |frame: usize| self.value(shown, frame);
        (0..shown.samples.len())
            .map(value)
            .map(|v| v.filter(|v| v.is_finite()))
    }

    fn value(&self, shown: &Trajectory, frame: usize) -> Option<f64> {
        let sample = &shown.samples[frame];
        let pose = sample.pose.as_ref()?;
        Some(
            self.factor
                * match self.place {
                    QuantityPlace::Input(k) => sample.inputs[k],
                    QuantityPlace::Output(k) => pose.outputs[k],
                    QuantityPlace::Unknown(k) => pose.unknowns[k],
                },
        )
    }
}

/// The quantities that are shown: inputs, outputs, then unknowns.
pub(super) fn shown_quantities(mechanism: &Mechanism) -> Vec<ShownQuantity> {
    let of_kind = |kind| {
        (
            mechanism.unit_name(kind).to_owned(),
            mechanism.file_units(kind),
        )
    };
    let one = |(name, (unit, factor), place): (&String, _, QuantityPlace)| ShownQuantity {
        name: name.clone(),
        unit,
        factor,
        place,
    };
    let inputs = mechanism.inputs.iter().enumerate();
    let outputs = mechanism.outputs.iter().enumerate();
    let unknowns = mechanism.unknowns.iter().enumerate();
    inputs
        .map(|(k, c)| (&c.name, of_kind(c.kind), QuantityPlace::Input(k)))
        .chain(outputs.map(|(k, o)| (&o.name, mechanism.output_unit(o), QuantityPlace::Output(k))))
        .chain(unknowns.map(|(k, c)| (&c.name, of_kind(c.kind), QuantityPlace::Unknown(k))))
        .map(one)
        .take(MOST_VALUES)
        .collect()
}

/// Powers of ten that are exact: rounded by them, a number is the nearest one to its decimal.
const EXACT_POWER: i32 = 22;

/// In six digits, as the page shows it. Thousands of values are rounded at every move of a slider.
fn rounded_to_six(value: f64) -> f64 {
    let decimals = 5.0 - libm::log10(value.abs()).floor();
    if decimals.abs() > f64::from(EXACT_POWER) || value == 0.0 {
        return rounded_to(value, 6);
    }
    let power = 10_f64.powi(decimals.abs() as i32);
    match decimals >= 0.0 {
        true => (value * power).round() / power,
        false => (value / power).round() * power,
    }
}

/// Smallest and largest values of all quantities among the frames, in the scene's units, by name.
pub(super) fn extreme_values(
    mechanism: &Mechanism,
    shown: &Trajectory,
) -> Vec<(String, String, [f64; 2])> {
    let ends = |quantity: ShownQuantity| {
        let [least, greatest] = ends_of(quantity.exact_values(shown))?;
        Some((quantity.name, quantity.unit, [least.1, greatest.1]))
    };
    shown_quantities(mechanism)
        .into_iter()
        .filter_map(ends)
        .collect()
}

/// The frames and values at which a quantity is least and greatest.
fn ends_of(values: impl Iterator<Item = Option<f64>>) -> Option<[(usize, f64); 2]> {
    let known: Vec<(usize, f64)> = values
        .enumerate()
        .filter_map(|(k, v)| Some((k, v?)))
        .collect();
    let least = known.iter().min_by(|a, b| a.1.total_cmp(&b.1))?;
    let greatest = known.iter().max_by(|a, b| a.1.total_cmp(&b.1))?;
    Some([*least, *greatest])
}

/// Smallest and largest values of all quantities among the frames.
pub(super) fn extreme_table(mechanism: &Mechanism, shown: &Trajectory) -> Table {
    let mut table = Table::new(
        "Smallest and largest values among the poses shown",
        &[
            "quantity",
            "least:",
            "at t / s:",
            "",
            "greatest:",
            "at t / s:",
            "",
        ],
    );
    for quantity in shown_quantities(mechanism) {
        let mut row = vec![Cell::text(&quantity.name)];
        let ends = ends_of(quantity.exact_values(shown));
        let words = ["least", "greatest"];
        for (word, (frame, value)) in words.into_iter().zip(ends.into_iter().flatten()) {
            let time = shown.samples[frame].time;
            let about = format!("the {word} {}", quantity.name);
            row.extend([
                Cell::number(beside_unit(decimals_of(value, 6), &quantity.unit)),
                Cell::number(format!("{time:.4}")),
                Cell::Show {
                    frame,
                    mark: None,
                    about,
                },
            ]);
        }
        table.rows.push(row);
    }
    table
}
