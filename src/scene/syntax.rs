//! A TOML text as tables, with all of its mistakes or, where it is long, the first: a list of every mistake takes a
//! thousand times the memory of the text.

use crate::diag::{Diagnostic, Diagnostics};
use crate::limits::allow_memory;
use toml::de::{DeTable, Error};

/// Texts up to so many bytes are read on behind a mistake; nobody writes longer ones by hand, and 256 KiB with a mistake a
/// byte take a sixth of a second and 100 MB.
const MOST_READ_ON: usize = 256 << 10;

/// Bytes that the reader takes for each word and each mark of a text. Measured, and somewhat more.
const BYTES_OF_TOKEN: f64 = 110.0;

/// Reads the tables of a text; `None` if its mistakes, which go to `diagnostics`, or the limit of memory allow none.
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
    Diagnostic::error(message).at(error.span().unwrap_or(text.len()..text.len()))
}

/// At least as many as the text has words and marks between them.
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
