//! Residual and analytic Jacobian of a group of loops and equations.
//!
//! A loop's product T must be the identity. Its residual is the rotation vector of T and the translation of T
//! over the mechanism's size: six numbers that vanish together only at the identity. Columns come from the
//! joints' twists: a rotation about axis a through o changes the translation t by a × (t - o) and turns the
//! frame by a; the inverse left Jacobian of SO(3) maps the turn to the rate of the rotation vector.

use super::plan::{BlockPlan, PlannedEquation, PlannedJoint, PlannedLoop, Share};
use super::structure::Block;
use crate::math::Pose;
use crate::math::{left_jacobian_inverse, rotation_log};
use crate::model::chain::{Argument, ArgumentValue, Motion, turn_about};
use crate::model::mechanism::Mechanism;
use glam::{DMat3, DVec3};

/// Buffers of one block's evaluation; made once, reused for every step.
#[derive(Clone, Debug, Default)]
pub struct BlockWorkspace {
    /// Residual, one entry per row of the block.
    pub residual: Vec<f64>,
    /// Jacobian with respect to the block's unknowns in their scaled form, column-major.
    pub jacobian: Vec<f64>,
    /// Rate of the residual along a direction of the other coordinates.
    pub drift: Vec<f64>,
    /// Derivative by the coordinates from outside, as the plan lists them, column-major and not scaled.
    outer: Vec<f64>,
    arguments: Vec<ArgumentValue>,
    joints: Vec<JointTwist>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
    /// All zero between uses.
    gradient: Vec<f64>,
}

/// Axis and place of a joint in the base frame of its loop.
#[derive(Clone, Copy, Debug)]
pub(super) struct JointTwist {
    /// Kind of motion.
    pub motion: Motion,
    /// Place in the plan's arguments.
    pub argument: usize,
    /// Direction, with the joint's sign.
    pub axis: DVec3,
    /// A point of the axis.
    pub origin: DVec3,
}

/// What to compute besides the residual.
#[derive(Clone, Copy)]
pub enum Want<'a> {
    /// Residual only.
    Residual,
    /// Residual and Jacobian.
    Jacobian,
    /// Residual, Jacobian, and the drift along the given rates of all coordinates (those of the block's own
    /// unknowns are left out).
    Drift(&'a [f64]),
}

/// The mechanism, the block's layout and the coordinates of one evaluation.
#[derive(Clone, Copy)]
struct Site<'a> {
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

    /// Joints of all loops of the block at the last evaluation, in the order of the plan.
    pub(super) fn twists(&self) -> &[JointTwist] {
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
        let site = Site {
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
            self.outer.resize(rows * plan.outer.len(), 0.0);
        }
        self.evaluate_arguments(site);
        self.joints.clear();
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
        let rows = self.residual.len();
        self.drift.clear();
        self.drift.resize(rows, 0.0);
        for (column, slot) in self.outer.chunks_exact(rows.max(1)).zip(&plan.outer) {
            let rate = rates[*slot];
            for (sum, entry) in self.drift.iter_mut().zip(column) {
                *sum += rate * entry;
            }
        }
    }

    fn evaluate_arguments(&mut self, site: Site) {
        self.arguments.clear();
        for argument in &site.plan.arguments {
            let value = if argument.is_formula {
                site.mechanism.arguments[argument.index].value(site.coordinates, &mut self.values)
            } else {
                let terms = site.plan.shares[argument.shares.clone()].iter();
                terms.fold(argument.constant, |sum, share| {
                    sum + share.coefficient * site.coordinates[share.slot]
                })
            };
            self.arguments.push(ArgumentValue::new(value));
        }
    }

    fn evaluate_loop(&mut self, site: Site, item: &PlannedLoop, with_columns: bool) {
        let size = site.mechanism.size;
        let first = self.joints.len();
        let product = self.walk(&site.plan.joints[item.joints.clone()], &item.end);
        let turn = rotation_log(&product.rotation);
        let six = residual_of(turn, product.translation, size);
        for (k, component) in item.components.iter().enumerate() {
            self.residual[item.row + k] = six[*component];
        }
        if with_columns {
            let log_from_spin = left_jacobian_inverse(turn);
            for joint in first..self.joints.len() {
                let twist = self.joints[joint];
                let column = column_of(&twist, product.translation, &log_from_spin, size);
                self.add_column(site, item, twist.argument, &column);
            }
        }
    }

    /// Multiplies the loop's steps, noting every joint's axis and origin.
    fn walk(&mut self, joints: &[PlannedJoint], end: &Pose) -> Pose {
        let mut pose = Pose::IDENTITY;
        for joint in joints {
            if let Some(shift) = joint.shift {
                pose.translation += pose.rotation * shift;
            }
            if let Some(turn) = joint.turn {
                pose.rotation *= turn;
            }
            let axis = pose.rotation.col(joint.axis) * joint.sign;
            let value = &self.arguments[joint.argument];
            self.joints.push(JointTwist {
                motion: joint.motion,
                argument: joint.argument,
                axis,
                origin: pose.translation,
            });
            match joint.motion {
                Motion::Translation => pose.translation += axis * value.value,
                Motion::Rotation => {
                    turn_about(&mut pose, joint.axis, joint.sign * value.sin, value.cos);
                }
            }
        }
        pose * *end
    }

    /// Distributes a joint's column over the coordinates of its argument.
    fn add_column(&mut self, site: Site, item: &PlannedLoop, argument: usize, column: &[f64; 6]) {
        let planned = &site.plan.arguments[argument];
        let shares = &site.plan.shares[planned.shares.clone()];
        if !planned.is_formula {
            for share in shares {
                self.add_entry(site, item, share, share.coefficient, column);
            }
            return;
        }
        let Argument::Formula(expression) = &site.mechanism.arguments[planned.index] else {
            return;
        };
        self.gradient.resize(site.coordinates.len(), 0.0);
        let (values, adjoints) = (&mut self.values, &mut self.adjoints);
        expression.add_gradient(site.coordinates, 1.0, &mut self.gradient, values, adjoints);
        for share in shares {
            let rate = std::mem::take(&mut self.gradient[share.slot]);
            self.add_entry(site, item, share, rate, column);
        }
    }

    /// Adds a coordinate's share of a joint's column to the Jacobian, or to the columns from outside.
    #[inline]
    fn add_entry(
        &mut self,
        site: Site,
        item: &PlannedLoop,
        share: &Share,
        rate: f64,
        column: &[f64; 6],
    ) {
        let factor = rate * share.scale;
        let target = column_at(&mut self.jacobian, &mut self.outer, site.rows, share.column);
        let target = &mut target[item.row..];
        if let ([_, _, _, _, _, _], Some(six)) =
            (&item.components[..], target.first_chunk_mut::<6>())
        {
            six.iter_mut()
                .zip(column)
                .for_each(|(t, c)| *t += factor * c);
        } else {
            for (entry, component) in target.iter_mut().zip(&item.components) {
                *entry += factor * column[*component];
            }
        }
    }

    fn evaluate_equation(&mut self, site: Site, planned: &PlannedEquation, with_columns: bool) {
        let equation = &site.mechanism.equations[planned.index];
        let row = planned.row;
        if !with_columns {
            let value = equation
                .expression
                .value_with(site.coordinates, &mut self.values);
            self.residual[row] = value * planned.scale;
            return;
        }
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
        for share in &site.plan.shares[planned.shares.clone()] {
            let derivative = std::mem::take(&mut self.gradient[share.slot]) * share.scale;
            let column = column_at(&mut self.jacobian, &mut self.outer, site.rows, share.column);
            column[row] += derivative;
        }
    }
}

/// The column of that number in the Jacobian, or after it in the columns from outside.
#[inline]
fn column_at<'a>(
    jacobian: &'a mut [f64],
    outer: &'a mut [f64],
    rows: usize,
    column: usize,
) -> &'a mut [f64] {
    let start = column * rows;
    match start.checked_sub(jacobian.len()) {
        None => &mut jacobian[start..start + rows],
        Some(start) => &mut outer[start..start + rows],
    }
}

/// The six numbers: rotation vector, then translation over the mechanism's size.
pub fn residual_of(turn: DVec3, translation: DVec3, size: f64) -> [f64; 6] {
    let t = translation / size;
    [turn.x, turn.y, turn.z, t.x, t.y, t.z]
}

#[inline]
fn column_of(joint: &JointTwist, translation: DVec3, log_from_spin: &DMat3, size: f64) -> [f64; 6] {
    match joint.motion {
        Motion::Translation => residual_of(DVec3::ZERO, joint.axis, size),
        Motion::Rotation => {
            let turn = *log_from_spin * joint.axis;
            residual_of(turn, joint.axis.cross(translation - joint.origin), size)
        }
    }
}
