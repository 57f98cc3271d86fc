//! A number of a formula over a tube, with its range, so that kinks and jumps can be passed.
//!
//! If the operand of `abs`, `min` or `max` may be on either side of its kink, one side is used, plus a bound of its
//! error. A `floor` that may have jumped is any number between the whole ones. Either is a formula that contains an
//! unknown number from an interval, which may differ at every instant and every place near the path: an enclosure of
//! all such formulas encloses this one.

use super::taylor_model::{TaylorEnclosure, TaylorModel};
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::{Ring, Scalar};
use crate::numbers::series::Series;
use std::f64::consts::PI;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// From the path towards the motion: value and derivative along the line between them.
pub type LineSeries = Series<Interval, 2>;

/// A number over one tube.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShownValue {
    /// About the middle of the stretch.
    pub middle: TaylorEnclosure,
    /// About every place of it at once.
    pub everywhere: TaylorEnclosure,
    /// Anywhere between path and motion, along any line from one to the other.
    pub beside: LineSeries,
}

impl ShownValue {
    /// Over the interval. By the mean value theorem a value on the motion differs from that on the path by at most its
    /// derivative between them.
    pub fn model(&self) -> TaylorModel {
        let [_, change] = *self.beside.coefficients();
        let mut model = TaylorModel::of(self.middle, &self.everywhere);
        model.rest += change.magnitude();
        model
    }

    /// All values on the motion.
    fn range(&self) -> Interval {
        let range = self.model().range();
        match range.is_finite() {
            true => range,
            false => self.beside.coefficients()[0],
        }
    }

    fn map(
        self,
        of_series: impl Fn(TaylorEnclosure) -> TaylorEnclosure,
        of_line: impl Fn(LineSeries) -> LineSeries,
    ) -> Self {
        Self {
            middle: of_series(self.middle),
            everywhere: of_series(self.everywhere),
            beside: of_line(self.beside),
        }
    }

    fn zip(
        self,
        other: Self,
        of_series: impl Fn(TaylorEnclosure, TaylorEnclosure) -> TaylorEnclosure,
        of_line: impl Fn(LineSeries, LineSeries) -> LineSeries,
    ) -> Self {
        Self {
            middle: of_series(self.middle, other.middle),
            everywhere: of_series(self.everywhere, other.everywhere),
            beside: of_line(self.beside, other.beside),
        }
    }

    /// Any number of an interval.
    fn any_of(range: Interval) -> Self {
        Self {
            middle: Series::constant(range),
            everywhere: Series::constant(range),
            beside: Series::constant(range),
        }
    }

    /// The larger one of two, or minus the smaller one of their opposites.
    fn larger(self, other: Self) -> Self {
        let ahead = (self - other).range();
        if !ahead.is_finite() {
            return Self::undefined();
        }
        let (below, above) = ((-ahead.lo).max(0.0), ahead.hi.max(0.0));
        // The greater side, plus the largest possible excess of the other.
        let (side, off) = match above >= below {
            true => (self, below),
            false => (other, above),
        };
        match off > 0.0 {
            true => side + Self::any_of(Interval::new(0.0, off)),
            false => side,
        }
    }
}

impl Add for ShownValue {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b, |a, b| a + b)
    }
}

impl Sub for ShownValue {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b, |a, b| a - b)
    }
}

impl Mul for ShownValue {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        self.zip(other, |a, b| a * b, |a, b| a * b)
    }
}

impl Div for ShownValue {
    type Output = Self;
    fn div(self, other: Self) -> Self {
        self.zip(other, |a, b| a / b, |a, b| a / b)
    }
}

impl Neg for ShownValue {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(|a| -a, |a| -a)
    }
}

impl Ring for ShownValue {
    fn number(value: f64) -> Self {
        Self::any_of(Interval::point(value))
    }

    fn scale(self, factor: f64) -> Self {
        self.map(|a| a.scale(factor), |a| a.scale(factor))
    }

    fn scale_by(self, factor: Constant) -> Self {
        self.map(|a| a.scale_by(factor), |a| a.scale_by(factor))
    }
}

impl Scalar for ShownValue {
    fn may_lack_value(self) -> bool {
        !self.range().is_finite()
    }

    fn from_constant(constant: Constant) -> Self {
        Self {
            middle: Series::from_constant(constant),
            everywhere: Series::from_constant(constant),
            beside: Series::from_constant(constant),
        }
    }

    fn undefined() -> Self {
        Self {
            middle: Series::undefined(),
            everywhere: Series::undefined(),
            beside: Series::undefined(),
        }
    }

    fn is_finite(self) -> bool {
        self.middle.is_finite() && self.everywhere.is_finite() && self.beside.is_finite()
    }

    fn as_number(self) -> Option<f64> {
        self.beside.as_number()
    }

    fn nominal(self) -> f64 {
        self.middle.nominal()
    }

    fn first_order(self, value: f64) -> Self {
        self.map(|a| a.first_order(value), |a| a.first_order(value))
    }

    fn is_below_zero(self) -> Option<bool> {
        let range = self.range();
        match (range.hi < 0.0, range.lo >= 0.0) {
            (true, _) => Some(true),
            (_, true) => Some(false),
            _ => None,
        }
    }

    fn square(self) -> Self {
        self.map(|a| a.square(), |a| a.square())
    }

    fn sin_cos(self) -> (Self, Self) {
        let [middle, everywhere] = [self.middle, self.everywhere].map(Series::sin_cos);
        let beside = self.beside.sin_cos();
        let of = |middle, everywhere, beside| Self {
            middle,
            everywhere,
            beside,
        };
        (
            of(middle.0, everywhere.0, beside.0),
            of(middle.1, everywhere.1, beside.1),
        )
    }

    fn exp(self) -> Self {
        self.map(Series::exp, Series::exp)
    }

    fn ln(self) -> Self {
        self.map(Series::ln, Series::ln)
    }

    fn sqrt(self) -> Self {
        self.map(Series::sqrt, Series::sqrt)
    }

    fn asin(self) -> Self {
        self.map(Series::asin, Series::asin)
    }

    fn acos(self) -> Self {
        self.map(Series::acos, Series::acos)
    }

    fn atan(self) -> Self {
        self.map(Series::atan, Series::atan)
    }

    fn atan2(self, x: Self) -> Self {
        let (height, across) = (self.range(), x.range());
        if height.holds_zero() && across.holds_zero() {
            return Self::undefined();
        }
        // On the negative x axis the angle jumps by a whole turn; its values are on both sides.
        if height.lo < 0.0 && height.hi >= 0.0 && across.lo < 0.0 {
            let most = PI.next_up();
            return Self::any_of(Interval::new(-most, most));
        }
        self.zip(x, Series::atan2, Series::atan2)
    }

    fn real_power(self, exponent: f64) -> Self {
        self.map(|a| a.real_power(exponent), |a| a.real_power(exponent))
    }

    fn floor(self) -> Self {
        let range = self.range();
        match range.is_finite() {
            true => Self::any_of(Interval::new(range.lo.floor(), range.hi.floor())),
            false => Self::undefined(),
        }
    }

    fn abs(self) -> Self {
        self.larger(-self)
    }

    fn min(self, other: Self) -> Self {
        -(-self).larger(-other)
    }

    fn max(self, other: Self) -> Self {
        self.larger(other)
    }
}
