//! How large the numbers of a mechanism and of its bodies may be.

use crate::diag::{Diagnostic, Span, shown_number};

/// Largest fixed length or angle of a chain, and largest number of a body. Lengths are squared, and the squares multiplied; a
/// fourth power must stay finite, with room for sums.
pub const LARGEST: f64 = 1e60;

/// `value`, unless it is beyond [`LARGEST`].
///
/// # Errors
/// The message for the text at `span`.
pub fn computable<T>(value: T, number: impl Fn(&T) -> f64, span: &Span) -> Result<T, Diagnostic> {
    let size = number(&value);
    match size.abs() > LARGEST {
        false => Ok(value),
        true => Err(Diagnostic::error(format!(
            "{} is beyond what can be computed with",
            shown_number(size)
        ))
        .at(span.clone())
        .hint(format!("at most {LARGEST:e}: choose a larger unit"))),
    }
}
