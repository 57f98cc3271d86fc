//! Arguments and equations over a time interval: dot products if they are affine, otherwise general formulas.

use super::path::TubePath;
use super::taylor_model::TaylorModel;
use crate::model::chain::Argument;
use crate::model::expression::quadratic::QuadraticFormula;
use crate::model::expression::{Affine, Expression};
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::Series;

/// A formula to the second order along a line.
type Bend = Series<Interval, 3>;

/// An argument of a joint, or an equation.
#[derive(Clone, Debug)]
pub enum Form {
    /// A dot product.
    Affine(Affine),
    /// Anything else.
    Formula(Sparse),
}

/// A formula of its few coordinates: its cost does not grow with the mechanism.
#[derive(Clone, Debug)]
pub struct Sparse {
    /// Of `slots`, in their order.
    expression: Expression,
    slots: Vec<usize>,
    /// A formula of second degree, and its derivatives, of all coordinates.
    quadratic: Option<QuadraticFormula>,
    slopes: Option<Vec<Affine>>,
}

impl Sparse {
    fn new(expression: &Expression) -> Self {
        let slots = expression.slots();
        Self {
            expression: expression.renumbered_slots(&slots),
            quadratic: expression.quadratic(),
            slopes: expression.affine_slopes(),
            slots,
        }
    }

    /// Its coordinates.
    fn own<S: Scalar>(&self, all: &[S]) -> Vec<S> {
        self.slots.iter().map(|slot| all[*slot]).collect()
    }

    fn value<S: Scalar>(&self, all: &[S]) -> S {
        self.expression.value(&self.own(all))
    }

    fn gradient<S: Scalar>(&self, all: &[S]) -> Vec<S> {
        self.expression.gradient(&self.own(all))
    }
}

/// Bounds of the derivatives along a direction, anywhere in the ball around the path.
#[derive(Clone, Copy, Debug, Default)]
pub struct FormChange {
    /// Of the first derivative.
    pub rate: f64,
    /// Of the second, along two such directions.
    pub bend: f64,
}

impl Form {
    /// All arguments, then all equations.
    pub fn all(mechanism: &Mechanism) -> Vec<Self> {
        let of = Self::of;
        let arguments = mechanism.arguments.iter().map(|argument| match argument {
            Argument::Affine(affine) => Self::Affine(affine.clone()),
            Argument::Formula(expression) => of(expression),
        });
        let equations = mechanism.equations.iter().map(|e| of(&e.expression));
        arguments.chain(equations).collect()
    }

    /// A formula.
    pub fn of(e: &Expression) -> Self {
        match e.affine() {
            Some(affine) => Self::Affine(affine),
            None => Self::Formula(Sparse::new(e)),
        }
    }

    /// Coordinates it depends on.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Affine(affine) => affine.terms.iter().map(|(slot, _)| *slot).collect(),
            Self::Formula(formula) => formula.slots.clone(),
        }
    }

    /// Value over the stretch.
    pub fn value(&self, path: &TubePath) -> TaylorModel {
        match self {
            Self::Formula(Sparse {
                quadratic: Some(quadratic),
                ..
            }) => quadratic_model(quadratic, &path.coordinates),
            Self::Formula(formula) => {
                if let Some(still) = path.still() {
                    return TaylorModel::standing(formula.value(still));
                }
                let [middle, everywhere] = path.series();
                TaylorModel::of(formula.value(middle), &formula.value(everywhere))
            }
            Self::Affine(affine) => TaylorModel::of_affine(affine, &path.coordinates),
        }
    }

    /// Derivatives by the coordinates it depends on, in the order of [`coordinates`](Self::coordinates).
    pub fn derivatives(&self, path: &TubePath) -> Vec<TaylorModel> {
        match self {
            Self::Affine(affine) => {
                let number = |c: Constant| TaylorModel {
                    rest: c.open(),
                    ..TaylorModel::constant(c.number())
                };
                affine.terms.iter().map(|(_, c)| number(*c)).collect()
            }
            Self::Formula(Sparse {
                slopes: Some(slopes),
                ..
            }) => {
                let of = |slope: &Affine| TaylorModel::of_affine(slope, &path.coordinates);
                slopes.iter().map(of).collect()
            }
            Self::Formula(formula) => {
                if let Some(still) = path.still() {
                    let gradient = formula.gradient(still).into_iter();
                    return gradient.map(TaylorModel::standing).collect();
                }
                // About the middle for the coefficients, over the stretch for the remainder.
                let [near, far] = path.series().each_ref().map(|all| formula.gradient(all));
                let pairs = near.into_iter().zip(&far);
                pairs
                    .map(|(near, far)| TaylorModel::of(near, far))
                    .collect()
            }
        }
    }

    /// Its change along directions whose entries are at most `rates`, anywhere in `place`, which affine forms do not
    /// need.
    pub fn change(&self, place: &[Interval], rates: &[f64]) -> FormChange {
        match self {
            Self::Affine(affine) => {
                let terms = affine.terms.iter();
                let rate: f64 = terms.map(|(slot, c)| c.largest() * rates[*slot]).sum();
                FormChange {
                    rate: rate * GROW,
                    bend: 0.0,
                }
            }
            Self::Formula(formula) => {
                let own = formula.own(place);
                let own_rates = formula.own(rates);
                let [rate, bend] = form_bounds(&formula.expression, &own, &own_rates);
                FormChange {
                    rate,
                    bend: self.bend(rates).unwrap_or(bend),
                }
            }
        }
    }

    /// Bound of the second derivative along two such directions, where it is the same everywhere.
    pub fn bend(&self, rates: &[f64]) -> Option<f64> {
        let Self::Formula(formula) = self else {
            return Some(0.0);
        };
        let along = |slope: &Affine| -> f64 {
            let terms = slope.terms.iter();
            terms.map(|(slot, c)| c.largest() * rates[*slot]).sum()
        };
        let slopes = formula.slots.iter().zip(formula.slopes.as_ref()?);
        // Slopes are affine: the second derivative is constant.
        let sum: f64 = slopes
            .map(|(slot, slope)| rates[*slot] * along(slope))
            .sum();
        Some(sum * GROW)
    }

    /// All values in `place`.
    pub fn range(&self, place: &[Interval]) -> Interval {
        match self {
            Self::Affine(affine) => affine.value(place),
            Self::Formula(formula) => formula.value(place),
        }
    }
}

/// A sum of products of affine forms.
fn quadratic_model(form: &QuadraticFormula, coordinates: &[TaylorModel]) -> TaylorModel {
    let model = |form: &Affine| TaylorModel::of_affine(form, coordinates);
    let factors: Vec<TaylorModel> = form.factors.iter().map(model).collect();
    let products = form.products.iter();
    products.fold(model(&form.rest), |sum, (factor, [a, b])| {
        let product = factors[*a].times(&factors[*b]);
        let scaled = TaylorModel {
            rest: factor.open() * product.size(),
            ..TaylorModel::ZERO
        };
        sum.plus(&product.scaled(factor.number())).plus(&scaled)
    })
}

/// Bounds of the first and second derivative of a formula in any direction whose entries are at most `rates`,
/// anywhere in the box `place`.
///
/// The second bounds the bilinear form for two such directions: by polarisation that is at most twice its value for two
/// equal ones.
fn form_bounds(expression: &Expression, place: &[Interval], rates: &[f64]) -> [f64; 2] {
    let lines = place.iter().zip(rates);
    let lines = lines.map(|(x, rate)| Bend::linear(*x, Interval::around_zero(*rate), 2));
    let value = expression.value(&lines.collect::<Vec<_>>());
    let [_, first, second] = value.coefficients();
    [first.magnitude(), 4.0 * second.magnitude()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::model::expression::{Function, Op};

    /// f(x, y) with a slot on both sides of every operation that has two.
    fn formulas() -> Vec<Expression> {
        let mut list = Vec::new();
        let slots = [Op::Slot(0), Op::Slot(1)];
        let mut add = |op: Op| list.push(Expression::new([&slots[..], &[op]].concat()));
        add(Op::Multiply(0, 1));
        add(Op::Divide(0, 1));
        add(Op::Power(0, 1));
        add(Op::Subtract(0, 1));
        add(Op::Negate(1));
        for function in Function::ALL {
            add(Op::Call(function, 0, 1));
        }
        list
    }

    #[test]
    fn whole_powers_of_negative_bases_have_derivatives() {
        for (exponent, exact) in [(2.0, -1.4), (3.0, 1.47), (-1.0, -1.0 / 0.49), (1.0, 1.0)] {
            let ops = vec![
                Op::Slot(0),
                Op::Constant(Constant::rounded(exponent)),
                Op::Power(0, 1),
            ];
            let base = Series::<Interval, 3>::constant(Interval::point(-0.7));
            let found = Expression::new(ops).gradient(&[base])[0].coefficients()[0];
            assert!(found.distance(exact) < 1e-14, "{exponent}: {found:?}");
        }
    }

    #[test]
    fn bounds_of_derivatives_hold_those_of_f64() {
        let (x, y) = (0.41, 0.73);
        for expression in formulas() {
            let exact = expression.gradient(&[x, y]);
            // The bounds in a small box hold differences of gradients inside.
            let (box_size, rates) = (1e-3, [1.0, 0.5]);
            let place = [x, y].map(|v| Interval::point(v) + Interval::around_zero(box_size));
            let [first, second] = form_bounds(&expression, &place, &rates);
            let beside = expression.gradient(&[x + box_size, y - 0.5 * box_size]);
            let slope = |g: [f64; 2]| g[0].abs() * rates[0] + g[1].abs() * rates[1];
            let here = slope([exact[0], exact[1]]);
            assert!(here <= first * (1.0 + 1e-12), "{expression:?}");
            let change = [beside[0] - exact[0], beside[1] - exact[1]];
            assert!(
                slope(change) <= second * box_size * (1.0 + 1e-9) + 1e-15,
                "{expression:?}: {change:?} {second}"
            );
        }
    }
}
