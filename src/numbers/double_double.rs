//! Unevaluated sums of two f64: about 31 digits, so that a residual of 1e-15 is known to many digits.
//!
//! Error-free sums and products of Knuth and Dekker, without fused operations, which not every machine has.

use std::ops::{Add, Mul, Neg, Sub};

/// The unevaluated sum `hi + lo`, `lo` below half a unit in the last place of `hi`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DoubleDouble {
    /// Leading part: the value rounded to f64.
    pub hi: f64,
    /// What is left.
    pub lo: f64,
}

/// 2^27 + 1: parts a 53-bit number into two halves of at most 26 bits.
pub const SPLITTER: f64 = 134_217_729.0;

impl From<f64> for DoubleDouble {
    fn from(hi: f64) -> Self {
        Self { hi, lo: 0.0 }
    }
}

impl DoubleDouble {
    /// The exact sum of two f64.
    #[inline]
    pub const fn sum(a: f64, b: f64) -> Self {
        let hi = a + b;
        let t = hi - a;
        let lo = (a - (hi - t)) + (b - t);
        Self { hi, lo }
    }

    /// The exact product of two f64 (exponents far from the limits).
    #[inline]
    pub const fn product(a: f64, b: f64) -> Self {
        let hi = a * b;
        let (a1, a2) = split_halves(a);
        let (b1, b2) = split_halves(b);
        let lo = ((a1 * b1 - hi) + a1 * b2 + a2 * b1) + a2 * b2;
        Self { hi, lo }
    }

    /// The sum, error below 2^-103 (|a| + |b|).
    #[inline]
    pub const fn plus(self, b: Self) -> Self {
        let s = Self::sum(self.hi, b.hi);
        Self::ordered(s.hi, s.lo + (self.lo + b.lo))
    }

    /// The product, error below 2^-101 |a b|.
    #[inline]
    pub const fn times(self, b: Self) -> Self {
        let p = Self::product(self.hi, b.hi);
        Self::ordered(p.hi, p.lo + (self.hi * b.lo + self.lo * b.hi))
    }

    /// The quotient, error below 2^-99 |a / b|.
    pub fn over(self, b: Self) -> Self {
        let first = self.hi / b.hi;
        let rest = self - b * first;
        let second = rest.hi / b.hi;
        let last = (rest - b * second).hi / b.hi;
        Self::ordered(first, second) + Self::from(last)
    }

    /// Sum of ordered parts: |a| is not below |b|.
    #[inline]
    pub const fn ordered(a: f64, b: f64) -> Self {
        let hi = a + b;
        let lo = b - (hi - a);
        Self { hi, lo }
    }
}

/// Two halves of at most 26 bits each whose sum is `a`.
#[inline]
pub const fn split_halves(a: f64) -> (f64, f64) {
    let c = SPLITTER * a;
    let high = c - (c - a);
    (high, a - high)
}

impl Add for DoubleDouble {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        self.plus(b)
    }
}

impl Neg for DoubleDouble {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            hi: -self.hi,
            lo: -self.lo,
        }
    }
}

impl Sub for DoubleDouble {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        self.times(b)
    }
}

impl Mul<f64> for DoubleDouble {
    type Output = Self;
    #[inline]
    fn mul(self, b: f64) -> Self {
        let p = Self::product(self.hi, b);
        Self::ordered(p.hi, p.lo + self.lo * b)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keeps_what_f64_loses() {
        let third = DoubleDouble::from(1.0 / 3.0);
        // 3 fl(1/3) = 1 - 2^-54 exactly.
        let rest = third * 3.0 - DoubleDouble::from(1.0);
        assert_eq!(rest.hi + rest.lo, -(2.0_f64.powi(-54)));
        let back = DoubleDouble::from(1.0).over(DoubleDouble::from(3.0)) * 3.0;
        assert!(
            (back - DoubleDouble::from(1.0)).hi.abs() < 1e-31,
            "{back:?}"
        );
        let square = DoubleDouble::sum(1.0, 1e-20) * DoubleDouble::sum(1.0, -1e-20);
        let rest = square - DoubleDouble::from(1.0);
        assert!(
            rest.hi.abs() < 1e-31,
            "(1+e)(1-e) = 1 - e², e² = 1e-40: {rest:?}"
        );
    }
}
