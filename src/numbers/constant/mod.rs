//! Constants of a scene: about 31 digits, and a bound on their difference from the number as written.
//!
//! `1000.3 - 960.2` is 40.1 to 31 digits here, while f64 gives 40.09999999999991. Computations use the nearest f64;
//! proofs add its difference from the number as written ([`Constant::open`]). Decimals are read digit by digit, so that
//! a number is exact only if f64, or the sum of two, can represent it.

mod decimal;
mod functions;

use super::double_double::DoubleDouble;
use super::rounding::{GROW, LONG_OPERATION, SMALLEST, of_decimal};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// What remains of the leading part of a number if the other part has the opposite sign: that is less than a unit in its last
/// place.
const LEADING: f64 = 1.0 - 1e-15;

/// A constant.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Constant {
    value: DoubleDouble,
    error: f64,
}

impl Constant {
    /// π.
    pub const PI: Self = Self {
        value: DoubleDouble {
            hi: std::f64::consts::PI,
            lo: 1.224_646_799_147_353_2e-16,
        },
        error: 3e-33,
    };

    /// Exactly this number.
    pub const fn exact(value: f64) -> Self {
        Self {
            value: DoubleDouble { hi: value, lo: 0.0 },
            error: 0.0,
        }
    }

    /// A number that was rounded to f64 before its digits could be read: whole numbers are exact, others are known to
    /// one unit in the last place.
    pub const fn rounded(value: f64) -> Self {
        Self {
            value: DoubleDouble { hi: value, lo: 0.0 },
            error: of_decimal(value),
        }
    }

    /// A number that differs from `value` by at most `error`.
    pub fn within(value: f64, error: f64) -> Self {
        Self::near(DoubleDouble::from(value), error)
    }

    /// The same for a sum of two. If the second part of the sum overflows, only the first is kept.
    fn near(value: DoubleDouble, error: f64) -> Self {
        if value.lo.is_finite() {
            return Self { value, error };
        }
        let hi = value.hi;
        Self {
            value: DoubleDouble::from(hi),
            error: error + of_decimal(hi) + SMALLEST,
        }
    }

    /// The nearest f64, used in computations.
    #[inline]
    pub const fn number(self) -> f64 {
        self.value.hi
    }

    /// All digits.
    #[inline]
    pub const fn value(self) -> DoubleDouble {
        self.value
    }

    /// Bound on the difference between the digits and the number as written.
    #[inline]
    pub const fn error(self) -> f64 {
        self.error
    }

    /// Bound on the difference between [`number`](Self::number) and the number as written.
    #[inline]
    pub fn open(self) -> f64 {
        (self.value.lo.abs() + self.error) * GROW
    }

    /// Whether f64 represents the number as written.
    pub fn is_exact(self) -> bool {
        self.value.lo == 0.0 && self.error == 0.0
    }

    /// The angle as quarter turns, if it is a whole number of them to all its digits.
    pub fn quarter_turns(self) -> Option<i64> {
        /// More turns than a scene has; the error stays far below one.
        const MOST: f64 = 1e9;
        /// The error of an angle that is known to far more digits than an f64 has.
        const QUARTER_KNOWN: f64 = 1e-18;
        let quarters = self / (Self::PI / Self::exact(2.0));
        let whole = quarters.number().round();
        let off = quarters - Self::exact(whole);
        let is_whole = off.number().abs() <= off.error() && whole.abs() < MOST;
        (is_whole && off.error() < QUARTER_KNOWN).then_some(whole as i64)
    }

    /// Bound on its magnitude, including its error.
    pub fn largest(self) -> f64 {
        (self.value.hi.abs() + self.error) * GROW
    }

    /// A bound of errors, increased by its own rounding; exact operations keep their zero.
    fn with_error(value: DoubleDouble, error: f64) -> Self {
        Self::near(value, error * GROW)
    }
}

impl Add for Constant {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let is_short = self.value.lo == 0.0 && b.value.lo == 0.0;
        let (x, y) = (self.value.hi.abs(), b.value.hi.abs());
        let rounding = match is_short || x == 0.0 || y == 0.0 {
            true => 0.0,
            false => LONG_OPERATION * (x + y),
        };
        Self::with_error(self.value + b.value, self.error + b.error + rounding)
    }
}

impl Neg for Constant {
    type Output = Self;
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            error: self.error,
        }
    }
}

impl Sub for Constant {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

/// The error is the rounding of a product, or quotient, of two f64 in `value`: none if both are short and far from
/// underflow.
fn rounding_of(value: DoubleDouble, is_short: bool) -> f64 {
    /// Products above this keep all digits of their second part.
    const FAR_FROM_SMALLEST: f64 = 1e-280;
    let size = value.hi.abs();
    if is_short && size > FAR_FROM_SMALLEST {
        0.0
    } else {
        LONG_OPERATION * size + SMALLEST
    }
}

impl Mul for Constant {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        let value = self.value * b.value;
        let is_zero = |c: Self| c.value.hi == 0.0 && c.error == 0.0;
        if is_zero(self) || is_zero(b) {
            return Self::exact(value.hi);
        }
        let is_short = self.value.lo == 0.0 && b.value.lo == 0.0;
        let error = self.largest() * b.error + b.largest() * self.error;
        Self::with_error(value, error + rounding_of(value, is_short))
    }
}

impl Div for Constant {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let least = b.value.hi.abs() * LEADING - b.error;
        if least.is_nan() || least <= 0.0 {
            return Self::exact(f64::NAN);
        }
        let value = self.value.over(b.value);
        // A quotient of f64 that multiplies back to its dividend is exact.
        let back = DoubleDouble::product(value.hi, b.value.hi);
        let is_short =
            [self.value.lo, b.value.lo, value.lo, back.lo] == [0.0; 4] && back.hi == self.value.hi;
        let error = (self.error + value.hi.abs() * b.error) / least;
        let rounding = if value.hi == 0.0 && is_short {
            0.0
        } else {
            rounding_of(value, is_short)
        };
        Self::with_error(value, error + rounding)
    }
}

#[cfg(test)]
mod tests;
