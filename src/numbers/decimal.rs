//! Numbers as decimal text: with so many decimals or digits, without superfluous zeros, with a real minus sign; and
//! numbers without the digits that only a conversion adds.

/// The sign of negative numbers in pictures, as wide as a plus.
pub const MINUS: char = '\u{2212}';

/// Magnitudes that are written without an exponent in a few digits.
const PLAIN: std::ops::Range<f64> = 1e-3..1e6;

/// The value with this many decimals, and no minus before zero.
pub fn fixed(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| matches!(b, b'0' | b'.')) => digits.to_owned(),
        _ => text,
    }
}

/// The value with at most this many decimals; no trailing zeros, and no minus before zero.
pub fn trimmed(value: f64, places: usize) -> String {
    let text = fixed(value, places);
    match text.contains('.') {
        true => without_zeros(&text).to_owned(),
        false => text,
    }
}

/// The value with this many significant digits, in scientific notation if it is small or large.
pub fn significant(value: f64, digits: usize) -> String {
    let behind_first = digits.saturating_sub(1);
    if value == 0.0 {
        "0".to_owned()
    } else if PLAIN.contains(&value.abs()) {
        // Digits before the point are all written, however few were asked for.
        let places = behind_first as i32 - libm::floor(libm::log10(value.abs())) as i32;
        fixed(value, places.max(0) as usize)
    } else {
        format!("{value:.behind_first$e}")
    }
}

/// The same without trailing zeros.
pub fn shortened(value: f64, digits: usize) -> String {
    let text = significant(value, digits);
    let (number, exponent) = text.split_at(text.find('e').unwrap_or(text.len()));
    match number.contains('.') {
        true => format!("{}{exponent}", without_zeros(number)),
        false => text,
    }
}

/// A decimal without the zeros that end its fraction.
fn without_zeros(decimal: &str) -> &str {
    decimal.trim_end_matches('0').trim_end_matches('.')
}

/// The number nearest to the value among those with this many digits.
pub fn rounded_to(value: f64, digits: usize) -> f64 {
    let behind_first = digits.saturating_sub(1);
    let text = format!("{value:.behind_first$e}");
    text.parse().unwrap_or(value)
}

/// A number's text with a real minus sign, also in its exponent.
pub fn with_minus(text: &str) -> String {
    let real = |c| if c == '-' { MINUS } else { c };
    text.chars().map(real).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_that_says_nothing() {
        for (value, places, whole, short) in [
            (1.5, 3, "1.500", "1.5"),
            (-0.0004, 3, "0.000", "0"),
            (-0.0, 0, "0", "0"),
            (100.0, 0, "100", "100"),
            (100.0, 2, "100.00", "100"),
            (-2.25, 1, "-2.2", "-2.2"),
            (f64::NEG_INFINITY, 2, "-inf", "-inf"),
        ] {
            assert_eq!(fixed(value, places), whole);
            assert_eq!(trimmed(value, places), short);
        }
    }

    #[test]
    fn digits_are_counted_from_the_first() {
        for (value, digits, text) in [
            (0.0, 3, "0"),
            (1.0, 3, "1.00"),
            (-0.0123456, 3, "-0.0123"),
            (123456.7, 3, "123457"),
            (6.5e-5, 3, "6.50e-5"),
            (6.5e7, 6, "6.50000e7"),
            (120.0, 1, "120"),
            (f64::NAN, 2, "NaN"),
        ] {
            assert_eq!(significant(value, digits), text);
        }
        for (value, text) in [
            (48.590377890, "48.5904"),
            (-0.125, "-0.125"),
            (1_234_567.0, "1.23457e6"),
            (2.5e-10, "2.5e-10"),
            (120.0, "120"),
            (0.0, "0"),
        ] {
            assert_eq!(shortened(value, 6), text);
        }
        assert_eq!(with_minus(&significant(-6.5e-5, 2)), "−6.5e−5");
        assert_eq!(rounded_to(0.1 + 0.2, 15), 0.3);
        assert_eq!(rounded_to(-123_456.7, 3), -123_000.0);
    }
}
