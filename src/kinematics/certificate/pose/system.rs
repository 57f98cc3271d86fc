//! One block as rows: residual, Jacobian and bounds of its equations. The test itself is in `kantorovich`.

use super::chain::{ArgumentDouble, LoopAtPose, LoopPlan, affine_value};
use crate::kinematics::certificate::neighbourhood::BALL;
use crate::kinematics::certificate::rows::ProofRows;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::LaneMatrix;
use crate::model::chain::ElementaryMotion;
use crate::model::expression::Affine;
use crate::model::mechanism::{Closes, Mechanism};
use crate::numbers::rounding::{DECIMAL, U};
use std::ops::Range;

/// Affine forms of the arguments, then of the equations; `None` for formulas.
type Forms = [Option<Affine>];

/// Relative rounding of a joint's column: a dozen operations on numbers that carry the last bit of f64.
const COLUMN_ROUNDING: f64 = 64.0 * U;

/// A trace below this could belong to a half-turn (trace -1) as well as to the identity (trace 3), after what the
/// rotation can change within the error bound.
const LEAST_TRACE: f64 = 1e-6;

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
    /// Change where all numbers of the scene are off by a unit in their last place; only where rows are redundant.
    pub last_units: f64,
}

/// A form (argument or affine equation) that the block uses.
#[derive(Clone, Debug)]
pub struct FormUse {
    /// Index among the certifier's forms.
    pub index: usize,
    /// Rate by each unknown of the block in scaled form, as (column, rate).
    pub own: Vec<(usize, f64)>,
    /// Rate by unknowns of earlier blocks, as (place in [`BlockSystem::before`], scaled rate).
    pub before: Vec<(usize, f64)>,
    /// Largest change by the block's unknowns.
    pub own_rate: f64,
    /// Largest change by all unknowns.
    pub rate: f64,
    /// Rows outside which nothing depends on it.
    pub rows: Range<usize>,
}

impl FormUse {
    fn reaches(&mut self, rows: Range<usize>) {
        self.rows = match self.rows.is_empty() {
            true => rows,
            false => self.rows.start.min(rows.start)..self.rows.end.max(rows.end),
        };
    }
}

/// An equation of the block.
#[derive(Clone, Debug)]
struct EquationRow {
    affine: Affine,
    scale: f64,
}

/// A loop of the block.
#[derive(Clone, Debug)]
struct LoopRows {
    plan: LoopPlan,
    /// Its equations and the rows they stand in, those of the block first.
    rows: Vec<(usize, usize)>,
    /// How many of them are the block's.
    of_block: usize,
    /// A point closes it, so that it may be turned by anything.
    may_turn: bool,
    /// What its translation is measured in.
    size: f64,
}

/// What is proved of a block, laid out once, and its rows at the last pose.
#[derive(Clone, Debug, Default)]
pub struct BlockSystem {
    /// Unknowns in the order of the columns.
    pub unknowns: Vec<usize>,
    /// Unknowns of earlier blocks that enter.
    pub before: Vec<usize>,
    /// Arguments of the loops, then equations.
    pub forms: Vec<FormUse>,
    /// A form that is not affine is among them.
    pub has_formula: bool,
    loops: Vec<LoopRows>,
    equations: Vec<EquationRow>,
    first_equation: usize,
    /// At the last pose.
    pub rows: Vec<ProvedRow>,
    /// Derivative of every row by every form, one form after the other.
    pub columns: LaneMatrix,
    /// How far each form is open, as what it is used for.
    pub open: Vec<f64>,
    at_pose: Vec<LoopAtPose>,
    arguments: Vec<ArgumentDouble>,
}

impl BlockSystem {
    /// Lays out a block.
    pub fn new(of: &System, block: &Block, forms: &Forms) -> Self {
        let mechanism = of.mechanism();
        let rows = ProofRows::new(of, block);
        let mut system = Self {
            first_equation: rows.first_equation,
            unknowns: block.unknowns.clone(),
            ..Self::default()
        };
        let first_equation = mechanism.arguments.len();
        let equations = block.equations.iter().map(|index| first_equation + index);
        for index in block.arguments.iter().copied().chain(equations) {
            system.add_form(mechanism, block, forms, index);
        }
        for (part, of_loop) in block.loops.iter().zip(rows.loops) {
            let place = |a: usize| block.arguments.binary_search(&a).unwrap_or(0);
            let steps = &mechanism.loops[part.index].chain.steps;
            system.loops.push(LoopRows {
                plan: LoopPlan::new(steps, place),
                rows: of_loop,
                of_block: part.components.len(),
                may_turn: mechanism.loops[part.index].closes == Closes::Point,
                size: mechanism.loops[part.index].size,
            });
            system.at_pose.push(LoopAtPose::default());
        }
        for index in &block.equations {
            let affine = forms[first_equation + index].clone().unwrap_or_default();
            let scale = mechanism.weight_of(*index);
            system.equations.push(EquationRow { affine, scale });
        }
        system.note_rows();
        system.rows = vec![ProvedRow::default(); rows.count];
        system.open = vec![0.0; system.forms.len()];
        system
    }

    /// Notes which rows of the block depend on each form.
    fn note_rows(&mut self) {
        let first = self.forms.len() - self.equations.len();
        let mut row = 0;
        for item in &self.loops {
            let end = row + item.of_block;
            for argument in item.plan.arguments() {
                self.forms[argument].reaches(row..end);
            }
            row = end;
        }
        for form in &mut self.forms[first..] {
            form.reaches(row..row + 1);
            row += 1;
        }
    }

    fn add_form(&mut self, mechanism: &Mechanism, block: &Block, forms: &Forms, index: usize) {
        self.has_formula |= forms[index].is_none();
        let (mut own, mut before) = (Vec::new(), Vec::new());
        let terms = forms[index].iter().flat_map(Affine::numbers);
        for (slot, c) in terms {
            if let Some(column) = block.columns.of(slot) {
                own.push((column, c * mechanism.scale_of(slot)));
            } else if slot < mechanism.unknowns.len() {
                let known = self.before.iter().position(|s| *s == slot);
                let place = known.unwrap_or_else(|| {
                    self.before.push(slot);
                    self.before.len() - 1
                });
                before.push((place, c * mechanism.scale_of(slot)));
            }
        }
        let sum = |rates: &[(usize, f64)]| rates.iter().map(|(_, c)| c.abs()).sum::<f64>();
        self.forms.push(FormUse {
            index,
            own_rate: sum(&own),
            rate: sum(&own) + sum(&before),
            own,
            before,
            rows: 0..0,
        });
    }

    /// Fills the rows at coordinates and their rests. `arguments` are those of the whole mechanism.
    pub fn evaluate(
        &mut self,
        [coordinates, rests]: [&[f64]; 2],
        arguments: &[ArgumentDouble],
    ) -> Result<(), Reason> {
        self.columns.reset(self.forms.len(), self.rows.len());
        self.open.fill(0.0);
        let of_block = self.forms[..self.forms.len() - self.equations.len()].iter();
        self.arguments.clear();
        self.arguments
            .extend(of_block.map(|form| arguments[form.index]));
        for index in 0..self.loops.len() {
            self.loop_rows(index)?;
        }
        self.equation_rows([coordinates, rests]);
        if self.rows.len() > self.unknowns.len() {
            self.weigh_last_units(coordinates);
        }
        Ok(())
    }

    /// By how much every row changes where the numbers of the scene are off by a unit in their last place.
    fn weigh_last_units(&mut self, coordinates: &[f64]) {
        for (item, at_pose) in self.loops.iter().zip(&self.at_pose) {
            let units = at_pose.last_units(&item.plan, &self.arguments);
            for &(component, row) in &item.rows {
                self.rows[row].last_units = units[component / 3];
            }
        }
        for (equation, row) in self.equations.iter().zip(self.first_equation..) {
            let terms = equation
                .affine
                .terms
                .iter()
                .map(|(slot, c)| (*c, coordinates[*slot]));
            let all = terms.chain([(equation.affine.constant, 1.0)]);
            let sizes = all
                .filter(|(c, _)| !c.is_exact())
                .map(|(c, x)| c.largest() * x.abs());
            self.rows[row].last_units = DECIMAL * equation.scale * sizes.sum::<f64>();
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
        } = &self.loops[index];
        let forms = &self.forms;
        let item = &mut self.at_pose[index];
        // The chain with every product's rounding, in double-double.
        item.evaluate(plan, &self.arguments, |a| forms[a].rate * BALL, *size);
        // Sine and cosine have no value there.
        if item.trace.is_nan() {
            return Err(Reason::Precision);
        }
        if !may_turn && item.trace <= LEAST_TRACE {
            return Err(Reason::HalfTurn);
        }
        // An argument is open by what its own formula rounds.
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
            // The columns carry rounding, and belong to arguments that are open by `open`.
            let slack = COLUMN_ROUNDING + open[0];
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
        let row = self.first_equation;
        let first = self.forms.len() - self.equations.len();
        for (k, equation) in self.equations.iter().enumerate() {
            let scale = equation.scale;
            let (value, open) = affine_value(&equation.affine, coordinates, rests);
            let residual = value.hi * scale;
            *self.columns.at_mut(first + k, row + k) = scale;
            self.rows[row + k] = ProvedRow {
                residual,
                open: (open + value.lo.abs()) * scale + 4.0 * U * residual.abs(),
                second: 0.0,
                second_all: 0.0,
                column_error: COLUMN_ROUNDING * scale * self.forms[first + k].rate,
                last_units: 0.0,
            };
        }
    }

    /// Whether a loop may be turned by π once the unknowns move by `distance`.
    pub fn may_be_half_turned(&self, distance: f64) -> bool {
        let loops = self.loops.iter().zip(&self.at_pose);
        let mut fixed = loops.filter(|(rows, _)| !rows.may_turn);
        fixed.any(|(_, item)| {
            let turned = item.first_derivatives(|a| self.forms[a].rate)[0];
            let least = item.trace - 2.0 * turned * distance;
            least.is_nan() || least <= LEAST_TRACE
        })
    }
}
