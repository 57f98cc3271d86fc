//! Formulas of second degree, such as the distance of two points: their derivatives are affine, and bend nowhere.

use super::{Affine, Expression, ONE, Op, ZERO, affine_of, combine_affine, operand_places};
use crate::numbers::constant::Constant;

/// What is known of an operation's value.
#[derive(Clone, Debug)]
enum Degree {
    /// At most one.
    Affine(Affine),
    /// Two: the derivatives by the slots that stand in it, ascending.
    Quadratic(Vec<(usize, Affine)>),
}

impl Expression {
    /// Derivatives by the slots of [`slots`](Self::slots), in their order, where all of them are affine.
    pub fn affine_slopes(&self) -> Option<Vec<Affine>> {
        let mut degrees: Vec<Degree> = Vec::with_capacity(self.ops().len());
        for op in self.ops() {
            degrees.push(degree_of(*op, &degrees)?);
        }
        let slopes = slopes_of(degrees.last()?);
        let find = |slot: usize| slopes.iter().find(|(s, _)| *s == slot);
        let slots = self.slots().into_iter();
        let all = slots.map(|slot| find(slot).map_or_else(Affine::default, |(_, a)| a.clone()));
        Some(all.collect())
    }
}

fn degree_of(op: Op, degrees: &[Degree]) -> Option<Degree> {
    let affine = |k: usize| match &degrees[k] {
        Degree::Affine(affine) => Some(affine),
        Degree::Quadratic(_) => None,
    };
    let constant = |k: usize| affine(k).filter(|a| a.terms.is_empty()).map(|a| a.constant);
    let combined = |parts: &[(usize, Constant)]| Degree::Quadratic(combine_slopes(degrees, parts));
    // What is affine stays so.
    let operands: Vec<usize> = operand_places(op).into_iter().flatten().collect();
    let forms: Option<Vec<Affine>> = operands.iter().map(|k| affine(*k).cloned()).collect();
    let place = |operand: usize| usize::from(operands.first() != Some(&operand));
    let form = forms.and_then(|forms| affine_of(op.mapped(place), &forms));
    if let Some(form) = form {
        return Some(Degree::Affine(form));
    }
    match op {
        Op::Negate(a) => Some(combined(&[(a, -ONE)])),
        Op::Add(a, b) => Some(combined(&[(a, ONE), (b, ONE)])),
        Op::Subtract(a, b) => Some(combined(&[(a, ONE), (b, -ONE)])),
        Op::Divide(a, b) => Some(combined(&[(a, ONE / constant(b)?)])),
        Op::Power(a, b) if constant(b)? == Constant::exact(2.0) => {
            Some(product_of(affine(a)?, affine(a)?))
        }
        Op::Multiply(a, b) => match (constant(a), constant(b)) {
            (Some(c), _) => Some(combined(&[(b, c)])),
            (_, Some(c)) => Some(combined(&[(a, c)])),
            _ => Some(product_of(affine(a)?, affine(b)?)),
        },
        _ => None,
    }
}

/// (a b)' = a' b + b' a
fn product_of(a: &Affine, b: &Affine) -> Degree {
    let mut slots: Vec<usize> = a.terms.iter().chain(&b.terms).map(|(s, _)| *s).collect();
    slots.sort_unstable();
    slots.dedup();
    let slope = |form: &Affine, slot: usize| {
        let term = form.terms.iter().find(|(s, _)| *s == slot);
        term.map_or(ZERO, |(_, c)| *c)
    };
    let slopes = slots.into_iter().map(|slot| {
        let sum = combine_affine(b, slope(a, slot), a, slope(b, slot));
        (slot, sum)
    });
    Degree::Quadratic(slopes.collect())
}

/// Derivatives of a sum of multiples.
fn combine_slopes(degrees: &[Degree], parts: &[(usize, Constant)]) -> Vec<(usize, Affine)> {
    let mut sum: Vec<(usize, Affine)> = Vec::new();
    for (operand, factor) in parts {
        for (slot, slope) in slopes_of(&degrees[*operand]) {
            let place = sum.partition_point(|(s, _)| *s < slot);
            if sum.get(place).is_none_or(|(s, _)| *s != slot) {
                sum.insert(place, (slot, Affine::default()));
            }
            sum[place].1 = combine_affine(&sum[place].1, ONE, &slope, *factor);
        }
    }
    sum
}

fn slopes_of(degree: &Degree) -> Vec<(usize, Affine)> {
    match degree {
        Degree::Quadratic(slopes) => slopes.clone(),
        Degree::Affine(affine) => {
            let number = |constant: Constant| Affine {
                constant,
                terms: Vec::new(),
            };
            let terms = affine.terms.iter();
            terms.map(|(slot, c)| (*slot, number(*c))).collect()
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
