//! Functions of affine forms, by the mean value theorem or by a tangent and a bound of the curvature.

use super::AffineForm;
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::rounding::{GROW, OPERATION, UNDERFLOW};
use crate::numbers::scalar::{Ring, Scalar};

impl AffineForm<'_> {
    /// A function of it: its value at the centre and its derivative on the whole range.
    fn through(self, value: Interval, derivative: Interval) -> Self {
        let slope = derivative.middle();
        if !(value.is_finite() && derivative.is_finite()) {
            return Self::undefined();
        }
        let middle = value.middle();
        let open = derivative.distance(slope) * self.deviation() + slope.abs() * self.error;
        let rounding = OPERATION * slope.abs() * self.radius;
        let error = (value.distance(middle) + open + rounding + UNDERFLOW) * GROW;
        self.with_each_slope(|own| slope * own, middle, error)
    }

    /// A function of it: its value and its derivative at the centre, and a bound of its second derivative on the whole
    /// range.
    fn bent(self, value: Interval, derivative: Interval, bend: f64) -> Self {
        let (middle, slope) = (value.middle(), derivative.middle());
        let wide = self.deviation();
        // The error of the tangent: the uncertainty of its slope over the range, and the curvature (Taylor, second
        // order).
        let open = derivative.distance(slope) * wide + slope.abs() * self.error;
        let rounding = OPERATION * slope.abs() * self.radius;
        let bent = 0.5 * bend * wide * wide;
        let error = (value.distance(middle) + open + bent + rounding + UNDERFLOW) * GROW;
        self.with_each_slope(|own| slope * own, middle, error)
    }

    /// A function of intervals and its derivative.
    pub(super) fn function(
        self,
        value: impl Fn(Interval) -> Interval,
        derivative: impl Fn(Interval) -> Interval,
    ) -> Self {
        if !self.is_finite() {
            return Self::undefined();
        }
        self.through(value(Interval::point(self.value)), derivative(self.range()))
    }
}

impl Scalar for AffineForm<'_> {
    fn may_lack_value(self) -> bool {
        !self.is_finite()
    }

    fn from_constant(constant: Constant) -> Self {
        match constant.is_exact() {
            true => Self::number(constant.number()),
            false => Self::within(constant.number(), constant.open()),
        }
    }

    fn undefined() -> Self {
        Self::within(0.0, f64::INFINITY)
    }

    fn is_finite(self) -> bool {
        self.value.is_finite() && self.deviation().is_finite()
    }

    fn as_number(self) -> Option<f64> {
        self.is_number().then_some(self.value)
    }

    fn nominal(self) -> f64 {
        self.value
    }

    fn first_order(self, _value: f64) -> Self {
        Self::undefined()
    }

    fn is_below_zero(self) -> Option<bool> {
        self.range().is_below_zero()
    }

    fn square(self) -> Self {
        self * self
    }

    fn sin_cos(self) -> (Self, Self) {
        if self.is_zero() {
            return (self, Self::number(1.0));
        }
        // Value and slope at the centre; the second derivative of a sine over the whole range is bounded by the sine
        // itself.
        let here = Interval::point(self.value).sin_cos();
        let over = self.range().sin_cos();
        if !self.is_finite() {
            return (Self::undefined(), Self::undefined());
        }
        (
            self.bent(here.0, here.1, over.0.magnitude()),
            self.bent(here.1, -here.0, over.1.magnitude()),
        )
    }

    fn exp(self) -> Self {
        self.function(Scalar::exp, Scalar::exp)
    }

    fn ln(self) -> Self {
        self.function(Scalar::ln, |x| Interval::ONE / x)
    }

    fn sqrt(self) -> Self {
        self.function(Scalar::sqrt, |x| Interval::point(0.5) / x.sqrt())
    }

    fn asin(self) -> Self {
        let slope = |x: Interval| Interval::ONE / (Interval::ONE - x.square()).sqrt();
        self.function(Scalar::asin, slope)
    }

    fn acos(self) -> Self {
        let slope = |x: Interval| Interval::ONE / (Interval::ONE - x.square()).sqrt();
        self.function(Scalar::acos, |x| -slope(x))
    }

    fn atan(self) -> Self {
        let slope = |x: Interval| Interval::ONE / (Interval::ONE + x.square());
        self.function(Scalar::atan, slope)
    }

    fn atan2(self, x: Self) -> Self {
        if !(self.is_finite() && x.is_finite()) {
            return Self::undefined();
        }
        let (along, up) = (x.range(), self.range());
        // The range must not contain the branch cut, or the derivatives would not describe the angle.
        if !up.atan2(along).is_finite() {
            return Self::undefined();
        }
        let square = along.square() + up.square();
        let here = Interval::point(self.value).atan2(Interval::point(x.value));
        let by_up = self.through(here, along / square);
        by_up + x.through(Interval::ZERO, -up / square)
    }

    /// Where the sign is undecided, a form of both.
    fn choose(self, negative: Self, other: Self) -> Self {
        match self.is_below_zero() {
            Some(true) => negative,
            Some(false) => other,
            None if self.is_finite() && negative.is_finite() && other.is_finite() => {
                Self::of_interval(negative.range().hull(other.range()))
            }
            None => Self::undefined(),
        }
    }

    /// About zero by the mean value theorem, which holds at a kink with the slopes of both sides.
    fn abs(self) -> Self {
        match self.is_below_zero() {
            Some(true) => -self,
            Some(false) => self,
            None => self.function(Scalar::abs, |_| Interval::around_zero(1.0)),
        }
    }

    fn min(self, other: Self) -> Self {
        -(-self).max(-other)
    }

    /// The other one, and what this one exceeds it by.
    fn max(self, other: Self) -> Self {
        let above = self - other;
        match above.is_below_zero() {
            Some(true) => other,
            Some(false) => self,
            None => other + (above + above.abs()).scale(0.5),
        }
    }

    fn floor(self) -> Self {
        match self.range().floor().as_number() {
            Some(whole) => Self::number(whole),
            None => Self::undefined(),
        }
    }
}
