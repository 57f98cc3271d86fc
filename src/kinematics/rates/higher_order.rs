//! Rates of any order at a closed pose: the Taylor series of the unknowns along given series of the inputs.
//!
//! Block by block and order by order: with all lower coefficients in place, and the k-th one zero, the k-th
//! coefficient of the residual is what the k-th coefficient of the unknowns must cancel, and it enters linearly with
//! the Jacobian of the pose. One factorisation serves all orders; nothing is differenced.

use super::residual_part;
use crate::kinematics::loops::observed::observed_values;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::TaylorSeries;

/// Pivots below this share of the largest one have no direction to divide by. A fold is found to the square root of
/// rounding (1.5e-8), so a pose within four times that may be the fold itself, where rates are infinite.
const FOLD_TOLERANCE: f64 = 6e-8;

/// Series of all coordinates (unknowns, then inputs) at a closed pose, up to `order`.
///
/// `coordinates` are the pose's; the constant coefficients of `inputs`, which go up to `order` too, are its inputs. `None` at a singular
/// pose, where the unknowns have no such series, or where a formula has no value.
pub fn higher_rates(
    system: &System,
    coordinates: &[f64],
    inputs: &[TaylorSeries],
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let n = mechanism.unknowns.len();
    let mut series: Vec<TaylorSeries> = coordinates[..n]
        .iter()
        .map(|q| TaylorSeries::linear(*q, 0.0, order))
        .collect();
    series.extend_from_slice(inputs);
    let (mut workspace, mut qr) = (BlockWorkspace::default(), PivotedQr::default());
    for block in &structure.blocks {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
        qr.factor(&workspace.jacobian, rows, columns, FOLD_TOLERANCE);
        if qr.rank() < columns {
            return None;
        }
        let mut step = vec![0.0; columns];
        // The k-th coefficient is linear in the k-th unknown: one factorisation serves all orders.
        for k in 1..=order {
            let mut right_side = residual_coefficient(mechanism, block, &series, k);
            right_side.iter_mut().for_each(|r| *r = -*r);
            qr.solve(&mut right_side, &mut step);
            for (unknown, step) in block.unknowns.iter().zip(&step) {
                series[*unknown].set(k, mechanism.scale_of(*unknown) * step);
            }
        }
    }
    let all_finite = series.iter().all(|s| s.is_finite());
    all_finite.then_some(series)
}

/// Coefficient k of the block's residual.
///
/// Up to order k the loop's product is I + hᵏ E, and E is skew because the product is a rotation: its three entries
/// are the coefficient of the rotation vector.
fn residual_coefficient(
    mechanism: &Mechanism,
    block: &Block,
    series: &[TaylorSeries],
    k: usize,
) -> Vec<f64> {
    let mut residual = Vec::with_capacity(block.rows());
    let series: Vec<TaylorSeries> = series.iter().map(|s| s.truncated(k)).collect();
    let arguments = output_arguments(mechanism, &block.arguments, &series);
    for part in &block.loops {
        let item = &mechanism.loops[part.index];
        let end = WalkFrame::at_end_of(&item.chain.steps, &arguments);
        // Coefficient k of the loop's product, as a residual.
        let six = residual_part(end.map(|c| c.coefficients()[k]), item.size);
        residual.extend(part.components.iter().map(|c| six[*c]));
    }
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let scale = mechanism.weight_of(*index);
        let value = equation.expression.value(&series);
        residual.push(value.coefficients()[k] * scale);
    }
    residual
}

/// What rates are taken by.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum By {
    /// Seconds of the drive.
    Time,
    /// One input, the others standing still: transfer functions.
    Input(usize),
}

impl By {
    /// Series of the inputs, whose values are `given`, along it.
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
}

/// Which rates a table shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct RateColumns {
    /// Highest order, at least one.
    pub order: usize,
    /// What they are taken by.
    pub by: By,
}

impl RateColumns {
    /// Names of the columns (`d2(h)/dt2`, `d(h)/d(phi)`) and the factors from internal values to the file's units;
    /// all orders of one quantity, then the next.
    pub fn headings(&self, mechanism: &Mechanism) -> Vec<(String, f64)> {
        let (below, unit) = match self.by {
            By::Time => ("t".to_owned(), 1.0),
            By::Input(k) => {
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
        let below = match self.by {
            By::Time => "s",
            By::Input(k) => mechanism.unit_name(mechanism.inputs[k].kind),
        };
        self.of_orders(mechanism, |_, kind, k| {
            let above = mechanism.unit_name(kind);
            let one = if above.is_empty() { "1" } else { above };
            match (below, k) {
                ("", _) => above.to_owned(),
                (_, 1) => format!("{one}/{below}"),
                (_, _) => format!("{one}/{below}^{k}"),
            }
        })
    }

    /// What `of` makes of every column: of the name and the kind of a quantity and the order.
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

    /// Values of the columns at a pose, in internal units; `None` where there are none.
    pub fn values(
        &self,
        system: &System,
        actuation: &Actuation,
        coordinates: &[f64],
        time: f64,
    ) -> Option<Vec<f64>> {
        let mechanism = system.mechanism();
        let given = &coordinates[mechanism.unknowns.len()..];
        let inputs = self.by.inputs(actuation, given, time, self.order);
        let series = higher_rates(system, coordinates, &inputs, self.order)?;
        let all = observed_values(mechanism, &series);
        let derivatives = all
            .iter()
            .flat_map(|s| (1..=self.order).map(|k| s.derivative(k)));
        Some(derivatives.collect())
    }
}

/// Fills the derivatives of every pose of a trajectory; those of singular poses stay empty.
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
