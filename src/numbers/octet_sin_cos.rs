//! Sine and cosine of eight angles at once.
//!
//! The nearest multiple of π/2 is subtracted in three parts (Cody and Waite, Software Manual for the Elementary
//! Functions); the rest is the argument of the minimax polynomials of FreeBSD's msun for -π/4 to π/4, which libm also
//! uses. The error is below one unit in the last place, as there; the last bit may differ.

use super::sin_cos::ROUNDING;
use wide::{f64x8, u64x8};

/// Angles up to this are reduced without loss: their multiples of π/2 have at most 20 bits.
const LARGEST: f64 = 1e6;

const PER_QUARTER: f64 = std::f64::consts::FRAC_2_PI;

/// π/2 as two parts of 33 bits and the rest, by their bits.
const QUARTER: [f64; 3] = [
    f64::from_bits(0x3FF9_21FB_5440_0000),
    f64::from_bits(0x3DD0_B461_1A60_0000),
    f64::from_bits(0x3BA3_198A_2E03_7073),
];

/// Coefficients of x³ to x¹³.
const SINE: [f64; 6] = [
    f64::from_bits(0xBFC5_5555_5555_5549),
    f64::from_bits(0x3F81_1111_1110_F8A6),
    f64::from_bits(0xBF2A_01A0_19C1_61D5),
    f64::from_bits(0x3EC7_1DE3_57B1_FE7D),
    f64::from_bits(0xBE5A_E5E6_8A2B_9CEB),
    f64::from_bits(0x3DE5_D93A_5ACF_D57C),
];

/// Coefficients of x⁴ to x¹⁴.
const COSINE: [f64; 6] = [
    f64::from_bits(0x3FA5_5555_5555_554C),
    f64::from_bits(0xBF56_C16C_16C1_5177),
    f64::from_bits(0x3EFA_01A0_19CB_1590),
    f64::from_bits(0xBE92_7E4F_809C_52AD),
    f64::from_bits(0x3E21_EE9E_BDB4_B1C4),
    f64::from_bits(0xBDA8_FAE9_BE88_38D4),
];

/// Sine and cosine.
#[inline]
pub(super) fn sin_cos(x: f64x8) -> (f64x8, f64x8) {
    let number = |value: f64| f64x8::splat(value);
    let sum = x * number(PER_QUARTER) + number(ROUNDING);
    let count = sum - number(ROUNDING);
    // x - count · π/2, with the rounding error of the difference.
    let first = x - count * number(QUARTER[0]);
    let by = count * number(QUARTER[1]);
    let second = first - by;
    let by = count * number(QUARTER[2]) - ((first - second) - by);
    let rest = second - by;
    let tail = (second - rest) - by;
    let square = rest * rest;
    let (sine, cosine) = (sine_of(rest, tail, square), cosine_of(rest, tail, square));
    // Every quarter turn exchanges the two, every half turn changes the signs.
    let quarters = sum.to_bits();
    let one = u64x8::splat(1);
    let is_odd = f64x8::from_bits(u64x8::splat(0) - (quarters & one));
    let sign = |quarters: u64x8| f64x8::from_bits((quarters & u64x8::splat(2)) << 62_u32);
    let sin = is_odd.bitselect(cosine, sine) ^ sign(quarters);
    let cos = is_odd.bitselect(sine, cosine) ^ sign(quarters + one);
    if !x.abs().simd_le(number(LARGEST)).all() {
        return with_large(x, sin, cos);
    }
    (sin, cos)
}

/// The same, with separate handling of angles that are too large for three parts and of NaN.
#[cold]
fn with_large(angles: f64x8, sin: f64x8, cos: f64x8) -> (f64x8, f64x8) {
    let (mut sin, mut cos) = (sin.to_array(), cos.to_array());
    let parts = sin.iter_mut().zip(&mut cos);
    for (angle, (sin, cos)) in angles.to_array().into_iter().zip(parts) {
        // False for what is no number.
        let is_small = angle.abs() <= LARGEST;
        if !is_small {
            (*sin, *cos) = libm::sincos(angle);
        }
    }
    (f64x8::new(sin), f64x8::new(cos))
}

/// Sine of `x` + `tail`.
#[inline(always)]
fn sine_of(x: f64x8, tail: f64x8, square: f64x8) -> f64x8 {
    let [s1, s2, s3, s4, s5, s6] = SINE.map(f64x8::splat);
    let high = s2 + square * (s3 + square * s4) + square * (square * square) * (s5 + square * s6);
    let cube = square * x;
    x - ((square * (tail * f64x8::splat(0.5) - cube * high) - tail) - cube * s1)
}

/// Cosine of `x` + `tail`.
#[inline(always)]
fn cosine_of(x: f64x8, tail: f64x8, square: f64x8) -> f64x8 {
    let [c1, c2, c3, c4, c5, c6] = COSINE.map(f64x8::splat);
    let fourth = square * square;
    let high = square * (c1 + square * (c2 + square * c3))
        + fourth * fourth * (c4 + square * (c5 + square * c6));
    let half = square * f64x8::splat(0.5);
    let one = f64x8::splat(1.0);
    let whole = one - half;
    whole + (((one - whole) - half) + (square * high - x * tail))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Units in the last place by which two numbers differ.
    fn apart(a: f64, b: f64) -> f64 {
        (a - b).abs() / (f64::EPSILON * b.abs().max(f64::MIN_POSITIVE))
    }

    #[test]
    fn angles_of_all_sizes_have_the_sine_and_the_cosine_that_libm_gives() {
        let mut worst = 0.0_f64;
        for step in 0..40_000 {
            let size = 10.0_f64.powi(step % 9 - 3);
            let angle = |k: usize| size * (0.37 * f64::from(step) + 1.3 * k as f64).sin();
            let angles: [f64; 8] = std::array::from_fn(angle);
            let (sin, cos) = sin_cos(f64x8::new(angles));
            let (sin, cos) = (sin.to_array(), cos.to_array());
            for k in 0..8 {
                let (s, c) = libm::sincos(angles[k]);
                worst = worst.max(apart(sin[k], s)).max(apart(cos[k], c));
            }
        }
        // Both are off by less than one unit, half of one mostly.
        assert!(worst <= 1.0, "{worst}");
    }

    #[test]
    fn what_is_beyond_is_left_to_libm_and_next_to_axes_no_digit_is_lost() {
        let quarter = std::f64::consts::FRAC_PI_2;
        let angles = [
            0.0,
            -0.0,
            1e9,
            f64::NAN,
            f64::INFINITY,
            quarter,
            -quarter * 7.0,
            628_318.530_717_958_6,
        ];
        let (sin, cos) = sin_cos(f64x8::new(angles));
        let (sin, cos) = (sin.to_array(), cos.to_array());
        for (k, angle) in angles.into_iter().enumerate() {
            let (s, c) = libm::sincos(angle);
            if s.is_nan() {
                assert!(sin[k].is_nan() && cos[k].is_nan());
                continue;
            }
            assert!(
                apart(sin[k], s) <= 1.0 && apart(cos[k], c) <= 1.0,
                "{angle}"
            );
            assert_eq!(sin[k].is_sign_negative(), s.is_sign_negative());
        }
    }
}
