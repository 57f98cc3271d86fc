//! Constants of a scene: about 31 digits, and how far these may be from the number that was meant.
//!
//! `1000.3 - 960.2` is 40.1 to 31 digits here, where f64 has 40.09999999999991. What is computed with is the nearest
//! f64; proofs add how far that is from the number meant ([`Constant::open`]). Decimals are read digit by digit, so that a
//! number is exact only if f64, or the sum of two, has all of its digits.

mod decimal;
mod functions;

use super::double_double::DoubleDouble;
use super::rounding::{GROW, LONG_OPERATION, SMALLEST, of_decimal};
use std::ops::{Add, Div, Mul, Neg, Sub};

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

    /// A number that was rounded to f64 before anybody could look at its digits: whole numbers are exact, others are known
    /// to one unit in the last place.
    pub const fn rounded(value: f64) -> Self {
        Self {
            value: DoubleDouble { hi: value, lo: 0.0 },
            error: of_decimal(value),
        }
    }

    /// A number that is no farther from `value` than `error`.
    pub fn within(value: f64, error: f64) -> Self {
        Self::near(DoubleDouble::from(value), error)
    }

    /// The same of a sum of two. Where the second part of the sum overflows, the first is all that
    /// is kept.
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

    /// The nearest f64, which is computed with.
    #[inline]
    pub const fn number(self) -> f64 {
        self.value.hi
    }

    /// All digits.
    #[inline]
    pub const fn value(self) -> DoubleDouble {
        self.value
    }

    /// How far the digits may be from the number meant.
    #[inline]
    pub const fn error(self) -> f64 {
        self.error
    }

    /// How far [`number`](Self::number) may be from the number meant.
    #[inline]
    pub fn open(self) -> f64 {
        (self.value.lo.abs() + self.error) * GROW
    }

    /// Whether f64 has the number meant.
    pub fn is_exact(self) -> bool {
        self.value.lo == 0.0 && self.error == 0.0
    }

    /// The angle as quarter turns, if it is a whole number of them to all its digits.
    pub fn quarter_turns(self) -> Option<i64> {
        /// More turns than a scene has; the error stays far below one.
        const MOST: f64 = 1e9;
        let quarters = self / (Self::PI / Self::exact(2.0));
        let whole = quarters.number().round();
        let off = quarters - Self::exact(whole);
        let is_whole = off.number().abs() <= off.error() && whole.abs() < MOST;
        (is_whole && off.error() < 1e-18).then_some(whole as i64)
    }

    /// Its size at most, with its error.
    pub fn largest(self) -> f64 {
        (self.value.hi.abs() + self.error) * GROW
    }

    /// A bound of errors, grown by what the sum itself rounds; exact operations keep their zero.
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

/// The error is what the product, or quotient, of two f64 in `value` may round: nothing if both are short and the digits far
/// from those that f64 cannot have.
fn rounding_of(value: DoubleDouble, is_short: bool) -> f64 {
    /// Products above keep all digits of their second part.
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
        let least = b.value.hi.abs() * (1.0 - 1e-15) - b.error;
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
