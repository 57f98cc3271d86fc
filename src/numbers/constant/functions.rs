//! Functions of constants, to 28 digits: a first value from `libm`, of which only half the digits must be right, and
//! one step of Newton's method or a series.

use super::{Constant, LEADING};
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{LONG_FUNCTION, LONG_OPERATION, SMALLEST};
use crate::numbers::scalar::{Ring, Scalar};
use crate::numbers::sin_cos::long_sin_cos;
use std::f64::consts::LN_2;

/// ln 2.
const LN_TWO: DoubleDouble = DoubleDouble {
    hi: LN_2,
    lo: 2.319_046_813_846_3e-17,
};

/// Terms of the exponential series up to half of ln 2: the next is below 1e-33.
const EXPONENTIAL_TERMS: usize = 27;

/// The direction to a point that is known to a fraction `e` of its distance has an error of asin e, at most π/2 times
/// e.
const ARC: f64 = 1.6;

/// Whole exponents up to this are products of squares.
const LARGEST_WHOLE_POWER: f64 = 1e6;

/// The exponential of anything below is smaller than every f64.
const LEAST_EXPONENT: f64 = -746.0;

impl Constant {
    const UNDEFINED: Self = Self::exact(f64::NAN);

    /// Whether it differs from zero by no more than its error.
    pub fn may_be_zero(self) -> bool {
        Scalar::is_finite(self) && self.value.hi.abs() <= self.error
    }

    fn is_zero(self) -> bool {
        self.value.hi == 0.0 && self.error == 0.0
    }

    /// exp of a number whose error is negligible.
    fn exponential(x: DoubleDouble) -> DoubleDouble {
        // Argument reduction: exp x = 2^k exp(x - k ln 2).
        let twos = (x.hi / LN_2).round();
        let rest = x - LN_TWO * twos;
        let one = DoubleDouble::from(1.0);
        // Taylor series of the rest by Horner's rule.
        let series = (1..=EXPONENTIAL_TERMS).rev().fold(one, |sum, k| {
            one + (rest * sum).over(DoubleDouble::from(k as f64))
        });
        let scale = |v: f64| libm::scalbn(v, twos as i32);
        DoubleDouble {
            hi: scale(series.hi),
            lo: scale(series.lo),
        }
    }
}

impl Ring for Constant {
    fn number(value: f64) -> Self {
        Self::exact(value)
    }

    fn scale_by(self, factor: Constant) -> Self {
        self * factor
    }
}

impl Scalar for Constant {
    fn may_lack_value(self) -> bool {
        !Scalar::is_finite(self)
    }

    fn from_constant(constant: Constant) -> Self {
        constant
    }

    fn undefined() -> Self {
        Self::UNDEFINED
    }

    fn is_finite(self) -> bool {
        self.value.hi.is_finite() && self.error.is_finite()
    }

    fn as_number(self) -> Option<f64> {
        self.is_exact().then_some(self.value.hi)
    }

    fn nominal(self) -> f64 {
        self.value.hi
    }

    fn first_order(self, _value: f64) -> Self {
        Self::UNDEFINED
    }

    fn is_below_zero(self) -> Option<bool> {
        let least = self.value.hi.abs() * LEADING;
        (self.is_zero() || least > self.error).then_some(self.value.hi < 0.0)
    }

    fn sin_cos(self) -> (Self, Self) {
        if self.is_zero() {
            return (self, Self::exact(1.0));
        }
        let (sin, cos) = long_sin_cos(self.value);
        let error = self.error + LONG_FUNCTION + LONG_OPERATION * self.value.hi.abs();
        (Self::with_error(sin, error), Self::with_error(cos, error))
    }

    fn exp(self) -> Self {
        if self.is_zero() {
            return Self::exact(1.0);
        }
        if self.value.hi + self.error < LEAST_EXPONENT {
            return Self::within(0.0, SMALLEST);
        }
        let value = Self::exponential(self.value);
        let share = LONG_FUNCTION + libm::expm1(self.error);
        Self::with_error(value, value.hi.abs() * share)
    }

    fn ln(self) -> Self {
        let least = self.value.hi * LEADING - self.error;
        if least.is_nan() || least <= 0.0 {
            return Self::UNDEFINED;
        }
        let first = DoubleDouble::from(libm::log(self.value.hi));
        // ln a = y + ln(1 + t); the term t² / 2 is needed for the last digits.
        let t = self.value * Self::exponential(-first) - DoubleDouble::from(1.0);
        let value = first + t - t * t * 0.5;
        let error = self.error / least + LONG_FUNCTION * (1.0 + first.hi.abs());
        Self::with_error(value, error)
    }

    /// The root of a square that may be zero has an error up to the root of the square's error.
    fn sqrt(self) -> Self {
        let (a, e) = (self.value.hi, self.error);
        if self.is_zero() {
            return self;
        }
        if a.is_nan() || a < -e {
            return Self::UNDEFINED;
        }
        if a <= 2.0 * e {
            let largest = (a.max(0.0) + e).sqrt();
            return Self::with_error(DoubleDouble::from(a.max(0.0).sqrt()), largest);
        }
        // One Newton step from the root in f64 doubles its digits.
        let first = a.sqrt();
        let square = DoubleDouble::product(first, first);
        let value =
            DoubleDouble::from(first) + (self.value - square).over(DoubleDouble::from(2.0 * first));
        let is_exact = self.is_exact() && square == DoubleDouble::from(a);
        let rounding = if is_exact { 0.0 } else { LONG_FUNCTION * first };
        Self::with_error(value, e / first + rounding)
    }

    fn asin(self) -> Self {
        let one = Self::exact(1.0);
        self.atan2(((one - self) * (one + self)).sqrt())
    }

    fn acos(self) -> Self {
        let one = Self::exact(1.0);
        ((one - self) * (one + self)).sqrt().atan2(self)
    }

    fn atan(self) -> Self {
        self.atan2(Self::exact(1.0))
    }

    /// tan(θ - θ₀) = (y cos θ₀ - x sin θ₀) / (x cos θ₀ + y sin θ₀), so small that it is the angle itself.
    fn atan2(self, x: Self) -> Self {
        if self.is_zero() && x.is_zero() {
            return Self::UNDEFINED;
        }
        let (a, b) = (self.value, x.value);
        let size = libm::hypot(a.hi, b.hi);
        let open = libm::hypot(self.error, x.error);
        if self.is_zero() && (b.hi > x.error || x.is_zero()) {
            return Self::exact(libm::atan2(a.hi, b.hi));
        }
        if open.is_nan() || open >= size {
            return Self::UNDEFINED;
        }
        let first = libm::atan2(a.hi, b.hi);
        let (sin, cos) = long_sin_cos(DoubleDouble::from(first));
        let across = a * cos - b * sin;
        let along = b * cos + a * sin;
        let value = DoubleDouble::from(first) + across.over(along);
        // The angle jumps at the negative x axis.
        let jump = if b.hi < 0.0 && self.error > 0.0 && a.hi.abs() <= self.error {
            std::f64::consts::TAU
        } else {
            0.0
        };
        Self::with_error(value, ARC * open / size + LONG_FUNCTION * 4.0 + jump)
    }

    /// If a whole number is within the error, the result may be this one or the one below.
    fn floor(self) -> Self {
        let near = self.value.hi.round();
        let off = (self.value.hi - near) + self.value.lo;
        if self.error > 0.0 && off.abs() <= self.error {
            return Self::near(DoubleDouble::from(near), 1.0);
        }
        let below = self.value.hi.floor();
        let is_lower = below == self.value.hi && self.value.lo < 0.0;
        Self::exact(if is_lower { below - 1.0 } else { below })
    }

    fn abs(self) -> Self {
        if self.value.hi < 0.0 { -self } else { self }
    }

    /// No farther from the smaller of the two meant than either is from its own.
    fn min(self, other: Self) -> Self {
        let smaller = if (other - self).value.hi < 0.0 {
            other
        } else {
            self
        };
        Self::near(smaller.value, self.error.max(other.error))
    }

    fn max(self, other: Self) -> Self {
        -(-self).min(-other)
    }

    /// A root or power of zero has no logarithm.
    fn power(self, exponent: Self) -> Self {
        match exponent.as_number() {
            // Whole powers by repeated squaring, the square root by its own function, all others as exp(e ln x).
            Some(e) if e.fract() == 0.0 && e.abs() <= LARGEST_WHOLE_POWER => {
                let product = self.whole_power(e.abs() as u32);
                match e < 0.0 {
                    true => Self::exact(1.0) / product,
                    false => product,
                }
            }
            // All such numbers beyond 2⁵³ are even.
            Some(e) if e.fract() == 0.0 && self.value.hi < 0.0 => {
                let size = (-self).power(exponent);
                if e % 2.0 == 0.0 { size } else { -size }
            }
            Some(0.5) => self.sqrt(),
            _ if self.is_zero() && exponent.value.hi > exponent.error => self,
            _ => (self.ln() * exponent).exp(),
        }
    }
}
