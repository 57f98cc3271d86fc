//! Rates of any order at a closed pose: the Taylor series of the unknowns along given series of the inputs.
//!
//! Block by block and order by order: with all lower coefficients in place, and the k-th one zero, the k-th
//! coefficient of the residual is what the k-th coefficient of the unknowns must cancel, and it enters linearly with
//! the Jacobian of the pose. One factorisation serves all orders; nothing is differenced.

use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::actuation::Actuation;
use crate::model::chain::{Argument, Chain, Motion, Step};
use crate::model::mechanism::{Coordinate, Kind, Mechanism};
use crate::numbers::series::{Series, drive, evaluate};
use glam::{DMat3, DVec3};

/// Pivots below this share of the largest one have no direction to divide by. A fold is found to the square root of
/// rounding (1.5e-8), so a pose within four times that may be the fold itself, where rates are infinite.
const FOLD_TOLERANCE: f64 = 6e-8;

/// A pose as a series: coefficient matrices and vectors.
struct PoseSeries {
    rotation: Vec<DMat3>,
    translation: Vec<DVec3>,
}

/// Value, sine and cosine of a joint's argument.
struct ArgumentSeries {
    value: Series,
    sin: Series,
    cos: Series,
}

/// Series of all coordinates (unknowns, then inputs) at a closed pose, up to `order`.
///
/// `coordinates` are the pose's; the constant coefficients of `inputs`, which go up to `order` too, are its inputs. `None` at a singular
/// pose, where the unknowns have no such series, or where a formula has no value.
pub fn rates(
    system: &System,
    coordinates: &[f64],
    inputs: &[Series],
    order: usize,
) -> Option<Vec<Series>> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let n = mechanism.unknowns.len();
    let mut series: Vec<Series> = coordinates[..n]
        .iter()
        .map(|q| Series::constant(*q, order))
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
        for k in 1..=order {
            let mut right_side = residual_coefficient(mechanism, block, &series, k);
            right_side.iter_mut().for_each(|r| *r = -*r);
            qr.solve(&mut right_side, &mut step);
            for (unknown, step) in block.unknowns.iter().zip(&step) {
                series[*unknown].set(k, mechanism.scale_of(*unknown) * step);
            }
        }
    }
    let finite = |s: &Series| s.coefficients().iter().all(|c| c.is_finite());
    series.iter().all(finite).then_some(series)
}

/// Coefficient k of the block's residual.
///
/// Up to order k the loop's product is I + hᵏ E, and E is skew because the product is a rotation: its three entries
/// are the coefficient of the rotation vector.
fn residual_coefficient(
    mechanism: &Mechanism,
    block: &Block,
    series: &[Series],
    k: usize,
) -> Vec<f64> {
    let mut residual = Vec::with_capacity(block.rows());
    let arguments = arguments(mechanism, &block.arguments, series, k);
    for part in &block.loops {
        let pose = chain(&mechanism.loops[part.index].chain, &arguments, k);
        let (r, t) = (pose.rotation[k], pose.translation[k] / mechanism.size);
        let turn = [
            r.y_axis.z - r.z_axis.y,
            r.z_axis.x - r.x_axis.z,
            r.x_axis.y - r.y_axis.x,
        ]
        .map(|v| 0.5 * v);
        let six = [turn, t.to_array()].concat();
        residual.extend(part.components.iter().map(|c| six[*c]));
    }
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let scale = mechanism.weight_of(*index);
        let value = evaluate(&equation.expression, series, k);
        residual.push(value.coefficients()[k] * scale);
    }
    residual
}

/// Series of the arguments in `used`; the others are left out.
fn arguments(
    mechanism: &Mechanism,
    used: &[usize],
    series: &[Series],
    order: usize,
) -> Vec<Option<ArgumentSeries>> {
    let mut all: Vec<Option<ArgumentSeries>> = mechanism.arguments.iter().map(|_| None).collect();
    for index in used {
        let value = match &mechanism.arguments[*index] {
            Argument::Affine(affine) => {
                let constant = Series::constant(affine.constant, order);
                affine.terms.iter().fold(constant, |sum, (slot, c)| {
                    &sum + &series[*slot].truncated(order).scaled(*c)
                })
            }
            Argument::Formula(expression) => evaluate(expression, series, order),
        };
        let (sin, cos) = value.sin_cos();
        all[*index] = Some(ArgumentSeries { value, sin, cos });
    }
    all
}

/// The product of a chain as a series.
fn chain(chain: &Chain, arguments: &[Option<ArgumentSeries>], order: usize) -> PoseSeries {
    let mut pose = PoseSeries {
        rotation: vec![DMat3::ZERO; order + 1],
        translation: vec![DVec3::ZERO; order + 1],
    };
    pose.rotation[0] = DMat3::IDENTITY;
    for step in &chain.steps {
        match *step {
            Step::Fixed(fixed) => {
                for (r, t) in pose.rotation.iter_mut().zip(&mut pose.translation) {
                    *t += *r * fixed.translation;
                    *r *= fixed.rotation;
                }
            }
            Step::Joint {
                motion,
                axis,
                argument,
                sign,
            } => {
                let Some(argument) = &arguments[argument] else {
                    continue;
                };
                match motion {
                    Motion::Translation => pose.translate(axis, &argument.value.scaled(sign)),
                    Motion::Rotation => {
                        pose.rotate(axis, &argument.sin.scaled(sign), &argument.cos)
                    }
                }
            }
        }
    }
    pose
}

impl PoseSeries {
    fn translate(&mut self, axis: usize, value: &Series) {
        let columns: Vec<DVec3> = self.rotation.iter().map(|r| r.col(axis)).collect();
        for (k, t) in self.translation.iter_mut().enumerate() {
            *t += convolved(&columns, value, k);
        }
    }

    /// Turns the frame about its own axis: only the two other columns change.
    fn rotate(&mut self, axis: usize, sin: &Series, cos: &Series) {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let a: Vec<DVec3> = self.rotation.iter().map(|r| r.col(i)).collect();
        let b: Vec<DVec3> = self.rotation.iter().map(|r| r.col(j)).collect();
        for (k, r) in self.rotation.iter_mut().enumerate() {
            *r.col_mut(i) = convolved(&a, cos, k) + convolved(&b, sin, k);
            *r.col_mut(j) = convolved(&b, cos, k) - convolved(&a, sin, k);
        }
    }
}

/// Coefficient k of the product of a series of vectors and one of numbers.
fn convolved(vectors: &[DVec3], numbers: &Series, k: usize) -> DVec3 {
    let pairs = vectors[..=k]
        .iter()
        .zip(numbers.coefficients()[..=k].iter().rev());
    pairs.map(|(v, c)| *v * *c).sum()
}

/// Series of everything a table shows besides the inputs: unknowns, x, y, z of every trace, outputs.
pub fn observed(mechanism: &Mechanism, coordinates: &[Series], order: usize) -> Vec<Series> {
    let mut slots = observed_slots(mechanism, coordinates, order);
    let after = slots.split_off(mechanism.coordinate_count());
    slots.truncate(mechanism.unknowns.len());
    slots.extend(after);
    slots
}

/// Series of all slots that a formula about the motion may use: coordinates, x, y, z of every trace, outputs.
pub fn observed_slots(mechanism: &Mechanism, coordinates: &[Series], order: usize) -> Vec<Series> {
    let mut slots = coordinates.to_vec();
    for trace in &mechanism.traces {
        let path = &mechanism.bodies[trace.body].world_from_body;
        let arguments = arguments(mechanism, &path.arguments(), coordinates, order);
        let pose = chain(path, &arguments, order);
        let mut place = [0, 1, 2].map(|_| Series::constant(0.0, order));
        for (k, (r, t)) in pose.rotation.iter().zip(&pose.translation).enumerate() {
            let point = *r * trace.point + *t;
            for (axis, series) in place.iter_mut().enumerate() {
                series.set(k, point[axis]);
            }
        }
        slots.extend(place);
    }
    for output in &mechanism.outputs {
        let value = evaluate(&output.expression, &slots, order);
        slots.push(value);
    }
    slots
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
    ) -> Vec<Series> {
        match self {
            Self::Time => {
                let drives = actuation.drives.iter();
                drives.map(|d| drive(d, time, order)).collect()
            }
            Self::Input(moving) => (0..given.len())
                .map(|k| {
                    let rate = if k == moving { 1.0 } else { 0.0 };
                    Series::linear(given[k], rate, order)
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
        let units = |kind| mechanism.file_units(kind);
        let named = |c: &Coordinate| (c.name.clone(), units(c.kind));
        let mut quantities: Vec<(String, f64)> = mechanism.unknowns.iter().map(named).collect();
        for trace in &mechanism.traces {
            let places = ["x", "y", "z"].map(|axis| format!("{}.{axis}", trace.name));
            quantities.extend(places.map(|name| (name, units(Kind::Length))));
        }
        let outputs = mechanism.outputs.iter();
        quantities.extend(outputs.map(|o| (o.name.clone(), units(o.kind))));
        let (below, unit) = match self.by {
            By::Time => ("t".to_owned(), 1.0),
            By::Input(k) => {
                let input = &mechanism.inputs[k];
                (format!("({})", input.name), units(input.kind))
            }
        };
        let orders = |(name, factor): (String, f64)| -> Vec<(String, f64)> {
            let heading = |k: usize| {
                let power = if k == 1 { String::new() } else { k.to_string() };
                let text = format!("d{power}({name})/d{below}{power}");
                (text, factor / unit.powi(k as i32))
            };
            (1..=self.order).map(heading).collect()
        };
        quantities.into_iter().flat_map(orders).collect()
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
        let series = rates(system, coordinates, &inputs, self.order)?;
        let all = observed(mechanism, &series, self.order);
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
