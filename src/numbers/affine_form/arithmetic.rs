//! Sums, products and quotients of affine forms.

use super::{AffineForm, OF_PRODUCT, sum_of_magnitudes};
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, OPERATION, UNDERFLOW};
use crate::numbers::scalar::{Ring, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

impl<const N: usize> Ring for AffineForm<N> {
    fn number(value: f64) -> Self {
        Self::within(value, 0.0)
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        if factor.abs() == 1.0 {
            return if factor < 0.0 { -self } else { self };
        }
        if factor == 0.0 && self.is_finite() || self.is_zero() {
            return Self::ZERO;
        }
        let size = self.value.abs() + self.radius();
        let rounding = OPERATION * size + self.error;
        Self {
            value: factor * self.value,
            slopes: self.slopes.map(|s| factor * s),
            error: (factor.abs() * rounding + UNDERFLOW) * GROW,
        }
    }

    fn scale_by(self, factor: Constant) -> Self {
        match factor.is_exact() {
            true => self.scale(factor.number()),
            false => self * Self::from_constant(factor),
        }
    }
}

impl<const N: usize> Neg for AffineForm<N> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            value: -self.value,
            slopes: self.slopes.map(|s| -s),
            error: self.error,
        }
    }
}

impl<const N: usize> Add for AffineForm<N> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        let mut sum = self;
        sum.value += b.value;
        for (s, slope) in sum.slopes.iter_mut().zip(&b.slopes) {
            *s += slope;
        }
        // Adding to zero causes no rounding.
        if !(self.is_zero() || b.is_zero()) {
            let size = sum.value.abs() + sum_of_magnitudes(&sum.slopes);
            sum.error = (self.error + b.error + OPERATION * size) * GROW;
        } else {
            sum.error = self.error + b.error;
        }
        sum
    }
}

impl<const N: usize> Sub for AffineForm<N> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl<const N: usize> Mul for AffineForm<N> {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        if self.is_zero() && b.is_finite() || b.is_zero() && self.is_finite() {
            return Self::ZERO;
        }
        let (u, v) = (self.value, b.value);
        let mut slopes = [0.0; N];
        for ((slope, x), y) in slopes.iter_mut().zip(&self.slopes).zip(&b.slopes) {
            *slope = u * y + v * x;
        }
        let (of_self, of_b) = (
            sum_of_magnitudes(&self.slopes),
            sum_of_magnitudes(&b.slopes),
        );
        // The product of the deviations is of second order: it goes into the error term.
        let (far, wide) = (of_self + self.error, of_b + b.error);
        let rounding = OF_PRODUCT * (u.abs() * (v.abs() + of_b) + v.abs() * of_self);
        let open = u.abs() * b.error + v.abs() * self.error + far * wide;
        Self {
            value: u * v,
            slopes,
            error: (open + rounding + UNDERFLOW) * GROW,
        }
    }
}

impl<const N: usize> Div for AffineForm<N> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let one = Interval::ONE;
        let inverse = b.function(|x| one / x, |x| -(one / x.square()));
        self.mul(inverse)
    }
}
