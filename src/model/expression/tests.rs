//! Values and derivatives of expressions against closed forms.

use super::*;

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
        Op::Constant(2.0),
        Op::Slot(0),
        Op::Multiply(0, 1),
        Op::Slot(3),
        Op::Subtract(2, 3),
    ]);
    assert_eq!(
        two_x_minus_y.affine(),
        Some(Affine {
            constant: 0.0,
            terms: vec![(0, 2.0), (3, -1.0)]
        })
    );
    let product = Expression::new(vec![Op::Slot(0), Op::Slot(1), Op::Multiply(0, 1)]);
    assert_eq!(product.affine(), None);
}
