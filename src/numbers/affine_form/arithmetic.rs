//! Sums, products and quotients of affine forms.

use super::AffineForm;
use super::sum::AffineSum;
use crate::numbers::constant::Constant;
use crate::numbers::form_sum::{FormSum, SummedForm};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, OPERATION, UNDERFLOW};
use crate::numbers::scalar::{Ring, Scalar, Sign};
use std::ops::{Add, Div, Mul, Neg, Sub};

impl Ring for AffineForm<'_> {
    fn number(value: f64) -> Self {
        Self::within(value, 0.0)
    }

    fn signed_products<const N: usize>(terms: [(Sign, Self, Self); N]) -> Self {
        let is_none =
            |a: &Self, b: &Self| a.is_zero() && b.is_finite() || b.is_zero() && a.is_finite();
        Self::summed_products(terms, is_none)
    }

    #[inline]
    fn scale(self, factor: f64) -> Self {
        if factor.abs() == 1.0 {
            return if factor < 0.0 { -self } else { self };
        }
        if factor == 0.0 && self.is_finite() || self.is_zero() {
            return Self::ZERO;
        }
        let size = self.value.abs() + self.radius;
        let rounding = OPERATION * size + self.error;
        let error = (factor.abs() * rounding + UNDERFLOW) * GROW;
        self.with_each_slope(|slope| factor * slope, factor * self.value, error)
    }

    fn scale_by(self, factor: Constant) -> Self {
        match factor.is_exact() {
            true => self.scale(factor.number()),
            false => self * Self::from_constant(factor),
        }
    }
}

impl Neg for AffineForm<'_> {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        self.with_each_slope(|slope| -slope, -self.value, self.error)
    }
}

impl Add for AffineForm<'_> {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        let room = self.room.or(b.room);
        // Adding to zero causes no rounding.
        match (self.is_zero(), b.is_zero()) {
            (true, _) => return Self { room, ..b },
            (_, true) => return Self { room, ..self },
            _ => {}
        }
        let value = self.value + b.value;
        let error = |size: f64| (self.error + b.error + OPERATION * size) * GROW;
        // Nor does it to slopes that are none.
        let alone = match (self.slopes, b.slopes) {
            (_, []) => Some(self),
            ([], _) => Some(b),
            _ => None,
        };
        if let Some(sloped) = alone {
            return Self {
                value,
                error: error(value.abs()),
                room,
                ..sloped
            };
        }
        let (longer, shorter) = match self.slopes.len() < b.slopes.len() {
            true => (b, self),
            false => (self, b),
        };
        let mut slopes = longer.blank();
        slopes.extend_from_slice(longer.slopes);
        let pairs = slopes.iter_mut().zip(shorter.slopes);
        pairs.for_each(|(sum, added)| *sum += added);
        let mut sum = Self::within(value, 0.0).sloped(slopes, room);
        sum.error += error(value.abs() + sum.radius);
        sum
    }
}

impl Sub for AffineForm<'_> {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        match b.slopes {
            [] => self + -b,
            _ => Self::combination(0.0, [(1.0, &self), (-1.0, &b)].into_iter()),
        }
    }
}

impl Mul for AffineForm<'_> {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        if self.is_zero() && b.is_finite() || b.is_zero() && self.is_finite() {
            return Self::ZERO;
        }
        let mut product = AffineSum::new(0.0);
        product.add_product(&self, &b);
        product.finish()
    }
}

impl Div for AffineForm<'_> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let one = Interval::ONE;
        let inverse = b.function(|x| one / x, |x| -(one / x.square()));
        self.mul(inverse)
    }
}
