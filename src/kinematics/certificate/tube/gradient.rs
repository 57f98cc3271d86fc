//! Derivatives of formulas over a stretch: by their variables as series, and bounds in a ball around the path.

use super::series::Series;
use crate::model::expression::{Expression, Function, Op};
use crate::numbers::interval::Interval;

/// Derivatives of `expression` by each of its slots, by reverse accumulation.
pub fn gradient(expression: &Expression, slots: &[Series]) -> Vec<Series> {
    let mut gradient = vec![Series::ZERO; slots.len()];
    let values = Series::all(expression, slots);
    let mut adjoints = vec![Series::ZERO; values.len()];
    if let Some(last) = adjoints.last_mut() {
        *last = number(1.0);
    }
    for (i, op) in expression.ops().iter().enumerate().rev() {
        let adjoint = adjoints[i];
        if adjoint == Series::ZERO {
            continue;
        }
        let mut pass = |operand: usize, partial: Series| {
            adjoints[operand] = adjoints[operand] + adjoint * partial;
        };
        let v = &values;
        match *op {
            Op::Constant(_) => {}
            Op::Slot(slot) => gradient[slot] = gradient[slot] + adjoint,
            Op::Negate(a) => pass(a, number(-1.0)),
            Op::Add(a, b) => {
                pass(a, number(1.0));
                pass(b, number(1.0));
            }
            Op::Subtract(a, b) => {
                pass(a, number(1.0));
                pass(b, number(-1.0));
            }
            Op::Multiply(a, b) => {
                pass(a, v[b]);
                pass(b, v[a]);
            }
            Op::Divide(a, b) => {
                pass(a, number(1.0).divided(&v[b]));
                pass(b, -v[i].divided(&v[b]));
            }
            Op::Power(a, b) => {
                // A whole exponent stays one number, or a negative base would have no power.
                let less = match expression.ops()[b] {
                    Op::Constant(e) if e.fract() == 0.0 && (e - 1.0) + 1.0 == e => number(e - 1.0),
                    _ => v[b] - number(1.0),
                };
                pass(a, v[b] * v[a].power(&less));
                if !matches!(expression.ops()[b], Op::Constant(_)) {
                    pass(b, v[i] * v[a].ln());
                }
            }
            Op::Call(f, a, b) => {
                let [by_a, by_b] = partials(f, &v[a], &v[b], &v[i]);
                pass(a, by_a);
                if f.accepts(2) {
                    pass(b, by_b);
                }
            }
        }
    }
    gradient
}

fn number(value: f64) -> Series {
    Series::constant(Interval::point(value))
}

/// Derivatives of `r = f(a, b)`.
fn partials(f: Function, a: &Series, b: &Series, r: &Series) -> [Series; 2] {
    let one = number(1.0);
    let alone = |by_a: Series| [by_a, Series::ZERO];
    let over_root = || one.divided(&(one - a.square()).sqrt());
    match f {
        Function::Sin => alone(a.sin_cos().1),
        Function::Cos => alone(-a.sin_cos().0),
        Function::Tan => alone(one + r.square()),
        Function::Asin => alone(over_root()),
        Function::Acos => alone(-over_root()),
        Function::Atan => alone(one.divided(&(one + a.square()))),
        Function::Atan2 => {
            let square = a.square() + b.square();
            [b.divided(&square), -a.divided(&square)]
        }
        Function::Sqrt => alone(number(0.5).divided(r)),
        Function::Exp => alone(*r),
        Function::Ln => alone(one.divided(a)),
        Function::Abs => alone(a.choose(&one, &-one)),
        Function::Min => {
            let difference = *b - *a;
            [
                difference.choose(&one, &Series::ZERO),
                difference.choose(&Series::ZERO, &one),
            ]
        }
        Function::Max => {
            let difference = *a - *b;
            [
                difference.choose(&one, &Series::ZERO),
                difference.choose(&Series::ZERO, &one),
            ]
        }
        Function::Hypot => [a.divided(r), b.divided(r)],
        Function::Mod => [one, -a.divided(b).floor()],
        Function::Floor => alone(Series::ZERO),
    }
}

/// Bounds of the first and second derivative of a formula in any direction whose entries are at most `rates`,
/// anywhere in the box `place`.
///
/// The second bounds the bilinear form for two such directions: by polarisation that is at most twice its value for two
/// equal ones.
pub fn bounds(expression: &Expression, place: &[Interval], rates: &[f64]) -> [f64; 2] {
    let slots: Vec<Series> = place
        .iter()
        .zip(rates)
        .map(|(x, rate)| {
            let mut line = Series::constant(*x);
            line.0[1] = Interval::around_zero(*rate);
            line
        })
        .collect();
    let value = Series::of(expression, &slots);
    [value.0[1].magnitude(), 4.0 * value.0[2].magnitude()]
}

#[cfg(test)]
mod tests {
    use super::*;

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
            let ops = vec![Op::Slot(0), Op::Constant(exponent), Op::Power(0, 1)];
            let base = Series::constant(Interval::point(-0.7));
            let found = gradient(&Expression::new(ops), &[base]);
            assert!(
                found[0].0[0].distance(exact) < 1e-14,
                "{exponent}: {found:?}"
            );
        }
    }

    #[test]
    fn derivatives_and_their_bounds_match_those_of_f64() {
        let (x, y) = (0.41, 0.73);
        for expression in formulas() {
            let series = [x, y].map(|v| Series::constant(Interval::point(v)));
            let found = gradient(&expression, &series);
            let mut exact = [0.0; 2];
            expression.add_gradient(&[x, y], 1.0, &mut exact, &mut Vec::new(), &mut Vec::new());
            for (found, exact) in found.iter().zip(exact) {
                let off = found.0[0].distance(exact);
                assert!(off < 1e-14, "{expression:?}: {exact} {found:?}");
            }
            // The bounds in a small box hold differences of gradients inside.
            let (box_size, rates) = (1e-3, [1.0, 0.5]);
            let place = [x, y].map(|v| Interval::point(v) + Interval::around_zero(box_size));
            let [first, second] = bounds(&expression, &place, &rates);
            let mut beside = [0.0; 2];
            let there = [x + box_size, y - 0.5 * box_size];
            expression.add_gradient(&there, 1.0, &mut beside, &mut Vec::new(), &mut Vec::new());
            let slope = |g: [f64; 2]| g[0].abs() * rates[0] + g[1].abs() * rates[1];
            assert!(slope(exact) <= first * (1.0 + 1e-12), "{expression:?}");
            let change = [beside[0] - exact[0], beside[1] - exact[1]];
            assert!(
                slope(change) <= second * box_size * (1.0 + 1e-9) + 1e-15,
                "{expression:?}: {change:?} {second}"
            );
        }
    }
}
