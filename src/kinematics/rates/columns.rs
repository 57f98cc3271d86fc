//! Rates as shown in tables: their variable, names and units, and their values at a pose.

use super::fold::series_beside_fold;
use super::higher_order::higher_rates;
use crate::kinematics::loops::observed::needed_slots;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::dimension::PhysicalDimension;
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::model::rate::Per;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::{HIGHEST_ORDER, TaylorSeries};

/// The variable of differentiation.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RateVariable {
    /// Seconds of the drive.
    Time,
    /// One input, the others constant: transfer functions.
    Input(usize),
}

impl From<Per> for RateVariable {
    fn from(per: Per) -> Self {
        match per {
            Per::Time => Self::Time,
            Per::Input(k) => Self::Input(k),
        }
    }
}

impl RateVariable {
    /// Series of the inputs along it, with the `given` values.
    pub fn inputs(
        self,
        actuation: &Actuation,
        given: &[f64],
        time: f64,
        order: usize,
    ) -> Vec<TaylorSeries> {
        match self {
            Self::Time => {
                let drives = actuation.drives.iter();
                drives.map(|d| d.series(time, order)).collect()
            }
            // The variable itself is the moving input; the others are constant.
            Self::Input(moving) => (0..given.len())
                .map(|k| {
                    let rate = if k == moving { 1.0 } else { 0.0 };
                    TaylorSeries::linear(given[k], rate, order)
                })
                .collect(),
        }
    }

    /// Its range during the motion.
    fn way(self, mechanism: &Mechanism, actuation: &Actuation, given: &[f64]) -> f64 {
        match self {
            Self::Time => actuation.duration,
            Self::Input(moving) => {
                let usual = mechanism.scale_of(mechanism.unknowns.len() + moving);
                let at = |share| actuation.drives[moving].value(share * actuation.duration);
                let far = LOOKS.map(|share| (at(share) - given[moving]).abs());
                let far = far.into_iter().fold(0.0, f64::max);
                if far > 0.0 { far } else { usual }
            }
        }
    }
}

/// Fractions of the duration at which the range of an input is evaluated.
const LOOKS: [f64; 5] = [0.0, 0.21, 0.47, 0.73, 1.0];

/// Series of all slots that formulas may use, along the variable of differentiation: for a motion driven by
/// `actuation`, at a pose at `time`. At a fold they are one-sided, with NaN for infinite coefficients; `None` at other
/// singular poses.
pub fn slot_series(
    system: &System,
    coordinates: &[f64],
    by: RateVariable,
    (actuation, time): (&Actuation, f64),
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let all = |_: usize| true;
    needed_series(system, coordinates, by, (actuation, time), order, all)
}

/// The same, of which only the slots needed are computed; others may be undefined.
pub fn needed_series(
    system: &System,
    coordinates: &[f64],
    by: RateVariable,
    (actuation, time): (&Actuation, f64),
    order: usize,
    is_needed: impl Fn(usize) -> bool,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let given = &coordinates[mechanism.unknowns.len()..];
    let of_order = |highest: usize| {
        let inputs = by.inputs(actuation, given, time, highest);
        let series = higher_rates(system, coordinates, &inputs, highest)?;
        let slots = needed_slots(mechanism, &series, &is_needed).into_iter();
        Some(slots.map(|slot| slot.truncated(order)).collect())
    };
    let is_whole = |slots: &Vec<TaylorSeries>| {
        let mut numbered = slots.iter().enumerate();
        numbered.all(|(slot, series)| !is_needed(slot) || series.is_finite())
    };
    // At zeros of roots a rate depends on higher orders: that of √(t²) is the root of the second.
    let first = of_order(order);
    let known = match first.as_ref().is_some_and(is_whole) || order == HIGHEST_ORDER {
        true => first,
        false => of_order(HIGHEST_ORDER).or(first),
    };
    known.or_else(|| {
        let inputs = by.inputs(actuation, given, time, HIGHEST_ORDER);
        let way = by.way(mechanism, actuation, given);
        series_beside_fold(system, coordinates, &inputs, way, order)
    })
}

/// The rates that a table shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateColumns {
    /// Highest order, at least one.
    pub order: usize,
    /// Their variable.
    pub by: RateVariable,
}

impl RateColumns {
    /// Names of the columns (`d2(h)/dt2`, `d(h)/d(phi)`) and the factors from internal values to the file's units;
    /// all orders of one quantity, then the next.
    pub fn headings(&self, mechanism: &Mechanism) -> Vec<(String, f64)> {
        let (below, unit) = match self.by {
            RateVariable::Time => ("t".to_owned(), 1.0),
            RateVariable::Input(k) => {
                let input = &mechanism.inputs[k];
                (
                    format!("({})", input.name),
                    mechanism.file_units(input.kind),
                )
            }
        };
        self.of_orders(mechanism, |name, kind, k| {
            let power = if k == 1 { String::new() } else { k.to_string() };
            let text = format!("d{power}({name})/d{below}{power}");
            (text, mechanism.file_units(kind) / unit.powi(k as i32))
        })
    }

    /// Units of the same columns: `mm/deg^2`; empty where there is none.
    pub fn units(&self, mechanism: &Mechanism) -> Vec<String> {
        let (below, variable) = match self.by {
            RateVariable::Time => ("s", PhysicalDimension::TIME),
            RateVariable::Input(k) => {
                let kind = mechanism.inputs[k].kind;
                (mechanism.unit_name(kind), PhysicalDimension::of(kind))
            }
        };
        let lengths = mechanism.unit_name(Kind::Length);
        self.of_orders(mechanism, |name, kind, k| {
            // Products and powers have units of their own; those with angles are in radians whatever the file's unit is.
            let output = mechanism.outputs.iter().find(|output| output.name == name);
            let own = output.map_or(PhysicalDimension::of(kind), |output| output.dimension);
            if kind == Kind::Number && own != PhysicalDimension::NUMBER {
                return match own.holds_angle() {
                    true => String::new(),
                    false => {
                        (own - variable * k as i32)
                            .unit_words(lengths, below, 1.0)
                            .0
                    }
                };
            }
            let above = mechanism.unit_name(kind);
            let one = if above.is_empty() { "1" } else { above };
            match (below, k) {
                ("", _) => above.to_owned(),
                (_, 1) => format!("{one}/{below}"),
                (_, _) => format!("{one}/{below}^{k}"),
            }
        })
    }

    /// Applies `of` to every column: to the name and kind of a quantity and the order.
    fn of_orders<T>(&self, mechanism: &Mechanism, of: impl Fn(&str, Kind, usize) -> T) -> Vec<T> {
        let mut quantities: Vec<(String, Kind)> = Vec::new();
        let named = |c: &Coordinate| (c.name.clone(), c.kind);
        quantities.extend(mechanism.unknowns.iter().map(named));
        for trace in &mechanism.traces {
            let places = ["x", "y", "z"].map(|axis| format!("{}.{axis}", trace.name));
            quantities.extend(places.map(|name| (name, Kind::Length)));
        }
        let outputs = mechanism.outputs.iter();
        quantities.extend(outputs.map(|o| (o.name.clone(), o.kind)));
        let mut list = Vec::with_capacity(quantities.len() * self.order);
        for (name, kind) in &quantities {
            list.extend((1..=self.order).map(|k| of(name, *kind, k)));
        }
        list
    }

    /// Values of the columns at a pose, in internal units; `None` if they do not exist.
    pub fn values(
        &self,
        system: &System,
        actuation: &Actuation,
        coordinates: &[f64],
        time: f64,
    ) -> Option<Vec<f64>> {
        let driven = (actuation, time);
        let slots = slot_series(system, coordinates, self.by, driven, self.order)?;
        let mechanism = system.mechanism();
        // Inputs have known rates and no columns.
        let inputs = mechanism.unknowns.len()..mechanism.coordinate_count();
        let shown = slots
            .iter()
            .enumerate()
            .filter(|(k, _)| !inputs.contains(k));
        let derivatives = shown.flat_map(|(_, s)| (1..=self.order).map(|k| s.derivative(k)));
        Some(derivatives.collect())
    }
}

/// Fills the derivatives of every pose of a trajectory; infinite or undetermined ones stay empty.
pub fn add_derivatives(
    system: &System,
    actuation: &Actuation,
    trajectory: &mut Trajectory,
    columns: RateColumns,
) {
    for sample in &mut trajectory.samples {
        if let Some(pose) = &mut sample.pose {
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            let values = columns.values(system, actuation, &coordinates, sample.time);
            pose.derivatives = values.unwrap_or_default();
        }
    }
}
