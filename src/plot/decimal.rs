//! Decimal numbers without superfluous digits.

/// The value with at most this many decimals; no trailing zeros, and no minus before zero.
pub fn trimmed_decimal(value: f64, places: usize) -> String {
    let text = format!("{value:.places$}");
    let short = match text.contains('.') {
        true => text.trim_end_matches('0').trim_end_matches('.'),
        false => &text,
    };
    match short {
        "-0" => "0".to_owned(),
        _ => short.to_owned(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_that_says_nothing() {
        for (value, places, text) in [
            (1.5, 3, "1.5"),
            (-0.0004, 3, "0"),
            (100.0, 0, "100"),
            (100.0, 2, "100"),
            (-2.25, 1, "-2.2"),
        ] {
            assert_eq!(trimmed_decimal(value, places), text);
        }
    }
}
