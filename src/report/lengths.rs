//! Lengths and their bounds in few digits: with decimals, or in scientific notation if they are too small for decimals.

use super::rounded::{at_least_three, not_below};
use crate::diag::decimals_of;
use crate::numbers::decimal::fixed;

/// Lengths below this share of the mechanism's size are contacts.
pub const CONTACT: f64 = 1e-6;

/// Lengths below this share of the mechanism's size are rounding.
const ROUNDING: f64 = 1e-12;

/// Digits of the largest length that decimals must show.
const LEAST_DIGITS: i32 = 3;

/// A distance of half-spaces that overlap without end.
const ENDLESS: &str = "endless";

/// A distance of two bodies in a table.
pub fn distance_text(distance: f64, decimals: usize) -> String {
    match distance == f64::NEG_INFINITY {
        true => ENDLESS.to_owned(),
        false => decimals_of(distance + 0.0, decimals),
    }
}

/// The same with its unit, in a sentence.
pub fn distance_words(distance: f64, decimals: usize, unit: &str) -> String {
    match distance == f64::NEG_INFINITY {
        true => format!("{ENDLESS} overlap"),
        false => format!("{} {unit}", distance_text(distance, decimals)),
    }
}

/// The form of the lengths of one row or sentence.
#[derive(Clone, Copy, Debug)]
pub struct LengthForm {
    decimals: usize,
    are_small: bool,
    rounding: f64,
}

impl LengthForm {
    /// With this many decimals, unless all `lengths` in a mechanism of this `size` are too small for them and not contacts.
    pub fn of(lengths: &[f64], size: f64, decimals: usize) -> Self {
        let largest = lengths.iter().fold(0.0_f64, |most, v| most.max(v.abs()));
        let least = 10_f64.powi(LEAST_DIGITS - 1 - decimals as i32);
        Self {
            decimals,
            are_small: largest < least && largest > CONTACT * size,
            rounding: ROUNDING * size,
        }
    }

    /// A length.
    pub fn length(self, value: f64) -> String {
        if value == f64::NEG_INFINITY {
            return ENDLESS.to_owned();
        }
        match self.are_small && value.abs() > self.rounding {
            true => format!("{value:.3e}"),
            false => fixed(value, self.decimals),
        }
    }

    /// A lower bound of a length.
    pub fn at_least(self, bound: f64) -> String {
        match self.are_small && bound != 0.0 {
            true => at_least_three(bound),
            false => not_below(bound, self.decimals),
        }
    }
}

/// A lower bound of a length in a mechanism of this `size`, with this many decimals unless it is too small for them.
pub fn at_least_length(bound: f64, size: f64, decimals: usize) -> String {
    LengthForm::of(&[bound], size, decimals).at_least(bound)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lengths of a hand-sized mechanism in millimetres, metres and kilometres.
    #[test]
    fn no_unit_of_length_erases_a_length() {
        for (unit, length, bound) in [
            (1.0, "1.2346", "1.2344"),
            (1e-3, "1.235e-3", "1.23e-3"),
            (1e-6, "1.235e-6", "1.23e-6"),
        ] {
            let (size, lengths) = (300.0 * unit, [1.23456 * unit, 0.5 * unit]);
            let form = LengthForm::of(&lengths, size, 4);
            assert_eq!(form.length(lengths[0]), length);
            assert_eq!(form.at_least(1.23449 * unit), bound);
            assert_eq!(at_least_length(1.23449 * unit, size, 4), bound);
            assert_eq!(form.length(-1e-17 * size), "0.0000");
        }
        // No number is a depth that has none.
        let endless = f64::NEG_INFINITY;
        assert_eq!(
            LengthForm::of(&[endless, 0.1], 1.0, 4).length(endless),
            "endless"
        );
        assert_eq!(distance_words(endless, 4, "mm"), "endless overlap");
        assert_eq!(distance_words(-0.0, 4, "mm"), "0.0000 mm");
        // Contacts are zero, however they are rounded; their bounds stay bounds.
        assert_eq!(LengthForm::of(&[-3e-7], 1.0, 4).length(-3e-7), "0.0000");
        assert_eq!(at_least_length(-3e-7, 1.0, 4), "-0.0001");
    }
}
