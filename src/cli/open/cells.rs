//! Tables as spreadsheets write them, row by row: byte order marks, quotes, comments, `;` or tab between cells, decimal
//! commas. Independent of mechanisms; keeps no row.

use std::io::{BufRead, Read};

/// Longest line: a row of a hundred thousand numbers.
const LONGEST_LINE: u64 = 1 << 20;

/// Possible separators of cells, the likeliest last: a comma may also be a decimal sign.
const SEPARATORS: [char; 3] = [';', '\t', ','];

/// First line that tells spreadsheets the separator.
const SEPARATOR_LINE: &str = "sep=";

/// The rows of a table.
pub struct Cells<R> {
    file: R,
    line: Vec<u8>,
    /// Byte at which every cell of the last line begins.
    starts: Vec<usize>,
    /// Number of the last line read.
    pub number: usize,
    separator: Option<char>,
    /// The decimal sign of the numbers with one, once known.
    decimal: Option<char>,
}

impl<R: BufRead> Cells<R> {
    /// Starts at the beginning of a file.
    pub fn new(file: R) -> Self {
        Self {
            file,
            line: Vec::new(),
            starts: Vec::new(),
            number: 0,
            separator: None,
            decimal: None,
        }
    }

    /// The cells of the next row, without blanks and quotes around them; `None` at the end. Errors in words.
    pub fn row(&mut self) -> Result<Option<Vec<String>>, String> {
        loop {
            if !self.next_line()? {
                return Ok(None);
            }
            let text = std::str::from_utf8(&self.line).map_err(|_| self.not_text())?;
            let text = if self.number == 1 {
                without_mark(text)
            } else {
                text
            };
            let text = text.trim_end_matches(['\n', '\r']);
            if text.contains('\r') {
                let why = "the lines end with carriage returns alone; save it as CSV with UTF-8";
                return Err(why.to_owned());
            }
            if text.trim().is_empty() || text.trim_start().starts_with('#') {
                continue;
            }
            if let (None, Some(sign)) = (self.separator, text.strip_prefix(SEPARATOR_LINE)) {
                self.separator = sign.chars().next();
                continue;
            }
            let separator = self.separator.unwrap_or_else(|| separator_of(text));
            self.separator = Some(separator);
            return split_cells(text, separator, &mut self.starts).map(Some);
        }
    }

    /// The character of the last line at which a cell begins, from 1; behind the line for a cell that it lacks, and 1
    /// where the line has no cells.
    pub fn place_of(&self, cell: usize) -> usize {
        if self.starts.is_empty() {
            return 1;
        }
        let text = String::from_utf8_lossy(&self.line);
        let text = without_mark(&text).trim_end_matches(['\n', '\r']);
        let start = self.starts.get(cell).copied().unwrap_or(text.len());
        text.get(..start).unwrap_or(text).chars().count() + 1
    }

    fn next_line(&mut self) -> Result<bool, String> {
        self.line.clear();
        self.starts.clear();
        let mut file = (&mut self.file).take(LONGEST_LINE);
        let count = file
            .read_until(b'\n', &mut self.line)
            .map_err(|e| e.to_string())?;
        self.number += 1;
        if count as u64 == LONGEST_LINE {
            return Err(format!("the line is longer than {LONGEST_LINE} bytes"));
        }
        Ok(count > 0)
    }

    fn not_text(&self) -> String {
        let is_utf_16 = self.line.starts_with(b"\xff\xfe") || self.line.starts_with(b"\xfe\xff");
        let known = if is_utf_16 { ": it is UTF-16" } else { "" };
        format!("the file is not UTF-8 text{known}; save it as CSV with UTF-8")
    }

    /// The number in a cell; with a decimal comma only where cells are not separated by commas. Errors: why it is not a
    /// number.
    pub fn value(&mut self, cell: &str) -> Result<f64, String> {
        let (commas, points) = (cell.matches(',').count(), cell.matches('.').count());
        if commas + points > 1 {
            return Err(
                "a number has one decimal separator and no thousands separators".to_owned(),
            );
        }
        let own = match (commas, points) {
            (1, _) => Some(','),
            (_, 1) => Some('.'),
            _ => None,
        };
        if let (Some(own), Some(known)) = (own, self.decimal)
            && own != known
        {
            return Err(format!(
                "the numbers above have `{known}` as their decimal separator"
            ));
        }
        self.decimal = self.decimal.or(own);
        let value = cell.replace(',', ".").parse::<f64>();
        match value {
            Ok(value) if value.is_finite() => Ok(value),
            Ok(_) => Err("a value must be finite".to_owned()),
            Err(_) if cell.is_empty() => Err("the cell is empty".to_owned()),
            Err(_) => Err("a cell must be a number, without formula or unit".to_owned()),
        }
    }
}

/// A text without the byte order mark of its file.
fn without_mark(text: &str) -> &str {
    text.strip_prefix('\u{feff}').unwrap_or(text)
}

/// The separator in a header: the first candidate that occurs outside of quotes.
fn separator_of(header: &str) -> char {
    let outside = header.split('"').step_by(2);
    let stands = |sign: &char| outside.clone().any(|part| part.contains(*sign));
    SEPARATORS.into_iter().find(stands).unwrap_or(',')
}

/// The cells of a line; `starts` receives the bytes at which they begin.
fn split_cells(
    text: &str,
    separator: char,
    starts: &mut Vec<usize>,
) -> Result<Vec<String>, String> {
    let mut cells = Vec::new();
    let mut rest = text;
    loop {
        let trimmed = rest.trim_start_matches([' ', '\u{a0}']);
        starts.push(text.len() - trimmed.len());
        let (cell, after) = match trimmed.strip_prefix('"') {
            Some(quoted) => unquote_cell(quoted)?,
            None => {
                let end = rest.find(separator).unwrap_or(rest.len());
                (rest[..end].trim().to_owned(), &rest[end..])
            }
        };
        cells.push(cell);
        let after = after.trim_start_matches([' ', '\u{a0}']);
        match after.strip_prefix(separator) {
            Some(next) => rest = next,
            None if after.is_empty() => return Ok(cells),
            None => return Err("there is text after the closing quote of a cell".to_owned()),
        }
    }
}

/// The text up to the closing quote, with doubled quotes as one, and the rest behind it.
fn unquote_cell(text: &str) -> Result<(String, &str), String> {
    let mut cell = String::new();
    let mut rest = text;
    while let Some((before, after)) = rest.split_once('"') {
        cell.push_str(before);
        match after.strip_prefix('"') {
            Some(next) => {
                cell.push('"');
                rest = next;
            }
            None => return Ok((cell.trim().to_owned(), after)),
        }
    }
    Err("a quote is not closed in its line".to_owned())
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn rows(bytes: &[u8]) -> Result<Vec<Vec<String>>, String> {
        let mut cells = Cells::new(bytes);
        let mut list = Vec::new();
        while let Some(row) = cells.row()? {
            list.push(row);
        }
        Ok(list)
    }

    #[test]
    fn what_spreadsheets_write_is_read() {
        for text in [
            "phi,h\n1.5,2\n",
            "\u{feff}phi,h\r\n1.5,2\r\n",
            "\"phi\",\"h\"\n\"1.5\" , 2",
            "# made by hand\n\nphi;h\n1.5;2\n",
            "phi\th\n1.5\t2\n",
            "sep=;\nphi;h\n1.5;2\n",
        ] {
            assert_eq!(
                rows(text.as_bytes()).unwrap(),
                [["phi", "h"], ["1.5", "2"]],
                "{text:?}"
            );
        }
        assert_eq!(
            rows(b"\"a;b\",\"say \"\"so\"\"\"\n").unwrap(),
            [["a;b", "say \"so\""]]
        );
        assert_eq!(rows(b"a,,\n").unwrap(), [["a", "", ""]]);
    }

    #[test]
    fn cells_have_places() {
        let mut cells = Cells::new("\u{feff}\"ä, b\", ü ,c\n".as_bytes());
        assert_eq!(cells.row().unwrap().unwrap(), ["ä, b", "ü", "c"]);
        let places: Vec<usize> = (0..4).map(|cell| cells.place_of(cell)).collect();
        assert_eq!(places, [1, 9, 12, 13]);
        let mut cells = Cells::new(&b"\xff,1\n"[..]);
        assert!(cells.row().is_err());
        assert_eq!(cells.place_of(1), 1);
    }

    #[test]
    fn what_is_no_table_is_refused() {
        for (bytes, why) in [
            (&b"a,b\n\"1,2\n"[..], "not closed"),
            (b"\"a\"b,c\n", "after the closing quote"),
            (b"\xff\xfea\0", "UTF-16"),
            (b"a\xe4,b\n", "not UTF-8"),
            (&vec![0; 3 << 20], "longer"),
        ] {
            let refused = rows(bytes).unwrap_err();
            assert!(refused.contains(why), "{refused}");
        }
    }

    #[test]
    fn decimal_commas_are_told_apart() {
        let mut cells = Cells::new(&b""[..]);
        for (cell, value) in [
            ("1,5", Some(1.5)),
            ("-2e3", Some(-2e3)),
            ("1.5", None),
            ("1.234,5", None),
            ("", None),
        ] {
            assert_eq!(cells.value(cell).ok(), value, "{cell}");
        }
        let mut cells = Cells::new(&b""[..]);
        for (cell, value) in [
            ("1.5", Some(1.5)),
            ("1,5", None),
            ("pi/2", None),
            ("1e400", None),
            ("nan", None),
        ] {
            assert_eq!(cells.value(cell).ok(), value, "{cell}");
        }
    }
}
