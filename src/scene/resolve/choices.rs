//! Words that stand for one of a few values in `[view]`, and how they are looked up.

use super::super::reader::Spanned;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::theme::Theme;
use crate::model::view::{EdgeLines, NamedView, ShownAxes, Trails};

/// Most ghosts: more of them hide what they are to show.
pub const MOST_GHOSTS: usize = 60;

/// The words of `axes`; the first is the default, here as below.
pub const AXES: [(&str, ShownAxes); 4] = [
    ("none", ShownAxes::None),
    ("world", ShownAxes::World),
    ("bodies", ShownAxes::Bodies),
    ("all", ShownAxes::All),
];

/// The words of `trails`; how long a fading one is stands elsewhere.
pub const TRAILS: [(&str, Trails); 4] = [
    ("whole", Trails::Whole),
    ("grow", Trails::Grow),
    ("fading", Trails::Fading(None)),
    ("none", Trails::None),
];

/// The words of `edges`.
pub const EDGES: [(&str, EdgeLines); 3] = [
    ("all", EdgeLines::All),
    ("outline", EdgeLines::Outline),
    ("none", EdgeLines::None),
];

/// The words of `theme`.
pub const THEMES: [(&str, Theme); 2] = [("light", Theme::Light), ("dark", Theme::Dark)];

/// The words of `from`.
pub const NAMED_VIEWS: [(&str, NamedView); 5] = [
    ("iso", NamedView::Iso),
    ("front", NamedView::Front),
    ("top", NamedView::Top),
    ("side", NamedView::Side),
    ("four", NamedView::Four),
];

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
