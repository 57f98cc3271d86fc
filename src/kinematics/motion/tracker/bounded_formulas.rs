//! Formulas of loops and equations whose values between the ends of a step are bounded: the lift of a cam, the length of a
//! driven bar. They may go elsewhere and come back within a step, as drives may.

use super::step_bounds::{STRAY, StepBound, joint_arguments};
use crate::model::actuation::{Actuation, INSTANTS};
use crate::model::chain::Argument;
use crate::model::expression::Expression;
use crate::model::mechanism::{Equation, Mechanism};
use crate::numbers::interval::Interval;

/// A formula of unknowns may leave the range between its values at the ends of a step by this much, radians or lengths of its
/// loop, over all values that these may have together.
const STRAY_OF_UNKNOWNS: f64 = 0.1;

/// The terms of an equation count as no less than this share of what they are at [`INSTANTS`]: all may vanish at one.
const LEAST_TERM: f64 = 1e-3;

/// Terms of so many times the width of their sum as an interval are rounding.
const NOISE: f64 = 8.0;

/// Longer formulas are not followed, and no more parts than that: their cost would grow with the square of a scene's text.
const MOST_OPERATIONS: usize = 1000;
const MOST_PARTS: usize = 1000;

/// A formula, and how far it may go.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct BoundedFormula {
    /// Slots are coordinates.
    pub formula: Expression,
    /// Those it uses.
    pub slots: Vec<usize>,
    bound: StepBound,
    /// The sum in an equation whose terms are the unit of the bound.
    terms: Option<SumTerms>,
}

/// A sum, and what is known of the size of its terms.
#[derive(Clone, Debug, PartialEq)]
struct SumTerms {
    sum: Expression,
    /// Terms count as no less, ...
    least: f64,
    /// ... and as none at all if they are no more: rounding.
    noise: f64,
}

impl SumTerms {
    /// From its terms at some places; where they are none but rounding, from the range of one of them over the whole motion.
    fn new(sum: Expression, about: &[Vec<f64>], range: Option<Interval>) -> Self {
        let at_places = |value: &dyn Fn(&[f64]) -> f64| {
            let values = about.iter().map(|slots| value(slots));
            values.filter(|v| v.is_finite()).fold(0.0, f64::max)
        };
        // An interval evaluation at a single point is as wide as the rounding errors of the sum.
        let width = |slots: &[f64]| {
            let points: Vec<Interval> = slots.iter().map(|v| Interval::point(*v)).collect();
            sum.range(&points).map_or(0.0, |range| range.hi - range.lo)
        };
        let noise = NOISE * at_places(&width);
        let largest = at_places(&|slots| sum.largest_term(slots));
        // Terms no larger than that are nothing but rounding: then the range over the motion counts.
        let largest = match largest > noise {
            true => largest,
            false => range.map_or(0.0, |range| range.magnitude()),
        };
        // All terms may vanish at one instant, so that they never count as less than a share of the largest.
        Self {
            least: if largest.is_finite() {
                LEAST_TERM * largest
            } else {
                0.0
            },
            noise,
            sum,
        }
    }

    /// The size of its terms; `None` if there are none.
    fn unit_at(&self, slots: &[f64]) -> Option<f64> {
        let largest = self.sum.largest_term(slots);
        let unit = if largest > self.noise { largest } else { 0.0 };
        Some(unit.max(self.least)).filter(|unit| *unit > 0.0)
    }
}

impl BoundedFormula {
    fn new(formula: Expression, bound: StepBound, terms: Option<SumTerms>) -> Self {
        Self {
            slots: formula.slots(),
            formula,
            bound,
            terms,
        }
    }

    /// The parts of a mechanism's formulas that depend on inputs only.
    pub fn of_inputs(mechanism: &Mechanism, actuation: &Actuation) -> Vec<Self> {
        let unknowns = mechanism.unknowns.len();
        let is_input = |slot| slot >= unknowns;
        let mut all: Vec<Self> = Vec::new();
        // Joints: affine arguments bound their inputs, see `StepBound::of_inputs`.
        for (argument, bound) in joint_arguments(mechanism) {
            if let Argument::Formula(formula) = argument
                && all.len() < MOST_PARTS
                && formula.ops().len() <= MOST_OPERATIONS
                && formula.affine().is_none()
            {
                let parts = formula.parts_of(is_input).into_iter();
                all.extend(parts.map(|[part, _]| Self::new(part, bound, None)));
            }
        }
        let of_terms = StepBound {
            farthest: f64::INFINITY,
            stray: STRAY,
        };
        let about = INSTANTS.map(|share| actuation.start_at(share * actuation.duration));
        let whole = Interval::new(0.0, actuation.duration);
        let mut boxes = vec![Interval::ZERO; unknowns];
        boxes.extend(
            actuation
                .drives
                .iter()
                .map(|drive| drive.sharp_range(whole).unwrap_or(Interval::ENTIRE)),
        );
        // Equations have no unit but their own terms.
        let short = |e: &&Equation| e.expression.ops().len() <= MOST_OPERATIONS;
        for equation in mechanism.equations.iter().filter(short) {
            if all.len() >= MOST_PARTS {
                break;
            }
            for [part, sum] in equation.expression.parts_of(is_input) {
                let terms = SumTerms::new(sum, &about, part.range(&boxes));
                all.push(Self::new(part, of_terms, Some(terms)));
            }
        }
        // The same angle or length enters many equations.
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
            // A gear turns farther than the unknown that moves it, and any formula may.
            let multiplies = |(slot, factor): (usize, f64)| slot < unknowns && factor.abs() > 1.0;
            let formula = match argument {
                Argument::Affine(affine) if affine.numbers().any(multiplies) => affine.formula(),
                Argument::Formula(formula) if !formula.has_jumps() => formula.clone(),
                _ => continue,
            };
            if all.len() >= MOST_PARTS {
                break;
            }
            let found = Self::new(formula, wide, None);
            if found.slots.first().is_some_and(|slot| *slot < unknowns) && !all.contains(&found) {
                all.push(found);
            }
        }
        all
    }

    /// The bound at a pose.
    pub fn bound_at(&self, coordinates: &[f64]) -> StepBound {
        match &self.terms {
            None => self.bound,
            // Without any term nothing can be said.
            Some(terms) => {
                let unit = terms.unit_at(coordinates).unwrap_or(f64::INFINITY);
                let bound = self.bound.scaled(unit);
                // Rounding is no way: not even at a kink, where all terms of a resting formula may be nothing else.
                StepBound {
                    stray: bound.stray.max(terms.noise),
                    ..bound
                }
            }
        }
    }

    /// Whether it stays within a bound between its values at two places, over boxes of its slots.
    pub fn stays(&self, bound: StepBound, ends: [f64; 2], between: &[Interval]) -> bool {
        // Most are told without their rates.
        bound.holds(ends, self.formula.range(between))
            || bound.holds(ends, self.formula.sharp_range(between))
    }
}
