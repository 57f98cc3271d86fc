//! Tables with named columns, as verbs read them: of inputs, of targets, of designs. What is wrong with one is told here,
//! with its line and column.

use super::cells::Cells;
use super::planned::cannot_read;
use crate::cli::term::outcome::Failure;
use crate::report::sentences::counted_things;
use crate::scene::source::open_input;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Name of a time column in seconds, and what else it may be called.
pub const TIME: &str = "time";
const TIMES: [&str; 3] = [TIME, "t", "time [s]"];

/// A table being read.
pub struct NamedTable<'f> {
    /// The file, as messages name it.
    pub name: String,
    /// Names of the columns. A separator behind the last one begins no other.
    pub header: Vec<String>,
    cells: Cells<Box<dyn BufRead + 'f>>,
}

impl NamedTable<'static> {
    /// Opens a file, or standard input for `-`, and reads the header.
    pub fn open(path: &Path) -> Result<Self, Failure> {
        let file: Box<dyn BufRead> = match path == Path::new("-") {
            true => Box::new(std::io::stdin().lock()),
            false => {
                let file = open_input(path).map_err(|e| cannot_read(path, &e))?;
                Box::new(BufReader::new(file))
            }
        };
        NamedTable::read(path.display().to_string(), file)
    }
}

impl<'f> NamedTable<'f> {
    /// Reads the header of a table that is already open.
    pub fn read(name: String, file: Box<dyn BufRead + 'f>) -> Result<Self, Failure> {
        let mut table = Self {
            name,
            header: Vec::new(),
            cells: Cells::new(file),
        };
        let Some(mut header) = table.next_line()? else {
            let hint = "the first line names the columns".to_owned();
            return Err(Failure::usage(
                format!("{} is empty", table.name),
                vec![hint],
            ));
        };
        while header.last().is_some_and(String::is_empty) {
            header.pop();
        }
        table.header = header;
        Ok(table)
    }

    /// A mistake in a cell of the last line read.
    pub fn fault(&self, column: usize, what: &str, hint: &str) -> Failure {
        let place = self.cells.place_of(column);
        let message = format!("{}:{}:{place}: {what}", self.name, self.line());
        Failure::usage(message, vec![hint.to_owned()])
    }

    /// Number of the last line read.
    pub fn line(&self) -> usize {
        self.cells.number
    }

    /// The only column of that name.
    pub fn find_column(&self, name: &str) -> Result<Option<usize>, Failure> {
        let mut named = (0..self.header.len()).filter(|k| self.header[*k] == name);
        let first = named.next();
        match named.next() {
            Some(second) => Err(self.double_fault(second)),
            None => Ok(first),
        }
    }

    /// The column of times, under a name that nothing else has.
    pub fn find_time(&self, is_taken: impl Fn(&str) -> bool) -> Result<Option<usize>, Failure> {
        let mut found = None;
        for name in TIMES.into_iter().filter(|name| !is_taken(name)) {
            let column = self.find_column(name)?;
            if let (Some(first), Some(second)) = (found, column) {
                let [first, name] = [first, second].map(|k: usize| &self.header[k]);
                let what = format!("`{first}` and `{name}` are both columns of times");
                return Err(self.fault(second, &what, "leave one of them out"));
            }
            found = found.or(column);
        }
        Ok(found)
    }

    /// Refuses columns without a name or with the same one: none may be ignored.
    pub fn refuse_unclear_columns(&self) -> Result<(), Failure> {
        for (k, name) in self.header.iter().enumerate() {
            if name.is_empty() {
                let what = format!("column {} has no name", k + 1);
                return Err(self.fault(k, &what, "the first line names the columns"));
            }
            if self.header[..k].contains(name) {
                return Err(self.double_fault(k));
            }
        }
        Ok(())
    }

    fn double_fault(&self, column: usize) -> Failure {
        let what = format!("there are two columns `{}`", self.header[column]);
        self.fault(column, &what, "write one column per quantity")
    }

    /// The cells of the next row, one per column; `None` at the end.
    pub fn next_row(&mut self) -> Result<Option<Vec<String>>, Failure> {
        let Some(mut row) = self.next_line()? else {
            return Ok(None);
        };
        let width = self.header.len();
        let beyond = (width..row.len()).find(|k| !row[*k].is_empty());
        if row.len() < width || beyond.is_some() {
            let cells = counted_things(row.len(), "cell");
            let what = format!("{cells} where the header has {width}");
            let hint = "decimal commas need `;` or a tab between cells";
            return Err(self.fault(beyond.unwrap_or(row.len()), &what, hint));
        }
        row.truncate(width);
        Ok(Some(row))
    }

    fn next_line(&mut self) -> Result<Option<Vec<String>>, Failure> {
        let row = self.cells.row();
        row.map_err(|why| self.fault(0, &why, "tables are CSV with a header"))
    }

    /// The number in a cell of the last row read.
    pub fn number(&mut self, row: &[String], column: usize) -> Result<f64, Failure> {
        let value = self.cells.value(&row[column]);
        value.map_err(|why| {
            let (cell, name) = (&row[column], &self.header[column]);
            let what = format!("`{cell}` is not a value for `{name}`");
            self.fault(column, &what, &why)
        })
    }
}
