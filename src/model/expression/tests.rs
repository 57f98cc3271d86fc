//! Values and derivatives of expressions against closed forms.

use super::*;
use crate::numbers::hyper_dual::HyperDual;
use crate::numbers::interval::Interval;
use crate::numbers::series::{Series, TaylorSeries};

/// One expression per operation that has a derivative, over slots x, y.
fn table() -> Vec<Expression> {
    let call = |f| vec![Op::Slot(0), Op::Slot(1), Op::Call(f, 0, 1)];
    let mut all: Vec<Expression> = Function::ALL
        .iter()
        .filter(|f| **f != Function::Floor)
        .map(|f| Expression::new(call(*f)))
        .collect();
    for op in [
        Op::Add(0, 1),
        Op::Subtract(0, 1),
        Op::Multiply(0, 1),
        Op::Divide(0, 1),
        Op::Power(0, 1),
    ] {
        all.push(Expression::new(vec![Op::Slot(0), Op::Slot(1), op]));
    }
    all
}

#[test]
fn gradients_match_differences() {
    let at = [0.37, 0.81];
    for expression in table() {
        let mut gradient = [0.0; 2];
        expression.add_gradient(&at, 1.0, &mut gradient, &mut Vec::new(), &mut Vec::new());
        for k in 0..2 {
            let shifted = |h: f64| {
                let mut x = at;
                x[k] += h;
                expression.value(&x)
            };
            let difference = (shifted(1e-6) - shifted(-1e-6)) / 2e-6;
            assert!(
                (difference - gradient[k]).abs() < 1e-8,
                "{:?} slot {k}",
                expression.ops()
            );
        }
    }
}

#[test]
fn affine_forms_are_found_and_only_those() {
    let two_x_minus_y = Expression::new(vec![
        Op::Constant(Constant::rounded(2.0)),
        Op::Slot(0),
        Op::Multiply(0, 1),
        Op::Slot(3),
        Op::Subtract(2, 3),
    ]);
    assert_eq!(
        two_x_minus_y.affine(),
        Some(Affine {
            constant: Constant::exact(0.0),
            terms: vec![(0, Constant::exact(2.0)), (3, Constant::exact(-1.0))]
        })
    );
    let product = Expression::new(vec![Op::Slot(0), Op::Slot(1), Op::Multiply(0, 1)]);
    assert_eq!(product.affine(), None);
}

/// Every operation of two slots: all functions, all operators.
fn all_operations() -> Vec<Expression> {
    let calls = Function::ALL.map(|f| Op::Call(f, 0, 1));
    let operators = [
        Op::Negate(0),
        Op::Add(0, 1),
        Op::Subtract(0, 1),
        Op::Multiply(0, 1),
        Op::Multiply(0, 0),
        Op::Divide(0, 1),
        Op::Power(0, 1),
    ];
    let all = calls.into_iter().chain(operators);
    all.map(|op| Expression::new(vec![Op::Slot(0), Op::Slot(1), op]))
        .collect()
}

/// The series of x(h), y(h) through every function, as polynomials against values of the function itself.
#[test]
fn series_of_all_functions_predict_their_values() {
    let x = TaylorSeries::from([0.37, 0.5, -0.3, 0.2, 0.1, 0.0, 0.3, -0.2, 0.1]);
    let y = TaylorSeries::from([0.81, -0.4, 0.2, 0.3, -0.1, 0.2, 0.0, 0.1, 0.2]);
    for expression in all_operations() {
        let series = expression.value(&[x, y]);
        // The error of the polynomial is h⁹ times a coefficient of order one, up to 1e3 for powers near a pole.
        for h in [0.01, -0.01] {
            let value = expression.value(&[x.value_at(h), y.value_at(h)]);
            let error = (series.value_at(h) - value).abs();
            assert!(error < 4e-15, "{expression:?} at {h}: {error:e}");
        }
    }
}

#[test]
fn whole_and_real_powers_are_right_at_negative_bases_and_zero() {
    let of = |base: f64, exponent| {
        let ops = vec![
            Op::Slot(0),
            Op::Constant(Constant::rounded(exponent)),
            Op::Power(0, 1),
        ];
        let series = Expression::new(ops).value(&[TaylorSeries::linear(base, 1.0, 4)]);
        series.coefficients()[..5].to_vec()
    };
    assert_eq!(of(0.0, 3.0), [0.0, 0.0, 0.0, 1.0, 0.0]);
    assert_eq!(of(-1.0, 2.0), [1.0, -2.0, 1.0, 0.0, 0.0]);
    assert_eq!(of(1.0, 1.5), [1.0, 1.5, 0.375, -0.0625, 0.0234375]);
    assert_eq!(of(-1.0, -1.0), [-1.0, -1.0, -1.0, -1.0, -1.0]);
}

/// Against series along s, along t and along both: the mixed derivative is what both have beyond each alone.
#[test]
fn hyper_dual_numbers_agree_with_series() {
    let [x, y] =
        [(0.37, 0.5, -0.3, 0.9), (0.81, -0.4, 0.2, -0.7)].map(|(value, first, second, mixed)| {
            HyperDual {
                value,
                first,
                second,
                mixed,
            }
        });
    for expression in all_operations() {
        let found = expression.value(&[x, y]);
        let along = |s: f64, t: f64| {
            let series = |n: &HyperDual| {
                let mut series = TaylorSeries::linear(n.value, s * n.first + t * n.second, 2);
                series.set(2, s * t * n.mixed);
                series
            };
            *expression.value(&[series(&x), series(&y)]).coefficients()
        };
        let [s, t, both] = [along(1.0, 0.0), along(0.0, 1.0), along(1.0, 1.0)];
        let parts = [
            found.value - s[0],
            found.first - s[1],
            found.second - t[1],
            found.mixed - (both[2] - s[2] - t[2]),
        ];
        let right = parts.iter().all(|d| d.abs() < 1e-14);
        assert!(right, "{expression:?}: {found:?} {parts:?}");
    }
}

/// The one gradient over every kind of number against the derivatives that the kind itself carries.
#[test]
fn gradients_of_all_kinds_of_numbers_agree() {
    let (x, y) = (0.37, 0.81);
    for expression in all_operations() {
        let plain = expression.gradient(&[x, y]);
        let enclosed = expression.gradient(&[x, y].map(Interval::point));
        let still = [x, y].map(|v| Series::<Interval, 3>::constant(Interval::point(v)));
        let series = expression.gradient(&still);
        for slot in 0..2 {
            let mut moving = [x, y].map(HyperDual::constant);
            moving[slot].first = 1.0;
            let carried = expression.value(&moving).first;
            assert!((plain[slot] - carried).abs() < 1e-14, "{expression:?}");
            assert!(enclosed[slot].distance(carried) < 1e-14, "{expression:?}");
            let [value, ..] = *series[slot].coefficients();
            assert!(value.distance(carried) < 1e-14, "{expression:?}");
        }
    }
}
