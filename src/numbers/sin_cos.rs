//! Sine and cosine with 20 digits, so that the proof need not trust those of f64.
//!
//! The angle is reduced to a multiple of π/64 and a rest; sine and cosine of the multiple are in a table that the
//! compiler fills by Taylor series, those of the rest are short polynomials.

use super::double_double::{DoubleDouble, split_halves};

/// Largest angle (radians) that is reduced without loss: its count of steps is exact in f64 with room to spare.
pub const LARGEST_ANGLE: f64 = 1e12;

/// π as three parts; the error is below 2e-49.
const PI: [f64; 3] = [
    std::f64::consts::PI,
    1.224_646_799_147_353_2e-16,
    -2.994_769_809_718_339_7e-33,
];

/// Steps to a half-turn, and to a quarter.
const STEPS: usize = 64;
const QUARTER: usize = STEPS / 2;

/// Adding and subtracting it rounds to whole numbers, whose last bits are then those of the sum.
pub const ROUNDING: f64 = 1.5 * (1u64 << 52) as f64;

/// Adding and subtracting it rounds numbers up to two to multiples of 2^-26. Products of two such numbers up to one,
/// and sums of a few of them, are exact in f64.
pub const GRID: f64 = 1.5 * (1u64 << 26) as f64;

/// A number as a short leading part, whose products with others are exact, and the rest: about 79 bits.
#[derive(Clone, Copy, Debug, Default)]
pub struct SinCosFactor {
    /// Leading part, of at most 27 bits.
    pub upper: f64,
    /// What is left.
    pub lower: f64,
    /// The number rounded to f64.
    pub whole: f64,
}

impl SinCosFactor {
    /// Of a number up to one: the leading part is a multiple of 2^-26.
    #[inline]
    pub const fn on_grid(value: DoubleDouble) -> Self {
        let upper = (value.hi + GRID) - GRID;
        Self {
            upper,
            lower: (value.hi - upper) + value.lo,
            whole: value.hi,
        }
    }

    /// Of any number: the leading part has 26 bits.
    #[inline]
    pub const fn short(value: DoubleDouble) -> Self {
        let (upper, lower) = split_halves(value.hi);
        Self {
            upper,
            lower: lower + value.lo,
            whole: value.hi,
        }
    }

    /// The number itself.
    #[inline]
    pub const fn value(&self) -> DoubleDouble {
        DoubleDouble::ordered(self.upper, self.lower)
    }

    /// Negated for a negative `sign`.
    #[inline]
    pub fn signed(&self, sign: f64) -> Self {
        Self {
            upper: sign * self.upper,
            lower: sign * self.lower,
            whole: sign * self.whole,
        }
    }

    /// The error of the product of the leading parts, itself with an error of 2^-78.
    #[inline]
    fn beside(&self, b: &Self) -> f64 {
        self.upper * b.lower + self.lower * b.whole
    }

    /// `a b + c d` of numbers on the grid, with an error of 2^-76.
    #[inline]
    fn two_products(a: &Self, b: &Self, c: &Self, d: &Self) -> Self {
        let exact = a.upper * b.upper + c.upper * d.upper;
        let upper = (exact + GRID) - GRID;
        let lower = (exact - upper) + (a.beside(b) + c.beside(d));
        Self {
            upper,
            lower,
            whole: upper + lower,
        }
    }
}

static TABLE: [(SinCosFactor, SinCosFactor); QUARTER] = factor_table();

const fn factor_table() -> [(SinCosFactor, SinCosFactor); QUARTER] {
    let blank = SinCosFactor::on_grid(DoubleDouble { hi: 0.0, lo: 0.0 });
    let mut table = [(blank, blank); QUARTER];
    let mut k = 0;
    while k < QUARTER {
        let count = k as f64;
        // Angle number k with two f64, then its sine and cosine rounded to the grid of factors.
        let (a, b) = (
            DoubleDouble::product(count, PI[0] / STEPS as f64),
            DoubleDouble::product(count, PI[1] / STEPS as f64),
        );
        let (sin, cos) = sin_cos_series(a.plus(b));
        table[k] = (SinCosFactor::on_grid(sin), SinCosFactor::on_grid(cos));
        k += 1;
    }
    table
}

/// Sine and cosine of an angle up to two by their Taylor series, error below 1e-30.
const fn sin_cos_series(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    let one = DoubleDouble { hi: 1.0, lo: 0.0 };
    let (mut sin, mut cos) = (DoubleDouble { hi: 0.0, lo: 0.0 }, one);
    let mut power = one;
    let mut k = 1;
    while k < 36 {
        power = divide_by(power.times(angle), k as f64);
        // Signs + + - -: odd powers belong to the sine, even ones to the cosine.
        let sign = if k % 4 < 2 { 1.0 } else { -1.0 };
        let term = DoubleDouble {
            hi: sign * power.hi,
            lo: sign * power.lo,
        };
        if k % 2 == 1 {
            sin = sin.plus(term);
        } else {
            cos = cos.plus(term);
        }
        k += 1;
    }
    (sin, cos)
}

/// A quotient by a small whole number.
const fn divide_by(a: DoubleDouble, divisor: f64) -> DoubleDouble {
    let hi = a.hi / divisor;
    let back = DoubleDouble::product(hi, divisor);
    let rest = ((a.hi - back.hi) - back.lo) + a.lo;
    DoubleDouble::ordered(hi, rest / divisor)
}

/// Sine and cosine of an angle in radians; no numbers above [`LARGEST_ANGLE`].
pub fn sin_cos(angle: DoubleDouble) -> (SinCosFactor, SinCosFactor) {
    let reducible = angle.hi.abs() <= LARGEST_ANGLE;
    if !reducible {
        let none = SinCosFactor::on_grid(DoubleDouble::from(f64::NAN));
        return (none, none);
    }
    // Adding and taking away three halves of 2^52 rounds what is below 2^51.
    let count = (angle.hi * (STEPS as f64 / PI[0]) + ROUNDING) - ROUNDING;
    let step = |part: usize| DoubleDouble::product(-count, PI[part] / STEPS as f64);
    let rest = DoubleDouble::from(angle.hi) + step(0);
    let rest = rest + (DoubleDouble::from(angle.lo) + step(1)) + DoubleDouble::from(step(2).hi);
    let (sin, cos) = near_zero(rest);
    let place = count as i64;
    let (table_sin, table_cos) = &TABLE[(place & (QUARTER as i64 - 1)) as usize];
    let minus = sin.signed(-1.0);
    let whole_sin = SinCosFactor::two_products(table_sin, &cos, table_cos, &sin);
    let whole_cos = SinCosFactor::two_products(table_cos, &cos, table_sin, &minus);
    match (place >> QUARTER.trailing_zeros()) & 3 {
        0 => (whole_sin, whole_cos),
        1 => (whole_cos, whole_sin.signed(-1.0)),
        2 => (whole_sin.signed(-1.0), whole_cos.signed(-1.0)),
        _ => (whole_cos.signed(-1.0), whole_sin),
    }
}

/// Sine and cosine with 29 digits, for constants: the series itself on the rest to the nearest quarter-turn. Not numbers above
/// [`LARGEST_ANGLE`].
pub fn long_sin_cos(angle: DoubleDouble) -> (DoubleDouble, DoubleDouble) {
    if angle.hi.is_nan() || angle.hi.abs() > LARGEST_ANGLE {
        let none = DoubleDouble::from(f64::NAN);
        return (none, none);
    }
    let quarters = (angle.hi / (0.5 * PI[0])).round();
    // Reduction by π with three f64, so that cancellation leaves all digits of the rest.
    let part = |p: usize| DoubleDouble::product(-quarters, 0.5 * PI[p]);
    let (sin, cos) = sin_cos_series(angle + part(0) + part(1) + part(2));
    match (quarters as i64) & 3 {
        0 => (sin, cos),
        1 => (cos, -sin),
        2 => (-sin, -cos),
        _ => (-cos, sin),
    }
}

/// Sine and cosine of at most π/128. The truncation error of the series is below 3e-23.
fn near_zero(rest: DoubleDouble) -> (SinCosFactor, SinCosFactor) {
    let r = rest.hi;
    let square = rest * rest;
    let q = square.hi;
    let sine = q * (-1.0 / 6.0 + q * (1.0 / 120.0 + q * (-1.0 / 5040.0 + q / 362_880.0)));
    let sin = DoubleDouble::ordered(r, rest.lo + (r + rest.lo) * sine);
    let cosine = q * q * (1.0 / 24.0 + q * (-1.0 / 720.0 + q / 40_320.0));
    let half = DoubleDouble::ordered(1.0, -0.5 * q);
    let cos = DoubleDouble::ordered(half.hi, half.lo + (cosine - 0.5 * square.lo));
    (SinCosFactor::on_grid(sin), SinCosFactor::on_grid(cos))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::numbers::rounding::SIN_COS;

    fn difference(a: SinCosFactor, b: DoubleDouble) -> f64 {
        (a.value() - b).hi.abs()
    }

    #[test]
    fn sine_and_cosine_keep_what_they_promise() {
        let mut state = 0x1234_5678_9abc_def1_u64;
        for k in 0..20_000 {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            let angle = DoubleDouble::sum((state >> 11) as f64 / (1u64 << 53) as f64 * 1.6, 1e-18);
            let (sin, cos) = sin_cos(angle);
            let (exact_sin, exact_cos) = sin_cos_series(angle);
            let error = difference(sin, exact_sin).max(difference(cos, exact_cos));
            assert!(error <= SIN_COS, "{}: {error:e}", angle.hi);
            let (long_sin, long_cos) = long_sin_cos(angle);
            let off = [long_sin - exact_sin, long_cos - exact_cos];
            assert!(
                off.iter().all(|d| d.hi.abs() < 1e-29),
                "{}: {off:?}",
                angle.hi
            );
            // Whole turns, added with all their digits, change nothing.
            let turns = f64::from(k % 2001 - 1000);
            let part = |p: usize| DoubleDouble::product(2.0 * turns, PI[p]);
            let far = angle + part(0) + part(1);
            let (far_sin, far_cos) = sin_cos(far);
            // Sums of thousands are known to 31 digits.
            let error = difference(far_sin, exact_sin).max(difference(far_cos, exact_cos));
            assert!(error <= SIN_COS + 1e-27, "{}: {error:e}", far.hi);
            let (sin, cos) = libm::sincos(far.hi);
            assert!((far_sin.whole - sin).abs() < 1e-12 && (far_cos.whole - cos).abs() < 1e-12);
        }
        assert!(sin_cos(DoubleDouble::from(1e13)).0.whole.is_nan());
    }

    #[test]
    fn series_agree_with_closed_forms() {
        let sixth = DoubleDouble::from(PI[0] / 6.0);
        let (sin, cos) = sin_cos_series(sixth);
        let square = sin * sin + cos * cos - DoubleDouble::from(1.0);
        assert!(square.hi.abs() < 1e-31, "{square:?}");
        let third = sin_cos_series(divide_by(
            DoubleDouble {
                hi: PI[0],
                lo: PI[1],
            },
            3.0,
        ))
        .1;
        assert!((third - DoubleDouble::from(0.5)).hi.abs() < 1e-31);
    }
}
