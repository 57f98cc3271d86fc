//! Truncated power series in one variable over any number type: exact rates of any order, and enclosures of them.
//!
//! A series contains the coefficients c₀ … cₙ of Σ cₖ hᵏ, so that the k-th derivative is k! cₖ. The recurrences come
//! from the differential equations of the functions (Griewank and Walther, Evaluating Derivatives, 2nd ed., chapter
//! 13). At a kink of a function (abs, min, max, mod, floor) the series is that of one side; an enclosure that contains
//! both sides is undefined where it changes.

use super::constant::Constant;
use super::interval::Interval;
use super::scalar::{Ring, Scalar};
use std::ops::{Add, Div, Mul, Neg, Sub};

/// Highest power of a series of plain numbers.
pub const HIGHEST_ORDER: usize = 8;

/// Coefficients of a truncated series, on the stack: those up to the order, followed by zeros.
///
/// Operands have the same order, or order zero: constants, which are compatible with every order.
#[derive(Clone, Copy, Debug)]
pub struct Series<T, const N: usize = { HIGHEST_ORDER + 1 }> {
    coefficients: [T; N],
    /// How many of them can differ from zero, at least one.
    length: usize,
}

/// Series of plain numbers.
pub type TaylorSeries = Series<f64>;

impl<T: Scalar, const N: usize> PartialEq for Series<T, N> {
    fn eq(&self, other: &Self) -> bool {
        self.coefficients == other.coefficients
    }
}

impl<T: Scalar, const N: usize> Series<T, N> {
    /// What does not change.
    pub fn constant(value: T) -> Self {
        let mut coefficients = [T::number(0.0); N];
        coefficients[0] = value;
        Self {
            coefficients,
            length: 1,
        }
    }

    /// `value + rate h`, up to the power `order`, which is at most N - 1.
    pub fn linear(value: T, rate: T, order: usize) -> Self {
        let mut series = Self::constant(value);
        series.length = N.min(order + 1);
        if series.length > 1 {
            series.coefficients[1] = rate;
        }
        series
    }

    /// Highest power that is kept.
    pub fn order(&self) -> usize {
        self.length - 1
    }

    /// The coefficients, from the constant on; those beyond the order are zero.
    pub fn coefficients(&self) -> &[T; N] {
        &self.coefficients
    }

    /// Replaces the coefficient of hᵏ, `k` below N.
    pub fn set(&mut self, k: usize, value: T) {
        self.coefficients[k] = value;
        self.length = self.length.max(k + 1);
    }

    /// The k-th derivative at h = 0, `k` below N.
    pub fn derivative(&self, k: usize) -> T {
        (1..=k).fold(self.coefficients[k], |value, j| value.scale(j as f64))
    }

    /// The polynomial's value at `h`.
    pub fn value_at(&self, h: T) -> T {
        let terms = self.used().iter().rev();
        terms.fold(T::number(0.0), |sum, c| sum * h + *c)
    }

    /// The same series with the powers up to `order` only.
    pub fn truncated(mut self, order: usize) -> Self {
        self.length = self.length.min(order + 1);
        self.coefficients[self.length..].fill(T::number(0.0));
        self
    }

    /// Whether it is known not to change.
    fn is_constant(&self) -> bool {
        self.used()[1..].iter().all(|c| *c == T::number(0.0))
    }

    fn used(&self) -> &[T] {
        &self.coefficients[..self.length]
    }

    /// Computes the coefficients one after the other, each from those before it.
    #[inline]
    pub(super) fn built(length: usize, mut coefficient: impl FnMut(usize, &[T; N]) -> T) -> Self {
        let mut coefficients = [T::number(0.0); N];
        for k in 0..length {
            coefficients[k] = coefficient(k, &coefficients);
        }
        Self {
            coefficients,
            length,
        }
    }

    #[inline]
    fn map(mut self, f: impl Fn(T) -> T) -> Self {
        let used = &mut self.coefficients[..self.length];
        used.iter_mut().for_each(|c| *c = f(*c));
        self
    }

    /// Term by term; constants continue with zeros.
    #[inline]
    fn zip(self, other: Self, f: impl Fn(T, T) -> T) -> Self {
        let length = self.length.max(other.length);
        let (a, b) = (&self.coefficients, &other.coefficients);
        Self::built(length, |k, _| f(a[k], b[k]))
    }

    /// Coefficient k of ∫ self' b: Σ from j = 1 to k of j cⱼ bₖ₋ⱼ, over k.
    #[inline]
    fn integral(&self, b: &[T; N], k: usize) -> T {
        let last = k.min(self.length - 1);
        let terms = (1..=last).map(|j| self.coefficients[j].scale(j as f64) * b[k - j]);
        sum_terms(terms) / T::number(k as f64)
    }

    /// The series that starts at `value` and whose derivative is `self' · factor`.
    fn integrated_product(&self, factor: &Self, value: T) -> Self {
        let length = self.length.max(factor.length);
        Self::built(length, |k, _| match k {
            0 => value,
            _ => self.integral(&factor.coefficients, k),
        })
    }

    fn one() -> Self {
        Self::number(1.0)
    }

    /// 1 / sqrt(1 - u²): the rate of the inverse sine.
    fn arc_rate(self) -> Self {
        Self::one() / (Self::one() - self.square()).sqrt()
    }
}

impl<T: Scalar, const N: usize> From<[T; N]> for Series<T, N> {
    fn from(coefficients: [T; N]) -> Self {
        Self {
            coefficients,
            length: N,
        }
    }
}

/// The sum of the terms in their order.
#[inline]
pub(super) fn sum_terms<T: Scalar>(mut terms: impl Iterator<Item = T>) -> T {
    let first = terms.next().unwrap_or(T::number(0.0));
    terms.fold(first, |sum, term| sum + term)
}

impl<T: Scalar, const N: usize> Ring for Series<T, N> {
    fn number(value: f64) -> Self {
        Self::constant(T::number(value))
    }

    fn scale(self, factor: f64) -> Self {
        self.map(|c| c.scale(factor))
    }

    fn scale_by(self, factor: Constant) -> Self {
        self.map(|c| c.scale_by(factor))
    }
}

impl<T: Scalar, const N: usize> Scalar for Series<T, N> {
    fn may_lack_value(self) -> bool {
        self.coefficients[0].may_lack_value()
    }

    /// Constants have powers at zero, too.
    fn variable_power(self, exponent: Self) -> Self {
        if self.is_constant() && exponent.is_constant() {
            return Self::constant(self.coefficients[0].power(exponent.coefficients[0]));
        }
        match self.ln() {
            log if log.may_lack_value() => Self::undefined(),
            log => (log * exponent).exp(),
        }
    }

    /// Where the divisor begins at zero there is no value, whatever follows.
    fn over(self, divisor: Self) -> Self {
        let begins = divisor.coefficients[0];
        match !T::IS_ENCLOSURE && begins.nominal() == 0.0 {
            true => Self::undefined(),
            false => self / divisor,
        }
    }

    fn from_constant(constant: Constant) -> Self {
        Self::constant(T::from_constant(constant))
    }

    fn undefined() -> Self {
        Self {
            coefficients: [T::undefined(); N],
            length: N,
        }
    }

    fn is_finite(self) -> bool {
        self.used().iter().all(|c| c.is_finite())
    }

    fn as_number(self) -> Option<f64> {
        let number = self.coefficients[0].as_number();
        number.filter(|_| self.is_constant())
    }

    fn nominal(self) -> f64 {
        self.coefficients[0].nominal()
    }

    fn first_order(self, value: f64) -> Self {
        let mut series = self;
        series.coefficients[0] = self.coefficients[0].first_order(value);
        let higher = series.coefficients[..self.length].iter_mut().skip(2);
        higher.for_each(|c| *c = T::undefined());
        series
    }

    fn is_below_zero(self) -> Option<bool> {
        let mut used = self.used().iter();
        let leading = used.find(|c| **c != T::number(0.0));
        // An infinite rate tells of no side: it may be that of an end.
        let leading = leading.map(|c| c.is_below_zero().filter(|_| c.is_finite()));
        leading.unwrap_or(Some(false))
    }

    /// The product with itself, whose value is a square.
    fn square(self) -> Self {
        let mut product = self * self;
        product.coefficients[0] = self.coefficients[0].square();
        product
    }

    /// s' = c u', c' = -s u'.
    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = self.coefficients[0].sin_cos();
        let (mut s, mut c) = (Self::constant(sin), Self::constant(cos));
        for k in 1..self.length {
            let next = self.integral(&c.coefficients, k);
            c.coefficients[k] = -self.integral(&s.coefficients, k);
            s.coefficients[k] = next;
        }
        (s.length, c.length) = (self.length, self.length);
        (s, c)
    }

    fn exp(self) -> Self {
        Self::built(self.length, |k, known| match k {
            0 => self.coefficients[0].exp(),
            _ => self.integral(known, k),
        })
    }

    fn ln(self) -> Self {
        self.integrated_product(&(Self::one() / self), self.coefficients[0].ln())
    }

    fn sqrt(self) -> Self {
        self.root()
    }

    fn hypot(self, other: Self) -> Self {
        self.length_with(other)
    }

    fn asin(self) -> Self {
        self.integrated_product(&self.arc_rate(), self.coefficients[0].asin())
    }

    fn acos(self) -> Self {
        self.integrated_product(&-self.arc_rate(), self.coefficients[0].acos())
    }

    fn atan(self) -> Self {
        let rate = Self::one() / (Self::one() + self.square());
        self.integrated_product(&rate, self.coefficients[0].atan())
    }

    /// From (x y' - y x') / (x² + y²). Where the cut may be met, the angle is not a series but jumps.
    fn atan2(self, x: Self) -> Self {
        let square = x.square() + self.square();
        let angle = self.coefficients[0].atan2(x.coefficients[0]);
        if !angle.is_finite() {
            return Self::undefined();
        }
        let from_y = self.integrated_product(&(x / square), angle);
        let from_x = x.integrated_product(&(self / square), T::number(0.0));
        from_y - from_x
    }

    /// At a kink an enclosure that does not change has values: those of both sides.
    fn abs(self) -> Self {
        match self.is_constant() {
            true => Self::constant(self.coefficients[0].abs()),
            false => self.choose(-self, self),
        }
    }

    fn min(self, other: Self) -> Self {
        match self.is_constant() && other.is_constant() {
            true => Self::constant(self.coefficients[0].min(other.coefficients[0])),
            false => (other - self).choose(other, self),
        }
    }

    fn max(self, other: Self) -> Self {
        match self.is_constant() && other.is_constant() {
            true => Self::constant(self.coefficients[0].max(other.coefficients[0])),
            false => (self - other).choose(other, self),
        }
    }

    fn floor(self) -> Self {
        let floor = self.coefficients[0].floor();
        if floor.is_finite() {
            Self::constant(floor)
        } else {
            Self::undefined()
        }
    }

    fn real_power(self, exponent: f64) -> Self {
        match exponent > 0.0 {
            true => self.power_at_zero(exponent, |series| series.plain_power(exponent)),
            false => self.plain_power(exponent),
        }
    }
}

impl<T: Scalar, const N: usize> Add for Series<T, N> {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
}

impl<T: Scalar, const N: usize> Sub for Series<T, N> {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
}

impl<T: Scalar, const N: usize> Neg for Series<T, N> {
    type Output = Self;
    fn neg(self) -> Self {
        self.map(|c| -c)
    }
}

impl<T: Scalar, const N: usize> Mul for Series<T, N> {
    type Output = Self;
    fn mul(self, other: Self) -> Self {
        let (a, b) = (&self.coefficients, &other.coefficients);
        Self::built(self.length.max(other.length), |k, _| {
            let from = (k + 1).saturating_sub(other.length);
            sum_terms((from..=k.min(self.length - 1)).map(|j| a[j] * b[k - j]))
        })
    }
}

impl<T: Scalar, const N: usize> Div for Series<T, N> {
    type Output = Self;
    fn div(self, divisor: Self) -> Self {
        let (a, b) = (&self.coefficients, &divisor.coefficients);
        Self::built(self.length.max(divisor.length), |k, known| {
            let from = (k + 1).saturating_sub(divisor.length);
            let products = sum_terms((from..k).map(|j| known[j] * b[k - j]));
            (a[k] - products) / b[0]
        })
    }
}

impl<const N: usize> Series<Interval, N> {
    /// Coefficients of the same polynomial about every place -1 ≤ h ≤ 1.
    pub fn over_the_stretch(mut self) -> Self {
        let place = Interval::new(-1.0, 1.0);
        // Horner's scheme, one order after the other: the coefficients about h are divided differences.
        let c = &mut self.coefficients;
        for k in 0..N {
            for j in (k..N - 1).rev() {
                c[j] = c[j] + c[j + 1] * place;
            }
        }
        self
    }

    /// The last coefficient from `stretch`, the others from here.
    pub fn with_remainder_of(mut self, stretch: &Self) -> Self {
        self.set(N - 1, stretch.coefficients[N - 1]);
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(coefficients: [f64; 4]) -> Series<f64, 4> {
        Series::from(coefficients)
    }

    #[test]
    fn constants_go_with_every_order() {
        let x = of([2.0, 1.0, -3.0, 0.5]);
        let three = Series::number(3.0);
        assert_eq!((x * three).order(), 3);
        assert_eq!(x * three, of([6.0, 3.0, -9.0, 1.5]));
        assert_eq!(three - x, of([1.0, -1.0, 3.0, -0.5]));
        assert_eq!(three * three, Series::number(9.0));
        assert_eq!((three / x) * x, three.truncated(3));
        assert_eq!(x.truncated(1) * x.truncated(0), of([4.0, 2.0, 0.0, 0.0]));
    }

    #[test]
    fn a_kink_is_passed_on_the_side_that_lies_ahead() {
        let x = of([0.0, 0.0, -2.0, 1.0]);
        assert_eq!(x.is_below_zero(), Some(true));
        assert_eq!(x.abs(), -x);
        let unsure = Series::<Interval, 4>::linear(Interval::new(-1.0, 1.0), Interval::ONE, 3);
        assert_eq!(unsure.abs(), Series::undefined());
        // What rests has the values of both sides, and rates of zero.
        let resting = Series::<Interval, 4>::constant(Interval::new(-1.0, 2.0));
        let [magnitude, below, above] =
            [resting.abs(), resting.min(-resting), resting.max(-resting)];
        for (found, [lo, hi]) in [
            (magnitude, [0.0, 2.0]),
            (below, [-2.0, 1.0]),
            (above, [-1.0, 2.0]),
        ] {
            assert_eq!(found, Series::constant(Interval::new(lo, hi)));
        }
        assert!(!resting.min(Series::undefined()).is_finite());
        assert!(!unsure.floor().is_finite());
    }

    #[test]
    fn enclosures_hold_the_series_of_their_members() {
        let near = |c: f64| Interval::new(c - 1e-9, c + 1e-9);
        let numbers = [0.4, 0.5, -0.3, 0.2, 0.1, 0.0, 0.3, -0.2, 0.1];
        let (x, wide) = (Series::from(numbers), Series::from(numbers.map(near)));
        let one = TaylorSeries::number(1.0);
        let wide_one = Series::number(1.0);
        let pairs: [(TaylorSeries, Series<Interval>); 9] = [
            (x.exp(), wide.exp()),
            (x.ln(), wide.ln()),
            (x.sqrt(), wide.sqrt()),
            (x.sin(), wide.sin()),
            (x.acos(), wide.acos()),
            (x.atan(), wide.atan()),
            (x.atan2(one + x), wide.atan2(wide_one + wide)),
            (x.real_power(0.7), wide.real_power(0.7)),
            (one / x, wide_one / wide),
        ];
        for (number, interval) in pairs {
            let both = number.coefficients().iter().zip(interval.coefficients());
            for (c, all) in both {
                assert!(all.lo <= *c && *c <= all.hi, "{number:?} {interval:?}");
                assert!(all.hi - all.lo < 1e-2);
            }
        }
    }
}
