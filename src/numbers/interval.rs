//! Intervals with outward rounding: every result contains all values that exact arithmetic could give.
//!
//! Plain f64 operations, widened afterwards, so that no rounding mode is needed. If a function has no value, or no
//! single formula (a quotient by an interval around zero), the result is [`Interval::ENTIRE`], and so is everything
//! computed from it; a proof then fails by itself. Functions of `libm` are assumed to be accurate to one unit in the
//! last place.

use super::constant::Constant;
use super::rounding::{FUNCTION_WIDENING, UNDERFLOW, WIDENING};
use super::scalar::{Ring, Scalar};
use crate::math::sin_cos;
use std::f64::consts::{FRAC_PI_2, TAU};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// All numbers from `lo` to `hi`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end.
    pub lo: f64,
    /// Upper end, not below the lower one.
    pub hi: f64,
}

/// What lies below zero by no more than this share of the upper end is rounding: that of a stretch is some 1e-13 of its coordinates.
const TOUCHING: f64 = 1e-11;

/// Quotients below this have a unit in the last place below one: 2 to the power of 52.
const MOST_WHOLE: f64 = 4_503_599_627_370_496.0;

/// Relative error of π/2 and of the quotient by 2π, with a generous margin.
const TURN_SLACK: f64 = 1e-14;

impl Interval {
    /// Zero.
    pub const ZERO: Self = Self::point(0.0);
    /// One.
    pub const ONE: Self = Self::point(1.0);
    /// Nothing is known.
    pub const ENTIRE: Self = Self {
        lo: f64::NEG_INFINITY,
        hi: f64::INFINITY,
    };

    /// Exactly this number.
    pub const fn point(value: f64) -> Self {
        Self {
            lo: value,
            hi: value,
        }
    }

    /// The quotient of two numbers that divide exactly: whole numbers stay whole.
    fn whole_quotient(self, b: Self) -> Option<f64> {
        let are_numbers = self.lo == self.hi && b.lo == b.hi;
        let quotient = self.lo / b.lo;
        let is_whole = are_numbers && self.lo % b.lo == 0.0 && quotient.abs() < MOST_WHOLE;
        is_whole.then_some(quotient)
    }

    /// The sum of two numbers, the second far smaller than the first.
    pub fn sum_of(value: f64, rest: f64) -> Self {
        Self::from_constant(Constant::exact(value) + Constant::exact(rest))
    }

    /// From `lo` to `hi`; everything if they are out of order or NaN.
    pub fn new(lo: f64, hi: f64) -> Self {
        if lo <= hi {
            Self { lo, hi }
        } else {
            Self::ENTIRE
        }
    }

    /// All numbers up to `radius` from zero.
    pub fn around_zero(radius: f64) -> Self {
        Self::new(-radius, radius)
    }

    /// Without what lies below zero by no more than rounding leaves there: a root may begin or touch at zero.
    fn cut_at_zero(self) -> Self {
        match self.lo < 0.0 && -self.lo <= TOUCHING * self.hi {
            true => Self { lo: 0.0, ..self },
            false => self,
        }
    }

    fn widened(lo: f64, hi: f64, by: f64) -> Self {
        Self::new(lo - lo.abs() * by, hi + hi.abs() * by)
    }

    /// Largest magnitude.
    pub fn magnitude(self) -> f64 {
        self.lo.abs().max(self.hi.abs())
    }

    /// A number inside, near the middle.
    pub fn middle(self) -> f64 {
        0.5 * self.lo + 0.5 * self.hi
    }

    /// Largest distance of a member from `value`.
    pub fn distance(self, value: f64) -> f64 {
        (self - Self::point(value)).magnitude()
    }

    /// The smallest interval that holds both.
    pub fn hull(self, b: Self) -> Self {
        Self::new(self.lo.min(b.lo), self.hi.max(b.hi))
    }

    /// Some member is zero.
    pub fn holds_zero(self) -> bool {
        self.lo <= 0.0 && self.hi >= 0.0
    }

    /// A wave with values `a` and `b` at the ends of the interval and its crests at `crest` + 2πk.
    fn wave_image(self, a: f64, b: f64, crest: f64) -> Self {
        let ends = Self::widened(a.min(b), a.max(b), FUNCTION_WIDENING);
        // A crest lies inside if some crest + 2πk does, with slack for the rounding of the division.
        let meets = |place: f64| {
            let (from, to) = ((self.lo - place) / TAU, (self.hi - place) / TAU);
            let slack = TURN_SLACK * (1.0 + from.abs().max(to.abs()));
            (from - slack).ceil() <= (to + slack).floor()
        };
        let hi = if meets(crest) { 1.0 } else { ends.hi.min(1.0) };
        let trough = crest + 0.5 * TAU;
        let lo = if meets(trough) {
            -1.0
        } else {
            ends.lo.max(-1.0)
        };
        Self::new(lo, hi)
    }

    /// A function of `libm` that grows on the whole interval.
    fn monotone_image(self, f: impl Fn(f64) -> f64) -> Self {
        let wide = Self::widened(f(self.lo), f(self.hi), FUNCTION_WIDENING);
        Self::new(wide.lo - UNDERFLOW, wide.hi + UNDERFLOW)
    }
}

impl Ring for Interval {
    fn number(value: f64) -> Self {
        Self::point(value)
    }

    /// Product with an exact number.
    #[inline]
    fn scale(self, factor: f64) -> Self {
        if factor == 0.0 {
            return if self.is_finite() {
                Self::ZERO
            } else {
                Self::ENTIRE
            };
        }
        let (a, b) = (self.lo * factor, self.hi * factor);
        let (lo, hi) = if factor > 0.0 { (a, b) } else { (b, a) };
        // One unit outwards for rounding, the smallest number for underflow.
        let wide = Self::widened(lo, hi, WIDENING);
        Self::new(wide.lo - UNDERFLOW, wide.hi + UNDERFLOW)
    }

    fn scale_by(self, factor: Constant) -> Self {
        if factor.is_exact() {
            self.scale(factor.number())
        } else {
            self * Self::from_constant(factor)
        }
    }
}

impl Scalar for Interval {
    const IS_ENCLOSURE: bool = true;

    fn may_lack_value(self) -> bool {
        !self.is_finite()
    }

    /// All values that the constant may have.
    fn from_constant(constant: Constant) -> Self {
        let number = constant.number();
        if constant.is_exact() {
            return Self::point(number);
        }
        let (off, error) = (constant.value().lo, constant.error());
        let end = |off: f64| number + off;
        Self::new(end(off - error).next_down(), end(off + error).next_up())
    }

    fn undefined() -> Self {
        Self::ENTIRE
    }

    fn is_finite(self) -> bool {
        self.lo.is_finite() && self.hi.is_finite()
    }

    fn as_number(self) -> Option<f64> {
        (self.lo == self.hi).then_some(self.lo)
    }

    fn nominal(self) -> f64 {
        self.middle()
    }

    fn first_order(self, _value: f64) -> Self {
        Self::ENTIRE
    }

    /// Zero at an end belongs to the side of the other values.
    fn is_below_zero(self) -> Option<bool> {
        if self.lo >= 0.0 {
            Some(false)
        } else if self.hi <= 0.0 {
            Some(true)
        } else {
            None
        }
    }

    /// Square: never negative.
    fn square(self) -> Self {
        let product = self * self;
        let lo = if self.holds_zero() { 0.0 } else { product.lo };
        Self::new(lo.max(0.0), product.hi)
    }

    /// Sine and cosine.
    fn sin_cos(self) -> (Self, Self) {
        if !self.is_finite() {
            return (Self::new(-1.0, 1.0), Self::new(-1.0, 1.0));
        }
        let (s, c) = (sin_cos(self.lo), sin_cos(self.hi));
        (
            self.wave_image(s.0, c.0, FRAC_PI_2),
            self.wave_image(s.1, c.1, 0.0),
        )
    }

    /// Square root.
    fn sqrt(self) -> Self {
        let Self { lo, hi } = self.cut_at_zero();
        Self::widened(lo.sqrt(), hi.sqrt(), WIDENING)
    }

    /// Exponential.
    fn exp(self) -> Self {
        self.monotone_image(libm::exp)
    }

    /// Natural logarithm.
    fn ln(self) -> Self {
        if self.lo > 0.0 {
            self.monotone_image(libm::log)
        } else {
            Self::ENTIRE
        }
    }

    /// Inverse sine.
    fn asin(self) -> Self {
        self.monotone_image(libm::asin)
    }

    /// Angle of the point (`x`, `self`); unknown if the box meets the negative x axis.
    fn atan2(self, x: Self) -> Self {
        if !(self.is_finite() && x.is_finite()) || (x.lo <= 0.0 && self.holds_zero()) {
            return Self::ENTIRE;
        }
        // Without the cut the angle is monotone along every edge of the box: extremes are at its corners.
        let corners = [
            libm::atan2(self.lo, x.lo),
            libm::atan2(self.lo, x.hi),
            libm::atan2(self.hi, x.lo),
            libm::atan2(self.hi, x.hi),
        ];
        let lo = corners.into_iter().fold(f64::INFINITY, f64::min);
        let hi = corners.into_iter().fold(f64::NEG_INFINITY, f64::max);
        let wide = Self::widened(lo, hi, FUNCTION_WIDENING);
        Self::new(wide.lo - UNDERFLOW, wide.hi + UNDERFLOW)
    }

    fn acos(self) -> Self {
        Self::ONE.atan2(Self::ZERO) - self.asin()
    }

    /// Unknown where a member may have no such power. From zero on powers rise, whatever their positive exponents are.
    fn variable_power(self, exponent: Self) -> Self {
        let power = |base: Self| (base.ln() * exponent).exp();
        match self.cut_at_zero() {
            base if base.lo > 0.0 && base.hi.is_finite() => power(base),
            Self { lo: 0.0, hi } if exponent.lo > 0.0 && hi.is_finite() => match hi > 0.0 {
                true => Self::new(0.0, power(Self::point(hi)).hi),
                false => Self::ZERO,
            },
            _ => Self::ENTIRE,
        }
    }

    fn real_power(self, exponent: f64) -> Self {
        self.variable_power(Self::number(exponent))
    }

    /// Magnitudes; about zero those of both signs.
    fn abs(self) -> Self {
        Self::new(self.lo.max(-self.hi).max(0.0), self.magnitude())
    }

    fn min(self, other: Self) -> Self {
        Self::new(self.lo.min(other.lo), self.hi.min(other.hi))
    }

    fn max(self, other: Self) -> Self {
        -(-self).min(-other)
    }

    fn atan(self) -> Self {
        self.monotone_image(libm::atan)
    }

    /// The whole number, if it is the same for all members.
    fn floor(self) -> Self {
        let (lo, hi) = (self.lo.floor(), self.hi.floor());
        if lo == hi {
            Self::point(lo)
        } else {
            Self::ENTIRE
        }
    }
}

impl Neg for Interval {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self {
            lo: -self.hi,
            hi: -self.lo,
        }
    }
}

impl Add for Interval {
    type Output = Self;
    #[inline]
    fn add(self, b: Self) -> Self {
        if b == Self::ZERO {
            return self;
        }
        if self == Self::ZERO {
            return b;
        }
        Self::widened(self.lo + b.lo, self.hi + b.hi, WIDENING)
    }
}

impl Sub for Interval {
    type Output = Self;
    #[inline]
    fn sub(self, b: Self) -> Self {
        self + -b
    }
}

impl Mul for Interval {
    type Output = Self;
    #[inline]
    fn mul(self, b: Self) -> Self {
        if self == Self::ZERO && b.is_finite() || b == Self::ZERO && self.is_finite() {
            return Self::ZERO;
        }
        let (p, q) = (self.lo * b.lo, self.lo * b.hi);
        let (r, s) = (self.hi * b.lo, self.hi * b.hi);
        // `min` and `max` would drop what is not a number.
        if (p + q + r + s).is_nan() {
            return Self::ENTIRE;
        }
        let wide = Self::widened(p.min(q).min(r.min(s)), p.max(q).max(r.max(s)), WIDENING);
        let (lo, hi) = (wide.lo - UNDERFLOW, wide.hi + UNDERFLOW);
        // The sign of a product is exact.
        let (positive, negative) = (self.lo >= 0.0, self.hi <= 0.0);
        if positive && b.lo >= 0.0 || negative && b.hi <= 0.0 {
            Self::new(lo.max(0.0), hi)
        } else if positive && b.hi <= 0.0 || negative && b.lo >= 0.0 {
            Self::new(lo, hi.min(0.0))
        } else {
            Self::new(lo, hi)
        }
    }
}

impl Div for Interval {
    type Output = Self;
    fn div(self, b: Self) -> Self {
        if b.holds_zero() {
            return Self::ENTIRE;
        }
        if let Some(whole) = self.whole_quotient(b) {
            return Self::point(whole);
        }
        let reciprocal = Self::widened(1.0 / b.hi, 1.0 / b.lo, WIDENING);
        self * Self::new(reciprocal.lo - UNDERFLOW, reciprocal.hi + UNDERFLOW)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::double_double::DoubleDouble;

    fn random(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    fn holds(x: Interval, exact: DoubleDouble) -> bool {
        let below = DoubleDouble::from(x.lo) - exact;
        let above = exact - DoubleDouble::from(x.hi);
        below.hi <= 0.0 && above.hi <= 0.0
    }

    #[test]
    fn arithmetic_holds_the_exact_results() {
        let mut state = 0x1234_5678_9abc_def1;
        for _ in 0..10_000 {
            let scale = 10.0_f64.powi((20.0 * random(&mut state)) as i32);
            let (a, b) = (random(&mut state), scale * random(&mut state));
            let (x, y) = (Interval::point(a), Interval::point(b));
            assert!(holds(x + y, DoubleDouble::sum(a, b)));
            assert!(holds(x - y, DoubleDouble::sum(a, -b)));
            assert!(holds(x * y, DoubleDouble::product(a, b)));
            // a = (a / b) b holds for some member of the quotient.
            assert!(holds((x / y) * y, DoubleDouble::from(a)));
            let root = Interval::point(b.abs()).sqrt();
            assert!(holds(root * root, DoubleDouble::from(b.abs())));
        }
    }

    #[test]
    fn members_map_into_the_results() {
        let mut state = 0x0dd_ba11;
        let mut tightest = f64::INFINITY;
        for _ in 0..20_000 {
            let (a, w) = (8.0 * random(&mut state), random(&mut state).powi(4));
            let x = Interval::new(a, a + 3.0 * w);
            let y = Interval::new(0.3 + w, 0.5 + 2.0 * w);
            let at = |i: Interval, f: f64| i.lo + f * (i.hi - i.lo);
            let f = 0.5 + 0.5 * random(&mut state);
            let (p, q) = (at(x, f).clamp(x.lo, x.hi), at(y, 1.0 - f).clamp(y.lo, y.hi));
            let within = |i: Interval, v: f64| assert!(i.lo <= v && v <= i.hi, "{i:?} {v}");
            let (sin, cos) = x.sin_cos();
            within(sin, libm::sin(p));
            within(cos, libm::cos(p));
            within(x * y, p * q);
            within(x.square(), p * p);
            within(x / y, p / q);
            within(x.exp(), libm::exp(p));
            within(y.ln(), libm::log(q));
            within(x.atan2(y), libm::atan2(p, q));
            within(y.atan2(x), libm::atan2(q, p));
            tightest = tightest.min(sin.hi - sin.lo);
        }
        assert!(tightest < 1e-13, "points stay thin: {tightest:e}");
    }

    #[test]
    fn crests_are_seen_and_nothing_is_made_up() {
        let near = Interval::new(1.5, 1.6).sin_cos().0;
        assert!(near.hi == 1.0 && near.lo > 0.99);
        let whole = Interval::new(-10.0, 10.0).sin_cos();
        assert_eq!(whole.0, Interval::new(-1.0, 1.0));
        for none in [
            Interval::ONE / Interval::new(-1.0, 1.0),
            Interval::new(-1.0, 1.0).ln(),
            Interval::new(-1.0, 1.0).sqrt(),
            Interval::new(0.5, 1.5).asin(),
            Interval::new(-1.0, 1.0).atan2(Interval::new(-2.0, -1.0)),
            Interval::ENTIRE * Interval::ZERO,
            Interval::new(f64::NAN, 1.0),
        ] {
            assert_eq!(none, Interval::ENTIRE);
        }
    }
}
