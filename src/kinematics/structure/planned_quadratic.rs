//! The layout of an equation of second degree: its affine factors as short sums of plain numbers.

use crate::model::expression::Affine;
use crate::model::expression::quadratic::QuadraticFormula;
use crate::numbers::scalar::Ring;

/// Highest order of the coefficients of products.
pub const HIGHEST_ORDER: usize = 4;

/// A coordinate's part of an affine form.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PlannedTerm {
    slot: usize,
    /// Its place among the equation's coordinates.
    place: usize,
    coefficient: f64,
}

/// An affine form.
#[derive(Clone, Debug, PartialEq)]
struct PlannedSum {
    constant: f64,
    terms: Vec<PlannedTerm>,
}

/// A sum of products of affine forms.
#[derive(Clone, Debug, PartialEq)]
pub struct PlannedQuadratic {
    rest: PlannedSum,
    factors: Vec<PlannedSum>,
    products: Vec<(f64, [usize; 2])>,
}

impl PlannedSum {
    fn new(form: &Affine, slots: &[usize]) -> Self {
        let term = |(slot, coefficient): (usize, f64)| PlannedTerm {
            slot,
            place: slots.partition_point(|s| *s < slot),
            coefficient,
        };
        Self {
            constant: form.constant.number(),
            terms: form.numbers().map(term).collect(),
        }
    }

    #[inline]
    fn value<S: Ring>(&self, coordinates: &[S]) -> S {
        self.linear(S::number(self.constant), coordinates)
    }

    /// The sum without its constant.
    #[inline]
    fn linear<S: Ring>(&self, start: S, coordinates: &[S]) -> S {
        let terms = self.terms.iter();
        terms.fold(start, |sum, term| {
            sum + coordinates[term.slot].scale(term.coefficient)
        })
    }

    /// Every coordinate's place, and `factor` times its coefficient.
    #[inline]
    fn each_part<S: Ring>(&self, factor: S, add: &mut impl FnMut(usize, S)) {
        for term in &self.terms {
            add(term.place, factor.scale(term.coefficient));
        }
    }
}

impl PlannedQuadratic {
    /// Of the coordinates `slots`, which are all of its own, ascending.
    pub fn new(form: &QuadraticFormula, slots: &[usize]) -> Self {
        let factors = form.factors.iter();
        let products = form.products.iter();
        Self {
            rest: PlannedSum::new(&form.rest, slots),
            factors: factors.map(|f| PlannedSum::new(f, slots)).collect(),
            products: products.map(|(c, pair)| (c.number(), *pair)).collect(),
        }
    }

    /// The value, with those of its factors in `values`.
    #[inline]
    pub fn value<S: Ring>(&self, coordinates: &[S], values: &mut Vec<S>) -> S {
        values.clear();
        values.extend(self.factors.iter().map(|f| f.value(coordinates)));
        let products = self.products.iter();
        let sum = products.fold(S::number(0.0), |sum, (factor, [a, b])| {
            sum + (values[*a] * values[*b]).scale(*factor)
        });
        // The constant comes last, as in the formula: where it cancels the rest, the result is exactly zero.
        sum + self.rest.value(coordinates)
    }

    /// Parts of the derivatives, by the place of a coordinate, where its factors have these `values`; a coordinate may have
    /// several.
    #[inline]
    pub fn each_slope<S: Ring>(&self, values: &[S], mut add: impl FnMut(usize, S)) {
        self.rest.each_part(S::number(1.0), &mut add);
        for (factor, [a, b]) in &self.products {
            if a == b {
                self.factors[*a].each_part(values[*a].scale(2.0 * factor), &mut add);
            } else {
                self.factors[*a].each_part(values[*b].scale(*factor), &mut add);
                self.factors[*b].each_part(values[*a].scale(*factor), &mut add);
            }
        }
    }

    /// Number of its factors.
    pub fn factor_count(&self) -> usize {
        self.factors.len()
    }

    /// Coefficient `order` of every factor, 1 to [`HIGHEST_ORDER`], from those `of_order` of all coordinates.
    pub fn take_order(&self, of_order: &[f64], order: usize, factors: &mut [[f64; HIGHEST_ORDER]]) {
        for (coefficients, factor) in factors.iter_mut().zip(&self.factors) {
            coefficients[order - 1] = factor.linear(0.0, of_order);
        }
    }

    /// The contribution of the coefficients of lower order, which its `factors` have, to coefficient `order` of the value.
    /// The order is 2 to [`HIGHEST_ORDER`].
    pub fn bend(&self, factors: &[[f64; HIGHEST_ORDER]], order: usize) -> f64 {
        // Cauchy product of the two factors without its first and last term, which contain coefficient `order`
        // itself.
        let products = self.products.iter().map(|(factor, [a, b])| {
            let [first, second] = [a, b].map(|k| &factors[*k][..order - 1]);
            let pairs = first.iter().zip(second.iter().rev());
            factor * pairs.map(|(x, y)| x * y).sum::<f64>()
        });
        products.sum()
    }
}

#[cfg(test)]
#[allow(clippy::unwrap_used)]
mod tests {
    use super::*;
    use crate::model::expression::{Expression, Op};
    use crate::numbers::constant::Constant;
    use crate::numbers::series::TaylorSeries;

    /// (x - y)^2 - 3 x y + 2 y - 7, of slots 1 and 3.
    fn formula() -> Expression {
        let number = |value: f64| Op::Constant(Constant::exact(value));
        Expression::new(vec![
            Op::Slot(1),
            Op::Slot(3),
            Op::Subtract(0, 1),
            Op::Multiply(2, 2),
            number(3.0),
            Op::Multiply(0, 4),
            Op::Multiply(5, 1),
            Op::Subtract(3, 6),
            number(2.0),
            Op::Multiply(8, 1),
            Op::Add(7, 9),
            number(7.0),
            Op::Subtract(10, 11),
        ])
    }

    #[test]
    fn value_slopes_and_bends_are_those_of_the_formula() {
        let formula = formula();
        let planned = PlannedQuadratic::new(&formula.quadratic().unwrap(), &formula.slots());
        let at = [9.0, 0.3, 9.0, -2.0];
        let mut values = Vec::new();
        let value = planned.value(&at, &mut values);
        assert!((value - formula.value(&at)).abs() < 1e-14);
        let mut slopes = [0.0; 2];
        planned.each_slope(&values, |place, part| slopes[place] += part);
        let exact = formula.gradient(&at);
        assert!((slopes[0] - exact[1]).abs() < 1e-14);
        assert!((slopes[1] - exact[3]).abs() < 1e-14);
        // Series with coefficients up to the third order: what they give in the fourth is not linear in them.
        let coefficients = [
            [0.0; 4],
            [0.0, 0.7, 0.0, -0.2],
            [0.0, 0.1, 0.0, 0.5],
            [0.0, -0.3, 0.0, 0.4],
        ];
        let series: Vec<TaylorSeries> = (0..4)
            .map(|slot| {
                let mut series = TaylorSeries::linear(at[slot], 0.0, 4);
                (1..4).for_each(|k| series.set(k, coefficients[k][slot]));
                series
            })
            .collect();
        let wanted = formula.value(&series).coefficients()[4];
        let mut factors = vec![[0.0; HIGHEST_ORDER]; planned.factor_count()];
        (1..4).for_each(|k| planned.take_order(&coefficients[k], k, &mut factors));
        let found = planned.bend(&factors, 4);
        assert!((found - wanted).abs() < 1e-14, "{found} {wanted}");
    }
}
