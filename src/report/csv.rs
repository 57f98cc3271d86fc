//! Tables as comma-separated values: one form of numbers and of texts, and nothing for what does not exist.

use crate::model::printed::push_shortest_decimal;
use serde_json::{Value, json};

/// A cell of a table.
#[derive(Clone, Debug, PartialEq)]
pub enum TableCell {
    /// The shortest decimal that reads back as the same number; nothing for NaN and infinities.
    Number(f64),
    /// A count.
    Whole(u64),
    /// A name or a word.
    Text(String),
    /// What does not exist.
    Empty,
}

impl TableCell {
    /// A text.
    pub fn text(text: &str) -> Self {
        Self::Text(text.to_owned())
    }

    /// A number, if there is one.
    pub fn of(value: Option<f64>) -> Self {
        value.map_or(Self::Empty, Self::Number)
    }

    /// The cell in a document: an undefined value is null, as it is an empty cell in CSV.
    pub fn json(self) -> Value {
        match self {
            Self::Number(value) => json!(value + 0.0),
            Self::Whole(value) => json!(value),
            Self::Text(text) => json!(text),
            Self::Empty => Value::Null,
        }
    }

    fn push(&self, text: &mut String) {
        match self {
            // Nothing is less than nothing: -0 is 0.
            Self::Number(value) if value.is_finite() => push_shortest_decimal(text, value + 0.0),
            Self::Whole(value) => text.push_str(&value.to_string()),
            Self::Text(own) => text.push_str(&quoted_cell(own)),
            Self::Number(_) | Self::Empty => {}
        }
    }
}

/// Adds a row to a text.
pub fn push_row(text: &mut String, cells: impl IntoIterator<Item = TableCell>) {
    for (place, cell) in cells.into_iter().enumerate() {
        if place > 0 {
            text.push(',');
        }
        cell.push(text);
    }
    text.push('\n');
}

/// Adds the row of the columns' names to a text.
pub fn push_header(text: &mut String, names: &[impl AsRef<str>]) {
    let cells = names.iter().map(|name| TableCell::text(name.as_ref()));
    push_row(text, cells);
}

/// A text as a CSV cell: quoted if necessary, and with an apostrophe before anything that a spreadsheet would run as a
/// formula. Sequences of signs, such as those of a branch, are only quoted: they run nothing.
fn quoted_cell(text: &str) -> String {
    let is_formula = text.starts_with(['+', '-', '=', '@', '\t', '\r']);
    if text.parse::<f64>().is_ok() {
        return text.to_owned();
    }
    let is_signs = text.chars().all(|c| matches!(c, '+' | '-' | '0'));
    let mark = if is_formula && !is_signs { "'" } else { "" };
    if is_formula || text.contains([',', ';', '"', '\n', '\r']) {
        format!("\"{mark}{}\"", text.replace('"', "\"\""))
    } else {
        text.to_owned()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_cell_is_run_by_a_spreadsheet() {
        for (text, cell) in [
            ("crank", "crank"),
            ("a, b", "\"a, b\""),
            ("say \"so\"", "\"say \"\"so\"\"\""),
            ("=cmd|' /C calc'!A0", "\"'=cmd|' /C calc'!A0\""),
            ("@SUM(A1)", "\"'@SUM(A1)\""),
            ("+1+cmd", "\"'+1+cmd\""),
            ("-2", "-2"),
            ("+-0", "\"+-0\""),
        ] {
            assert_eq!(quoted_cell(text), cell);
        }
    }

    #[test]
    fn rows_have_one_form_of_numbers_and_nothing_for_what_does_not_exist() {
        let mut text = String::new();
        push_header(&mut text, &["name", "a, b"]);
        push_row(
            &mut text,
            [
                TableCell::text("crank"),
                TableCell::Whole(3),
                TableCell::Number(40.0),
                TableCell::Number(1e-7),
                TableCell::Empty,
                TableCell::of(Some(-0.5)),
            ],
        );
        assert_eq!(text, "name,\"a, b\"\ncrank,3,40,1e-7,,-0.5\n");
        for value in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            let mut text = String::new();
            push_row(&mut text, [TableCell::Number(value), TableCell::of(None)]);
            assert_eq!(text, ",\n");
            assert_eq!(TableCell::Number(value).json(), Value::Null);
        }
    }
}
