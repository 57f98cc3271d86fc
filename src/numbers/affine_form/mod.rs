//! Affine forms: the first-order dependence of a number on N others, and a bound of everything else.
//!
//! A form `value + Σ slopesₖ δₖ ± error` encloses a function of δ in [-1, 1]ᴺ. First-order terms that two forms share
//! cancel, unlike in interval arithmetic; terms of second order and rounding go into the error. Affine arithmetic of de
//! Figueiredo and Stolfi (Numerical Algorithms 37, 2004) with functions by the mean value theorem.

mod arithmetic;
mod functions;

use super::interval::Interval;
use super::rounding::{GROW, OPERATION, UNDERFLOW};
use super::scalar::{Ring, Scalar};

/// An enclosure of a function of δ in [-1, 1]ᴺ.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AffineForm<const N: usize> {
    /// At δ = 0.
    pub value: f64,
    /// Change along each δ.
    pub slopes: [f64; N],
    /// Bound of the difference between the function and the linear one.
    pub error: f64,
}

/// Operations in one slope of a product.
const OF_PRODUCT: f64 = 4.0 * OPERATION;

/// Number of parallel partial sums: in a single sum every addition would wait for the previous one.
const AT_ONCE: usize = 8;

/// Σ |slope|, not rounded up.
#[inline]
pub(super) fn sum_of_magnitudes(slopes: &[f64]) -> f64 {
    let (groups, rest) = slopes.as_chunks::<AT_ONCE>();
    let mut parts = [0.0; AT_ONCE];
    for group in groups {
        for (part, slope) in parts.iter_mut().zip(group) {
            *part += slope.abs();
        }
    }
    let rest: f64 = rest.iter().map(|slope| slope.abs()).sum();
    rest + parts.iter().sum::<f64>()
}

impl<const N: usize> AffineForm<N> {
    /// Exactly zero.
    pub const ZERO: Self = Self {
        value: 0.0,
        slopes: [0.0; N],
        error: 0.0,
    };

    /// A number that stays within `error` of `value`.
    pub const fn within(value: f64, error: f64) -> Self {
        Self {
            value,
            slopes: [0.0; N],
            error,
        }
    }

    /// All numbers of an interval.
    pub fn of_interval(interval: Interval) -> Self {
        let value = interval.middle();
        match interval.is_finite() {
            true => Self::within(value, interval.distance(value)),
            false => Self::undefined(),
        }
    }

    /// The same plus `half_width` δ of number `index`.
    pub fn moving(mut self, index: usize, half_width: f64) -> Self {
        self.slopes[index] += half_width;
        self
    }

    /// Adds `factor` times `b`.
    #[inline]
    pub fn add_scaled(&mut self, factor: f64, b: &Self) {
        if factor == 0.0 {
            // An unknown number stays unknown.
            self.error += if b.error.is_finite() { 0.0 } else { b.error };
            return;
        }
        let before = self.value.abs();
        self.value += factor * b.value;
        for (s, slope) in self.slopes.iter_mut().zip(&b.slopes) {
            *s += factor * slope;
        }
        let (own, added) = (
            sum_of_magnitudes(&self.slopes),
            sum_of_magnitudes(&b.slopes),
        );
        let size = before + 2.0 * (factor * b.value).abs() + own + factor.abs() * added;
        self.error += (factor.abs() * b.error + OPERATION * size + UNDERFLOW) * GROW;
        self.error *= GROW;
    }

    /// `start` and the sum of all forms times their factors, rounded as a whole.
    pub fn combination<'f>(start: f64, terms: impl Iterator<Item = (f64, &'f Self)>) -> Self {
        let mut sum = Self::number(start);
        let (mut count, mut size, mut open) = (1.0, start.abs(), 0.0);
        for (factor, form) in terms {
            if factor == 0.0 || form.is_zero() {
                // An unknown number stays unknown.
                open += if form.error.is_finite() {
                    0.0
                } else {
                    form.error
                };
                continue;
            }
            sum.value += factor * form.value;
            for (s, slope) in sum.slopes.iter_mut().zip(&form.slopes) {
                *s += factor * slope;
            }
            count += 1.0;
            size += factor.abs() * (form.value.abs() + sum_of_magnitudes(&form.slopes));
            open += factor.abs() * form.error;
        }
        // A sum of products loses at most this many roundings of the sum of their magnitudes.
        sum.error = (open + count * (OPERATION * size + UNDERFLOW)) * GROW;
        sum
    }

    /// Bound of the linear part.
    #[inline]
    pub fn radius(&self) -> f64 {
        sum_of_magnitudes(&self.slopes) * GROW
    }

    /// Bound of the difference from the value.
    #[inline]
    pub fn deviation(&self) -> f64 {
        (self.radius() + self.error) * GROW
    }

    /// Bound of the magnitude.
    pub fn magnitude(&self) -> f64 {
        (self.value.abs() + self.deviation()) * GROW
    }

    /// All its values.
    pub fn range(&self) -> Interval {
        Interval::point(self.value) + Interval::around_zero(self.deviation())
    }

    /// Exactly zero, so that products with it are zero too.
    pub(super) fn is_zero(&self) -> bool {
        self.value == 0.0 && self.error == 0.0 && self.slopes == [0.0; N]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    type Form = AffineForm<2>;

    fn random(state: &mut u64) -> f64 {
        *state ^= *state << 13;
        *state ^= *state >> 7;
        *state ^= *state << 17;
        (*state >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// Values of x + 0.1 δ₀ and y + 0.2 δ₁ through every operation lie within the form's linear part and its error.
    #[test]
    fn forms_hold_what_they_enclose() {
        let mut state = 0x51_ced1;
        for _ in 0..2000 {
            let (x, y) = (
                0.5 + 0.2 * random(&mut state),
                0.6 + 0.2 * random(&mut state),
            );
            let (tx, ty) = (
                0.1 * random(&mut state).abs(),
                0.2 * random(&mut state).abs(),
            );
            let a = Form::number(x).moving(0, tx) + Form::number(0.25).moving(1, 0.5 * ty);
            let b = Form::number(y).moving(1, ty);
            let d = [random(&mut state), random(&mut state)];
            let (p, q) = (x + 0.25 + tx * d[0] + 0.5 * ty * d[1], y + ty * d[1]);
            let holds = |form: Form, value: f64| {
                let line = form.value + form.slopes[0] * d[0] + form.slopes[1] * d[1];
                let off = (line - value).abs();
                assert!(off <= form.error + 4e-16, "{form:?} at {d:?}: {value}");
            };
            holds(a + b, p + q);
            holds(a - b, p - q);
            holds(a * b, p * q);
            holds(a / b, p / q);
            holds(a.square(), p * p);
            holds(a.scale(-1.7), -1.7 * p);
            holds(a.sin(), libm::sin(p));
            holds(a.cos(), libm::cos(p));
            holds(a.exp(), libm::exp(p));
            holds(a.ln(), libm::log(p));
            holds(a.sqrt(), p.sqrt());
            holds((a.scale(0.5)).asin(), libm::asin(0.5 * p));
            holds((a.scale(0.5)).acos(), libm::acos(0.5 * p));
            holds(a.atan(), libm::atan(p));
            holds(a.atan2(b), libm::atan2(p, q));
            holds(a.hypot(b), libm::hypot(p, q));
            let terms = [(1.5, &a), (0.0, &b), (-0.3, &b), (2.0, &Form::ZERO)];
            let sum = Form::combination(-1.0, terms.into_iter());
            holds(sum, -1.0 + 1.5 * p - 0.3 * q);
        }
    }

    #[test]
    fn errors_are_of_second_order_and_common_parts_cancel() {
        let [wide, narrow] = [1e-2, 1e-3].map(|t| Form::number(0.7).moving(0, t));
        for f in [
            Scalar::sin,
            Scalar::exp,
            Scalar::sqrt,
            Scalar::ln,
            Scalar::square,
        ] {
            let ratio = f(wide).error / f(narrow).error;
            assert!((90.0..110.0).contains(&ratio), "{ratio}");
        }
        assert!((wide - wide).deviation() < 1e-15);
    }

    #[test]
    fn nothing_is_made_up() {
        let around_zero = Form::number(0.0).moving(0, 1.0);
        for none in [
            Form::number(1.0) / around_zero,
            around_zero.ln(),
            around_zero.sqrt(),
            around_zero.atan2(Form::number(-1.0)),
            around_zero.floor(),
            around_zero.abs(),
            Form::number(1.0).asin(),
            Form::undefined() * Form::ZERO,
            Form::undefined() + Form::number(1.0),
            Form::combination(1.0, [(0.0, &Form::undefined())].into_iter()),
        ] {
            assert!(!none.is_finite(), "{none:?}");
        }
        assert_eq!(Form::ZERO * around_zero, Form::ZERO);
        assert_eq!(Form::ZERO.sin_cos(), (Form::ZERO, Form::number(1.0)));
    }
}
