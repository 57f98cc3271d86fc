//! Residual and analytic Jacobian of a group of loops and equations.
//!
//! A loop's product T must be the identity. Its residual is the rotation vector of T and the translation of T
//! over the mechanism's size: six numbers that vanish together only at the identity. Columns come from the
//! joints' twists: a rotation about axis a through o changes the translation t by a × (t - o) and turns the
//! frame by a; the inverse left Jacobian of SO(3) maps the turn to the rate of the rotation vector.

use super::joint_lanes::{JointGroup, LaneFrame};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::layout::{BlockPlan, LayoutEntry, PlannedEquation, PlannedLoop};
use crate::linalg::lanes::{Lanes, add_scaled, combine_rows, lane_groups};
use crate::math::Pose;
use crate::math::{left_jacobian_inverse, rotation_log};
use crate::model::chain::{Argument, ArgumentValue};
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// Buffers of one block's evaluation; made once, reused for every step.
#[derive(Clone, Debug, Default)]
pub struct BlockWorkspace {
    /// Residual, one entry per row of the block.
    pub residual: Vec<f64>,
    /// Jacobian with respect to the block's unknowns in their scaled form, column-major.
    pub jacobian: Vec<f64>,
    /// Rate of the residual along a direction of the other coordinates, in whole groups of lanes.
    pub drift: Vec<Lanes>,
    /// Derivative by coordinates of other blocks, in the order of the layout, column-major in whole groups of lanes and
    /// not scaled.
    outer: Vec<Lanes>,
    /// Rates of those coordinates.
    outer_rates: Vec<f64>,
    arguments: Vec<ArgumentValue>,
    joints: Vec<JointGroup>,
    /// Columns of a loop's joints, four joints at a time.
    columns: Vec<[Lanes; 6]>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
    /// All zero between uses.
    gradient: Vec<f64>,
}

/// What to compute besides the residual.
#[derive(Clone, Copy)]
pub enum Want<'a> {
    /// Residual only.
    Residual,
    /// Residual and Jacobian.
    Jacobian,
    /// Residual, Jacobian, and the drift along the given rates of all coordinates except the block's own unknowns.
    Drift(&'a [f64]),
}

/// The mechanism, the block's layout and the coordinates of one evaluation.
#[derive(Clone, Copy)]
struct UnknownSite<'a> {
    mechanism: &'a Mechanism,
    plan: &'a BlockPlan,
    coordinates: &'a [f64],
    rows: usize,
}

impl BlockWorkspace {
    /// Largest entry of the residual; infinite if any entry is not a number.
    pub fn residual_norm(&self) -> f64 {
        self.residual.iter().fold(0.0, |m: f64, r| {
            if r.is_nan() {
                f64::INFINITY
            } else {
                m.max(r.abs())
            }
        })
    }

    /// Joints of all loops of the block at the last evaluation, grouped as in the layout.
    pub(crate) fn joints(&self) -> &[JointGroup] {
        &self.joints
    }

    /// Evaluates `block` at `coordinates` (unknowns, then inputs).
    pub fn evaluate(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        coordinates: &[f64],
        want: Want,
    ) {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let with_columns = !matches!(want, Want::Residual);
        let plan = &block.plan;
        let site = UnknownSite {
            mechanism,
            plan,
            coordinates,
            rows,
        };
        self.residual.clear();
        self.residual.resize(rows, 0.0);
        if with_columns {
            self.jacobian.clear();
            self.jacobian.resize(rows * columns, 0.0);
            self.outer.clear();
            self.outer
                .resize(lane_groups(rows) * plan.outer.len(), [0.0; 4]);
        }
        // Joint values first, then the product and columns of every loop, then scalar equations.
        self.evaluate_arguments(site);
        self.joints.resize(plan.groups.len(), JointGroup::default());
        for item in &plan.loops {
            self.evaluate_loop(site, item, with_columns);
        }
        for equation in &plan.equations {
            self.evaluate_equation(site, equation, with_columns);
        }
        if let Want::Drift(rates) = want {
            self.drift_along(plan, rates);
        }
    }

    /// Fills `drift` along the given rates of all coordinates, from the last evaluation with a Jacobian.
    pub fn drift_along(&mut self, plan: &BlockPlan, rates: &[f64]) {
        self.outer_rates.clear();
        self.outer_rates
            .extend(plan.outer.iter().map(|slot| rates[*slot]));
        self.drift
            .resize(lane_groups(self.residual.len()), [0.0; 4]);
        combine_rows(&mut self.drift, &self.outer_rates, &self.outer);
        // The slope of a root at zero is infinite: what does not move adds nothing all the same.
        if self.drift.as_flattened().iter().any(|v| v.is_nan()) {
            let stride = self.drift.len().max(1);
            self.drift.fill([0.0; 4]);
            let rows = self.outer_rates.iter().zip(self.outer.chunks_exact(stride));
            for (rate, row) in rows.filter(|(rate, _)| **rate != 0.0) {
                add_scaled(&mut self.drift, *rate, row);
            }
        }
    }

    fn evaluate_arguments(&mut self, site: UnknownSite) {
        let still = ArgumentValue::default();
        self.arguments.resize(site.plan.arguments.len(), still);
        for (argument, own) in site.plan.arguments.iter().zip(&mut self.arguments) {
            let value = if argument.is_formula {
                site.mechanism.arguments[argument.index].value(site.coordinates, &mut self.values)
            } else {
                // Affine arguments are dot products with the coordinates.
                let terms = site.plan.shares[argument.shares.clone()].iter();
                terms.fold(argument.constant, |sum, share| {
                    sum + share.coefficient * site.coordinates[share.slot]
                })
            };
            own.renew(value, argument.turns);
        }
    }

    fn evaluate_loop(&mut self, site: UnknownSite, item: &PlannedLoop, with_columns: bool) {
        let product = self.walk(site.plan, item);
        let turn = rotation_log(&product.rotation);
        let six = residual_of(turn, product.translation, item.size);
        for (k, component) in item.components.iter().enumerate() {
            self.residual[item.row + k] = six[*component];
        }
        if with_columns {
            self.add_columns(site, item, turn, product.translation);
        }
    }

    /// Multiplies the loop's steps, recording every joint's axis and origin.
    fn walk(&mut self, plan: &BlockPlan, item: &PlannedLoop) -> Pose {
        let mut frame = LaneFrame::IDENTITY;
        let fours = plan.joints[item.joints.clone()].chunks(4);
        let noted = &mut self.joints[item.groups.clone()];
        for (joints, group) in fours.zip(noted) {
            for (lane, joint) in joints.iter().enumerate() {
                // Axis and origin are those before the joint's own motion.
                let (axis, origin) = frame.reach(joint);
                for k in 0..3 {
                    group.axis[k][lane & 3] = axis[k];
                    group.origin[k][lane & 3] = origin[k];
                }
                frame.pass(joint, &self.arguments[joint.argument]);
            }
        }
        frame.end(&item.end)
    }

    /// Distributes the joints' columns over the coordinates of their arguments.
    fn add_columns(
        &mut self,
        site: UnknownSite,
        item: &PlannedLoop,
        turn: DVec3,
        translation: DVec3,
    ) {
        // The rotation vector's rate is the inverse left Jacobian of SO(3) times the angular velocity.
        let log_from_spin = left_jacobian_inverse(turn);
        let per_size = 1.0 / item.size;
        let planned = &site.plan.groups[item.groups.clone()];
        let joints = &self.joints[item.groups.clone()];
        self.columns.resize(planned.len(), [[0.0; 4]; 6]);
        for ((columns, group), planned) in self.columns.iter_mut().zip(joints).zip(planned) {
            *columns = group.columns(planned, &log_from_spin, translation, per_size);
        }
        let outer = self.outer.as_flattened_mut();
        let (columns, components) = (&self.columns[..], &item.components[..]);
        if let [_, _, _, _, _, _] = components {
            add_whole(&mut self.jacobian, &item.own, columns);
            add_whole(outer, &item.outside, columns);
        } else {
            add_parts(&mut self.jacobian, &item.own, columns, components);
            add_parts(outer, &item.outside, columns, components);
        }
        for joint in &item.formulas {
            self.add_formula(site, item, *joint);
        }
    }

    /// Adds the column of a joint whose argument is a formula, times the formula's rates.
    fn add_formula(&mut self, site: UnknownSite, item: &PlannedLoop, joint: usize) {
        let argument = site.plan.joints[item.joints.start + joint].argument;
        let planned = &site.plan.arguments[argument];
        let Argument::Formula(expression) = &site.mechanism.arguments[planned.index] else {
            return;
        };
        self.gradient.resize(site.coordinates.len(), 0.0);
        let (values, adjoints) = (&mut self.values, &mut self.adjoints);
        // Reverse mode: one pass for the derivatives by all coordinates.
        expression.add_gradient(site.coordinates, 1.0, &mut self.gradient, values, adjoints);
        for share in &site.plan.shares[planned.shares.clone()] {
            let factor = std::mem::take(&mut self.gradient[share.slot]) * share.scale;
            let target = column_at(&mut self.jacobian, &mut self.outer, site.rows, share.column);
            let parts = item.components.iter();
            for (entry, component) in target[item.row..].iter_mut().zip(parts) {
                *entry += factor * self.columns[joint / 4][*component][joint % 4];
            }
        }
    }

    fn evaluate_equation(
        &mut self,
        site: UnknownSite,
        planned: &PlannedEquation,
        with_columns: bool,
    ) {
        let equation = &site.mechanism.equations[planned.index];
        let row = planned.row;
        let shares = &site.plan.shares[planned.shares.clone()];
        if let Some(quadratic) = &planned.quadratic {
            let value = quadratic.value(site.coordinates, &mut self.values);
            self.residual[row] = value * planned.scale;
            if with_columns {
                let (jacobian, outer) = (&mut self.jacobian, &mut self.outer);
                quadratic.each_slope(&self.values, |place, slope| {
                    let share = &shares[place];
                    let column = column_at(jacobian, outer, site.rows, share.column);
                    column[row] += slope * planned.scale * share.scale;
                });
            }
            return;
        }
        if !with_columns {
            let value = equation
                .expression
                .value_with(site.coordinates, &mut self.values);
            self.residual[row] = value * planned.scale;
            return;
        }
        // Value and gradient in one pass of reverse mode.
        self.gradient.resize(site.coordinates.len(), 0.0);
        let (values, adjoints) = (&mut self.values, &mut self.adjoints);
        let value = equation.expression.add_gradient(
            site.coordinates,
            planned.scale,
            &mut self.gradient,
            values,
            adjoints,
        );
        self.residual[row] = value * planned.scale;
        for share in shares {
            let derivative = std::mem::take(&mut self.gradient[share.slot]) * share.scale;
            let column = column_at(&mut self.jacobian, &mut self.outer, site.rows, share.column);
            column[row] += derivative;
        }
    }
}

/// Adds multiples of joints' columns to a column-major matrix, all six rows of each.
fn add_whole(matrix: &mut [f64], entries: &[LayoutEntry], columns: &[[Lanes; 6]]) {
    for entry in entries {
        let column = &columns[entry.joint / 4];
        let target = matrix[entry.start..].first_chunk_mut::<6>();
        for (t, c) in target.into_iter().flatten().zip(column) {
            *t += entry.factor * c[entry.joint % 4];
        }
    }
}

/// The same if only some of the six rows are kept.
fn add_parts(matrix: &mut [f64], entries: &[LayoutEntry], columns: &[[Lanes; 6]], parts: &[usize]) {
    for entry in entries {
        let column = &columns[entry.joint / 4];
        for (t, part) in matrix[entry.start..].iter_mut().zip(parts) {
            *t += entry.factor * column[*part][entry.joint % 4];
        }
    }
}

/// The column of that number in the Jacobian, or after it in the columns from outside.
#[inline]
fn column_at<'a>(
    jacobian: &'a mut [f64],
    outer: &'a mut [Lanes],
    rows: usize,
    column: usize,
) -> &'a mut [f64] {
    let start = column * rows;
    match start.checked_sub(jacobian.len()) {
        None => &mut jacobian[start..start + rows],
        // Columns without rows are not used.
        Some(after) => {
            let start = after / rows.max(1) * lane_groups(rows);
            &mut outer[start..start + lane_groups(rows)].as_flattened_mut()[..rows]
        }
    }
}

/// The six numbers: rotation vector, then translation over the loop's size.
pub fn residual_of(turn: DVec3, translation: DVec3, size: f64) -> [f64; 6] {
    let t = translation / size;
    [turn.x, turn.y, turn.z, t.x, t.y, t.z]
}
