//! The equations of a block and their derivatives by all coordinates that they depend on, in any arithmetic.

use super::twists::{ChainTwists, frame_about, residual_component};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::columns::ColumnMap;
use crate::kinematics::structure::loop_part::LoopPart;
use crate::model::chain::{Argument, ArgumentValue, ChainStep, ElementaryMotion};
use crate::model::expression::Expression;
use crate::model::mechanism::{Closes, Mechanism};
use crate::model::outputs::output_arguments;
use crate::model::walk::add_vectors;
use crate::numbers::constant::Constant;
use crate::numbers::scalar::Scalar;

/// The layout of a block: the coordinates it depends on.
#[derive(Clone, Debug)]
pub struct Layout<'m> {
    mechanism: &'m Mechanism,
    /// The block.
    pub block: &'m Block,
    /// Coordinates of the columns: the block's own unknowns, then all others.
    pub slots: Vec<usize>,
    columns: ColumnMap,
    /// Which arguments of the mechanism are angles of the block's loops.
    turning: Vec<bool>,
}

/// Residuals and derivatives, row after row.
#[derive(Clone, Debug)]
pub struct Rows<S> {
    /// One a row.
    pub residual: Vec<S>,
    /// Row after row, one a column.
    pub jacobian: Vec<S>,
}

impl<'m> Layout<'m> {
    /// Lays out a block.
    pub fn new(mechanism: &'m Mechanism, block: &'m Block) -> Self {
        let arguments = block.arguments.iter();
        let of_arguments = arguments.flat_map(|a| mechanism.arguments[*a].coordinates());
        let equations = block.equations.iter();
        let of_equations = equations.flat_map(|e| mechanism.equations[*e].expression.slots());
        let mut others: Vec<usize> = of_arguments.chain(of_equations).collect();
        others.sort_unstable();
        others.dedup();
        // Unknowns of the block first, then coordinates of other blocks.
        others.retain(|slot| block.columns.of(*slot).is_none());
        let slots = [block.unknowns.clone(), others].concat();
        let loops = block.loops.iter();
        let chains = loops.map(|part| &mechanism.loops[part.index].chain.steps[..]);
        Self {
            mechanism,
            block,
            columns: ColumnMap::new(&slots),
            turning: turning_arguments(mechanism, chains),
            slots,
        }
    }

    /// Number of own unknowns.
    pub fn own(&self) -> usize {
        self.block.unknowns.len()
    }

    /// Points about which the block's loops are expressed: the middles of their hinges at a pose. Residuals about
    /// different points are different equations for the same closed poses, as long as all of them are solved.
    pub fn middles(&self, coordinates: &[f64]) -> Vec<[f64; 3]> {
        let loops = &self.block.loops;
        if self.block.rows() > self.own() {
            return vec![[0.0; 3]; loops.len()];
        }
        let values = output_arguments(self.mechanism, &self.block.arguments, coordinates);
        let middle = |part: &LoopPart| {
            let item = &self.mechanism.loops[part.index];
            if item.closes == Closes::Point {
                // Its rotation is unknown, so that it closes about its own origin only.
                return [0.0; 3];
            }
            let twists = ChainTwists::new(&item.chain.steps, &values, [0.0; 3]);
            let count = twists.rotation_origins().count().max(1) as f64;
            let sum = twists.rotation_origins().fold([0.0; 3], add_vectors);
            let middle = sum.map(|c| c / count);
            match middle.iter().all(|c| c.is_finite()) {
                true => middle,
                false => [0.0; 3],
            }
        };
        loops.iter().map(middle).collect()
    }

    /// Evaluates all rows at coordinates (unknowns, then inputs), with the loops expressed about the points `about`.
    pub fn rows<S: Scalar>(&self, coordinates: &[S], about: &[[f64; 3]]) -> Rows<S> {
        let (count, columns) = (self.block.rows(), self.slots.len());
        let zero = S::number(0.0);
        let mut rows = Rows {
            residual: Vec::with_capacity(count),
            jacobian: vec![zero; count * columns],
        };
        let used = &self.block.arguments;
        let values = argument_values(self.mechanism, used, &self.turning, coordinates);
        let rates = Rates::new(self.mechanism, used, coordinates);
        // Loops: residual and columns of the joints' twists, by the chain rule.
        for (part, about) in self.block.loops.iter().zip(about) {
            let item = &self.mechanism.loops[part.index];
            let twists = ChainTwists::new(&item.chain.steps, &values, *about);
            let (first, per_size) = (rows.residual.len(), 1.0 / item.size);
            let components = &part.components;
            let residuals = components.iter().map(|c| twists.residual(*c, per_size));
            rows.residual.extend(residuals);
            twists.columns(per_size, |argument, by_argument| {
                for (slot, rate) in rates.of(argument) {
                    let Some(column) = self.columns.of(*slot) else {
                        continue;
                    };
                    for (row, component) in components.iter().enumerate() {
                        let entry = &mut rows.jacobian[(first + row) * columns + column];
                        *entry = *entry + rate.times(by_argument[*component]);
                    }
                }
            });
        }
        // Scalar equations: value and gradient.
        for index in &self.block.equations {
            let equation = &self.mechanism.equations[*index];
            let (expression, weight) = (&equation.expression, equation.weight);
            let row = rows.residual.len();
            rows.residual
                .push(expression.value(coordinates).scale(weight));
            for (slot, rate) in expression_gradient(expression, coordinates) {
                if let Some(column) = self.columns.of(slot) {
                    rows.jacobian[row * columns + column] = rate.scale(weight);
                }
            }
        }
        rows
    }

    /// The residuals alone.
    pub fn residuals<S: Scalar>(&self, coordinates: &[S], about: &[[f64; 3]]) -> Vec<S> {
        let used = &self.block.arguments;
        let values = argument_values(self.mechanism, used, &self.turning, coordinates);
        let mut list = Vec::with_capacity(self.block.rows());
        for (part, about) in self.block.loops.iter().zip(about) {
            let item = &self.mechanism.loops[part.index];
            let end = frame_about(&item.chain.steps, &values, *about);
            let components = part.components.iter();
            list.extend(components.map(|c| residual_component(&end, *c, 1.0 / item.size)));
        }
        for index in &self.block.equations {
            let equation = &self.mechanism.equations[*index];
            let value = equation.expression.value(coordinates);
            list.push(value.scale(equation.weight));
        }
        list
    }
}

/// Which arguments are angles of the chains.
pub fn turning_arguments<'c>(
    mechanism: &Mechanism,
    chains: impl Iterator<Item = &'c [ChainStep]>,
) -> Vec<bool> {
    let mut turning = vec![false; mechanism.arguments.len()];
    for joint in chains.flatten().filter_map(ChainStep::joint) {
        turning[joint.argument] |= joint.motion == ElementaryMotion::Rotation;
    }
    turning
}

/// Values of the arguments in `used`, with sine and cosine of those that are `turning`; the others stay zero.
pub fn argument_values<S: Scalar>(
    mechanism: &Mechanism,
    used: &[usize],
    turning: &[bool],
    coordinates: &[S],
) -> Vec<ArgumentValue<S>> {
    let zero = S::number(0.0);
    let still = |value| ArgumentValue {
        value,
        sin: zero,
        cos: zero,
    };
    let mut all = vec![still(zero); mechanism.arguments.len()];
    let mut scratch = Vec::new();
    for index in used {
        let value = mechanism.arguments[*index].value(coordinates, &mut scratch);
        all[*index] = match turning[*index] {
            true => ArgumentValue::new(value),
            false => still(value),
        };
    }
    all
}

/// A derivative of an argument.
#[derive(Clone, Copy, Debug)]
pub enum ArgumentRate<S> {
    /// The same everywhere.
    Constant(Constant),
    /// Of a formula.
    Varying(S),
}

impl<S: Scalar> ArgumentRate<S> {
    /// The product with a quantity that changes like the argument.
    pub fn times(&self, by_argument: S) -> S {
        match self {
            Self::Constant(constant) => by_argument.scale_by(*constant),
            Self::Varying(rate) => by_argument * *rate,
        }
    }
}

/// Derivatives of arguments by the coordinates that each depends on.
#[derive(Clone, Debug)]
pub struct Rates<S> {
    of_argument: Vec<Vec<(usize, ArgumentRate<S>)>>,
}

impl<S: Scalar> Rates<S> {
    /// Of the arguments in `used`; the others have none.
    pub fn new(mechanism: &Mechanism, used: &[usize], coordinates: &[S]) -> Self {
        let mut of_argument = vec![Vec::new(); mechanism.arguments.len()];
        for index in used {
            of_argument[*index] = match &mechanism.arguments[*index] {
                Argument::Affine(affine) => {
                    let terms = affine.terms.iter();
                    terms
                        .map(|(slot, c)| (*slot, ArgumentRate::Constant(*c)))
                        .collect()
                }
                Argument::Formula(expression) => {
                    let list = expression_gradient(expression, coordinates).into_iter();
                    list.map(|(slot, rate)| (slot, ArgumentRate::Varying(rate)))
                        .collect()
                }
            };
        }
        Self { of_argument }
    }

    /// Coordinates and rates of an argument.
    pub fn of(&self, argument: usize) -> &[(usize, ArgumentRate<S>)] {
        &self.of_argument[argument]
    }
}

/// The derivatives of a formula by the slots that it depends on. Where it may jump or is undefined it has none.
pub fn expression_gradient<S: Scalar>(expression: &Expression, slots: &[S]) -> Vec<(usize, S)> {
    let (one, mut values, mut adjoints) = (S::number(1.0), Vec::new(), Vec::new());
    let mut all = vec![S::number(0.0); slots.len()];
    let value = expression.add_gradient(slots, one, &mut all, &mut values, &mut adjoints);
    let of = |slot: usize| match value.is_finite() {
        true => all[slot],
        false => S::undefined(),
    };
    let used = expression.slots().into_iter();
    used.map(|slot| (slot, of(slot))).collect()
}
