//! Residual and Jacobian of a block in eight lanes: the formulas of `loops/residual`, near a closed pose.

use super::frames::{left_jacobian_inverse, shift_frame, turn_frame, turn_of};
use crate::kinematics::loops::residual::residual_of;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::layout::{BlockPlan, LayoutEntry, PlannedLoop, RateShare};
use crate::linalg::lanes::lane_groups;
use crate::model::chain::{Argument, ArgumentValue, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::model::walk::{Triple, WalkFrame};
use crate::numbers::octet::{LANES, Octet};
use crate::numbers::scalar::Scalar;
use glam::{DMat3, DVec3};

/// A joint's axis, with its sign, and a point of it.
#[derive(Clone, Copy, Debug, Default)]
struct JointAxis {
    axis: Triple<Octet>,
    origin: Triple<Octet>,
}

/// Plain numbers needed for the chain rule, lane after lane.
#[derive(Clone, Debug, Default)]
struct PlainValues {
    coordinates: Vec<f64>,
    gradient: Vec<f64>,
    values: Vec<f64>,
    adjoints: Vec<f64>,
}

/// Values of a block.
#[derive(Clone, Debug, Default)]
pub(super) struct BlockValues {
    /// An entry a row.
    pub residual: Vec<Octet>,
    /// By the block's scaled unknowns, column-major.
    pub jacobian: Vec<Octet>,
    /// By coordinates of other blocks, in the order of the layout, with its padding; only on request.
    outer: Vec<Octet>,
    arguments: Vec<ArgumentValue<Octet>>,
    /// Of arguments and equations that are formulas: the rates by the coordinates of their shares.
    rates: Vec<Octet>,
    lines: Vec<JointAxis>,
    columns: Vec<[Octet; 6]>,
    /// Forms that an equation multiplies.
    factors: Vec<Octet>,
    plain: PlainValues,
}

/// A block of a mechanism.
#[derive(Clone, Debug)]
pub(super) struct LaneBlock<'s> {
    pub mechanism: &'s Mechanism,
    pub block: &'s Block,
    /// Whether derivatives by coordinates of other blocks are requested, too.
    with_outside: bool,
}

impl<'s> LaneBlock<'s> {
    pub fn new(mechanism: &'s Mechanism, block: &'s Block) -> Self {
        Self {
            mechanism,
            block,
            with_outside: false,
        }
    }

    /// The same with derivatives by coordinates of other blocks.
    pub fn with_outside(self) -> Self {
        Self {
            with_outside: true,
            ..self
        }
    }
}

impl BlockValues {
    /// Evaluates a block at `coordinates`; `again` if only its unknowns have changed since the last evaluation.
    pub fn evaluate(&mut self, lanes: &LaneBlock, coordinates: &[Octet], again: bool) {
        let block = lanes.block;
        let (plan, rows) = (&block.plan, block.rows());
        self.residual.clear();
        self.residual.resize(rows, Octet::ZERO);
        self.jacobian.clear();
        self.jacobian
            .resize(rows * block.unknowns.len(), Octet::ZERO);
        if lanes.with_outside {
            self.outer.clear();
            let size = plan.outer.len() * outer_stride(rows);
            self.outer.resize(size, Octet::ZERO);
        }
        self.evaluate_arguments(lanes, coordinates, again);
        // Residual of each loop, then the columns of its joints.
        for item in &plan.loops {
            let end = self.walk(plan, item);
            let turn = turn_of(&end.axes);
            self.note_residual(item, &turn, &end.origin);
            self.add_columns(lanes, item, &turn, &end.origin);
        }
        for equation in 0..plan.equations.len() {
            self.evaluate_equation(lanes, equation, coordinates);
        }
    }

    /// The rate of the residual for these `rates` of the coordinates, with the block's unknowns fixed, after an
    /// evaluation with derivatives by coordinates of other blocks.
    pub fn drift(&self, lanes: &LaneBlock, rates: &[Octet], drift: &mut Vec<Octet>) {
        let rows = lanes.block.rows();
        drift.clear();
        drift.resize(rows, Octet::ZERO);
        let columns = self.outer.chunks_exact(outer_stride(rows).max(1));
        for (slot, column) in lanes.block.plan.outer.iter().zip(columns) {
            for (sum, entry) in drift.iter_mut().zip(column) {
                *sum += *entry * rates[*slot];
            }
        }
    }

    fn evaluate_arguments(&mut self, lanes: &LaneBlock, coordinates: &[Octet], again: bool) {
        let plan = &lanes.block.plan;
        let still = ArgumentValue::default();
        self.arguments.resize(plan.arguments.len(), still);
        self.rates.resize(plan.shares.len(), Octet::ZERO);
        for (k, argument) in plan.arguments.iter().enumerate() {
            // Arguments that do not depend on the block's unknowns are evaluated once per pose.
            if again && !argument.moves {
                continue;
            }
            let value = match &lanes.mechanism.arguments[argument.index] {
                Argument::Formula(formula) => {
                    let shares = argument.shares.clone();
                    let rates = &mut self.rates[shares.clone()];
                    value_and_rates(
                        &mut self.plain,
                        formula,
                        &plan.shares[shares],
                        coordinates,
                        rates,
                    )
                }
                Argument::Affine(_) => {
                    let mut sum = Octet::splat(argument.constant);
                    for share in &plan.shares[argument.shares.clone()] {
                        sum += coordinates[share.slot] * share.coefficient;
                    }
                    sum
                }
            };
            let own = &mut self.arguments[k];
            own.value = value;
            // Sine and cosine only where a rotation needs them.
            if argument.turns {
                (own.sin, own.cos) = value.sin_cos();
            }
        }
    }

    /// Multiplies the loop's steps, recording the line of every joint.
    fn walk(&mut self, plan: &BlockPlan, item: &PlannedLoop) -> WalkFrame<Octet> {
        let mut frame = WalkFrame::identity();
        let joints = &plan.joints[item.joints.clone()];
        self.lines.resize(joints.len(), JointAxis::default());
        for (joint, line) in joints.iter().zip(&mut self.lines) {
            if let Some(shift) = &joint.shift {
                shift_frame(&mut frame, shift);
            }
            if let Some(turn) = &joint.turn {
                turn_frame(&mut frame, turn);
            }
            let value = &self.arguments[joint.argument];
            let WalkFrame { axes, origin } = &mut frame;
            let along = joint.axis % 3;
            for k in 0..3 {
                line.axis[k] = axes[along][k] * joint.sign;
                line.origin[k] = origin[k];
            }
            match joint.motion {
                ElementaryMotion::Translation => {
                    for (place, axis) in origin.iter_mut().zip(&line.axis) {
                        *place += *axis * value.value;
                    }
                }
                // Only two axes change.
                ElementaryMotion::Rotation => {
                    let (sin, cos) = (value.sin * joint.sign, value.cos);
                    let (i, j) = ((along + 1) % 3, (along + 2) % 3);
                    let [mut first, mut second] = [axes[i], axes[j]];
                    for (p, q) in first.iter_mut().zip(&mut second) {
                        let (a, b) = (*p, *q);
                        *p = a * cos + b * sin;
                        *q = b * cos - a * sin;
                    }
                    (axes[i], axes[j]) = (first, second);
                }
            }
        }
        shift_frame(&mut frame, &item.end.translation);
        if item.end.rotation != DMat3::IDENTITY {
            turn_frame(&mut frame, &item.end.rotation);
        }
        frame
    }

    fn note_residual(&mut self, item: &PlannedLoop, turn: &Triple<Octet>, shift: &Triple<Octet>) {
        // The unit of a residual's translation is defined in one place.
        let [.., per_size] = residual_of(DVec3::ZERO, DVec3::Z, item.size);
        for (k, component) in item.components.iter().enumerate() {
            self.residual[item.row + k] = match component / 3 {
                0 => turn[component % 3],
                _ => shift[component % 3] * per_size,
            };
        }
    }

    /// Distributes the joints' columns over the unknowns of their arguments.
    fn add_columns(
        &mut self,
        lanes: &LaneBlock,
        item: &PlannedLoop,
        turn: &Triple<Octet>,
        shift: &Triple<Octet>,
    ) {
        let log_from_spin = left_jacobian_inverse(turn);
        let per_size = 1.0 / item.size;
        let joints = lanes.block.plan.joints[item.joints.clone()].iter();
        self.columns.resize(self.lines.len(), [Octet::ZERO; 6]);
        for ((joint, line), column) in joints.zip(&self.lines).zip(&mut self.columns) {
            let axis = &line.axis;
            if joint.motion == ElementaryMotion::Translation {
                for k in 0..3 {
                    column[k] = Octet::ZERO;
                    column[3 + k] = axis[k] * per_size;
                }
                continue;
            }
            for (k, row) in log_from_spin.iter().enumerate() {
                column[k] = row[0] * axis[0] + row[1] * axis[1] + row[2] * axis[2];
                // a × (t - o)
                let (i, j) = ((k + 1) % 3, (k + 2) % 3);
                let arms = (shift[i] - line.origin[i], shift[j] - line.origin[j]);
                column[3 + k] = (axis[i] * arms.1 - axis[j] * arms.0) * per_size;
            }
        }
        let (columns, components) = (&self.columns, &item.components);
        add_entries(&mut self.jacobian, &item.own, columns, components);
        if lanes.with_outside {
            add_entries(&mut self.outer, &item.outside, columns, components);
        }
        for joint in &item.formulas {
            self.add_formula(lanes, item, *joint);
        }
    }

    /// Adds the column of a joint whose argument is a formula, times the formula's rates.
    fn add_formula(&mut self, lanes: &LaneBlock, item: &PlannedLoop, joint: usize) {
        let (plan, rows) = (&lanes.block.plan, lanes.block.rows());
        let argument = plan.joints[item.joints.start + joint].argument;
        let shares = plan.arguments[argument].shares.clone();
        let unknowns = lanes.block.unknowns.len();
        for (share, rate) in plan.shares[shares.clone()].iter().zip(&self.rates[shares]) {
            let is_outside = share.column >= unknowns;
            if is_outside && !lanes.with_outside {
                continue;
            }
            // Chain rule: the joint's twist times the derivative of its formula.
            let rate = *rate * share.scale;
            let target = match is_outside {
                false => &mut self.jacobian[share.column * rows + item.row..],
                true => {
                    &mut self.outer[(share.column - unknowns) * outer_stride(rows) + item.row..]
                }
            };
            for (entry, component) in target.iter_mut().zip(&item.components) {
                *entry += self.columns[joint][*component] * rate;
            }
        }
    }

    fn evaluate_equation(&mut self, lanes: &LaneBlock, index: usize, coordinates: &[Octet]) {
        let (plan, rows) = (&lanes.block.plan, lanes.block.rows());
        let planned = &plan.equations[index];
        let formula = &lanes.mechanism.equations[planned.index].expression;
        let unknowns = lanes.block.unknowns.len();
        let shares = &plan.shares[planned.shares.clone()];
        // An equation of second degree in all lanes at once: slopes follow from the values of its factors.
        if let Some(quadratic) = &planned.quadratic {
            let value = quadratic.value(coordinates, &mut self.factors);
            self.residual[planned.row] = value * planned.scale;
            let (jacobian, outer) = (&mut self.jacobian, &mut self.outer);
            quadratic.each_slope(&self.factors, |place, slope| {
                let share = &shares[place];
                // Columns behind the block's own unknowns belong to coordinates of other blocks.
                let entry = match share.column.checked_sub(unknowns) {
                    None => &mut jacobian[share.column * rows + planned.row],
                    Some(_) if !lanes.with_outside => return,
                    Some(column) => &mut outer[column * outer_stride(rows) + planned.row],
                };
                *entry += slope * (planned.scale * share.scale);
            });
            return;
        }
        // Any other formula lane by lane.
        let rates = &mut self.rates[planned.shares.clone()];
        let value = value_and_rates(&mut self.plain, formula, shares, coordinates, rates);
        self.residual[planned.row] = value * planned.scale;
        for (share, rate) in shares.iter().zip(&self.rates[planned.shares.clone()]) {
            let is_outside = share.column >= unknowns;
            if is_outside && !lanes.with_outside {
                continue;
            }
            let entry = match is_outside {
                false => &mut self.jacobian[share.column * rows + planned.row],
                true => {
                    &mut self.outer[(share.column - unknowns) * outer_stride(rows) + planned.row]
                }
            };
            *entry += *rate * (planned.scale * share.scale);
        }
    }
}

/// Distance between columns of other coordinates: whole groups of four, as in the layout.
fn outer_stride(rows: usize) -> usize {
    4 * lane_groups(rows)
}

/// The value of a formula, and its rates by the coordinates of `shares`: formulas are scalar code, one lane after the other.
fn value_and_rates(
    plain: &mut PlainValues,
    formula: &Expression,
    shares: &[RateShare],
    coordinates: &[Octet],
    rates: &mut [Octet],
) -> Octet {
    let mut value = Octet::ZERO;
    let PlainValues {
        coordinates: slots,
        gradient,
        values,
        adjoints,
    } = plain;
    for lane in 0..LANES {
        slots.clear();
        slots.extend(coordinates.iter().map(|c| c.lane(lane)));
        gradient.clear();
        gradient.resize(slots.len(), 0.0);
        // All rates at once, by reverse accumulation.
        let here = formula.add_gradient(slots, 1.0, gradient, values, adjoints);
        value.set_lane(lane, here);
        for (rate, share) in rates.iter_mut().zip(shares) {
            rate.set_lane(lane, gradient[share.slot]);
        }
    }
    value
}

/// Adds multiples of joints' columns, of all six rows or of some.
fn add_entries(
    matrix: &mut [Octet],
    entries: &[LayoutEntry],
    columns: &[[Octet; 6]],
    components: &[usize],
) {
    for entry in entries {
        let column = &columns[entry.joint];
        // All six rows at once if none is omitted: the loop is unrolled.
        if let ([_, _, _, _, _, _], Some(target)) =
            (components, matrix[entry.start..].first_chunk_mut::<6>())
        {
            for (t, c) in target.iter_mut().zip(column) {
                *t += *c * entry.factor;
            }
            continue;
        }
        for (t, component) in matrix[entry.start..].iter_mut().zip(components) {
            *t += column[*component] * entry.factor;
        }
    }
}
