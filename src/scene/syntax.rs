//! Parses a TOML text into tables, with all of its syntax errors or, for a long text, only the first: a list of all
//! errors can take a thousand times the memory of the text.

use crate::diag::{Diagnostic, Diagnostics};
use crate::limits::allow_memory;
use toml::de::{DeTable, Error};

/// Texts up to this many bytes are read on after an error. Nobody writes longer ones by hand, and 256 KiB with an error
/// in every byte take a sixth of a second and 100 MB.
const MOST_READ_ON: usize = 256 << 10;

/// Bytes of memory that the parser needs for each word and each punctuation mark of a text: measured, with a margin.
const BYTES_OF_TOKEN: f64 = 110.0;

/// Parses the tables of a text; `None` if syntax errors, which go to `diagnostics`, or the limit of memory prevent it.
pub fn parse_tables<'t>(
    text: &'t str,
    diagnostics: &mut Diagnostics,
) -> Option<toml::Spanned<DeTable<'t>>> {
    let tokens = most_tokens(text) as f64;
    if let Err(limit) = allow_memory(tokens * BYTES_OF_TOKEN, &"reading the text") {
        diagnostics.push(Diagnostic::error(limit.to_string()));
        return None;
    }
    let first = match DeTable::parse(text) {
        Ok(tables) => return Some(tables),
        Err(first) => first,
    };
    if text.len() <= MOST_READ_ON {
        let (_, errors) = DeTable::parse_recoverable(text);
        let each = errors.iter().map(|error| mistake(text, error));
        each.for_each(|one| diagnostics.push(one));
    } else {
        let hint = "more may follow: of a text of this size only the first mistake is shown";
        diagnostics.push(mistake(text, &first).hint(hint));
    }
    None
}

fn mistake(text: &str, error: &Error) -> Diagnostic {
    let message = format!("not valid TOML: {}", error.message());
    let span = error.span().unwrap_or(text.len()..text.len());
    let word = text.get(span.clone()).unwrap_or_default();
    let diagnostic = Diagnostic::error(message).at(span);
    // `30mm`, `90deg`, `2*pi`
    match word.starts_with(|first: char| first.is_ascii_digit()) {
        true => diagnostic.hint("a value that is more than a number is a formula, and stands in quotes: \"2*pi\", \"90deg\"; lengths have no unit"),
        false => diagnostic,
    }
}

/// An upper bound on the number of words and punctuation marks of a text.
fn most_tokens(text: &str) -> usize {
    let is_word =
        |byte: &u8| byte.is_ascii_alphanumeric() || matches!(byte, b'_' | b'-') || !byte.is_ascii();
    let bytes = text.as_bytes();
    let marks = bytes.iter().filter(|byte| !is_word(byte)).count();
    let words = bytes
        .windows(2)
        .filter(|two| is_word(&two[0]) && !is_word(&two[1]));
    marks + words.count() + 1
}
