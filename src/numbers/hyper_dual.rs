//! Hyper-dual numbers, with derivatives in two directions s and t: value, both first derivatives and the mixed second
//! one. They are on the stack; exact mixed derivatives of many poses by many variables are computed with them.
//! [`super::series`] has series of any order in one direction.

use super::scalar::{Ring, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number f(s, t) at s = t = 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct HyperDual {
    /// f
    pub value: f64,
    /// ∂f/∂s
    pub first: f64,
    /// ∂f/∂t
    pub second: f64,
    /// ∂²f/∂s∂t
    pub mixed: f64,
}

impl HyperDual {
    /// A constant.
    pub const fn constant(value: f64) -> Self {
        Self {
            value,
            first: 0.0,
            second: 0.0,
            mixed: 0.0,
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

    /// With slope 1 / sqrt(1 - u²) times `sign`.
    fn arc(self, value: f64, sign: f64) -> Self {
        let rest = 1.0 - self.value * self.value;
        let slope = sign / rest.sqrt();
        self.through(value, slope, slope * self.value / rest)
    }
}

impl Ring for HyperDual {
    fn number(value: f64) -> Self {
        Self::constant(value)
    }

    fn scale(self, factor: f64) -> Self {
        Self {
            value: factor * self.value,
            first: factor * self.first,
            second: factor * self.second,
            mixed: factor * self.mixed,
        }
    }
}

impl Scalar for HyperDual {
    fn may_lack_value(self) -> bool {
        self.value.is_nan()
    }

    fn over(self, divisor: Self) -> Self {
        match divisor.value == 0.0 {
            true => Self::undefined(),
            false => self / divisor,
        }
    }

    fn undefined() -> Self {
        let value = f64::NAN;
        Self {
            value,
            first: value,
            second: value,
            mixed: value,
        }
    }

    fn is_finite(self) -> bool {
        let parts = [self.value, self.first, self.second, self.mixed];
        parts.iter().all(|v| v.is_finite())
    }

    fn as_number(self) -> Option<f64> {
        (self == Self::constant(self.value)).then_some(self.value)
    }

    fn nominal(self) -> f64 {
        self.value
    }

    fn first_order(self, value: f64) -> Self {
        Self {
            value,
            mixed: f64::NAN,
            ..self
        }
    }

    fn is_below_zero(self) -> Option<bool> {
        self.value.is_below_zero()
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = Scalar::sin_cos(self.value);
        (self.through(sin, cos, -sin), self.through(cos, -sin, -cos))
    }

    fn tan(self) -> Self {
        let tan = Scalar::tan(self.value);
        let slope = 1.0 + tan * tan;
        self.through(tan, slope, 2.0 * tan * slope)
    }

    fn exp(self) -> Self {
        let e = Scalar::exp(self.value);
        self.through(e, e, e)
    }

    fn ln(self) -> Self {
        let r = 1.0 / self.value;
        self.through(Scalar::ln(self.value), r, -r * r)
    }

    fn sqrt(self) -> Self {
        let r = self.value.sqrt();
        self.through(r, 0.5 / r, -0.25 / (r * self.value))
    }

    fn asin(self) -> Self {
        self.arc(Scalar::asin(self.value), 1.0)
    }

    fn acos(self) -> Self {
        self.arc(Scalar::acos(self.value), -1.0)
    }

    fn atan(self) -> Self {
        let slope = 1.0 / (1.0 + self.value * self.value);
        let bend = -2.0 * self.value * slope * slope;
        self.through(Scalar::atan(self.value), slope, bend)
    }

    fn atan2(self, x: Self) -> Self {
        let (y, square) = (self, x.value * x.value + self.value * self.value);
        // Gradient and second derivatives of atan2(y, x), for the chain rule of second order.
        let (by_y, by_x) = (x.value / square, -y.value / square);
        let (yy, xy) = (2.0 * by_y * by_x, by_x * by_x - by_y * by_y);
        let cross = y.first * x.second + x.first * y.second;
        Self {
            value: Scalar::atan2(y.value, x.value),
            first: by_y * y.first + by_x * x.first,
            second: by_y * y.second + by_x * x.second,
            mixed: by_y * y.mixed
                + by_x * x.mixed
                + yy * (y.first * y.second - x.first * x.second)
                + xy * cross,
        }
    }

    fn floor(self) -> Self {
        Self::constant(self.value.floor())
    }

    fn real_power(self, exponent: f64) -> Self {
        let power = |e: f64| self.value.power(e);
        self.through(
            power(exponent),
            exponent * power(exponent - 1.0),
            exponent * (exponent - 1.0) * power(exponent - 2.0),
        )
    }
}

impl Div for HyperDual {
    type Output = Self;
    /// The quotient q from q b = a, part by part.
    fn div(self, b: Self) -> Self {
        let value = self.value / b.value;
        let first = (self.first - value * b.first) / b.value;
        let second = (self.second - value * b.second) / b.value;
        // The mixed part of q b = a, solved for that of q.
        let known = value * b.mixed + first * b.second + second * b.first;
        Self {
            value,
            first,
            second,
            mixed: (self.mixed - known) / b.value,
        }
    }
}

impl Add for HyperDual {
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

impl Neg for HyperDual {
    type Output = Self;
    fn neg(self) -> Self {
        self.scale(-1.0)
    }
}

impl Sub for HyperDual {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Mul for HyperDual {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_powers_exist_at_zero_and_below() {
        let x = |value| HyperDual {
            value,
            first: 1.0,
            second: 2.0,
            mixed: 0.0,
        };
        let of = |value, e| x(value).power(HyperDual::constant(e));
        assert_eq!(of(0.0, 2.0).mixed, 4.0);
        assert_eq!(of(0.0, 1.0).first, 1.0);
        assert_eq!(of(-2.0, 3.0).value, -8.0);
        assert_eq!(of(-2.0, 3.0).mixed, -24.0);
    }

    #[test]
    fn quotients_undo_products() {
        let [x, y] = [0.7, -1.3].map(|value| HyperDual {
            value,
            first: 0.5,
            second: -0.25,
            mixed: 2.0,
        });
        let rest = (x / y) * y - x;
        let parts = [rest.value, rest.first, rest.second, rest.mixed];
        assert!(parts.iter().all(|v| v.abs() < 1e-15), "{rest:?}");
    }
}
