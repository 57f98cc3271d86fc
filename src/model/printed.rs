//! Numbers as tables print them: in the scene's unit, as the shortest decimal that reads back as the same f64.
//!
//! A table's `40` degrees is not the f64 used in computations. Bounds next to printed numbers include the difference:
//! for an input all its digits ([`printing_error`]), for everything else a bound ([`printing_unit`]).

use crate::numbers::constant::Constant;
use crate::numbers::decimal::rounded_to;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{GROW, SMALLEST, U};
use std::fmt::Write;

/// The meaning of a sample's inputs when its pose is proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum InputReading {
    /// The f64 themselves, in radians: for those who compute with them.
    Numbers,
    /// The decimals that a table prints: for those who read it.
    Decimals,
}

/// The f64 of a table; `unit` is the factor from the scene's unit to internal values.
pub fn in_unit(value: f64, unit: Constant) -> f64 {
    value * (1.0 / unit.number())
}

/// Numbers below the first are rounded to the second part of one: at most fifteen digits, the quotient of whole numbers that f64 has.
const TYPED: [[f64; 2]; 2] = [[1e3, 1e12], [1e6, 1e9]];

/// The f64 of a table for an input: as a person would have typed it, if that is read as the value again, up to the last place.
pub fn typed_in_unit(value: f64, unit: Constant) -> f64 {
    let factor = unit.number();
    let shown = in_unit(value, unit);
    let part = TYPED.iter().find(|[below, _]| shown.abs() < *below);
    let Some([_, part]) = part.filter(|_| factor != 1.0) else {
        return shown;
    };
    let short = libm::round(shown * part) / part;
    let read = short * factor;
    match read.next_down() <= value && value <= read.next_up() {
        true => short,
        false => shown,
    }
}

/// A number as a person would have typed it, without the rounding errors of conversions of its unit.
pub fn as_typed(value: f64) -> f64 {
    rounded_to(value, 14)
}

/// The shortest decimal that reads back as the same number.
pub fn shortest_decimal(value: f64) -> String {
    let mut text = String::with_capacity(LONGEST_DECIMAL);
    push_shortest_decimal(&mut text, value);
    text
}

/// The same, appended to a text, so that a row of numbers needs no further allocations.
pub fn push_shortest_decimal(text: &mut String, value: f64) {
    let magnitude = value.abs();
    let is_far = magnitude != 0.0 && !(1e-4..1e15).contains(&magnitude) && value.is_finite();
    let mut buffer = zmij::Buffer::new();
    // Three times as fast as the standard library, and as short; exponents above zero are spelled otherwise.
    match buffer.format(value) {
        digits if is_far && digits.contains("e-") => text.push_str(digits),
        digits if !is_far && !digits.contains('e') => {
            text.push_str(digits.strip_suffix(".0").unwrap_or(digits));
        }
        _ => push_decimal_plainly(text, value, is_far),
    }
}

/// The same by the standard library.
fn push_decimal_plainly(text: &mut String, value: f64, is_far: bool) {
    // Writing into a text cannot fail.
    let _ = match is_far {
        true => write!(text, "{value:e}"),
        false => write!(text, "{value}"),
    };
}

/// Sign, point, exponent, and seventeen digits.
const LONGEST_DECIMAL: usize = 24;

/// The decimal that is printed for an input, minus its `value`; zero for NaN and infinities.
pub fn printing_error(value: f64, unit: Constant) -> f64 {
    let printed = typed_in_unit(value, unit);
    let Some(size) = Constant::decimal(&shortest_decimal(printed.abs())) else {
        return 0.0;
    };
    let meant = if printed < 0.0 { -size } else { size } * unit;
    (meant - Constant::exact(value)).number()
}

/// Bound on the difference between the printed decimal and a `value` that is no input: the error of the conversion, and half a unit in the
/// last place of the decimal.
pub fn printing_unit(value: f64, unit: Constant) -> f64 {
    let converted = unit.value() * in_unit(value, unit) - DoubleDouble::from(value);
    (converted.hi.abs() + U * value.abs() + SMALLEST) * GROW
}

/// Bound on the difference between the decimal printed for an input and its `value`: as above, and one unit in the last place more
/// for what is left out as nobody would have typed it.
pub fn input_rounding(value: f64, unit: Constant) -> f64 {
    let typed = match unit.number() {
        1.0 => 0.0,
        _ => 3.0 * U * value.abs(),
    };
    (printing_unit(value, unit) + typed) * GROW
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn numbers_read_back_exactly() {
        for value in [
            0.0,
            -0.1,
            1e-17,
            112.77081077023263,
            6.02e23,
            f64::MIN_POSITIVE,
            -1.5e15,
        ] {
            assert_eq!(shortest_decimal(value).parse::<f64>().unwrap(), value);
        }
    }

    /// All exponents, all signs, and numbers of few digits; the ends of the range without an exponent.
    #[test]
    fn decimals_are_as_short_as_those_of_the_standard_library() {
        let ends = [1e-5, 1e-4, 1e15, 1e16, 123.0, -0.0, f64::NAN, f64::INFINITY];
        let beside = ends.map(f64::next_down).into_iter();
        let mut state = 0x9E37_79B9_7F4A_7C15_u64;
        let random = (0..200_000).map(|k| {
            state ^= state << 13;
            state ^= state >> 7;
            state ^= state << 17;
            match k % 3 {
                0 => f64::from_bits(state),
                1 => (state % 100_000) as f64 / 1e3,
                _ => (state as i64) as f64 * 2.0_f64.powi(-(k % 100)),
            }
        });
        for value in ends.into_iter().chain(beside).chain(random) {
            let far = value.is_finite() && value != 0.0 && !(1e-4..1e15).contains(&value.abs());
            let mut plain = String::new();
            push_decimal_plainly(&mut plain, value, far);
            // Of two decimals equally near the last digit may be either.
            let own = shortest_decimal(value);
            let is_tie = own.len() == plain.len() && own.parse() == Ok(value);
            assert!(own == plain || is_tie, "{own} {plain}");
        }
    }

    /// What a person typed in degrees is printed again; other numbers are not rounded.
    #[test]
    fn inputs_are_printed_as_typed() {
        let degree = Constant::PI / Constant::exact(180.0);
        for tenths in -100_000..100_000 {
            let typed = f64::from(tenths) / 10.0;
            for factor in [degree.number(), 1.0 / (1.0 / degree.number())] {
                assert_eq!(typed_in_unit(typed * factor, degree), typed);
            }
        }
        for value in [1.0, 0.123456789, 1e-20, 7e8] {
            assert_eq!(typed_in_unit(value, degree), in_unit(value, degree));
            assert_eq!(typed_in_unit(value, Constant::exact(1.0)), value);
        }
    }

    /// The rest is that of 31 digits, and never above its bound, which is met. That of an input is at most one unit more.
    #[test]
    fn what_printing_leaves_out_is_known() {
        let degree = Constant::PI / Constant::exact(180.0);
        let mut closest = [0.0_f64; 2];
        for (k, unit) in [Constant::exact(1.0), degree].into_iter().enumerate() {
            for step in -500..500 {
                let value = f64::from(step) * 0.0137;
                let printed = Constant::decimal(&shortest_decimal(in_unit(value, unit).abs()));
                let rest = (printed.unwrap() * unit - Constant::exact(value.abs())).number();
                let bound = printing_unit(value, unit);
                assert!(rest.abs() <= bound, "{value}: {rest:e} above {bound:e}");
                closest[k] = closest[k].max(rest.abs() / bound);
                assert!(bound <= 6.0 * U * value.abs() + 1e-300);
                let typed = printing_error(value, unit).abs();
                assert!(typed <= input_rounding(value, unit));
            }
        }
        assert!(closest.iter().all(|c| *c > 0.85), "{closest:?}");
        // 40 degrees, computed as anybody would, and the decimal 40.
        let forty = 40.0 * degree.number();
        let meant = (degree * Constant::exact(40.0) - Constant::exact(forty)).number();
        assert_eq!(printing_error(forty, degree), meant);
        assert_eq!(printing_error(0.5, Constant::exact(1.0)), 0.0);
        assert_eq!(printing_error(f64::NAN, degree), 0.0);
    }
}
