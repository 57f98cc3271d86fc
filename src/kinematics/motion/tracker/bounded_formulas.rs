//! Formulas of loops and equations whose values between the ends of a step are bounded: the lift of a cam, the length of a
//! driven bar. They may go elsewhere and come back within a step, as drives may.

use super::step_bounds::{FARTHEST_WAY, STRAY, StepBound, joint_arguments};
use crate::model::chain::Argument;
use crate::model::expression::Expression;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;

/// A formula of unknowns may leave the range between its values at the ends of a step by this much, radians or lengths of its
/// loop, over all values that these may have together.
const STRAY_OF_UNKNOWNS: f64 = 0.1;

/// No equation's terms count as less than this share of what its kind of quantity has in the mechanism.
const LEAST_TERM: f64 = 1e-9;

/// A formula, and how far it may go.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BoundedFormula {
    /// Slots are coordinates.
    pub formula: Expression,
    /// Those it uses.
    pub slots: Vec<usize>,
    bound: StepBound,
    /// The equation whose terms are the unit of the bound.
    equation: Option<usize>,
}

impl BoundedFormula {
    fn new(formula: Expression, bound: StepBound, equation: Option<usize>) -> Self {
        Self {
            slots: formula.slots(),
            formula,
            bound,
            equation,
        }
    }

    /// The parts of a mechanism's formulas that depend on inputs only.
    pub fn of_inputs(mechanism: &Mechanism) -> Vec<Self> {
        let unknowns = mechanism.unknowns.len();
        let is_input = |slot| slot >= unknowns;
        let mut all: Vec<Self> = Vec::new();
        for (argument, bound) in joint_arguments(mechanism) {
            if let Argument::Formula(formula) = argument
                && formula.affine().is_none()
            {
                let parts = formula.parts_of(is_input).into_iter();
                all.extend(parts.map(|part| Self::new(part, bound, None)));
            }
        }
        let of_terms = StepBound {
            farthest: FARTHEST_WAY,
            stray: STRAY,
        };
        for (k, equation) in mechanism.equations.iter().enumerate() {
            let parts = equation.expression.parts_of(is_input).into_iter();
            all.extend(parts.map(|part| Self::new(part, of_terms, Some(k))));
        }
        let mut distinct: Vec<Self> = Vec::new();
        for part in all {
            if !distinct.contains(&part) {
                distinct.push(part);
            }
        }
        distinct
    }

    /// Arguments of its joints that unknowns move by more than themselves; what may jump is left to rules of its own.
    pub fn of_unknowns(mechanism: &Mechanism) -> Vec<Self> {
        let unknowns = mechanism.unknowns.len();
        let mut all = Vec::new();
        for (argument, bound) in joint_arguments(mechanism) {
            let wide = StepBound {
                stray: bound.stray * (STRAY_OF_UNKNOWNS / STRAY),
                ..bound
            };
            let multiplies = |(slot, factor): (usize, f64)| slot < unknowns && factor.abs() > 1.0;
            let formula = match argument {
                Argument::Affine(affine) if affine.numbers().any(multiplies) => affine.formula(),
                Argument::Formula(formula) if !formula.has_jumps() => formula.clone(),
                _ => continue,
            };
            let found = Self::new(formula, wide, None);
            if found.slots.first().is_some_and(|slot| *slot < unknowns) && !all.contains(&found) {
                all.push(found);
            }
        }
        all
    }

    /// The bound at a pose.
    pub fn bound_at(&self, mechanism: &Mechanism, coordinates: &[f64]) -> StepBound {
        let Some(equation) = self.equation else {
            return self.bound;
        };
        let usual = 1.0 / mechanism.weight_of(equation);
        let terms = mechanism.equations[equation]
            .expression
            .largest_term(coordinates);
        self.bound
            .scaled(terms.map_or(usual, |term| term.max(LEAST_TERM * usual)))
    }

    /// Whether it stays within a bound between its values at two places, over boxes of its slots.
    pub fn stays(&self, bound: StepBound, ends: [f64; 2], between: &[Interval]) -> bool {
        // Most are told without their rates.
        bound.holds(ends, self.formula.range(between))
            || bound.holds(ends, self.formula.sharp_range(between))
    }
}
