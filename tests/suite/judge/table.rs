//! The program's tables, every number as the decimal that is printed.

use super::number::Precise;
use std::collections::HashMap;

/// Rows of a CSV file by the names of their columns.
pub struct Table {
    pub rows: Vec<HashMap<String, String>>,
}

impl Table {
    pub fn parse(csv: &str) -> Self {
        let mut lines = csv.lines().map(cells);
        let names = lines.next().unwrap();
        let row = |cells: Vec<String>| names.iter().cloned().zip(cells).collect();
        Self {
            rows: lines.map(row).collect(),
        }
    }
}

/// The number in a cell.
pub fn number(row: &HashMap<String, String>, name: &str) -> Precise {
    let text = row.get(name).unwrap_or_else(|| panic!("no column {name}"));
    Precise::of_decimal(text)
}

/// Cells of a line; those in quotes may hold commas, and quotes twice.
fn cells(line: &str) -> Vec<String> {
    let mut all = vec![String::new()];
    let mut is_quoted = false;
    for part in line.split_inclusive([',', '"']) {
        let (text, sign) = part.split_at(part.len() - usize::from(part.ends_with([',', '"'])));
        let last = all.last_mut().unwrap();
        last.push_str(text);
        match sign {
            "\"" => is_quoted = !is_quoted,
            "," if is_quoted => last.push(','),
            "," => all.push(String::new()),
            _ => {}
        }
    }
    all
}
