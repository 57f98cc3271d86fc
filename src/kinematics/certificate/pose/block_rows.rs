//! One block as rows: residual, Jacobian and bounds of its equations. The test itself is in `kantorovich`.

use super::chain::{ArgumentDouble, LoopAtPose};
use super::equation::EquationAtPose;
use crate::kinematics::certificate::neighbourhood::{BALL, LEAST_TRACE};
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::structure::proof_plan::{LoopRows, ProofBlock};
use crate::linalg::lanes::LaneMatrix;
use crate::model::chain::ElementaryMotion;
use crate::numbers::rounding::{COLUMN, GROW, U};

/// One row of the block, without its derivatives.
#[derive(Clone, Copy, Debug, Default)]
pub struct ProvedRow {
    /// At the pose.
    pub residual: f64,
    /// Absolute error of the residual.
    pub open: f64,
    /// Bound of the second derivative within the ball, along the block's unknowns.
    pub second: f64,
    /// The same along the block's unknowns and those of earlier blocks.
    pub second_all: f64,
    /// Error of the row of the Jacobian, summed over all unknowns.
    pub column_error: f64,
    /// Change if all numbers of the scene differ by a unit in their last place; only with redundant rows.
    pub last_units: f64,
}

/// The rows of a block at the last pose.
#[derive(Clone, Debug)]
pub struct BlockRows<'m> {
    /// The block.
    pub of: &'m ProofBlock,
    /// At the last pose.
    pub rows: Vec<ProvedRow>,
    /// Derivative of every row by every form, one form after the other.
    pub columns: LaneMatrix,
    /// Uncertainty of each form, in the sense of its use.
    pub open: Vec<f64>,
    at_pose: Vec<LoopAtPose>,
    equation: EquationAtPose,
    arguments: Vec<ArgumentDouble>,
}

impl<'m> BlockRows<'m> {
    /// Buffers for a block.
    pub fn new(of: &'m ProofBlock) -> Self {
        Self {
            of,
            rows: vec![ProvedRow::default(); of.rows],
            columns: LaneMatrix::default(),
            open: vec![0.0; of.forms.len()],
            at_pose: vec![LoopAtPose::default(); of.loops.len()],
            equation: EquationAtPose::default(),
            arguments: Vec::with_capacity(of.forms.len()),
        }
    }

    /// Fills the rows at coordinates and their rests. `arguments` are those of the whole mechanism.
    pub fn evaluate(
        &mut self,
        [coordinates, rests]: [&[f64]; 2],
        arguments: &[ArgumentDouble],
    ) -> Result<(), Reason> {
        self.columns.reset(self.of.forms.len(), self.rows.len());
        self.open.fill(0.0);
        self.arguments.clear();
        let of_block = self.of.arguments.iter();
        self.arguments
            .extend(of_block.map(|index| arguments[*index]));
        for index in 0..self.of.loops.len() {
            self.loop_rows(index)?;
        }
        self.equation_rows([coordinates, rests]);
        if self.rows.len() > self.of.unknowns.len() {
            self.weigh_last_units(coordinates);
        }
        Ok(())
    }

    /// Change of every row if the numbers of the scene differ by a unit in their last place.
    fn weigh_last_units(&mut self, coordinates: &[f64]) {
        for (item, at_pose) in self.of.loops.iter().zip(&self.at_pose) {
            let units = at_pose.last_units(&item.plan, &self.arguments);
            for &(component, row) in &item.rows {
                self.rows[row].last_units = units[component / 3];
            }
        }
        for (equation, row) in self.of.equations.iter().zip(self.of.first_equation..) {
            let units = self.equation.last_units(&equation.formula, coordinates);
            self.rows[row].last_units = equation.scale * units;
        }
    }

    /// Fills the rows of a loop.
    fn loop_rows(&mut self, index: usize) -> Result<(), Reason> {
        let LoopRows {
            plan,
            rows,
            may_turn,
            size,
            ..
        } = &self.of.loops[index];
        let forms = &self.of.forms;
        let item = &mut self.at_pose[index];
        // The chain with every product's rounding, in double-double.
        item.evaluate(plan, &self.arguments, |a| forms[a].rate * BALL, *size);
        // Sine and cosine are undefined there.
        if item.trace.is_nan() {
            return Err(Reason::Precision);
        }
        if !may_turn && item.trace <= LEAST_TRACE {
            return Err(Reason::HalfTurn);
        }
        // The uncertainty of an argument is the rounding of its own formula.
        for joint in &item.joints {
            let argument = &self.arguments[joint.argument];
            let open = match joint.motion {
                ElementaryMotion::Rotation => argument.open_angle,
                ElementaryMotion::Translation => argument.open_length,
            };
            self.open[joint.argument] = self.open[joint.argument].max(open);
        }
        // Bounds of the derivatives over the ball, from the reaches of the joints.
        let own = item.second_derivatives(|a| forms[a].own_rate);
        let all = item.second_derivatives(|a| forms[a].rate);
        let first = item.first_derivatives(|a| forms[a].rate);
        let open = item.first_derivatives(|a| self.open[a]);
        let reach = item.joints.first().map_or(0.0, |j| 1.0 + j.reach);
        for &(component, row) in rows {
            let kind = component / 3;
            let farthest = if kind == 0 { 1.0 } else { reach };
            // The columns carry rounding, and belong to arguments with the uncertainty `open`.
            let slack = COLUMN + open[0];
            self.rows[row] = ProvedRow {
                residual: item.residual[component],
                open: item.open[kind] + open[0] * open[0] * farthest + open[0] * open[1],
                second: own[kind],
                second_all: all[kind],
                column_error: slack * (first[kind] + first[0] * farthest) + open[kind] * first[0],
                last_units: 0.0,
            };
        }
        // The Jacobian's columns: axis and arm of every joint.
        for joint in &item.joints {
            let column = item.column(joint);
            let target = self.columns.row_mut(joint.argument).as_flattened_mut();
            for &(component, row) in rows {
                target[row] += column[component];
            }
        }
        Ok(())
    }

    fn equation_rows(&mut self, [coordinates, rests]: [&[f64]; 2]) {
        for (equation, row) in self.of.equations.iter().zip(self.of.first_equation..) {
            let scale = equation.scale;
            let (value, open) = self
                .equation
                .evaluate(&equation.formula, [coordinates, rests]);
            let residual = value.hi * scale;
            // The formula is a function of its forms, whose derivatives are its factors.
            let (mut second, mut second_all, mut column_error) = (0.0, 0.0, 0.0);
            let forms = &self.of.forms[equation.forms()];
            for (form, [slope, open]) in equation.forms().zip(&self.equation.slopes) {
                *self.columns.at_mut(form, row) = slope * scale;
                let error = COLUMN * slope.abs() + open;
                column_error += error * self.of.forms[form].rate;
            }
            for (factor, [a, b]) in &equation.formula.products {
                let [a, b] = [&forms[1 + a], &forms[1 + b]];
                second += 2.0 * factor.largest() * a.own_rate * b.own_rate;
                second_all += 2.0 * factor.largest() * a.rate * b.rate;
            }
            self.rows[row] = ProvedRow {
                residual,
                open: (open + value.lo.abs()) * scale + 4.0 * U * residual.abs(),
                second: second * scale * GROW,
                second_all: second_all * scale * GROW,
                column_error: column_error * scale * GROW,
                last_units: 0.0,
            };
        }
    }

    /// Whether a loop may be rotated by π once the unknowns move by `distance`.
    pub fn may_be_half_turned(&self, distance: f64) -> bool {
        let loops = self.of.loops.iter().zip(&self.at_pose);
        let mut fixed = loops.filter(|(rows, _)| !rows.may_turn);
        fixed.any(|(_, item)| {
            let turned = item.first_derivatives(|a| self.of.forms[a].rate)[0];
            let least = item.trace - 2.0 * turned * distance;
            least.is_nan() || least <= LEAST_TRACE
        })
    }
}
