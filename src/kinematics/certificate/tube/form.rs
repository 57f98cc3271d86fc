//! Arguments and equations over a stretch: dot products where they are affine, general formulas elsewhere.

use super::super::interval::Interval;
use super::gradient::{bounds, gradient};
use super::series::Series;
use crate::model::chain::Argument;
use crate::model::expression::{Affine, Expression};
use crate::model::mechanism::Mechanism;

/// An argument of a joint, or an equation.
#[derive(Clone, Debug)]
pub enum Form<'m> {
    /// A dot product.
    Affine(Affine),
    /// Anything else.
    Formula(&'m Expression),
}

/// Bounds of the derivatives along a direction, anywhere in the ball around the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct Change {
    /// Of the first derivative.
    pub rate: f64,
    /// Of the second, along two such directions.
    pub bend: f64,
}

impl<'m> Form<'m> {
    /// All arguments, then all equations.
    pub fn all(mechanism: &'m Mechanism) -> Vec<Self> {
        let of = |e: &'m Expression| e.affine().map_or(Self::Formula(e), Self::Affine);
        let arguments = mechanism.arguments.iter().map(|argument| match argument {
            Argument::Affine(affine) => Self::Affine(affine.clone()),
            Argument::Formula(expression) => of(expression),
        });
        let equations = mechanism.equations.iter().map(|e| of(&e.expression));
        arguments.chain(equations).collect()
    }

    /// Coordinates it depends on.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Affine(affine) => affine.terms.iter().map(|(slot, _)| *slot).collect(),
            Self::Formula(expression) => expression.slots(),
        }
    }

    /// Value over the stretch.
    pub fn value(&self, coordinates: &[Series]) -> Series {
        match self {
            Self::Formula(expression) => Series::of(expression, coordinates),
            Self::Affine(affine) => {
                let constant = Series::constant(Interval::decimal(affine.constant));
                affine.terms.iter().fold(constant, |sum, (slot, c)| {
                    sum + coordinates[*slot].scale(Interval::decimal(*c))
                })
            }
        }
    }

    /// Derivatives by the coordinates it depends on, as (coordinate, derivative).
    pub fn derivatives(&self, coordinates: &[Series]) -> Vec<(usize, Series)> {
        match self {
            Self::Affine(affine) => {
                let terms = affine.terms.iter();
                terms
                    .map(|(slot, c)| (*slot, Series::constant(Interval::decimal(*c))))
                    .collect()
            }
            Self::Formula(expression) => {
                let all = gradient(expression, coordinates);
                let slots = expression.slots();
                slots.into_iter().map(|slot| (slot, all[slot])).collect()
            }
        }
    }

    /// How it changes along directions whose entries are at most `rates`, anywhere in `place`.
    pub fn change(&self, place: &[Interval], rates: &[f64]) -> Change {
        match self {
            Self::Affine(affine) => {
                let terms = affine.terms.iter();
                let rate: f64 = terms.map(|(slot, c)| c.abs() * rates[*slot]).sum();
                Change {
                    rate: rate * (1.0 + 1e-12),
                    bend: 0.0,
                }
            }
            Self::Formula(expression) => {
                let [rate, bend] = bounds(expression, place, rates);
                Change { rate, bend }
            }
        }
    }
}
