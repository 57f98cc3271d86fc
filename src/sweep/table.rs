//! Rows as CSV or JSON lines: the design's number, status, parameters, values, and what is proved about them.

use super::row::Row;
use super::swept_scene::Sweep;
use crate::report::csv::{TableCell, push_header, push_row};
use crate::scene::columns::{DESIGN, DESIGN_PROOF};
use serde_json::{Map, Value, json};

/// Format of the rows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum RowFormat {
    /// A header, then one line per row; undefined values are empty cells.
    Csv,
    /// One JSON object per line; undefined values are null.
    JsonLines,
}

/// Writes the rows of a sweep.
pub struct RowTable<'s> {
    sweep: &'s Sweep,
    format: RowFormat,
    names: Vec<String>,
}

impl<'s> RowTable<'s> {
    /// For the rows of `sweep`.
    pub fn new(sweep: &'s Sweep, format: RowFormat) -> Self {
        let axes = sweep.design.axes.iter().map(|axis| axis.name.clone());
        let values = sweep.columns.iter().map(|(name, _)| name.clone());
        let own = |list: [&str; 3]| list.map(str::to_owned).into_iter();
        Self {
            sweep,
            format,
            names: own(DESIGN)
                .chain(axes)
                .chain(values)
                .chain(own(DESIGN_PROOF))
                .collect(),
        }
    }

    /// Names of the columns: the design's number, its status, whether it is feasible, and numbers.
    pub fn into_names(self) -> Vec<String> {
        self.names
    }

    /// The text before the rows.
    pub fn header(&self) -> String {
        match self.format {
            RowFormat::Csv => {
                let mut text = String::new();
                push_header(&mut text, &self.names);
                text
            }
            RowFormat::JsonLines => String::new(),
        }
    }

    /// Adds the row of design `item`.
    pub fn add(&self, item: u64, row: &Row, text: &mut String) {
        let design = self.sweep.design.values(item);
        let numbers = row.numbers(&design);
        match self.format {
            RowFormat::Csv => {
                let first = [
                    TableCell::Whole(item),
                    TableCell::text(row.status.word()),
                    TableCell::Whole(u64::from(row.is_feasible)),
                ];
                let numbers = numbers.map(TableCell::Number);
                push_row(text, first.into_iter().chain(numbers));
            }
            RowFormat::JsonLines => {
                let first = [
                    json!(item),
                    json!(row.status.word()),
                    json!(row.is_feasible),
                ];
                let cells = first.into_iter().chain(numbers.map(|number| json!(number)));
                let object: Map<String, Value> = self.names.iter().cloned().zip(cells).collect();
                text.push_str(&format!("{}\n", Value::Object(object)));
            }
        }
    }
}
