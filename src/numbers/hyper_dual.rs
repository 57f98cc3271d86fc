//! Numbers that change along two directions at once, s and t: value, both first derivatives and the mixed second one.
//! They lie on the stack: exact mixed derivatives of many poses by many variables are made of them. [`super::series`]
//! has series of any order along one direction.

use crate::math::sin_cos;
use crate::model::expression::{Expression, Function, Op};
use std::ops::{Add, Mul, Neg, Sub};

/// Whole exponents up to this are products, as in values.
const LARGEST_PRODUCT: f64 = 16.0;

/// A number f(s, t) at s = t = 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twofold {
    /// f
    pub value: f64,
    /// ∂f/∂s
    pub first: f64,
    /// ∂f/∂t
    pub second: f64,
    /// ∂²f/∂s∂t
    pub mixed: f64,
}

impl Twofold {
    /// A number that does not change.
    pub const fn constant(value: f64) -> Self {
        Self {
            value,
            first: 0.0,
            second: 0.0,
            mixed: 0.0,
        }
    }

    /// Every part times `factor`.
    pub fn scaled(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            first: factor * self.first,
            second: factor * self.second,
            mixed: factor * self.mixed,
        }
    }

    /// A function of it, given by its value and its first two derivatives.
    fn through(self, value: f64, slope: f64, bend: f64) -> Self {
        Self {
            value,
            first: slope * self.first,
            second: slope * self.second,
            mixed: slope * self.mixed + bend * self.first * self.second,
        }
    }

    /// Sine and cosine together.
    pub fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = sin_cos(self.value);
        (self.through(sin, cos, -sin), self.through(cos, -sin, -cos))
    }

    fn reciprocal(self) -> Self {
        let r = 1.0 / self.value;
        self.through(r, -r * r, 2.0 * r * r * r)
    }

    fn sqrt(self) -> Self {
        let r = self.value.sqrt();
        self.through(r, 0.5 / r, -0.25 / (r * self.value))
    }

    fn exp(self) -> Self {
        let e = libm::exp(self.value);
        self.through(e, e, e)
    }

    fn ln(self) -> Self {
        let r = 1.0 / self.value;
        self.through(libm::log(self.value), r, -r * r)
    }

    /// Of a fixed exponent; whole ones exist for negative bases and at zero.
    fn to_the(self, exponent: f64) -> Self {
        let whole = exponent.fract() == 0.0 && exponent.abs() <= LARGEST_PRODUCT;
        let power = |e: f64| {
            if whole {
                self.value.powi(e as i32)
            } else {
                libm::pow(self.value, e)
            }
        };
        let term = |factor: f64, e: f64| {
            if factor == 0.0 {
                0.0
            } else {
                factor * power(e)
            }
        };
        self.through(
            power(exponent),
            term(exponent, exponent - 1.0),
            term(exponent * (exponent - 1.0), exponent - 2.0),
        )
    }

    fn power(self, exponent: Self) -> Self {
        let fixed = exponent == Self::constant(exponent.value);
        if fixed {
            self.to_the(exponent.value)
        } else {
            (self.ln() * exponent).exp()
        }
    }

    /// With slope 1 / sqrt(1 - u²) times `sign`.
    fn arc(self, value: f64, sign: f64) -> Self {
        let rest = 1.0 - self.value * self.value;
        let slope = sign / rest.sqrt();
        self.through(value, slope, slope * self.value / rest)
    }

    fn atan2(y: Self, x: Self) -> Self {
        let (y, x, square) = (y, x, x.value * x.value + y.value * y.value);
        let (by_y, by_x) = (x.value / square, -y.value / square);
        let (yy, xy) = (2.0 * by_y * by_x, by_x * by_x - by_y * by_y);
        let cross = y.first * x.second + x.first * y.second;
        Self {
            value: libm::atan2(y.value, x.value),
            first: by_y * y.first + by_x * x.first,
            second: by_y * y.second + by_x * x.second,
            mixed: by_y * y.mixed
                + by_x * x.mixed
                + yy * (y.first * y.second - x.first * x.second)
                + xy * cross,
        }
    }

    fn call(function: Function, a: Self, b: Self) -> Self {
        match function {
            Function::Sin => a.sin_cos().0,
            Function::Cos => a.sin_cos().1,
            Function::Tan => {
                let tan = libm::tan(a.value);
                let slope = 1.0 + tan * tan;
                a.through(tan, slope, 2.0 * tan * slope)
            }
            Function::Asin => a.arc(libm::asin(a.value), 1.0),
            Function::Acos => a.arc(libm::acos(a.value), -1.0),
            Function::Atan => Self::atan2(a, Self::constant(1.0)),
            Function::Atan2 => Self::atan2(a, b),
            Function::Sqrt => a.sqrt(),
            Function::Exp => a.exp(),
            Function::Ln => a.ln(),
            Function::Abs if a.value < 0.0 => -a,
            Function::Abs => a,
            Function::Min if b.value < a.value => b,
            Function::Max if b.value > a.value => b,
            Function::Min | Function::Max => a,
            Function::Hypot => (a * a + b * b).sqrt(),
            Function::Mod => a - b.scaled((a.value / b.value).floor()),
            Function::Floor => Self::constant(a.value.floor()),
        }
    }
}

impl Add for Twofold {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self {
            value: self.value + other.value,
            first: self.first + other.first,
            second: self.second + other.second,
            mixed: self.mixed + other.mixed,
        }
    }
}

impl Neg for Twofold {
    type Output = Self;
    fn neg(self) -> Self {
        self.scaled(-1.0)
    }
}

impl Sub for Twofold {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for Twofold {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        Self {
            value: self.value * other.value,
            first: self.value * other.first + self.first * other.value,
            second: self.value * other.second + self.second * other.value,
            mixed: self.value * other.mixed
                + self.first * other.second
                + self.second * other.first
                + self.mixed * other.value,
        }
    }
}

/// The value of a formula of twofold slots; `scratch` is reused.
pub fn evaluate(expression: &Expression, slots: &[Twofold], scratch: &mut Vec<Twofold>) -> Twofold {
    scratch.clear();
    for op in expression.ops() {
        let v = &scratch;
        let value = match *op {
            Op::Constant(c) => Twofold::constant(c),
            Op::Slot(i) => slots[i],
            Op::Negate(a) => -v[a],
            Op::Add(a, b) => v[a] + v[b],
            Op::Subtract(a, b) => v[a] - v[b],
            Op::Multiply(a, b) => v[a] * v[b],
            Op::Divide(a, b) => v[a] * v[b].reciprocal(),
            Op::Power(a, b) => v[a].power(v[b]),
            Op::Call(function, a, b) => Twofold::call(function, v[a], v[b]),
        };
        scratch.push(value);
    }
    scratch.last().copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::series as taylor;
    use crate::numbers::series::Series;

    /// Against series along s, along t and along both: the mixed derivative is what both have beyond each alone.
    #[test]
    fn all_functions_agree_with_their_series() {
        let x = Twofold {
            value: 0.37,
            first: 0.5,
            second: -0.3,
            mixed: 0.9,
        };
        let y = Twofold {
            value: 0.81,
            first: -0.4,
            second: 0.2,
            mixed: -0.7,
        };
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
            let found = evaluate(&expression, &[x, y], &mut Vec::new());
            let along = |s: f64, t: f64| {
                let series = |n: &Twofold| {
                    let mut series = Series::linear(n.value, s * n.first + t * n.second, 2);
                    series.set(2, s * t * n.mixed);
                    series
                };
                taylor::evaluate(&expression, &[series(&x), series(&y)], 2)
            };
            let [s, t, both] = [along(1.0, 0.0), along(0.0, 1.0), along(1.0, 1.0)];
            let second = |series: &Series| series.coefficients()[2];
            let wanted = Twofold {
                value: s.coefficients()[0],
                first: s.coefficients()[1],
                second: t.coefficients()[1],
                mixed: second(&both) - second(&s) - second(&t),
            };
            let parts = [
                found.value - wanted.value,
                found.first - wanted.first,
                found.second - wanted.second,
                found.mixed - wanted.mixed,
            ];
            assert!(
                parts.iter().all(|d| d.abs() < 1e-14),
                "{op:?}: {found:?} {wanted:?}"
            );
        }
    }

    #[test]
    fn whole_powers_exist_at_zero_and_below() {
        let x = |value| Twofold {
            value,
            first: 1.0,
            second: 2.0,
            mixed: 0.0,
        };
        let of = |value, e| x(value).to_the(e);
        assert_eq!(of(0.0, 2.0).mixed, 4.0);
        assert_eq!(of(0.0, 1.0).first, 1.0);
        assert_eq!(of(-2.0, 3.0).value, -8.0);
        assert_eq!(of(-2.0, 3.0).mixed, -24.0);
    }
}
