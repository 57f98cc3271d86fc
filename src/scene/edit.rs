//! Replaces parameters and start values in the text of a scene; the rest of the text stays as typed.

use super::file;
use super::reader::NamedFormula;
use super::source::SourceError;
use crate::diag::{Diagnostics, Source};
use crate::sorting::sort_by_key;

/// Header of the section of start values.
const GUESS: &str = "[guess]";

/// The text of `source` with new values, formulas of the file, for some parameters and start values. Missing start
/// values are added.
///
/// # Errors
/// The text has errors or no such parameter, or its start values are an inline table.
pub fn with_values(
    source: &Source,
    parameters: &[(String, String)],
    guess: &[(String, String)],
) -> Result<String, SourceError> {
    edited_text(source, parameters, guess).ok_or_else(|| SourceError {
        message: "the values cannot be written into the text of the scene".to_owned(),
        hints: vec!["write start values as a section of their own: [guess]".to_owned()],
    })
}

fn edited_text(
    source: &Source,
    parameters: &[(String, String)],
    guess: &[(String, String)],
) -> Option<String> {
    let mut diagnostics = Diagnostics::default();
    let file = file::read_scene(source, &mut diagnostics);
    let place = |list: &[NamedFormula], name: &str| {
        let found = list.iter().find(|(n, _)| n.value == name);
        found.map(|(_, formula)| formula.span.clone())
    };
    let mut edits = Vec::new();
    for (name, value) in parameters {
        edits.push((place(&file.parameters, name)?, typed_value(value)));
    }
    let mut added = String::new();
    for (name, value) in guess {
        match place(&file.guess, name) {
            Some(span) => edits.push((span, typed_value(value))),
            None => added.push_str(&format!("{name} = {}\n", typed_value(value))),
        }
    }
    if !added.is_empty() {
        let end = source.text.len();
        match after_header(&source.text, GUESS) {
            Some(place) => edits.push((place..place, added)),
            None if file.guess.is_empty() => {
                edits.push((end..end, format!("\n{GUESS}\n{added}")));
            }
            // An inline table: no line can be added to it.
            None => return None,
        }
    }
    sort_by_key(&mut edits, |(span, _)| std::cmp::Reverse(span.start));
    let mut text = source.text.clone();
    for (span, value) in edits {
        text.replace_range(span, &value);
    }
    (!diagnostics.has_errors()).then_some(text)
}

/// A plain number, or a formula in quotes.
fn typed_value(value: &str) -> String {
    match value.parse::<f64>() {
        Ok(_) => value.to_owned(),
        Err(_) => format!("{value:?}"),
    }
}

/// Start of the line after a section's header.
fn after_header(text: &str, header: &str) -> Option<usize> {
    let mut start = 0;
    for line in text.split_inclusive('\n') {
        start += line.len();
        let code = line.split('#').next().unwrap_or(line);
        if code.trim() == header && line.ends_with('\n') {
            return Some(start);
        }
    }
    None
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    const SCENE: &str = "[parameters]\nr = 40 # crank\nL = \"2*r\"\n[inputs]\nphi = 0.3\n\
        [loops]\nA = \"Rz(phi) Tx(r) Rz(alpha) Tx(L) Rz(beta) Tx(-h)\"\n";

    fn edited(text: &str) -> Option<String> {
        let source = Source {
            name: "s".to_owned(),
            text: text.to_owned(),
        };
        let pair = |name: &str, value: &str| (name.to_owned(), value.to_owned());
        edited_text(
            &source,
            &[pair("r", "41.5")],
            &[pair("h", "100"), pair("alpha", "pi/2")],
        )
    }

    #[test]
    fn values_are_replaced_and_start_values_added() {
        let added = "h = 100\nalpha = \"pi/2\"\n";
        let changed = SCENE.replace("r = 40 #", "r = 41.5 #");
        assert_eq!(
            edited(SCENE).unwrap(),
            format!("{changed}\n[guess]\n{added}")
        );
        let with = |guess: &str| format!("{SCENE}[guess] # start\n{guess}[outputs]\no = \"h\"\n");
        let expected =
            format!("{changed}[guess] # start\nalpha = \"pi/2\"\nh = 100\n[outputs]\no = \"h\"\n");
        assert_eq!(edited(&with("h = 7\n")).unwrap(), expected);
        assert!(edited(&SCENE.replace("r = 40", "q = 40")).is_none());
    }
}
