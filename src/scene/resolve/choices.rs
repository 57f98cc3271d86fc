//! Looks up words that stand for one of a few values.

use super::super::reader::Spanned;
use crate::diag::{Diagnostic, Diagnostics};

/// Most ghosts: more of them would hide what they show.
pub const MOST_GHOSTS: usize = 60;

/// Most labels: each must avoid all others, so the time grows faster than their number, and more would hide the
/// picture.
pub const MOST_LABELS: usize = 200;

/// One of the named values; the first is the default.
pub fn chosen_word<T: Copy>(
    word: &Option<Spanned<String>>,
    known: &[(&str, T)],
    what: &str,
    diagnostics: &mut Diagnostics,
) -> T {
    let Some(word) = word else { return known[0].1 };
    match known.iter().find(|(name, _)| *name == word.value) {
        Some((_, value)) => *value,
        None => {
            let names: Vec<&str> = known.iter().map(|(name, _)| *name).collect();
            diagnostics.push(
                Diagnostic::error(format!("unknown {what} `{}`", word.value))
                    .at(word.span.clone())
                    .hint(format!("one of {}", names.join(", "))),
            );
            known[0].1
        }
    }
}
