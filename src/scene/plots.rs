//! The entries of `[[plots]]` as typed.

use super::reader::{Spanned, TableReader, required_value};
use super::values::FormulaText;
use crate::diag::Diagnostic;

/// One entry of `[[plots]]`.
#[derive(Clone, Debug, Default)]
pub struct PlotFile {
    /// `title`
    pub title: Option<String>,
    /// `x`: a quantity or `time`, which is the default.
    pub x: Option<FormulaText>,
    /// `y`: quantities.
    pub y: Vec<FormulaText>,
    /// `equal`
    pub equal: bool,
    /// `marks`: points.
    pub marks: Vec<[FormulaText; 2]>,
    /// `lines`: start and end of each.
    pub lines: Vec<[FormulaText; 4]>,
    /// `angle`: unit of angles in this plot.
    pub angle: Option<Spanned<String>>,
}

/// Reads one entry.
pub(super) fn read_plot(r: &mut TableReader) -> Option<PlotFile> {
    let (title, x) = (r.string("title"), r.formula("x"));
    let y = required_value(r, "y", |r, k| r.formulas(k));
    let (equal, angle) = (r.boolean("equal"), r.string("angle"));
    let marks = r.rows::<2>("marks");
    let lines = r.rows::<4>("lines");
    if let Some(list) = y.as_ref().filter(|list| list.value.is_empty()) {
        let diagnostic = Diagnostic::error("a plot needs at least one curve");
        r.diagnostics.push(diagnostic.at(list.span.clone()));
    }
    Some(PlotFile {
        title: title.map(|t| t.value),
        x,
        y: y?.value,
        equal: equal.unwrap_or(false),
        marks: marks.map_or_else(Vec::new, |m| m.value),
        lines: lines.map_or_else(Vec::new, |l| l.value),
        angle,
    })
}
