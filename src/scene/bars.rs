//! Bars as typed: two points and their distance.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::{Diagnostic, Span};

/// One entry of `[bars]`.
#[derive(Clone, Debug)]
pub struct BarFile {
    /// Its name.
    pub name: Spanned<String>,
    /// What it is. A part that could not be read is `None` and has been reported.
    pub parts: BarParts,
}

/// What a bar is.
#[derive(Clone, Debug, Default)]
pub struct BarParts {
    /// `from` and `to`
    pub ends: [Option<EndFile>; 2],
    /// `length`
    pub length: Option<FormulaText>,
}

/// Where an end is.
#[derive(Clone, Debug)]
pub enum EndFile {
    /// Its coordinates, two or three.
    Point(Vec<FormulaText>, Span),
    /// A chain whose origin it is, or the name of a traced point.
    Chain(FormulaText),
}

/// Reads the parts of a bar.
pub fn read_bar(r: &mut TableReader) -> BarParts {
    let from = required_value(r, "from", read_end);
    let to = required_value(r, "to", read_end);
    let length = required_value(r, "length", |r, key| r.formula(key));
    BarParts {
        ends: [from, to],
        length,
    }
}

fn read_end(r: &mut TableReader, key: &'static str) -> Option<EndFile> {
    if !r.holds_list(key) {
        return r.formula(key).map(EndFile::Chain);
    }
    let list = r.formulas(key)?;
    let count = list.value.len();
    if matches!(count, 2 | 3) {
        return Some(EndFile::Point(list.value, list.span));
    }
    let message = format!("`{key}` must have 2 or 3 components, found {count}");
    r.diagnostics
        .push(Diagnostic::error(message).at(list.span).hint(END_HINT));
    None
}

/// What an end may be.
pub const END_HINT: &str =
    "an end is a point `[x, y]` or `[x, y, z]`, a chain whose origin it is, or the name of a trace";
