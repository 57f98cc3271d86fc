//! Limits on the numbers of a mechanism and of its bodies.

use crate::diag::{Diagnostic, Span, shown_number};

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
