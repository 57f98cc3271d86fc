//! Bounds in few digits: printed bounds are rounded to the safe side.

use super::cells::six_digits;

/// Tries until the decimal is on the safe side: one is enough unless f64 itself rounds.
const TRIES: u32 = 4;

/// An upper bound with two digits: `6.3e-14` of 6.21e-14.
pub fn at_most(value: f64) -> String {
    let unit = last_digit(value);
    safe_text(value, unit, |v| format!("{v:.1e}"))
}

/// An upper bound with three digits.
pub fn at_most_three(value: f64) -> String {
    let unit = 0.1 * last_digit(value);
    safe_text(value, unit, |v| format!("{v:.2e}"))
}

/// A lower bound with three digits.
pub fn at_least_three(value: f64) -> String {
    let unit = 0.1 * last_digit(value);
    safe_text(value, -unit, |v| format!("{v:.2e}"))
}

/// An upper bound with six digits, as tables show numbers.
pub fn at_most_six(value: f64) -> String {
    safe_text(value, 1e-4 * last_digit(value), six_digits)
}

/// A lower bound with six digits, as tables show numbers.
pub fn at_least_six(value: f64) -> String {
    safe_text(value, -1e-4 * last_digit(value), six_digits)
}

/// A lower bound: two digits of small ones, else three decimals.
pub fn at_least(value: f64) -> String {
    if value.abs() < 0.01 {
        let unit = last_digit(value);
        safe_text(value, -unit, |v| format!("{v:.1e}"))
    } else {
        not_below(value, 3)
    }
}

/// A lower bound with so many decimals.
pub fn not_below(value: f64, decimals: usize) -> String {
    let unit = 0.1_f64.powi(decimals as i32);
    safe_text(value, -unit, |v| format!("{v:.decimals$}"))
}

/// An upper bound with so many decimals.
pub fn not_above(value: f64, decimals: usize) -> String {
    let unit = 0.1_f64.powi(decimals as i32);
    safe_text(value, unit, |v| format!("{v:.decimals$}"))
}

/// The value of a unit in the second digit.
fn last_digit(value: f64) -> f64 {
    match libm::log10(value.abs()).floor() {
        power if power.is_finite() => 10.0_f64.powi(power as i32 - 1),
        _ => 0.0,
    }
}

/// The decimal number that `text` makes of `value`, or of a number half a `unit` farther on its side.
fn safe_text(value: f64, unit: f64, text: impl Fn(f64) -> String) -> String {
    let is_safe = |text: &str| {
        let read = text.parse::<f64>().unwrap_or(value);
        if unit < 0.0 {
            read <= value
        } else {
            read >= value
        }
    };
    let tries = (0..TRIES).map(|k| text(value + 0.5 * f64::from(k) * unit));
    let mut last = String::new();
    for tried in tries {
        if is_safe(&tried) {
            return tried;
        }
        last = tried;
    }
    last
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn bounds_stay_bounds_in_few_digits() {
        for k in 0..2000 {
            let value = 1.037_f64.powi(k - 1000) * (1.0 + f64::from(k) * 1e-3);
            let read = |text: String| text.parse::<f64>().unwrap();
            for (upper, most) in [(at_most(value), 1.1), (at_most_three(value), 1.01)] {
                let upper = read(upper);
                assert!(
                    upper >= value && upper <= value * most,
                    "{value:e} {upper:e}"
                );
            }
            for signed in [value, -value] {
                let [below, above] = [at_least_six(signed), at_most_six(signed)].map(read);
                assert!(below <= signed && signed <= above, "{below:e} {above:e}");
                assert!(above - below <= 1.1e-5 * value, "{below:e} {above:e}");
            }
            let lower = read(at_least(value));
            assert!(
                lower <= value && lower >= value * 0.9,
                "{value:e} {lower:e}"
            );
            let above = read(not_above(value, 4));
            assert!(
                above >= value && above <= value + 1.1e-4_f64.max(value * 1e-15),
                "{value:e} {above:e}"
            );
            let below = read(not_below(-value, 4));
            assert!(
                below <= -value && below >= -value - 1.1e-4,
                "{value:e} {below:e}"
            );
        }
        assert_eq!(at_most(6.21e-14), "6.3e-14");
        assert_eq!(at_most(2e-14), "2.0e-14");
        assert_eq!(at_most(0.0), "0.0e0");
        assert_eq!(not_below(0.49999, 4), "0.4999");
        assert_eq!(not_below(0.5, 4), "0.5000");
        assert_eq!(at_least(f64::INFINITY), "inf");
    }
}
