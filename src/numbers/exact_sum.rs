//! Exact sums of f64: the same in any order and for any division of the terms.
//!
//! Every f64 is a whole multiple of the smallest one, so a sum is one long whole number (Kulisch, Computer Arithmetic
//! and Validity, chapter 8). It is stored in digits of 32 bits with delayed carries.

use libm::ldexp;

/// Bits of a digit.
const BITS: usize = 32;

/// Digits: 2098 bits of f64, and 64 for as many summands as can be counted.
pub const DIGITS: usize = 68;

/// Exponent of the smallest f64.
const SMALLEST: i32 = -1074;

/// Number of terms after which carries are propagated: before that no digit can overflow.
const MOST_WAITING: u32 = 1 << 30;

/// Bits of the mantissa that are stored.
const FRACTION: u32 = 52;

/// An exact sum.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExactSum {
    /// The lowest first; the highest one has the sign.
    digits: [i64; DIGITS],
    waiting: u32,
    /// Number of terms that are NaN or infinite: there is no sum then.
    unbounded: u64,
}

impl Default for ExactSum {
    fn default() -> Self {
        Self {
            digits: [0; DIGITS],
            waiting: 0,
            unbounded: 0,
        }
    }
}

impl ExactSum {
    /// Numbers that [`record`](Self::record) takes.
    pub const WIDTH: usize = DIGITS + 1;

    /// Adds a number.
    pub fn add(&mut self, value: f64) {
        if !value.is_finite() {
            self.unbounded += 1;
            return;
        }
        let bits = value.to_bits();
        let exponent = (bits >> FRACTION) as usize & 0x7ff;
        let fraction = bits & ((1 << FRACTION) - 1);
        // Below the smallest normal number there is no leading one.
        let hidden = u64::from(exponent > 0) << FRACTION;
        let place = exponent.max(1) - 1;
        let shifted = u128::from(fraction | hidden) << (place % BITS);
        let sign = if value < 0.0 { -1 } else { 1 };
        for (k, digit) in self.digits[place / BITS..].iter_mut().take(3).enumerate() {
            *digit += sign * i64::from((shifted >> (BITS * k)) as u32);
        }
        self.waiting += 1;
        if self.waiting == MOST_WAITING {
            self.carry();
        }
    }

    /// Adds another sum.
    pub fn join(&mut self, mut other: Self) {
        other.carry();
        self.carry();
        for (own, digit) in self.digits.iter_mut().zip(other.digits) {
            *own += digit;
        }
        self.unbounded += other.unbounded;
        self.carry();
    }

    /// Propagates carries: all digits but the highest become non-negative, with 32 bits.
    fn carry(&mut self) {
        let mut carried = 0;
        for (k, digit) in self.digits.iter_mut().enumerate() {
            *digit += carried;
            if k + 1 < DIGITS {
                carried = *digit >> BITS;
                *digit &= (1 << BITS) - 1;
            }
        }
        self.waiting = 0;
    }

    /// The sum, rounded once; NaN if a term was NaN or infinite.
    pub fn value(&self) -> f64 {
        if self.unbounded > 0 {
            return f64::NAN;
        }
        let mut sum = self.clone();
        sum.carry();
        let is_negative = sum.digits[DIGITS - 1] < 0;
        if is_negative {
            sum.digits.iter_mut().for_each(|digit| *digit = -*digit);
            sum.carry();
        }
        let Some(highest) = sum.digits.iter().rposition(|digit| *digit != 0) else {
            return 0.0;
        };
        // Three digits contain more bits than f64; of the others it only matters whether they are zero.
        let lowest = highest.saturating_sub(2);
        let digits = sum.digits[lowest..=highest].iter().rev();
        let leading = digits.fold(0u128, |all, digit| all << BITS | *digit as u128);
        let is_more = sum.digits[..lowest].iter().any(|digit| *digit != 0);
        let rounded = (leading << 1 | u128::from(is_more)) as f64;
        let value = ldexp(rounded, (BITS * lowest) as i32 + SMALLEST - 1);
        if is_negative { -value } else { value }
    }

    /// The sum as whole numbers that f64 holds; the same for equal sums.
    pub fn record(&self) -> Vec<f64> {
        let mut sum = self.clone();
        sum.carry();
        let digits = sum.digits.iter().map(|digit| *digit as f64);
        digits.chain([self.unbounded as f64]).collect()
    }

    /// The sum from such numbers; `None` if they are invalid.
    pub fn of_record(record: &[f64]) -> Option<Self> {
        let (digits, unbounded) = record.split_first_chunk::<DIGITS>()?;
        let [unbounded] = unbounded else { return None };
        let is_whole = |v: &f64| v.fract() == 0.0 && v.abs() < (1u64 << 53) as f64;
        record.iter().all(is_whole).then(|| Self {
            digits: digits.map(|digit| digit as i64),
            waiting: 0,
            unbounded: *unbounded as u64,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn numbers() -> Vec<f64> {
        let value = |k: u32| {
            let sign = if k.is_multiple_of(3) { -1.0 } else { 1.0 };
            sign * f64::from(k * k % 977 + 1) * 2.0_f64.powi((k * 37 % 120) as i32 - 60) / 3.0
        };
        (0..4000).map(value).collect()
    }

    fn sum(values: &[f64]) -> ExactSum {
        let mut sum = ExactSum::default();
        values.iter().for_each(|v| sum.add(*v));
        sum
    }

    /// Against whole numbers of 128 bits: multiples of 2^-100 below 2^27.
    #[test]
    fn sums_are_those_of_big_integers() {
        let value =
            |k: u64| ((k * k * 7919) % 1_000_003) as f64 * 2.0_f64.powi(-40 - (k % 25) as i32);
        let values: Vec<f64> = (0..3000)
            .map(|k| {
                if k % 2 == 0 {
                    value(k)
                } else {
                    -value(k) / 3.0
                }
            })
            .collect();
        let unit = 2.0_f64.powi(-118);
        let exact: i128 = values.iter().map(|v| (v / unit) as i128).sum();
        // `as` rounds to the nearest, ties to even.
        assert_eq!(sum(&values).value(), exact as f64 * unit);
    }

    #[test]
    fn neither_order_nor_division_matters_and_nothing_is_lost() {
        let mut values = numbers();
        let whole = sum(&values);
        values.reverse();
        assert_eq!(sum(&values).record(), whole.record());
        for cut in [1, 7, 64, 3999] {
            let mut joined = ExactSum::default();
            for part in values.chunks(cut) {
                joined.join(ExactSum::of_record(&sum(part).record()).unwrap());
            }
            assert_eq!(joined.record(), whole.record());
            assert_eq!(joined.value().to_bits(), whole.value().to_bits());
        }
        let negated: Vec<f64> = values.iter().map(|v| -v).collect();
        assert_eq!(sum(&negated).value(), -whole.value());
        values.extend(negated);
        values.push(1e-300);
        assert_eq!(sum(&values).value(), 1e-300);
    }

    #[test]
    fn ends_of_the_range_are_kept() {
        let ends = [f64::MAX, f64::MIN_POSITIVE, 5e-324, -f64::MAX, 5e-324];
        assert_eq!(sum(&ends).value(), f64::MIN_POSITIVE + 1e-323);
        assert_eq!(sum(&[f64::MAX; 4]).value(), f64::INFINITY);
        assert_eq!(sum(&[f64::MAX, f64::MAX, -f64::MAX]).value(), f64::MAX);
        assert_eq!(sum(&[]).value(), 0.0);
        // Half a unit in the last place: to even, and up as soon as there is anything more.
        let half = f64::EPSILON / 2.0;
        assert_eq!(sum(&[1.0, half]).value(), 1.0);
        assert_eq!(sum(&[1.0, half, 5e-324]).value(), 1.0 + f64::EPSILON);
        assert!(sum(&[1.0, f64::NAN]).value().is_nan());
        assert!(ExactSum::of_record(&[0.5; ExactSum::WIDTH]).is_none());
    }
}
