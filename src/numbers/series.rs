//! Truncated power series in one variable: arithmetic, the functions of formulas, and drives as series of time.
//!
//! A series holds the coefficients c₀ … cₙ of Σ cₖ hᵏ, so that the k-th derivative is k! cₖ. The recurrences come from
//! the differential equations of the functions (Griewank and Walther, Evaluating Derivatives, 2nd ed., chapter 13).
//! Where a function has a kink (abs, min, max, mod, floor) the series is that of the side it is on.

use crate::math::sin_cos;
use crate::model::drive::{Drive, Ease};
use crate::model::expression::{Expression, Function, Op};
use std::ops::{Add, Mul, Neg, Sub};

/// Whole exponents up to this are products, so that they exist for negative bases and at zero, as in values.
const LARGEST_PRODUCT: f64 = 16.0;

/// Coefficients of a truncated series, at least one. Operands of an operation have the same length.
#[derive(Clone, Debug, PartialEq)]
pub struct Series(Vec<f64>);

impl Series {
    /// A number that does not change.
    pub fn constant(value: f64, order: usize) -> Self {
        let mut coefficients = vec![0.0; order + 1];
        coefficients[0] = value;
        Self(coefficients)
    }

    /// `value + rate h`.
    pub fn linear(value: f64, rate: f64, order: usize) -> Self {
        let mut series = Self::constant(value, order);
        if let Some(first) = series.0.get_mut(1) {
            *first = rate;
        }
        series
    }

    /// Highest power that is kept.
    pub fn order(&self) -> usize {
        self.0.len() - 1
    }

    /// The coefficients, from the constant on.
    pub fn coefficients(&self) -> &[f64] {
        &self.0
    }

    /// Replaces the coefficient of hᵏ, `k` up to the order.
    pub fn set(&mut self, k: usize, value: f64) {
        self.0[k] = value;
    }

    /// The k-th derivative at h = 0, `k` up to the order.
    pub fn derivative(&self, k: usize) -> f64 {
        (1..=k).fold(self.0[k], |value, j| value * j as f64)
    }

    /// The polynomial's value at `h`.
    pub fn value_at(&self, h: f64) -> f64 {
        self.0.iter().rev().fold(0.0, |sum, c| sum * h + c)
    }

    /// The same series with the powers up to `order` only.
    pub fn truncated(&self, order: usize) -> Self {
        Self(self.0[..=order.min(self.order())].to_vec())
    }

    /// Every coefficient times `factor`.
    pub fn scaled(&self, factor: f64) -> Self {
        Self(self.0.iter().map(|c| factor * c).collect())
    }

    fn shifted(&self, value: f64) -> Self {
        let mut series = self.clone();
        series.0[0] += value;
        series
    }

    fn is_constant(&self) -> bool {
        self.0[1..].iter().all(|c| *c == 0.0)
    }

    /// Σ over j in `from..=k` of `aⱼ bₖ₋ⱼ`.
    fn fold(a: &[f64], b: &[f64], from: usize, k: usize) -> f64 {
        (from..=k).map(|j| a[j] * b[k - j]).sum()
    }

    fn divided(&self, divisor: &Self) -> Self {
        let mut quotient: Vec<f64> = Vec::with_capacity(self.0.len());
        for k in 0..self.0.len() {
            let known: f64 = (0..k).map(|j| quotient[j] * divisor.0[k - j]).sum();
            quotient.push((self.0[k] - known) / divisor.0[0]);
        }
        Self(quotient)
    }

    /// Sine and cosine together: s' = c u', c' = -s u'.
    pub fn sin_cos(&self) -> (Self, Self) {
        let (sin, cos) = sin_cos(self.0[0]);
        let (mut s, mut c) = (vec![sin], vec![cos]);
        for k in 1..self.0.len() {
            let rate = |other: &[f64]| -> f64 {
                let terms = (1..=k).map(|j| j as f64 * self.0[j] * other[k - j]);
                terms.sum::<f64>() / k as f64
            };
            let (next_s, next_c) = (rate(&c), -rate(&s));
            s.push(next_s);
            c.push(next_c);
        }
        (Self(s), Self(c))
    }

    /// The series that starts at `value` and whose derivative is `self' · factor`.
    fn integrated(&self, factor: &Self, value: f64) -> Self {
        let mut result = vec![value];
        for k in 1..self.0.len() {
            let terms = (1..=k).map(|j| j as f64 * self.0[j] * factor.0[k - j]);
            result.push(terms.sum::<f64>() / k as f64);
        }
        Self(result)
    }

    fn exp(&self) -> Self {
        let mut result = vec![libm::exp(self.0[0])];
        for k in 1..self.0.len() {
            let terms = (1..=k).map(|j| j as f64 * self.0[j] * result[k - j]);
            result.push(terms.sum::<f64>() / k as f64);
        }
        Self(result)
    }

    fn reciprocal(&self) -> Self {
        Self::constant(1.0, self.order()).divided(self)
    }

    fn ln(&self) -> Self {
        self.integrated(&self.reciprocal(), libm::log(self.0[0]))
    }

    fn sqrt(&self) -> Self {
        let mut result = vec![self.0[0].sqrt()];
        for k in 1..self.0.len() {
            let known: f64 = (1..k).map(|j| result[j] * result[k - j]).sum();
            result.push((self.0[k] - known) / (2.0 * result[0]));
        }
        Self(result)
    }

    /// A constant real power, from u v' = r u' v.
    fn real_power(&self, exponent: f64) -> Self {
        let u = &self.0;
        let mut v = vec![libm::pow(u[0], exponent)];
        for k in 1..u.len() {
            let terms = (1..=k).map(|j| {
                let weight = exponent * j as f64 - (k - j) as f64;
                weight * u[j] * v[k - j]
            });
            v.push(terms.sum::<f64>() / (k as f64 * u[0]));
        }
        Self(v)
    }

    fn power(&self, exponent: &Self) -> Self {
        let e = exponent.0[0];
        if !exponent.is_constant() {
            return (&self.ln() * exponent).exp();
        }
        if e.fract() != 0.0 || e.abs() > LARGEST_PRODUCT {
            return self.real_power(e);
        }
        let one = Self::constant(1.0, self.order());
        let product = (0..e.abs() as u32).fold(one, |product, _| &product * self);
        if e < 0.0 {
            product.reciprocal()
        } else {
            product
        }
    }

    /// 1 / sqrt(1 - u²): the rate of the inverse sine.
    fn arc_rate(&self) -> Self {
        let square = self * self;
        (-&square).shifted(1.0).sqrt().reciprocal()
    }

    /// From (x y' - y x') / (x² + y²).
    fn atan2(y: &Self, x: &Self) -> Self {
        let square = (&(x * x) + &(y * y)).reciprocal();
        let angle = libm::atan2(y.0[0], x.0[0]);
        let from_y = y.integrated(&(x * &square), 0.0);
        let from_x = x.integrated(&(y * &square), 0.0);
        (&from_y - &from_x).shifted(angle)
    }

    fn call(function: Function, a: &Self, b: &Self) -> Self {
        let order = a.order();
        let negative = |s: &Self| s.0[0] < 0.0 || (s.0[0] == 0.0 && s.0.get(1) < Some(&0.0));
        match function {
            Function::Sin => a.sin_cos().0,
            Function::Cos => a.sin_cos().1,
            Function::Tan => {
                let (sin, cos) = a.sin_cos();
                sin.divided(&cos)
            }
            Function::Asin => a.integrated(&a.arc_rate(), libm::asin(a.0[0])),
            Function::Acos => a.integrated(&-&a.arc_rate(), libm::acos(a.0[0])),
            Function::Atan => Self::atan2(a, &Self::constant(1.0, order)),
            Function::Atan2 => Self::atan2(a, b),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Ln => a.ln(),
            Function::Abs if negative(a) => -a,
            Function::Abs => a.clone(),
            Function::Min if negative(&(b - a)) => b.clone(),
            Function::Max if negative(&(a - b)) => b.clone(),
            Function::Min | Function::Max => a.clone(),
            Function::Hypot => (&(a * a) + &(b * b)).sqrt(),
            Function::Mod => a - &b.scaled((a.0[0] / b.0[0]).floor()),
            Function::Floor => Self::constant(a.0[0].floor(), order),
        }
    }
}

impl Add for &Series {
    type Output = Series;
    fn add(self, other: Self) -> Series {
        Series(self.0.iter().zip(&other.0).map(|(a, b)| a + b).collect())
    }
}

impl Sub for &Series {
    type Output = Series;
    fn sub(self, other: Self) -> Series {
        Series(self.0.iter().zip(&other.0).map(|(a, b)| a - b).collect())
    }
}

impl Neg for &Series {
    type Output = Series;
    fn neg(self) -> Series {
        self.scaled(-1.0)
    }
}

impl Mul for &Series {
    type Output = Series;
    fn mul(self, other: Self) -> Series {
        let product = (0..self.0.len()).map(|k| Series::fold(&self.0, &other.0, 0, k));
        Series(product.collect())
    }
}

/// The value of a formula whose slots are series of the given order.
pub fn evaluate(expression: &Expression, slots: &[Series], order: usize) -> Series {
    let mut values: Vec<Series> = Vec::with_capacity(expression.ops().len());
    for op in expression.ops() {
        let v = &values;
        let value = match *op {
            Op::Constant(c) => Series::constant(c, order),
            Op::Slot(i) => slots[i].truncated(order),
            Op::Negate(a) => -&v[a],
            Op::Add(a, b) => &v[a] + &v[b],
            Op::Subtract(a, b) => &v[a] - &v[b],
            Op::Multiply(a, b) => &v[a] * &v[b],
            Op::Divide(a, b) => v[a].divided(&v[b]),
            Op::Power(a, b) => v[a].power(&v[b]),
            Op::Call(function, a, b) => Series::call(function, &v[a], &v[b]),
        };
        values.push(value);
    }
    values.pop().unwrap_or(Series::constant(0.0, order))
}

/// The value of a drive from `time` on, as a series of the seconds since then.
///
/// At a key it is the piece that begins there, at the last key the piece that ends there; held values have no rate.
pub fn drive(drive: &Drive, time: f64, order: usize) -> Series {
    let clock = Series::linear(time, 1.0, order);
    match drive {
        Drive::Formula(expression) => evaluate(expression, &[clock], order),
        Drive::Keys {
            times,
            values,
            ease,
        } => {
            let after = times.partition_point(|t| *t <= time);
            let at_end = after == times.len() && times.last() == Some(&time);
            let next = if at_end { after - 1 } else { after };
            if next == 0 || next == times.len() {
                return Series::constant(drive.value(time), order);
            }
            let (from, to) = (times[next - 1], times[next]);
            let s = clock.shifted(-from).scaled(1.0 / (to - from));
            let change = values[next] - values[next - 1];
            let mut value = progress(*ease, &s).scaled(change);
            value.set(0, drive.value(time));
            value
        }
    }
}

/// The polynomials of [`Ease::progress`].
fn progress(ease: Ease, s: &Series) -> Series {
    let polynomial: &[f64] = match ease {
        Ease::Linear => &[0.0, 1.0],
        Ease::Smooth => &[0.0, 0.0, 3.0, -2.0],
        Ease::Smoother => &[0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
        Ease::Step => &[0.0],
    };
    let zero = Series::constant(0.0, s.order());
    let sum = polynomial.iter().rev();
    sum.fold(zero, |sum, c| (&sum * s).shifted(*c))
}

#[cfg(test)]
mod tests {
    use super::*;

    const ORDER: usize = 8;

    /// The series of x(h), y(h) through every function, as polynomials against values of the function itself.
    #[test]
    fn series_of_all_functions_predict_their_values() {
        let x = Series(vec![0.37, 0.5, -0.3, 0.2, 0.1, 0.0, 0.3, -0.2, 0.1]);
        let y = Series(vec![0.81, -0.4, 0.2, 0.3, -0.1, 0.2, 0.0, 0.1, 0.2]);
        let two = vec![Op::Slot(0), Op::Slot(1)];
        let calls = Function::ALL.map(|f| Op::Call(f, 0, 1));
        let operators = [
            Op::Negate(0),
            Op::Add(0, 1),
            Op::Subtract(0, 1),
            Op::Multiply(0, 1),
            Op::Divide(0, 1),
            Op::Power(0, 1),
        ];
        for op in calls.into_iter().chain(operators) {
            let expression = Expression::new([two.clone(), vec![op]].concat());
            let series = evaluate(&expression, &[x.clone(), y.clone()], ORDER);
            // The error of the polynomial is h⁹ times a coefficient of order one, up to 1e3 for powers near a pole.
            for h in [0.01, -0.01] {
                let value = expression.value(&[x.value_at(h), y.value_at(h)]);
                let error = (series.value_at(h) - value).abs();
                assert!(error < 4e-15, "{op:?} at {h}: {error:e}");
            }
        }
    }

    #[test]
    fn whole_and_real_powers_are_right_at_negative_bases_and_zero() {
        let power = |exponent| {
            let ops = vec![Op::Slot(0), Op::Constant(exponent), Op::Power(0, 1)];
            Expression::new(ops)
        };
        let of = |base: f64, exponent| {
            let series = evaluate(&power(exponent), &[Series::linear(base, 1.0, 4)], 4);
            series.coefficients().to_vec()
        };
        assert_eq!(of(0.0, 3.0), [0.0, 0.0, 0.0, 1.0, 0.0]);
        assert_eq!(of(-1.0, 2.0), [1.0, -2.0, 1.0, 0.0, 0.0]);
        assert_eq!(of(1.0, 1.5), [1.0, 1.5, 0.375, -0.0625, 0.0234375]);
        assert_eq!(of(-1.0, -1.0), [-1.0, -1.0, -1.0, -1.0, -1.0]);
    }

    #[test]
    fn keyframes_are_their_polynomials() {
        for (_, ease) in Ease::NAMES {
            let keys = Drive::Keys {
                times: vec![1.0, 3.0, 4.0],
                values: vec![2.0, -1.0, 5.0],
                ease,
            };
            for (time, h) in [(0.2, 0.3), (1.0, 0.7), (2.2, -0.4), (3.0, 0.4), (4.5, 1.0)] {
                let series = drive(&keys, time, 5);
                let error = series.value_at(h) - keys.value(time + h);
                assert!(error.abs() < 1e-13, "{ease:?} {time} {error:e}");
            }
            let error = drive(&keys, 4.0, 5).value_at(-0.3) - keys.value(3.7);
            let held = ease == Ease::Step;
            assert!(error.abs() < 1e-13 || held, "{ease:?} {error:e}");
        }
    }
}
