//! Operations of formulas and chains on second-order forms.

use super::QuadraticForm;
use crate::numbers::affine_form::AffineForm;
use crate::numbers::constant::Constant;
use crate::numbers::form_sum::SummedForm;
use crate::numbers::interval::Interval;
use crate::numbers::lists::add_long_list;
use crate::numbers::rounding::{GROW, OPERATION};
use crate::numbers::scalar::{Ring, Scalar, Sign};
use std::ops::{Add, Div, Mul, Neg, Sub};

impl Ring for QuadraticForm<'_> {
    fn number(value: f64) -> Self {
        Self::from(AffineForm::within(value, 0.0))
    }

    fn signed_products<const N: usize>(terms: [(Sign, Self, Self); N]) -> Self {
        let is_zero = |form: &Self| form.is_number() && form.line.value == 0.0;
        let is_none =
            |a: &Self, b: &Self| is_zero(a) && b.is_finite() || is_zero(b) && a.is_finite();
        Self::summed_products(terms, is_none)
    }

    fn scale(self, factor: f64) -> Self {
        if factor == 1.0 {
            return self;
        }
        if factor == -1.0 {
            return -self;
        }
        Self::combination(0.0, std::iter::once((factor, &self)))
    }

    fn scale_by(self, factor: Constant) -> Self {
        match factor.is_exact() {
            true => self.scale(factor.number()),
            false => self * Self::from_constant(factor),
        }
    }
}

impl Scalar for QuadraticForm<'_> {
    fn may_lack_value(self) -> bool {
        !self.is_finite()
    }

    fn from_constant(constant: Constant) -> Self {
        Self::from(AffineForm::from_constant(constant))
    }

    fn undefined() -> Self {
        Self::from(AffineForm::undefined())
    }

    fn is_finite(self) -> bool {
        self.affine().is_finite()
    }

    fn as_number(self) -> Option<f64> {
        self.is_number().then_some(self.line.value)
    }

    fn nominal(self) -> f64 {
        self.line.value
    }

    fn first_order(self, _value: f64) -> Self {
        Self::undefined()
    }

    fn is_below_zero(self) -> Option<bool> {
        self.affine().is_below_zero()
    }

    fn sin_cos(self) -> (Self, Self) {
        if self.is_number() || !self.is_finite() {
            let (sin, cos) = self.line.sin_cos();
            return (Self::from(sin), Self::from(cos));
        }
        let (sin, cos) = Interval::point(self.line.value).sin_cos();
        (self.wave_form(sin, cos), self.wave_form(cos, -sin))
    }

    fn exp(self) -> Self {
        self.by_line(Scalar::exp)
    }

    fn ln(self) -> Self {
        self.by_line(Scalar::ln)
    }

    fn sqrt(self) -> Self {
        self.by_line(Scalar::sqrt)
    }

    fn asin(self) -> Self {
        self.by_line(Scalar::asin)
    }

    fn acos(self) -> Self {
        self.by_line(Scalar::acos)
    }

    fn atan(self) -> Self {
        self.by_line(Scalar::atan)
    }

    fn atan2(self, x: Self) -> Self {
        self.by_line(|y| y.atan2(x.affine()))
    }

    fn floor(self) -> Self {
        self.by_line(Scalar::floor)
    }

    fn choose(self, negative: Self, other: Self) -> Self {
        match self.is_below_zero() {
            Some(true) => negative,
            Some(false) => other,
            None => self.by_line(|sign| sign.choose(negative.affine(), other.affine())),
        }
    }

    fn abs(self) -> Self {
        match self.is_below_zero() {
            Some(true) => -self,
            Some(false) => self,
            None => self.by_line(Scalar::abs),
        }
    }

    fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    fn max(self, other: Self) -> Self {
        match (self - other).is_below_zero() {
            Some(true) => other,
            Some(false) => self,
            None => self.by_line(|this| this.max(other.affine())),
        }
    }
}

impl Neg for QuadraticForm<'_> {
    type Output = Self;
    fn neg(self) -> Self {
        let mut turned = self.blank();
        turned.extend(self.bends.iter().map(|b| -b));
        Self::from(-self.line).bent(turned)
    }
}

impl Add for QuadraticForm<'_> {
    type Output = Self;
    fn add(self, b: Self) -> Self {
        let line = self.line + b.line;
        if self.bends.is_empty() || b.bends.is_empty() {
            // Adding to nothing causes no rounding and no copy.
            let (bends, bend) = match self.bends.is_empty() {
                true => (b.bends, b.bend),
                false => (self.bends, self.bend),
            };
            return Self { line, bends, bend };
        }
        let (longer, shorter) = match self.bends.len() < b.bends.len() {
            true => (&b, &self),
            false => (&self, &b),
        };
        let mut bends = longer.blank();
        bends.extend_from_slice(longer.bends);
        add_long_list(&mut bends, 1.0, shorter.bends);
        let mut sum = Self::from(line).bent(bends);
        // Rounding of every sum of second-order terms.
        sum.line.error = (sum.line.error + OPERATION * (self.bend + b.bend)) * GROW;
        sum
    }
}

impl Sub for QuadraticForm<'_> {
    type Output = Self;
    fn sub(self, b: Self) -> Self {
        Self::combination(0.0, [(1.0, &self), (-1.0, &b)].into_iter())
    }
}

impl Mul for QuadraticForm<'_> {
    type Output = Self;
    fn mul(self, b: Self) -> Self {
        Self::sum_of_products(std::iter::once((&self, &b)))
    }
}

impl Div for QuadraticForm<'_> {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        let inverse = AffineForm::number(1.0) / b.affine();
        self * Self::from(inverse)
    }
}
