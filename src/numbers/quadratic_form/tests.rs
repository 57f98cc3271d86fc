//! Forms of second order against the functions that they enclose.

use super::*;
use crate::numbers::form_sum::SummedForm;
use crate::numbers::scalar::{Ring, Scalar};

type Form<'r> = QuadraticForm<'r>;

fn random(state: &mut u64) -> f64 {
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
}

fn at(form: &Form, [p, q]: [f64; 2]) -> f64 {
    let [s, t] = [0, 1].map(|k| form.line.slope(k));
    let [a, b, c] = [(0, 0), (0, 1), (1, 1)].map(|(k, l)| form.bend_of(k, l));
    form.line.value + s * p + t * q + a * p * p + b * p * q + c * q * q
}

fn moving(room: &FormRoom, value: f64, slopes: [f64; 2]) -> Form<'_> {
    AffineForm::linear(room, value, &slopes, 0.0).into()
}

#[test]
fn forms_hold_what_they_enclose() {
    let (mut state, room) = (0x51_ced2, FormRoom::new(2));
    for _ in 0..2000 {
        let mut next = || random(&mut state);
        let (x, y) = (0.8 + 0.2 * next(), 0.9 + 0.2 * next());
        let (s, t) = ([0.1 * next(), 0.1 * next()], [0.1 * next(), 0.1 * next()]);
        let (a, b) = (moving(&room, x, s), moving(&room, y, t));
        let d = [next(), next()];
        let (p, q) = (x + s[0] * d[0] + s[1] * d[1], y + t[0] * d[0] + t[1] * d[1]);
        let holds = |form: Form, value: f64| {
            let off = (at(&form, d) - value).abs();
            assert!(off <= form.line.error + 8e-16, "{form:?} at {d:?}: {value}");
            let line = form.affine();
            let far = (line.value + line.slope(0) * d[0] + line.slope(1) * d[1] - value).abs();
            assert!(far <= line.error + 8e-16);
        };
        let (c, r) = (a * b, p * q);
        holds(a + b, p + q);
        holds(a - b, p - q);
        holds(c, r);
        holds(c * a, r * p);
        holds(c * c - a, r * r - p);
        holds(c.scale(-1.7), -1.7 * r);
        holds(a / b, p / q);
        holds(c.sin(), libm::sin(r));
        holds(c.cos(), libm::cos(r));
        holds(c.sqrt(), r.sqrt());
        holds(a.atan2(b), libm::atan2(p, q));
        let (e, f) = (c - Form::number(0.6), r - 0.6);
        holds(e.abs(), f.abs());
        holds(c.max(a), r.max(p));
        holds(c.min(a), r.min(p));
        holds(e.choose(a, b), if f < 0.0 { p } else { q });
        let mut sum = a;
        sum.add_scaled(-0.3, &c);
        holds(sum, p - 0.3 * r);
        let more = Form::sum_of_products([(&Form::number(1.0), &sum), (&c, &b)].into_iter());
        holds(more, p - 0.3 * r + r * q);
        let terms = [(1.5, &a), (0.0, &b), (-0.3, &c), (2.0, &Form::ZERO)];
        let sum = Form::combination(-1.0, terms.into_iter());
        holds(sum, -1.0 + 1.5 * p - 0.3 * r);
    }
}

#[test]
fn errors_of_products_and_sines_are_of_third_order() {
    let room = FormRoom::new(2);
    let of = |t: f64| {
        let (a, b) = (moving(&room, 0.7, [t, 0.0]), moving(&room, 0.4, [t, -t]));
        [(a * b) * (a * a), (a * b).sin(), (a * b).cos()].map(|f| f.line.error)
    };
    for (wide, narrow) in of(1e-2).into_iter().zip(of(1e-3)) {
        assert!(
            (900.0..1100.0).contains(&(wide / narrow)),
            "{wide} {narrow}"
        );
    }
}

#[test]
fn nothing_is_made_up() {
    let room = FormRoom::new(2);
    let around_zero = moving(&room, 0.0, [1.0, 0.0]);
    for none in [
        Form::number(1.0) / around_zero,
        around_zero.ln(),
        Form::undefined() * Form::ZERO,
        Form::undefined() + Form::number(1.0),
        Form::combination(1.0, [(0.0, &Form::undefined())].into_iter()),
        Form::undefined().sin(),
    ] {
        assert!(!none.is_finite(), "{none:?}");
    }
    assert_eq!(Form::ZERO * around_zero, Form::ZERO);
}
