//! Formulas of second degree, such as the distance of two points: sums of products of affine forms, whose derivatives are
//! affine and bend nowhere.

use super::{Affine, Expression, ONE, Op, ZERO, affine_of, combine_affine, operand_places};
use crate::numbers::constant::Constant;

/// A formula of second degree: `rest` and a sum of products of affine forms, as it is written. The square of a difference
/// stays one, so that nothing is lost where two far places are near each other.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct QuadraticFormula {
    /// What is affine.
    pub rest: Affine,
    /// The forms that are multiplied, each once.
    pub factors: Vec<Affine>,
    /// Products of two of them, and what each is multiplied by.
    pub products: Vec<(Constant, [usize; 2])>,
}

/// The value of an operation: of first degree if there are no products.
#[derive(Clone, Debug, Default)]
struct Degree {
    rest: Affine,
    products: Vec<(Constant, [Affine; 2])>,
}

impl Expression {
    /// As a sum of products of affine forms, where no more than two are multiplied.
    pub fn quadratic(&self) -> Option<QuadraticFormula> {
        let last_uses = self.last_uses();
        let mut degrees: Vec<Degree> = Vec::with_capacity(self.ops().len());
        for (place, op) in self.ops().iter().enumerate() {
            let degree = match last_uses[place] {
                None => Degree::default(),
                Some(_) => degree_of(*op, &mut |k: usize| match last_uses[k] == Some(place) {
                    true => std::mem::take(&mut degrees[k]),
                    // Long sums are handed on, not copied.
                    false => degrees[k].clone(),
                })?,
            };
            degrees.push(degree);
        }
        degrees.pop().map(QuadraticFormula::from)
    }

    /// Derivatives by the slots of [`slots`](Self::slots), in their order, where all of them are affine.
    pub fn affine_slopes(&self) -> Option<Vec<Affine>> {
        let quadratic = self.quadratic()?;
        let slots = self.slots().into_iter();
        Some(slots.map(|slot| quadratic.slope(slot)).collect())
    }

    /// For every operation the last one that uses it; itself for the last one, `None` for what does not enter the value.
    fn last_uses(&self) -> Vec<Option<usize>> {
        let mut uses = vec![None; self.ops().len()];
        if let Some(last) = uses.len().checked_sub(1) {
            uses[last] = Some(last);
        }
        for (place, op) in self.ops().iter().enumerate().rev() {
            if uses[place].is_some() {
                for operand in operand_places(*op).into_iter().flatten() {
                    uses[operand] = uses[operand].or(Some(place));
                }
            }
        }
        uses
    }
}

impl QuadraticFormula {
    /// The derivative by a slot: (a b)' = a' b + b' a.
    fn slope(&self, slot: usize) -> Affine {
        let rate = |form: &Affine| {
            let term = form.terms.iter().find(|(s, _)| *s == slot);
            term.map_or(ZERO, |(_, c)| *c)
        };
        let rest = Affine {
            constant: rate(&self.rest),
            terms: Vec::new(),
        };
        let products = self.products.iter();
        products.fold(rest, |sum, (factor, [a, b])| {
            let [a, b] = [&self.factors[*a], &self.factors[*b]];
            match [rate(a), rate(b)] {
                [ZERO, ZERO] => sum,
                [x, y] => {
                    let slope = combine_affine(b, x, a, y);
                    combine_affine(&sum, ONE, &slope, *factor)
                }
            }
        })
    }
}

impl From<Degree> for QuadraticFormula {
    fn from(degree: Degree) -> Self {
        let mut quadratic = Self {
            rest: degree.rest,
            ..Self::default()
        };
        let factors = &mut quadratic.factors;
        // Only a neighbour is looked at: the two factors of a square.
        let mut place = |form: Affine| {
            if factors.last() != Some(&form) {
                factors.push(form);
            }
            factors.len() - 1
        };
        for (factor, [a, b]) in degree.products {
            let places = [place(a), place(b)];
            quadratic.products.push((factor, places));
        }
        quadratic
    }
}

impl Degree {
    fn is_affine(&self) -> bool {
        self.products.is_empty()
    }

    /// The number that it is.
    fn constant(&self) -> Option<Constant> {
        (self.is_affine() && self.rest.terms.is_empty()).then_some(self.rest.constant)
    }

    fn scaled(mut self, factor: Constant) -> Self {
        self.rest = combine_affine(&self.rest, factor, &Affine::default(), ZERO);
        for (c, _) in &mut self.products {
            *c = factor * *c;
        }
        self
    }

    fn plus(mut self, other: Self, factor: Constant) -> Self {
        self.rest = combine_affine(&self.rest, ONE, &other.rest, factor);
        let others = other.products.into_iter();
        self.products
            .extend(others.map(|(c, forms)| (factor * c, forms)));
        self
    }

    fn times(self, other: Self) -> Option<Self> {
        match (self.constant(), other.constant()) {
            (Some(c), _) => Some(other.scaled(c)),
            (_, Some(c)) => Some(self.scaled(c)),
            _ if self.is_affine() && other.is_affine() => Some(Self {
                rest: Affine::default(),
                products: vec![(ONE, [self.rest, other.rest])],
            }),
            _ => None,
        }
    }
}

/// The degree of an operation; `take` gives that of an operand.
fn degree_of(op: Op, take: &mut dyn FnMut(usize) -> Degree) -> Option<Degree> {
    match op {
        Op::Constant(_) | Op::Slot(_) => Some(Degree {
            rest: affine_of(op, &[])?,
            products: Vec::new(),
        }),
        Op::Negate(a) => Some(take(a).scaled(-ONE)),
        Op::Add(a, b) if a == b => Some(take(a).scaled(ONE + ONE)),
        Op::Add(a, b) => Some(take(a).plus(take(b), ONE)),
        Op::Subtract(a, b) if a == b => Some(Degree::default()),
        Op::Subtract(a, b) => Some(take(a).plus(take(b), -ONE)),
        Op::Multiply(a, b) if a == b => {
            let degree = take(a);
            degree.clone().times(degree)
        }
        Op::Multiply(a, b) => take(a).times(take(b)),
        // Functions, and what has a variable below the line or in the exponent: of numbers only, or of first degree.
        Op::Divide(..) | Op::Power(..) | Op::Call(..) => {
            let places = operand_places(op);
            let [first, second] = match places {
                [Some(a), Some(b)] if a != b => [take(a), take(b)],
                [Some(a), _] => {
                    let degree = take(a);
                    [degree.clone(), degree]
                }
                _ => return None,
            };
            match (op, second.constant()) {
                (Op::Divide(..), Some(divisor)) if !first.is_affine() => {
                    return Some(first.scaled(ONE / divisor));
                }
                (Op::Power(..), Some(exponent))
                    if exponent == ONE + ONE && first.constant().is_none() =>
                {
                    return first.clone().times(first);
                }
                _ => {}
            }
            if !first.is_affine() || !second.is_affine() {
                return None;
            }
            // Its operands stand first and second now.
            let is_first = |operand: usize| usize::from(places[0] != Some(operand));
            Some(Degree {
                rest: affine_of(op.mapped(is_first), &[first.rest, second.rest])?,
                products: Vec::new(),
            })
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]

    use super::*;
    use crate::model::expression::Function;

    fn number(value: f64) -> Op {
        Op::Constant(Constant::exact(value))
    }

    /// (x - y)^2 / 4 - 3 (x + 1) y + 2 y - 7, of slots 1 and 4.
    fn formula() -> Expression {
        Expression::new(vec![
            Op::Slot(1),
            Op::Slot(4),
            Op::Subtract(0, 1),
            number(2.0),
            Op::Power(2, 3),
            number(4.0),
            Op::Divide(4, 5),
            number(1.0),
            Op::Add(0, 7),
            number(3.0),
            Op::Multiply(9, 8),
            Op::Multiply(10, 1),
            Op::Subtract(6, 11),
            Op::Multiply(3, 1),
            Op::Add(12, 13),
            number(7.0),
            Op::Subtract(14, 15),
        ])
    }

    #[test]
    fn slopes_are_those_of_the_gradient() {
        let formula = formula();
        let slopes = formula.affine_slopes().unwrap();
        for place in [[0.0, 0.0], [0.3, -2.0], [5.0, 1.7]] {
            let slots = [9.0, place[0], 9.0, 9.0, place[1]];
            let gradient = formula.gradient(&slots);
            for (slot, slope) in formula.slots().into_iter().zip(&slopes) {
                let difference = slope.value(&slots) - gradient[slot];
                assert!(difference.abs() < 1e-14, "{slot}: {difference:e}");
            }
        }
    }

    #[test]
    fn other_degrees_have_none() {
        let [x, y] = [Op::Slot(0), Op::Slot(1)];
        let cubes = [
            vec![x, number(3.0), Op::Power(0, 1)],
            vec![x, Op::Multiply(0, 0), Op::Multiply(1, 0)],
            vec![x, number(2.0), Op::Divide(1, 0)],
            vec![x, y, Op::Power(0, 1)],
            vec![x, Op::Call(Function::Sin, 0, 0)],
        ];
        for ops in cubes {
            let formula = Expression::new(ops);
            assert_eq!(formula.affine_slopes(), None, "{formula:?}");
        }
        // What is affine has slopes that are numbers.
        let affine = Expression::new(vec![x, number(3.0), Op::Multiply(0, 1)]);
        let slopes = affine.affine_slopes().unwrap();
        assert_eq!(slopes[0].value(&[5.0]), 3.0);
    }
}
