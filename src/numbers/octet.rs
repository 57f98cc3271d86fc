//! Eight numbers side by side: one for each of eight designs of the same structure.
//!
//! Lanes do not affect each other, so the bits of a lane do not depend on its neighbours. Sums and products are those
//! of f64 lane by lane, whatever the width of the processor's registers; so are the functions, except sine and cosine
//! (`octet_sin_cos`).

use super::octet_sin_cos::sin_cos;
use super::scalar::{Ring, Scalar};
use std::ops::{Add, AddAssign, BitAnd, Div, Mul, Neg, Sub, SubAssign};
use wide::f64x8;

/// Numbers side by side.
pub const LANES: usize = 8;

/// Eight numbers.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Octet(f64x8);

impl Octet {
    /// Eight zeros.
    pub const ZERO: Self = Self::splat(0.0);

    /// Eight times the same number.
    #[inline(always)]
    pub const fn splat(value: f64) -> Self {
        Self(f64x8::splat(value))
    }

    /// From the numbers of the lanes.
    #[inline(always)]
    pub const fn new(lanes: [f64; LANES]) -> Self {
        Self(f64x8::new(lanes))
    }

    /// The numbers of the lanes.
    #[inline(always)]
    pub const fn to_array(self) -> [f64; LANES] {
        self.0.to_array()
    }

    /// The number of one lane, counted modulo their number.
    #[inline(always)]
    pub const fn lane(self, lane: usize) -> f64 {
        self.0.to_array()[lane % LANES]
    }

    /// Replaces the number of one lane.
    #[inline(always)]
    pub const fn set_lane(&mut self, lane: usize, value: f64) {
        self.0.as_mut_array()[lane % LANES] = value;
    }

    /// Applies a function of plain numbers to each.
    #[inline]
    pub fn each(self, function: impl Fn(f64) -> f64) -> Self {
        Self::new(self.to_array().map(function))
    }

    fn each_of(self, other: Self, function: impl Fn(f64, f64) -> f64) -> Self {
        let (a, b) = (self.to_array(), other.to_array());
        Self::new(std::array::from_fn(|k| function(a[k], b[k])))
    }

    /// Magnitudes.
    #[inline(always)]
    pub fn magnitude(self) -> Self {
        Self(self.0.abs())
    }

    /// The larger magnitude of each lane; NaN propagates.
    #[inline(always)]
    pub fn larger_magnitude(self, other: Self) -> Self {
        let other = other.magnitude();
        // False for NaN on either side: a known NaN stays, a new one is taken.
        let is_kept = other.at_most(self).or(self.is_nan());
        is_kept.choose(self, other)
    }

    /// The lanes that are NaN.
    #[inline(always)]
    pub fn is_nan(self) -> LaneMask {
        LaneMask(self.0.is_nan())
    }

    /// The lanes where these are less than or equal to the others; not those with NaN.
    #[inline(always)]
    pub fn at_most(self, other: Self) -> LaneMask {
        LaneMask(self.0.simd_le(other.0))
    }

    /// The lanes where these are greater than the others; not those with NaN.
    #[inline(always)]
    pub fn above(self, other: Self) -> LaneMask {
        LaneMask(self.0.simd_gt(other.0))
    }

    /// Square roots.
    #[inline(always)]
    pub fn root(self) -> Self {
        Self(self.0.sqrt())
    }
}

/// Some of eight lanes.
#[derive(Clone, Copy, Debug, Default)]
pub struct LaneMask(f64x8);

impl LaneMask {
    /// None of them.
    pub const NONE: Self = Self(f64x8::splat(0.0));

    /// The first so many.
    pub fn first(count: usize) -> Self {
        let lane = |k: usize| {
            if k < count {
                f64::from_bits(u64::MAX)
            } else {
                0.0
            }
        };
        Self(f64x8::new(std::array::from_fn(lane)))
    }

    /// From the one in the selected lanes, from the other elsewhere.
    #[inline(always)]
    pub fn choose(self, here: Octet, elsewhere: Octet) -> Octet {
        Octet(self.0.bitselect(here.0, elsewhere.0))
    }

    /// Those in both.
    #[inline(always)]
    pub fn and(self, other: Self) -> Self {
        Self(self.0.bitand(other.0))
    }

    /// Those in either.
    #[inline(always)]
    pub fn or(self, other: Self) -> Self {
        Self(self.0 | other.0)
    }

    /// Those that are not in the other.
    #[inline(always)]
    pub fn without(self, other: Self) -> Self {
        Self(self.0 & !other.0)
    }

    /// Whether there is any.
    #[inline(always)]
    pub fn any(self) -> bool {
        self.0.any()
    }

    /// Whether a lane is one of them.
    pub fn has(self, lane: usize) -> bool {
        self.0.to_bitmask() >> (lane % LANES) & 1 == 1
    }

    /// The same without one lane.
    pub fn except(self, lane: usize) -> Self {
        let mut lanes = self.0.to_array();
        lanes[lane % LANES] = 0.0;
        Self(f64x8::new(lanes))
    }
}

impl Add for Octet {
    type Output = Self;
    #[inline(always)]
    fn add(self, b: Self) -> Self {
        Self(self.0 + b.0)
    }
}

impl Sub for Octet {
    type Output = Self;
    #[inline(always)]
    fn sub(self, b: Self) -> Self {
        Self(self.0 - b.0)
    }
}

impl Mul for Octet {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: Self) -> Self {
        Self(self.0 * b.0)
    }
}

impl Mul<f64> for Octet {
    type Output = Self;
    #[inline(always)]
    fn mul(self, b: f64) -> Self {
        Self(self.0 * f64x8::splat(b))
    }
}

impl Div for Octet {
    type Output = Self;
    #[inline(always)]
    fn div(self, b: Self) -> Self {
        Self(self.0 / b.0)
    }
}

impl Neg for Octet {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        Self(-self.0)
    }
}

impl AddAssign for Octet {
    #[inline(always)]
    fn add_assign(&mut self, b: Self) {
        *self = *self + b;
    }
}

impl SubAssign for Octet {
    #[inline(always)]
    fn sub_assign(&mut self, b: Self) {
        *self = *self - b;
    }
}

impl Ring for Octet {
    #[inline(always)]
    fn number(value: f64) -> Self {
        Self::splat(value)
    }
}

impl Scalar for Octet {
    fn undefined() -> Self {
        Self::splat(f64::NAN)
    }

    fn is_finite(self) -> bool {
        self.to_array().into_iter().all(f64::is_finite)
    }

    fn as_number(self) -> Option<f64> {
        let [first, rest @ ..] = self.to_array();
        rest.iter().all(|other| *other == first).then_some(first)
    }

    /// Eight numbers are not a single one.
    fn nominal(self) -> f64 {
        self.as_number().unwrap_or(f64::NAN)
    }

    fn first_order(self, value: f64) -> Self {
        Self::splat(value)
    }

    fn is_below_zero(self) -> Option<bool> {
        let [first, rest @ ..] = self.to_array().map(|v| v < 0.0);
        rest.iter().all(|other| *other == first).then_some(first)
    }

    fn choose(self, negative: Self, other: Self) -> Self {
        let chosen = LaneMask(self.0.simd_lt(f64x8::splat(0.0))).choose(negative, other);
        self.is_nan().choose(Self::undefined(), chosen)
    }

    fn sin_cos(self) -> (Self, Self) {
        let (sin, cos) = sin_cos(self.0);
        (Self(sin), Self(cos))
    }

    fn exp(self) -> Self {
        self.each(Scalar::exp)
    }

    fn ln(self) -> Self {
        self.each(Scalar::ln)
    }

    fn sqrt(self) -> Self {
        self.root()
    }

    fn asin(self) -> Self {
        self.each(Scalar::asin)
    }

    fn acos(self) -> Self {
        self.each(Scalar::acos)
    }

    fn atan(self) -> Self {
        self.each(Scalar::atan)
    }

    fn atan2(self, x: Self) -> Self {
        self.each_of(x, Scalar::atan2)
    }

    fn over(self, divisor: Self) -> Self {
        let is_zero = divisor.magnitude().at_most(Self::splat(0.0));
        is_zero.choose(Self::splat(f64::NAN), self / divisor)
    }

    fn floor(self) -> Self {
        self.each(Scalar::floor)
    }

    fn power(self, exponent: Self) -> Self {
        self.each_of(exponent, Scalar::power)
    }

    fn existing_power(self, exponent: Self) -> Self {
        self.each_of(exponent, Scalar::existing_power)
    }

    fn hypot(self, other: Self) -> Self {
        self.each_of(other, Scalar::hypot)
    }

    fn abs(self) -> Self {
        self.magnitude()
    }

    fn slope_by_exponent(self) -> Self {
        self.each(Scalar::slope_by_exponent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn some(seed: u64) -> Octet {
        Octet::new(std::array::from_fn(|k| {
            3.0 * (seed as f64 + 1.7 * k as f64).sin()
        }))
    }

    /// Every function of formulas gives a lane what it gives the plain number.
    #[test]
    fn lanes_are_plain_numbers() {
        let (a, b) = (some(1), some(5));
        type Two<S> = fn(S, S) -> S;
        let functions: [(Two<Octet>, Two<f64>); 14] = [
            (|a, b| a + b, |a, b| a + b),
            (|a, b| a - b * a, |a, b| a - b * a),
            (|a, b| -a / b, |a, b| -a / b),
            (Scalar::min, Scalar::min),
            (Scalar::max, Scalar::max),
            (Scalar::modulo, Scalar::modulo),
            (Scalar::power, Scalar::power),
            (Scalar::atan2, Scalar::atan2),
            (Scalar::hypot, Scalar::hypot),
            (|a, _| a.sqrt(), |a, _| Scalar::sqrt(a)),
            (|a, _| a.floor(), |a, _| Scalar::floor(a)),
            (|a, _| a.exp(), |a, _| Scalar::exp(a)),
            (|a, b| a.choose(b, a), |a, b| Scalar::choose(a, b, a)),
            (|a, _| Scalar::abs(a), |a, _| Scalar::abs(a)),
        ];
        for (index, (eight, one)) in functions.into_iter().enumerate() {
            let found = eight(a, b);
            for k in 0..LANES {
                let right = one(a.lane(k), b.lane(k));
                let is_same = found.lane(k).to_bits() == right.to_bits();
                assert!(
                    is_same || found.lane(k).is_nan() && right.is_nan(),
                    "{index} {k}: {} {right}",
                    found.lane(k)
                );
            }
        }
    }

    #[test]
    fn masks_choose_lane_by_lane_and_what_is_no_number_wins() {
        let mut a = some(2);
        a.set_lane(3, f64::NAN);
        let b = some(3);
        for (one, other) in [(a, b), (b, a)] {
            let largest = Octet::ZERO.larger_magnitude(one).larger_magnitude(other);
            for k in 0..LANES {
                match k {
                    3 => assert!(largest.lane(k).is_nan()),
                    _ => assert_eq!(largest.lane(k), a.lane(k).abs().max(b.lane(k).abs())),
                }
            }
        }
        let mask = LaneMask::first(5).except(2);
        let chosen = mask.choose(a, b);
        for k in [0, 1, 4, 5, 6, 7] {
            assert_eq!(mask.has(k), k < 5);
            assert_eq!(chosen.lane(k), if k < 5 { a.lane(k) } else { b.lane(k) });
        }
        assert!(!mask.has(2) && mask.any() && !mask.without(mask).any());
    }
}
