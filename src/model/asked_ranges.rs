//! Ranges of the numbers that a caller may ask for, on the command line and in the library.

use crate::diag::shown_number;
use std::ops::RangeInclusive;

/// Positive numbers.
pub const POSITIVE: RangeInclusive<f64> = f64::MIN_POSITIVE..=f64::MAX;

/// Agreement of a clearance with its bound: a millionth of a thousandth is less than rounding leaves.
pub const AGREEMENT: RangeInclusive<f64> = 1e-9..=1.0;

/// Tolerances of dimensions, in the scene's unit: more than any mechanism measures.
pub const TOLERANCE: RangeInclusive<f64> = f64::MIN_POSITIVE..=1e9;

/// Share of its value by which a variable may change: what is more is no change of a dimension any more.
pub const WITHIN: RangeInclusive<f64> = f64::MIN_POSITIVE..=1e3;

/// Relative accuracy of a search.
pub const ACCURACY: RangeInclusive<f64> = f64::MIN_POSITIVE..=1.0;

/// The range in words, without "must be": `positive`, `positive and at most 1000`, `between 1e-9 and 1`.
pub fn range_words(range: &RangeInclusive<f64>) -> String {
    let [low, high] = [*range.start(), *range.end()].map(shown_number);
    match (
        *range.start() == f64::MIN_POSITIVE,
        *range.end() == f64::MAX,
    ) {
        (true, true) => "positive".to_owned(),
        (true, false) => format!("positive and at most {high}"),
        _ => format!("between {low} and {high}"),
    }
}
