//! Decimal numbers as typed, to all digits that the sum of two f64 can represent.

use super::Constant;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{LONG_OPERATION, SMALLEST, of_decimal};

/// Digits that are read individually; later ones become part of the error.
const MOST_DIGITS: usize = 31;

/// Powers of ten that f64 has.
const LARGEST_POWER: u32 = 22;

/// Powers of ten beyond this are read as this one: with as many digits as a text has, they stay beyond all numbers.
const FARTHEST_POWER: i32 = 1_000_000_000;

/// For decimals beyond this, the second part of the sum would underflow or overflow.
const LONG_RANGE: std::ops::Range<f64> = 1e-270..1e270;

/// The digits of a decimal: a whole number, its power of ten, and whether digits were omitted.
struct Digits {
    whole: u128,
    power: i32,
    is_cut: bool,
}

impl Digits {
    /// `None` if `text` is not a decimal of digits, one point and a power of ten.
    fn read(text: &str) -> Option<Self> {
        let (mantissa, power) = match text.split_once(['e', 'E']) {
            Some((mantissa, power)) => (mantissa, Self::read_power(power)?),
            None => (text, 0),
        };
        let (before, after) = mantissa.split_once('.').unwrap_or((mantissa, ""));
        let mut digits = Self {
            whole: 0,
            power,
            is_cut: false,
        };
        let mut count = 0;
        for (digit, is_after) in before
            .bytes()
            .map(|d| (d, false))
            .chain(after.bytes().map(|d| (d, true)))
        {
            if !digit.is_ascii_digit() {
                return None;
            }
            let value = u128::from(digit - b'0');
            // Digits before the point extend the number; digits after it also lower the power of ten.
            if count < MOST_DIGITS {
                digits.whole = digits.whole * 10 + value;
                count += usize::from(digits.whole > 0);
                digits.power -= i32::from(is_after);
            } else {
                digits.is_cut |= value != 0;
                digits.power += i32::from(!is_after);
            }
        }
        Some(digits)
    }

    /// A power of ten; of one beyond all numbers nothing but its sign matters.
    fn read_power(text: &str) -> Option<i32> {
        let digits = text.strip_prefix(['+', '-']).unwrap_or(text);
        let is_whole = !digits.is_empty() && digits.bytes().all(|d| d.is_ascii_digit());
        let size = is_whole.then(|| digits.parse().unwrap_or(FARTHEST_POWER))?;
        let size = FARTHEST_POWER.min(size);
        Some(if text.starts_with('-') { -size } else { size })
    }
}

impl Constant {
    /// The unsigned decimal in `text`; `None` if it is not one, or out of the range of f64.
    pub fn decimal(text: &str) -> Option<Self> {
        let number = text.parse::<f64>().ok().filter(|v| v.is_finite())?;
        let read = Digits::read(text)?;
        if read.whole == 0 {
            return Some(Self::exact(0.0));
        }
        if !LONG_RANGE.contains(&number) {
            return Some(Self::within(number, of_decimal(number) + SMALLEST));
        }
        let hi = read.whole as f64;
        // Both parts of a whole number below 2^106 are exact.
        let lo = (read.whole as i128 - hi as i128) as f64;
        let mut value = Self::exact(hi) + Self::exact(lo);
        value.error = if read.is_cut {
            LONG_OPERATION * hi
        } else {
            0.0
        };
        let mut left = read.power.unsigned_abs();
        while left > 0 {
            let step = left.min(LARGEST_POWER);
            let ten = Self::exact(10.0_f64.powi(step as i32));
            value = if read.power < 0 {
                value / ten
            } else {
                value * ten
            };
            left -= step;
        }
        // The parser of f64 determines the nearest f64.
        let rest = value.value - DoubleDouble::from(number);
        Some(Self {
            value: DoubleDouble::ordered(number, rest.hi),
            error: value.error + rest.lo.abs(),
        })
    }
}
