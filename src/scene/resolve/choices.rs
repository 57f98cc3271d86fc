//! Looks up words that stand for one of a few values.

use super::super::reader::Spanned;
use crate::diag::{Diagnostic, Diagnostics, name_hint};
use crate::model::mechanism::AngleUnit;

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
            let names = known.iter().map(|(name, _)| *name);
            diagnostics.push(unknown_word(word, what, names));
            known[0].1
        }
    }
}

/// The angle unit that a word names.
pub fn chosen_angle_unit(
    word: &Spanned<String>,
    diagnostics: &mut Diagnostics,
) -> Option<AngleUnit> {
    let unit = AngleUnit::from_name(&word.value);
    if unit.is_none() {
        diagnostics.push(unknown_word(word, "angle unit", AngleUnit::NAMES));
    }
    unit
}

/// An error: the word is not one of the known ones.
pub fn unknown_word<'a>(
    word: &Spanned<String>,
    what: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> Diagnostic {
    Diagnostic::error(format!("unknown {what} `{}`", word.value))
        .at(word.span.clone())
        .hint(name_hint(&word.value, known))
}
