//! Residual and Jacobian of a block in eight lanes: the formulas of `loops/residual`, near a closed pose.

use crate::kinematics::loops::residual::residual_of;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::layout::{BlockPlan, LayoutEntry, PlannedLoop};
use crate::model::chain::{Argument, ArgumentValue, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::model::walk::{Triple, WalkFrame};
use crate::numbers::octet::{LANES, Octet};
use crate::numbers::scalar::Scalar;
use glam::{DMat3, DVec3};

/// Largest square of the sine of a loop's turn whose rotation vector is taken from a short series: 0.05 rad, as far as a
/// correction may lead. Beyond it a lane has no residual.
const LARGEST_SQUARE: f64 = 2.5e-3;

/// asin(s)/s by powers of s²; what is left out is below 1e-17.
const ASIN: [f64; 6] = [
    1.0,
    1.0 / 6.0,
    3.0 / 40.0,
    5.0 / 112.0,
    35.0 / 1152.0,
    63.0 / 2816.0,
];

/// The factor of P² in the inverse left Jacobian by powers of the angle's square, likewise.
const LEFT: [f64; 4] = [1.0 / 12.0, 1.0 / 720.0, 1.0 / 30_240.0, 1.0 / 1_209_600.0];

/// A joint's axis, with its sign, and a point of it.
#[derive(Clone, Copy, Debug, Default)]
struct Line {
    axis: Triple<Octet>,
    origin: Triple<Octet>,
}

/// What the chain rule needs of plain numbers, lane after lane.
#[derive(Clone, Debug, Default)]
struct Plain {
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
    arguments: Vec<ArgumentValue<Octet>>,
    lines: Vec<Line>,
    columns: Vec<[Octet; 6]>,
    plain: Plain,
}

/// What there is to know of an argument beforehand.
#[derive(Clone, Copy, Debug, Default)]
struct Role {
    /// It is the angle of a rotation.
    turns: bool,
    /// It depends on unknowns of the block: the others stand still while the block is closed.
    moves: bool,
}

/// A block with the roles of its arguments.
#[derive(Clone, Debug)]
pub(super) struct LaneBlock<'s> {
    pub mechanism: &'s Mechanism,
    pub block: &'s Block,
    roles: Vec<Role>,
}

impl<'s> LaneBlock<'s> {
    pub fn new(mechanism: &'s Mechanism, block: &'s Block) -> Self {
        let plan = &block.plan;
        let mut roles = vec![Role::default(); plan.arguments.len()];
        for (role, argument) in roles.iter_mut().zip(&plan.arguments) {
            let mut shares = plan.shares[argument.shares.clone()].iter();
            role.moves = shares.any(|share| share.column < block.unknowns.len());
        }
        for joint in &plan.joints {
            roles[joint.argument].turns |= joint.motion == ElementaryMotion::Rotation;
        }
        Self {
            mechanism,
            block,
            roles,
        }
    }
}

impl BlockValues {
    /// Evaluates a block at `coordinates`; `again` if nothing but its unknowns has changed since it was evaluated last.
    pub fn evaluate(&mut self, lanes: &LaneBlock, coordinates: &[Octet], again: bool) {
        let block = lanes.block;
        let (plan, rows) = (&block.plan, block.rows());
        self.residual.clear();
        self.residual.resize(rows, Octet::ZERO);
        self.jacobian.clear();
        self.jacobian
            .resize(rows * block.unknowns.len(), Octet::ZERO);
        self.evaluate_arguments(lanes, coordinates, again);
        for item in &plan.loops {
            let end = self.walk(plan, item);
            let turn = turn_of(&end.axes);
            self.note_residual(item, &turn, &end.origin);
            self.add_columns(lanes, item, &turn, &end.origin, coordinates);
        }
        for equation in 0..plan.equations.len() {
            self.evaluate_equation(lanes, equation, coordinates);
        }
    }

    fn evaluate_arguments(&mut self, lanes: &LaneBlock, coordinates: &[Octet], again: bool) {
        let plan = &lanes.block.plan;
        let still = ArgumentValue::default();
        self.arguments.resize(plan.arguments.len(), still);
        for (k, (argument, role)) in plan.arguments.iter().zip(&lanes.roles).enumerate() {
            if again && !role.moves {
                continue;
            }
            let value = match &lanes.mechanism.arguments[argument.index] {
                Argument::Formula(formula) => {
                    by_lanes(&mut self.plain, coordinates, |plain, slots| {
                        formula.value_with(slots, &mut plain.values)
                    })
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
            if role.turns {
                (own.sin, own.cos) = value.sin_cos();
            }
        }
    }

    /// Multiplies the loop's steps, noting every joint's line.
    fn walk(&mut self, plan: &BlockPlan, item: &PlannedLoop) -> WalkFrame<Octet> {
        let mut frame = WalkFrame::identity();
        let joints = &plan.joints[item.joints.clone()];
        self.lines.resize(joints.len(), Line::default());
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
                    for k in 0..3 {
                        origin[k] += line.axis[k] * value.value;
                    }
                }
                // Only two axes change.
                ElementaryMotion::Rotation => {
                    let (sin, cos) = (value.sin * joint.sign, value.cos);
                    let (i, j) = ((along + 1) % 3, (along + 2) % 3);
                    for k in 0..3 {
                        let (a, b) = (axes[i][k], axes[j][k]);
                        axes[i][k] = a * cos + b * sin;
                        axes[j][k] = b * cos - a * sin;
                    }
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
        // What a residual's translation is measured in stands in one place.
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
        coordinates: &[Octet],
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
        add_entries(
            &mut self.jacobian,
            &item.own,
            &self.columns,
            &item.components,
        );
        for joint in &item.formulas {
            self.add_formula(lanes, item, *joint, coordinates);
        }
    }

    /// Adds the column of a joint whose argument is a formula, times the formula's rates.
    fn add_formula(
        &mut self,
        lanes: &LaneBlock,
        item: &PlannedLoop,
        joint: usize,
        coordinates: &[Octet],
    ) {
        let (plan, rows) = (&lanes.block.plan, lanes.block.rows());
        let argument = plan.joints[item.joints.start + joint].argument;
        let planned = &plan.arguments[argument];
        let Argument::Formula(formula) = &lanes.mechanism.arguments[planned.index] else {
            return;
        };
        let unknowns = lanes.block.unknowns.len();
        for share in &plan.shares[planned.shares.clone()] {
            if share.column >= unknowns {
                continue;
            }
            let rate = rate_by(&mut self.plain, formula, share.slot, coordinates) * share.scale;
            let target = &mut self.jacobian[share.column * rows + item.row..];
            for (entry, component) in target.iter_mut().zip(&item.components) {
                *entry += self.columns[joint][*component] * rate;
            }
        }
    }

    fn evaluate_equation(&mut self, lanes: &LaneBlock, index: usize, coordinates: &[Octet]) {
        let (plan, rows) = (&lanes.block.plan, lanes.block.rows());
        let planned = &plan.equations[index];
        let formula = &lanes.mechanism.equations[planned.index].expression;
        let value = by_lanes(&mut self.plain, coordinates, |plain, slots| {
            formula.value_with(slots, &mut plain.values)
        });
        self.residual[planned.row] = value * planned.scale;
        for (k, share) in plan.shares[planned.shares.clone()].iter().enumerate() {
            if share.column >= lanes.block.unknowns.len() {
                continue;
            }
            let rate = match &planned.slopes {
                Some(slopes) => slopes[k].value(coordinates),
                None => rate_by(&mut self.plain, formula, share.slot, coordinates),
            };
            self.jacobian[share.column * rows + planned.row] +=
                rate * (planned.scale * share.scale);
        }
    }
}

/// What a function of plain coordinates gives in every lane.
fn by_lanes(
    plain: &mut Plain,
    coordinates: &[Octet],
    mut function: impl FnMut(&mut Plain, &[f64]) -> f64,
) -> Octet {
    let mut slots = std::mem::take(&mut plain.coordinates);
    let mut values = Octet::ZERO;
    for lane in 0..LANES {
        slots.clear();
        slots.extend(coordinates.iter().map(|c| c.lane(lane)));
        values.set_lane(lane, function(plain, &slots));
    }
    plain.coordinates = slots;
    values
}

/// The rate of a formula by a coordinate.
fn rate_by(plain: &mut Plain, formula: &Expression, slot: usize, coordinates: &[Octet]) -> Octet {
    by_lanes(plain, coordinates, |plain, slots| {
        plain.gradient.clear();
        plain.gradient.resize(slots.len(), 0.0);
        let Plain {
            gradient,
            values,
            adjoints,
            ..
        } = plain;
        formula.add_gradient(slots, 1.0, gradient, values, adjoints);
        gradient[slot]
    })
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

/// Moves a frame by a fixed vector; most have one entry that is not zero.
#[inline(always)]
fn shift_frame(frame: &mut WalkFrame<Octet>, by: &DVec3) {
    for (axis, factor) in frame.axes.iter().zip(by.to_array()) {
        if factor != 0.0 {
            for (own, c) in frame.origin.iter_mut().zip(axis) {
                *own += *c * factor;
            }
        }
    }
}

/// Turns a frame by a fixed rotation; most have entries that are zero.
#[inline(always)]
fn turn_frame(frame: &mut WalkFrame<Octet>, by: &DMat3) {
    let before = frame.axes;
    for (own, column) in frame.axes.iter_mut().zip(by.to_cols_array_2d()) {
        *own = [Octet::ZERO; 3];
        for (axis, factor) in before.iter().zip(column) {
            if factor != 0.0 {
                for (sum, c) in own.iter_mut().zip(axis) {
                    *sum += *c * factor;
                }
            }
        }
    }
}

/// The rotation vector of a frame that is turned by little; NaN where it is turned by more.
#[inline(always)]
fn turn_of(axes: &[Triple<Octet>; 3]) -> Triple<Octet> {
    let [x, y, z] = axes;
    let mut skew = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
    skew.iter_mut().for_each(|s| *s = *s * 0.5);
    let square = dot(&skew, &skew);
    // The cosine tells a small turn from one beyond a right angle.
    let cos = x[0] + y[1] + z[2] - Octet::splat(1.0);
    let is_small = square.at_most(Octet::splat(LARGEST_SQUARE));
    let is_small = is_small.and(Octet::ZERO.at_most(cos));
    let factor = is_small.choose(polynomial(&ASIN, square), Octet::splat(f64::NAN));
    skew.iter_mut().for_each(|s| *s = *s * factor);
    skew
}

/// I - P/2 + c P², with P the cross-product matrix of a short rotation vector; rows.
#[inline(always)]
fn left_jacobian_inverse(turn: &Triple<Octet>) -> [Triple<Octet>; 3] {
    let square = dot(turn, turn);
    let c = polynomial(&LEFT, square);
    let rest = Octet::splat(1.0) - c * square;
    let mut rows = [[Octet::ZERO; 3]; 3];
    for (i, row) in rows.iter_mut().enumerate() {
        // P² = φ φᵀ - |φ|² I.
        for (j, entry) in row.iter_mut().enumerate() {
            *entry = c * (turn[i] * turn[j]);
        }
        row[i] += rest;
        // -P/2 has the halves of the two others beside the diagonal, with either sign.
        row[(i + 1) % 3] += turn[(i + 2) % 3] * 0.5;
        row[(i + 2) % 3] -= turn[(i + 1) % 3] * 0.5;
    }
    rows
}

#[inline(always)]
fn polynomial<const N: usize>(coefficients: &[f64; N], x: Octet) -> Octet {
    let highest_first = coefficients.iter().rev();
    highest_first.fold(Octet::ZERO, |sum, c| sum * x + Octet::splat(*c))
}

#[inline(always)]
fn dot(a: &Triple<Octet>, b: &Triple<Octet>) -> Octet {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
