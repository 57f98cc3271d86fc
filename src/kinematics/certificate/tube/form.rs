//! Arguments and equations over a stretch: dot products where they are affine, general formulas elsewhere.

use super::gradient::{bounds, gradient};
use super::model::Model;
use super::path::Path;
use super::series::Series;
use crate::model::chain::Argument;
use crate::model::expression::{Affine, Expression};
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;

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
    pub fn value(&self, path: &Path) -> Model {
        match self {
            Self::Formula(expression) => {
                let [middle, everywhere] = path.series();
                let of = |slots: &[Series]| Series::of(expression, slots);
                Model::of(&of(middle), &of(everywhere))
            }
            Self::Affine(affine) => Model::of_affine(affine, &path.coordinates),
        }
    }

    /// Derivatives by the coordinates it depends on, in the order of [`coordinates`](Self::coordinates).
    pub fn derivatives(&self, path: &Path) -> Vec<Model> {
        match self {
            Self::Affine(affine) => {
                let open = |c: f64| if c.fract() == 0.0 { 0.0 } else { f64::EPSILON };
                let number = |c: f64| Model {
                    rest: open(c) * c.abs(),
                    ..Model::constant(c)
                };
                affine.terms.iter().map(|(_, c)| number(*c)).collect()
            }
            Self::Formula(expression) => {
                let [middle, everywhere] = path.series();
                let (near, far) = (
                    gradient(expression, middle),
                    gradient(expression, everywhere),
                );
                let slots = expression.slots();
                let of = |slot: usize| Model::of(&near[slot], &far[slot]);
                slots.into_iter().map(of).collect()
            }
        }
    }

    /// How it changes along directions whose entries are at most `rates`, anywhere in `place`, which affine forms do not
    /// need.
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

    /// All values in `place`.
    pub fn range(&self, place: &[Interval]) -> Interval {
        match self {
            Self::Affine(affine) => {
                let constant = Interval::decimal(affine.constant);
                affine.terms.iter().fold(constant, |sum, (slot, c)| {
                    sum + place[*slot] * Interval::decimal(*c)
                })
            }
            Self::Formula(expression) => {
                let still: Vec<Series> = place.iter().map(|i| Series::constant(*i)).collect();
                Series::of(expression, &still).0[0]
            }
        }
    }
}
