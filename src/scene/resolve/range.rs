//! Limits on the numbers of a mechanism and of its bodies, and those of measures.

use crate::diag::{Diagnostic, Span, shown_number};
use crate::scene::values::FormulaText;

/// Largest fixed length or angle of a chain, and largest number of a body. Squares of lengths are multiplied, so a
/// fourth power must be finite, with room for sums.
pub const LARGEST: f64 = 1e60;

/// Rejects a number greater than [`LARGEST`].
///
/// # Errors
/// The message for the text at `span`.
pub fn within_range(value: f64, span: &Span) -> Result<(), Diagnostic> {
    if value.abs() <= LARGEST {
        return Ok(());
    }
    let number = shown_number(value);
    let message = format!("{number} is beyond what can be computed with");
    Err(Diagnostic::error(message)
        .at(span.clone())
        .hint(format!("at most {LARGEST:e}: choose a larger unit")))
}

/// A value in its range; the largest number as an end is none.
///
/// # Errors
/// The message for the text at `span`.
pub fn in_range(
    what: &str,
    value: f64,
    [low, high]: [f64; 2],
    span: &Span,
) -> Result<f64, Diagnostic> {
    if (low..=high).contains(&value) {
        return Ok(value);
    }
    let range = match high == f64::MAX {
        true => format!("at least {low}"),
        false => format!("between {low} and {high}"),
    };
    let message = format!("{what} must be {range}, found {}", shown_number(value));
    Err(Diagnostic::error(message).at(span.clone()))
}

/// Rejects limits that no value keeps; `texts` are those of the ends that stand in one place.
///
/// # Errors
/// The message for the first of them.
pub fn limits_in_order(
    name: &str,
    [min, max]: [Option<f64>; 2],
    texts: &[Option<FormulaText>; 2],
) -> Result<(), Diagnostic> {
    // Equal ones leave a single value.
    let is_kept_by_some = min.zip(max).is_none_or(|(min, max)| min <= max);
    let Some(text) = texts.iter().flatten().next().filter(|_| !is_kept_by_some) else {
        return Ok(());
    };
    let message = format!("no value of `{name}` keeps these limits: `min` is greater than `max`");
    let hint = "`min` is the smallest value allowed, `max` the greatest";
    Err(Diagnostic::error(message).at(text.span.clone()).hint(hint))
}
