//! The `[study]` section as typed: variables, objective, and limits.

use super::keys::results::{LIMIT, VARIABLE};
use super::reader::{FoundValue, Spanned, TableReader, read_table};
use super::values::FormulaText;
use crate::diag::Diagnostic;

/// `[study]`
#[derive(Clone, Debug, Default)]
pub struct StudyFile {
    /// `[study.variables]`
    pub variables: Vec<(Spanned<String>, VariableFile)>,
    /// `minimise`: the name of a measure
    pub minimise: Option<Spanned<String>>,
    /// `[study.limits]`: `min` and `max` of measures
    pub limits: Vec<(Spanned<String>, [Option<FormulaText>; 2])>,
    /// `[study.printed]`: values of measures printed in the source
    pub printed: Vec<(Spanned<String>, FormulaText)>,
    /// `note`: one line about what is studied
    pub note: Option<String>,
}

/// One entry of `[study.variables]`.
#[derive(Clone, Debug, Default)]
pub struct VariableFile {
    /// `range`
    pub range: Option<[FormulaText; 2]>,
    /// `tolerance`
    pub tolerance: Option<FormulaText>,
}

/// Reads the section.
pub fn read_study<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> StudyFile {
    let mut variables = Vec::new();
    // A variable with an error counts as one without range and tolerance.
    for (name, value, span) in r.named("variables") {
        let variable = match value.as_table() {
            Some(table) => {
                let place = format!("variable `{}`", name.value);
                let found = FoundValue { table, text, span };
                read_table(found, &VARIABLE, place, r.diagnostics, |v| VariableFile {
                    range: v.vector("range"),
                    tolerance: v.formula("tolerance"),
                })
            }
            None => {
                let message = format!("variable `{}` must be a table", name.value);
                let hint = "for example { range = [20, 200], tolerance = 0.5 }";
                r.diagnostics
                    .push(Diagnostic::error(message).at(span).hint(hint));
                VariableFile::default()
            }
        };
        variables.push((name, variable));
    }
    let mut limits = Vec::new();
    // A limit with an error is left out.
    for (name, value, span) in r.named("limits") {
        let Some(table) = value.as_table() else {
            let message = format!("the limit of `{}` must be a table", name.value);
            let hint = "for example { max = 60 }";
            r.diagnostics
                .push(Diagnostic::error(message).at(span).hint(hint));
            continue;
        };
        let place = format!("limit of `{}`", name.value);
        let found = FoundValue { table, text, span };
        let ends = read_table(found, &LIMIT, place, r.diagnostics, |v| {
            [v.formula("min"), v.formula("max")]
        });
        limits.push((name, ends));
    }
    StudyFile {
        variables,
        limits,
        minimise: r.string("minimise"),
        printed: r.named_formulas("printed"),
        note: r.string("note").map(|s| s.value),
    }
}
