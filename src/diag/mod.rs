//! What a user is told: messages about a text, names that may have been meant, and texts and numbers in printable form.

mod diagnostic;
mod names;
mod shown;

pub use diagnostic::{Diagnostic, Diagnostics, SceneError, Severity, Source, Span};
pub use names::{list_names, name_hint};
pub use shown::{
    MOST_QUOTED, cut_text, decimals_of, shorten_text, shown_char, shown_lines, shown_number,
    shown_text, xml_text,
};
