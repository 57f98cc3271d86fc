//! Checks names: each must be unique and not a word of the formula language.

use super::super::columns::is_column;
use super::super::file::SceneFile;
use crate::diag::{Diagnostic, Diagnostics, Span};
use crate::model::expression::Function;
use std::collections::BTreeMap;

/// The name of the time in the formulas of drives.
pub const TIME: &str = "t";

/// Words of the formula language besides its functions.
const RESERVED: [&str; 7] = [TIME, "pi", "π", "E", "inv", "nan", "inf"];

/// What is wrong with a name of a coordinate, an output or a measure, each of which is a column: that tables have it already.
pub fn taken_by_tables(word: &str, place: &Span) -> Option<Diagnostic> {
    is_column(word).then(|| {
        let hint = match word {
            "time" => {
                format!("in the formulas of inputs the time is `{TIME}`; choose another name")
            }
            _ => "choose another name".to_owned(),
        };
        Diagnostic::error(format!("`{word}` is a column of tables"))
            .at(place.clone())
            .hint(hint)
    })
}

/// The sections whose names are columns.
const COLUMN_SECTIONS: [&str; 4] = ["parameter", "input", "output", "measure"];

/// Rejects names that are given twice and words of the formula language.
pub fn refuse_double_and_reserved(file: &SceneFile, diagnostics: &mut Diagnostics) {
    let mut seen: BTreeMap<&str, (&str, Span)> = BTreeMap::new();
    // All sections whose names can appear in the same formula.
    let sections = [
        (
            "parameter",
            file.parameters.iter().map(|(n, _)| n).collect::<Vec<_>>(),
        ),
        ("input", file.inputs.iter().map(|(n, _)| n).collect()),
        ("chain", file.chains.iter().map(|(n, _)| n).collect()),
        ("bar", file.bars.iter().map(|b| &b.name).collect()),
        ("contact", file.contacts.iter().map(|c| &c.name).collect()),
        ("output", file.outputs.iter().map(|(n, _)| n).collect()),
        ("output", file.distances.iter().map(|d| &d.name).collect()),
        ("measure", file.measures.iter().map(|m| &m.name).collect()),
        ("trace", file.traces.iter().map(|t| &t.name).collect()),
    ];
    for (section, list) in sections {
        for name in list {
            let word = name.value.as_str();
            if let Some((other, span)) = seen.get(word) {
                diagnostics.push(
                    Diagnostic::error(format!(
                        "`{word}` is defined twice: as {other} and as {section}"
                    ))
                    .at(name.span.clone())
                    .with_related(span.clone(), "first here"),
                );
                continue;
            }
            seen.insert(word, (section, name.span.clone()));
            let taken = taken_by_tables(word, &name.span);
            if let Some(taken) = taken.filter(|_| COLUMN_SECTIONS.contains(&section)) {
                diagnostics.push(taken);
            }
            // A name must be readable as a name wherever it may be used.
            let reserved = RESERVED.contains(&word) || Function::from_name(word).is_some();
            if reserved || !is_identifier(word) {
                let (why, hint) = if reserved {
                    ("has a fixed meaning in formulas", "choose another name")
                } else {
                    (
                        "cannot be written in a formula",
                        "names start with a letter and contain letters, digits and `_`",
                    )
                };
                let message = format!("`{word}` {why}");
                let diagnostic = Diagnostic::error(message).at(name.span.clone());
                diagnostics.push(diagnostic.hint(hint));
            }
        }
    }
}

fn is_identifier(word: &str) -> bool {
    let mut chars = word.chars();
    chars.next().is_some_and(|c| c.is_alphabetic() || c == '_')
        && chars.all(|c| c.is_alphanumeric() || c == '_' || c == '\'')
}
