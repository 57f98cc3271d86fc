//! The number types of formulas and chains: one set of operations and functions for all of them.
//!
//! A formula is evaluated by one traversal, in `model::expression`, over any [`Scalar`]: plain numbers, numbers with
//! derivatives ([`HyperDual`](super::hyper_dual::HyperDual), [`Series`](super::series::Series)) and enclosures
//! ([`Interval`](super::interval::Interval), series of intervals). Operations that a type does not define follow from
//! the others.

use super::constant::Constant;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Whole exponents up to this are products, so that powers exist for negative bases and at zero, and squares are exact. A
/// product has as many roundings as its exponent says; larger powers need a positive base where they are bounded.
pub const LARGEST_PRODUCT: f64 = 1024.0;

/// How a term enters a sum.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sign {
    /// As it is.
    Plus,
    /// Negated.
    Minus,
}

impl Sign {
    /// ±1
    pub fn factor(self) -> f64 {
        match self {
            Self::Plus => 1.0,
            Self::Minus => -1.0,
        }
    }
}

/// Types with sums and products: enough for products of chains.
pub trait Ring:
    Copy + Add<Output = Self> + Sub<Output = Self> + Mul<Output = Self> + Neg<Output = Self>
{
    /// Exactly this number, constant.
    fn number(value: f64) -> Self;

    /// The sum of products, each with its sign.
    #[inline(always)]
    fn signed_products<const N: usize>(terms: [(Sign, Self, Self); N]) -> Self {
        let mut sum = None;
        for (sign, a, b) in terms {
            let product = a * b;
            sum = Some(match (sum, sign) {
                (None, Sign::Plus) => product,
                (None, Sign::Minus) => -product,
                (Some(sum), Sign::Plus) => sum + product,
                (Some(sum), Sign::Minus) => sum - product,
            });
        }
        sum.unwrap_or_else(|| Self::number(0.0))
    }

    /// Product with an exact number.
    fn scale(self, factor: f64) -> Self {
        Self::number(factor) * self
    }

    /// Product with a constant of the scene: enclosures use the number as written, with its error.
    fn scale_by(self, factor: Constant) -> Self {
        self.scale(factor.number())
    }
}

/// A number, or a type that represents one.
pub trait Scalar: Ring + PartialEq + Div<Output = Self> {
    /// Whether a number of this type stands for all that it contains.
    const IS_ENCLOSURE: bool = false;

    /// Whether it stands for what has no value, or encloses what may have none: without finite ends nothing tells.
    fn may_lack_value(self) -> bool {
        false
    }

    /// A constant of the scene: enclosures contain the number as written, others use the nearest f64.
    fn from_constant(constant: Constant) -> Self {
        Self::number(constant.number())
    }

    /// An undefined or unknown value.
    fn undefined() -> Self;

    /// Whether all parts are finite numbers.
    fn is_finite(self) -> bool;

    /// The number, if this is a single constant one.
    fn as_number(self) -> Option<f64>;

    /// The number itself, without derivatives; for an enclosure, one in its middle.
    fn nominal(self) -> f64;

    /// A number with this `value` and the first-order changes of `self`: its higher orders are unknown, and an
    /// enclosure of it as well.
    fn first_order(self, value: f64) -> Self;

    /// Whether it is negative (just after a zero for a series); `None` if undecided.
    fn is_below_zero(self) -> Option<bool>;

    /// The quotient; a number has none by zero.
    fn over(self, divisor: Self) -> Self {
        self / divisor
    }

    /// Square.
    fn square(self) -> Self {
        self * self
    }

    /// Sine and cosine of an angle in radians.
    fn sin_cos(self) -> (Self, Self);

    /// Exponential.
    fn exp(self) -> Self;

    /// Natural logarithm.
    fn ln(self) -> Self;

    /// Square root.
    fn sqrt(self) -> Self;

    /// Inverse sine, -π/2 to π/2.
    fn asin(self) -> Self;

    /// Inverse cosine, 0 to π.
    fn acos(self) -> Self;

    /// Inverse tangent, -π/2 to π/2.
    fn atan(self) -> Self;

    /// Angle of the point (`x`, `self`), -π to π.
    fn atan2(self, x: Self) -> Self;

    /// Largest whole number that is not above.
    fn floor(self) -> Self;

    /// A power with a constant exponent that is not a small whole number.
    fn real_power(self, exponent: f64) -> Self {
        (self.ln() * Self::number(exponent)).exp()
    }

    /// Sine.
    fn sin(self) -> Self {
        self.sin_cos().0
    }

    /// Cosine.
    fn cos(self) -> Self {
        self.sin_cos().1
    }

    /// Tangent.
    fn tan(self) -> Self {
        let (sin, cos) = self.sin_cos();
        sin / cos
    }

    /// Length of (`self`, `other`).
    fn hypot(self, other: Self) -> Self {
        (self.square() + other.square()).sqrt()
    }

    /// Remainder of the division by `divisor`, with the sign of the divisor.
    fn modulo(self, divisor: Self) -> Self {
        self - divisor * self.over(divisor).floor()
    }

    /// `negative` if this is below zero, otherwise `other`; undefined if the sign is undecided, or what contains both.
    fn choose(self, negative: Self, other: Self) -> Self {
        match self.is_below_zero() {
            Some(true) => negative,
            Some(false) => other,
            None => Self::undefined(),
        }
    }

    /// Magnitude.
    fn abs(self) -> Self {
        self.choose(-self, self)
    }

    /// The smaller one.
    fn min(self, other: Self) -> Self {
        (other - self).choose(other, self)
    }

    /// The larger one.
    fn max(self, other: Self) -> Self {
        (self - other).choose(other, self)
    }

    /// Power. Small whole exponents are products; variable exponents need a positive base.
    fn power(self, exponent: Self) -> Self {
        match exponent.as_number() {
            None => self.variable_power(exponent),
            // Whole exponents work for negative bases, too.
            Some(e) if e.fract() == 0.0 && e.abs() <= LARGEST_PRODUCT => {
                let product = self.whole_power(e.abs() as u32);
                if e < 0.0 {
                    Self::number(1.0) / product
                } else {
                    product
                }
            }
            Some(e) => self.real_power(e),
        }
    }

    /// A power whose exponent is no single number.
    fn variable_power(self, exponent: Self) -> Self {
        match self.ln() {
            log if log.may_lack_value() => Self::undefined(),
            log => (log * exponent).exp(),
        }
    }

    /// The power; zero has none with a negative exponent, and slopes there are infinite.
    fn existing_power(self, exponent: Self) -> Self {
        self.power(exponent)
    }

    /// A power as a product of squares.
    fn whole_power(self, exponent: u32) -> Self {
        match exponent {
            0 => Self::number(1.0),
            1 => self,
            _ => {
                // Repeated squaring.
                let even = self.square().whole_power(exponent / 2);
                if exponent.is_multiple_of(2) {
                    even
                } else {
                    even * self
                }
            }
        }
    }

    /// The relative derivative of a power by its exponent: the logarithm of the base.
    ///
    /// A negative number has no logarithm, but has powers of whole exponents, between which there is no slope: zero.
    fn slope_by_exponent(self) -> Self {
        self.ln()
    }
}

impl Ring for f64 {
    #[inline]
    fn number(value: f64) -> Self {
        value
    }
}

impl Scalar for f64 {
    fn may_lack_value(self) -> bool {
        self.is_nan()
    }

    fn undefined() -> Self {
        Self::NAN
    }

    fn is_finite(self) -> bool {
        Self::is_finite(self)
    }

    fn as_number(self) -> Option<f64> {
        Some(self)
    }

    fn nominal(self) -> f64 {
        self
    }

    fn first_order(self, value: f64) -> Self {
        value
    }

    #[inline]
    fn is_below_zero(self) -> Option<bool> {
        (!self.is_nan()).then_some(self < 0.0)
    }

    #[inline]
    fn over(self, divisor: Self) -> Self {
        match divisor == 0.0 {
            true => Self::NAN,
            false => self / divisor,
        }
    }

    fn sin_cos(self) -> (Self, Self) {
        crate::math::sin_cos(self)
    }

    fn exp(self) -> Self {
        libm::exp(self)
    }

    /// Zero has none.
    fn ln(self) -> Self {
        if self == 0.0 {
            return Self::NAN;
        }
        libm::log(self)
    }

    fn sqrt(self) -> Self {
        Self::sqrt(self)
    }

    fn asin(self) -> Self {
        libm::asin(self)
    }

    fn acos(self) -> Self {
        libm::acos(self)
    }

    fn atan(self) -> Self {
        libm::atan(self)
    }

    /// The origin has none.
    fn atan2(self, x: Self) -> Self {
        if self == 0.0 && x == 0.0 {
            return Self::NAN;
        }
        libm::atan2(self, x)
    }

    fn floor(self) -> Self {
        Self::floor(self)
    }

    fn real_power(self, exponent: f64) -> Self {
        libm::pow(self, exponent)
    }

    fn existing_power(self, exponent: Self) -> Self {
        let is_none = self.is_nan() || exponent.is_nan() || self == 0.0 && exponent < 0.0;
        match is_none {
            true => Self::NAN,
            false => self.power(exponent),
        }
    }

    fn sin(self) -> Self {
        libm::sin(self)
    }

    fn cos(self) -> Self {
        libm::cos(self)
    }

    fn tan(self) -> Self {
        libm::tan(self)
    }

    fn hypot(self, other: Self) -> Self {
        libm::hypot(self, other)
    }

    fn abs(self) -> Self {
        Self::abs(self)
    }

    /// `f64::min` would pass over what is no number.
    fn min(self, other: Self) -> Self {
        match self.is_nan() || other.is_nan() {
            true => Self::NAN,
            false => Self::min(self, other),
        }
    }

    fn max(self, other: Self) -> Self {
        match self.is_nan() || other.is_nan() {
            true => Self::NAN,
            false => Self::max(self, other),
        }
    }

    fn slope_by_exponent(self) -> Self {
        if self > 0.0 { libm::log(self) } else { 0.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_products_of_few_roundings() {
        for exponent in 0..=32_u32 {
            let e = f64::from(exponent);
            let exact = (-3.0_f64).powi(exponent as i32);
            assert_eq!(Scalar::power(-3.0, e), exact);
            let inverse = Scalar::power(-3.0, -e) * exact - 1.0;
            assert!(inverse.abs() <= f64::EPSILON);
        }
        assert_eq!(Scalar::power(2.0_f64, 0.5), std::f64::consts::SQRT_2);
        assert_eq!(Scalar::power(0.0_f64, 0.0), 1.0);
        assert!(Scalar::power(-2.0_f64, 0.5).is_nan());
    }

    #[test]
    fn choices_of_plain_numbers_pass_on_what_is_none() {
        assert_eq!(Scalar::min(1.0, 2.0), 1.0);
        assert_eq!(Scalar::max(1.0, 2.0), 2.0);
        assert!(Scalar::min(f64::NAN, 2.0).is_nan());
        assert_eq!(Scalar::min(f64::INFINITY, f64::INFINITY), f64::INFINITY);
        assert_eq!(Scalar::modulo(-1.0, 3.0), 2.0);
    }

    #[test]
    fn what_has_no_value_is_no_number() {
        let none = [
            1.0.over(0.0),
            Scalar::ln(0.0),
            Scalar::existing_power(0.0, -1.0),
            Scalar::existing_power(0.0, -0.5),
            Scalar::existing_power(f64::NAN, 0.0),
            Scalar::existing_power(1.0, f64::NAN),
            Scalar::atan2(0.0, 0.0),
            Scalar::atan2(0.0, -0.0),
            Scalar::modulo(1.0, 0.0),
        ];
        assert!(none.iter().all(|value| value.is_nan()), "{none:?}");
        // What is too large for a number is one beyond all bounds.
        assert_eq!(Scalar::exp(1e3), f64::INFINITY);
        assert_eq!(1e300.over(1e-300), f64::INFINITY);
    }
}
