//! Roots and powers of series, and lengths of two of them, where the first coefficients may vanish: `sqrt((t - 1)^2)` has a kink at
//! its zero, and the series is that of the side just after it.

use super::scalar::Scalar;
use super::series::{Series, sum_terms};

impl<T: Scalar, const N: usize> Series<T, N> {
    /// Coefficients that vanish before the first one that does not; all that are kept if none is known to differ from zero.
    fn leading_zeros(&self) -> usize {
        let all = self.coefficients().iter();
        let zeros = all.take_while(|c| **c == T::number(0.0)).count();
        zeros.min(N)
    }

    /// The square root of a series that does not start at zero: the square of the root gives coefficient after coefficient.
    fn plain_root(self) -> Self {
        Self::built(self.order() + 1, |k, known| match k {
            0 => self.coefficients()[0].sqrt(),
            _ => {
                let products = sum_terms((1..k).map(|j| known[j] * known[k - j]));
                (self.coefficients()[k] - products) / known[0].scale(2.0)
            }
        })
    }

    /// A power of a series that does not start at zero: from u v' = r u' v.
    pub(super) fn plain_power(self, exponent: f64) -> Self {
        let (u, r) = (self.coefficients(), T::number(exponent));
        Self::built(self.order() + 1, |k, known| match k {
            0 => u[0].power(r),
            _ => {
                let weight = |j: usize| r.scale(j as f64) - T::number((k - j) as f64);
                let terms = (1..=k).map(|j| weight(j) * u[j] * known[k - j]);
                sum_terms(terms) / u[0].scale(k as f64)
            }
        })
    }

    /// A power above zero of what is zero up to an order: zero below the power of the first order that is not known, and not known
    /// from there on. An enclosure of the highest order that is zero is zero everywhere, as `max(t, 0)` is before its kink.
    fn power_of_nothing(exponent: f64, order: usize) -> Self {
        let is_zero = T::IS_ENCLOSURE && order + 1 == N;
        let known = if is_zero {
            f64::INFINITY
        } else {
            (order + 1) as f64 * exponent
        };
        Self::zero_below(known, order)
    }

    /// Zero in all coefficients below a power, up to an order; the others are infinite or not known.
    fn zero_below(power: f64, order: usize) -> Self {
        let mut zero = Self::constant(T::number(0.0));
        let open = (1..=order).filter(|k| *k as f64 >= power);
        open.for_each(|k| zero.set(k, T::undefined()));
        zero
    }

    /// The series over the power `zeros`, of which that many coefficients are zero.
    fn lowered(&self, zeros: usize) -> Self {
        let order = self.order().saturating_sub(zeros);
        let mut lowered = Self::constant(self.coefficients()[zeros]);
        (1..=order).for_each(|k| lowered.set(k, self.coefficients()[k + zeros]));
        lowered
    }

    /// The series times a power, up to an order; what lies between is not known, and nothing of what has no value.
    fn raised(&self, power: usize, order: usize) -> Self {
        let mut raised = Self::constant(T::number(0.0));
        let has_value = self.coefficients()[0].is_finite();
        for k in 1..=order {
            let known = k.checked_sub(power).filter(|k| *k <= self.order());
            let zero = T::number(0.0);
            let unknown = if k < power && has_value {
                zero
            } else {
                T::undefined()
            };
            raised.set(k, known.map_or(unknown, |k| self.coefficients()[k]));
        }
        raised
    }

    /// The square root.
    pub(super) fn root(self) -> Self {
        self.power_at_zero(0.5, Self::plain_root)
    }

    /// A power above zero, which `plain` tells of series that do not start at zero: that of tᵐ s is tᵐᵖ sᵖ, whose last coefficients
    /// depend on what is not kept; where m p is no whole number, those above it are infinite.
    pub(super) fn power_at_zero(self, exponent: f64, plain: impl Fn(Self) -> Self) -> Self {
        let (zeros, order) = (self.leading_zeros(), self.order());
        let power = zeros as f64 * exponent;
        match zeros {
            0 => plain(self),
            _ if zeros > order => Self::power_of_nothing(exponent, order),
            _ => {
                let rest = plain(self.lowered(zeros));
                match power.fract() == 0.0 || !rest.coefficients()[0].is_finite() {
                    true => rest.raised(power as usize, order),
                    false => Self::zero_below(power, order),
                }
            }
        }
    }

    /// √(self² + other²): a common power is taken out, so that no coefficient is lost.
    pub(super) fn length_with(self, other: Self) -> Self {
        let zeros = self.leading_zeros().min(other.leading_zeros());
        let order = self.order().max(other.order());
        let sum = |a: Self, b: Self| (a.square() + b.square()).root();
        match zeros {
            0 => sum(self, other),
            _ if zeros > order => Self::constant(T::number(0.0)),
            _ => {
                let [a, b] = [self, other].map(|series| series.lowered(zeros));
                sum(a, b).raised(zeros, order)
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::scalar::Ring;
    use crate::numbers::series::TaylorSeries;

    /// Just after its zero, |c h| is |c| h, whichever way it is written, and nothing is told that is not known.
    #[test]
    fn roots_of_squares_are_one_sided() {
        for slope in [3.0, -0.5] {
            let x = TaylorSeries::linear(0.0, slope, 4);
            let exact = TaylorSeries::linear(0.0, f64::abs(slope), 4);
            let hypot = x.hypot(TaylorSeries::number(0.0));
            assert_eq!(hypot, exact);
            let root = x.square().sqrt();
            assert_eq!(root.coefficients()[..4], exact.coefficients()[..4]);
            assert!(root.coefficients()[4].is_nan());
            let longer = x.hypot(x.scale(4.0 / 3.0));
            assert!((longer.derivative(1) - f64::abs(slope) * 5.0 / 3.0).abs() < 1e-15);
        }
    }

    #[test]
    fn a_zero_that_is_not_known_to_remain_has_no_rates() {
        // (t - 1)² to the first order is zero twice.
        let short = TaylorSeries::linear(0.0, 0.0, 1);
        assert!(short.sqrt().derivative(1).is_nan() && short.sqrt().derivative(0) == 0.0);
        let rest = TaylorSeries::number(0.0);
        assert_eq!(rest.sqrt(), rest);
        assert_eq!(rest.hypot(rest), rest);
        // √(t¹⁰) = |t|⁵.
        let long = TaylorSeries::linear(0.0, 0.0, 8);
        assert!(long.sqrt().derivative(4) == 0.0 && long.sqrt().derivative(5).is_nan());
        assert_eq!(long.hypot(long), rest);
        assert!(
            !TaylorSeries::linear(0.0, 2.0, 3)
                .sqrt()
                .derivative(1)
                .is_finite()
        );
        assert!(
            TaylorSeries::linear(0.0, 1.0, 3)
                .square()
                .scale(-1.0)
                .sqrt()
                .derivative(1)
                .is_nan()
        );
    }
}
