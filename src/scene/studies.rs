//! The `[study]` section as typed: variables, tracks, measures, objective and limits.

use super::file::NamedFormula;
use super::reader::{FormulaText, Spanned, TableReader, read_table};
use crate::diag::Diagnostic;
use toml::de::{DeTable, DeValue};

/// `[study]`
#[derive(Clone, Debug, Default)]
pub struct StudyFile {
    /// `[study.variables]`
    pub variables: Vec<(Spanned<String>, VariableFile)>,
    /// `[study.tracks]`
    pub tracks: Vec<(Spanned<String>, TrackFile)>,
    /// `[study.measures]`
    pub measures: Vec<NamedFormula>,
    /// `minimise`
    pub minimise: Option<FormulaText>,
    /// `[study.constraints]`
    pub constraints: Vec<(Spanned<String>, LimitFile)>,
    /// `[study.requirements]`
    pub requirements: Vec<(Spanned<String>, LimitFile)>,
}

/// One entry of `[study.variables]`.
#[derive(Clone, Debug, Default)]
pub struct VariableFile {
    /// `range`
    pub range: Option<[FormulaText; 2]>,
    /// `tolerance`
    pub tolerance: Option<FormulaText>,
}

/// One entry of `[study.tracks]`.
#[derive(Clone, Debug, Default)]
pub struct TrackFile {
    /// `samples`
    pub samples: Option<FormulaText>,
    /// `from`
    pub from: Vec<NamedFormula>,
    /// `to`
    pub to: Vec<NamedFormula>,
    /// `time`
    pub time: Option<[FormulaText; 2]>,
}

/// One entry of `[study.constraints]` or `[study.requirements]`.
#[derive(Clone, Debug, Default)]
pub struct LimitFile {
    /// `value`
    pub value: Option<FormulaText>,
    /// `at_most`
    pub at_most: Option<FormulaText>,
    /// `at_least`
    pub at_least: Option<FormulaText>,
}

/// Reads the section.
pub fn study<'t>(r: &mut TableReader<'t, '_>, text: &'t str) -> StudyFile {
    StudyFile {
        variables: entries(r, text, "variables", |v| VariableFile {
            range: v.vector("range"),
            tolerance: v.formula("tolerance"),
        }),
        tracks: entries(r, text, "tracks", |t| TrackFile {
            samples: t.formula("samples"),
            from: t.named_formulas("from"),
            to: t.named_formulas("to"),
            time: t.vector("time"),
        }),
        measures: r.named_formulas("measures"),
        minimise: r.formula("minimise"),
        constraints: entries(r, text, "constraints", limit),
        requirements: entries(r, text, "requirements", limit),
    }
}

fn limit(r: &mut TableReader) -> LimitFile {
    let limit = LimitFile {
        value: r.formula("value"),
        at_most: r.formula("at_most"),
        at_least: r.formula("at_least"),
    };
    if limit.value.is_none() {
        r.missing("value");
    }
    if limit.at_most.is_none() && limit.at_least.is_none() {
        r.missing("at_most` or `at_least");
    }
    limit
}

/// Tables under names of the user's choice.
fn entries<'t, T: Default>(
    r: &mut TableReader<'t, '_>,
    text: &'t str,
    key: &'static str,
    read: impl Fn(&mut TableReader<'t, '_>) -> T,
) -> Vec<(Spanned<String>, T)> {
    let mut list = Vec::new();
    for (name, value, span) in r.named(key) {
        let entry = match table_of(value) {
            Some(table) => {
                let place = format!("`{}` of {key}", name.value);
                read_table(table, text, span, place, r.diagnostics, &read)
            }
            None => {
                let message = format!("`{}` must be a table of keys", name.value);
                r.diagnostics.push(Diagnostic::error(message).at(span));
                T::default()
            }
        };
        list.push((name, entry));
    }
    list
}

fn table_of<'t>(value: &'t DeValue<'t>) -> Option<&'t DeTable<'t>> {
    value.as_table()
}
