//! `--input-table TABLE.csv`: rows of input values instead of the scene's drive, one sample per row.

use super::cells::Cells;
use crate::cli::term::outcome::Failure;
use crate::diag::nearest_name;
use crate::limits::{Resource, current_limits};
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::Mechanism;
use crate::report::sentences::counted_things;
use crate::scene::source::open_input;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Maximum number of rows.
const MAX_ROWS: usize = crate::kinematics::motion::sampling::MAX_SAMPLES;

/// Names of a time column in seconds, unless an input has that name.
const TIME: [&str; 3] = ["time", "t", "time [s]"];

/// Replaces the drives. Columns are found by name, others are ignored. A time column gives the time of each row;
/// otherwise row k is at second k, and the warning returned says so if another column may have been meant as the time.
pub fn apply_inputs(
    mechanism: &Mechanism,
    actuation: &mut Actuation,
    path: &Path,
) -> Result<Option<String>, Failure> {
    let name = path.display();
    let failed = |e: std::io::Error| Failure::usage(format!("cannot read {name}: {e}"), Vec::new());
    let file: Box<dyn BufRead> = match path == Path::new("-") {
        true => Box::new(std::io::stdin().lock()),
        false => Box::new(BufReader::new(open_input(path).map_err(failed)?)),
    };
    let mut table = InputsTable {
        path,
        mechanism,
        cells: Cells::new(file),
        columns: Vec::new(),
        time: None,
        width: 0,
        times: Vec::new(),
        values: vec![Vec::new(); mechanism.inputs.len()],
    };
    let warning = table.read_header()?;
    while let Some(row) = table.next()? {
        table.read(&row)?;
    }
    let Some(last) = table.times.last().copied() else {
        return Err(Failure::usage(
            format!("{name} has no rows of values for the inputs"),
            Vec::new(),
        ));
    };
    let InputsTable { times, values, .. } = table;
    let keys = values.into_iter().map(|values| Drive::Keys {
        times: times.clone(),
        values,
        ease: Ease::Linear,
    });
    actuation.drives = keys.collect();
    // A single row has no duration.
    actuation.duration = if last > 0.0 { last } else { 1.0 };
    Ok(warning)
}

/// The sample times that belong to a table: one per row.
pub fn row_times(actuation: &Actuation) -> Vec<f64> {
    match actuation.drives.first() {
        Some(Drive::Keys { times, .. }) => times.clone(),
        _ => vec![0.0],
    }
}

/// A table being read.
struct InputsTable<'t> {
    path: &'t Path,
    mechanism: &'t Mechanism,
    cells: Cells<Box<dyn BufRead>>,
    /// Column of every input.
    columns: Vec<usize>,
    time: Option<usize>,
    /// Columns of the header.
    width: usize,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl InputsTable<'_> {
    /// An error in the last line read.
    fn table_fault(&self, what: &str, hints: Vec<String>) -> Failure {
        Failure::usage(
            format!("{}:{}: {what}", self.path.display(), self.cells.number),
            hints,
        )
    }

    fn next(&mut self) -> Result<Option<Vec<String>>, Failure> {
        let row = self.cells.row();
        row.map_err(|why| self.table_fault(&why, Vec::new()))
    }

    fn read_header(&mut self) -> Result<Option<String>, Failure> {
        let Some(header) = self.next()? else {
            let hint = "the first line names the columns".to_owned();
            let message = format!("{} is empty", self.path.display());
            return Err(Failure::usage(message, vec![hint]));
        };
        self.width = header.len();
        for input in &self.mechanism.inputs {
            let column = self.find_column(&header, &input.name)?;
            self.columns
                .push(column.ok_or_else(|| self.missing(&input.name, &header))?);
        }
        let is_input = |name: &str| self.mechanism.inputs.iter().any(|i| i.name == name);
        for name in TIME.into_iter().filter(|name| !is_input(name)) {
            if self.time.is_none() {
                self.time = self.find_column(&header, name)?;
            }
        }
        let others = header
            .iter()
            .filter(|name| !name.is_empty() && !is_input(name));
        let others: Vec<String> = others.map(|name| format!("`{name}`")).collect();
        if self.time.is_some() || others.is_empty() {
            return Ok(None);
        }
        let ignored = match others.len() {
            1 => format!("column {} is", others[0]),
            _ => format!("columns {} are", others.join(", ")),
        };
        let table = self.path.display();
        Ok(Some(format!(
            "{table} has no column `time`: row k is at k seconds, {ignored} ignored"
        )))
    }

    /// The only column of that name.
    fn find_column(&self, header: &[String], name: &str) -> Result<Option<usize>, Failure> {
        let mut named = (0..header.len()).filter(|k| header[*k] == name);
        let first = named.next();
        match named.next() {
            Some(_) => {
                Err(self.table_fault(&format!("there are two columns `{name}`"), Vec::new()))
            }
            None => Ok(first),
        }
    }

    fn missing(&self, input: &str, header: &[String]) -> Failure {
        let mut hints = vec![format!("its columns are: {}", header.join(", "))];
        if let Some(near) = nearest_name(input, header.iter().map(String::as_str)) {
            hints.insert(0, format!("did you mean `{near}` to be `{input}`?"));
        }
        let message = format!(
            "{} has no column for the input `{input}`",
            self.path.display()
        );
        Failure::usage(message, hints)
    }

    /// Stores the values of a row.
    fn read(&mut self, row: &[String]) -> Result<(), Failure> {
        if row.len() != self.width && row.iter().skip(self.width).any(|c| !c.is_empty())
            || row.len() < self.width
        {
            let cells = counted_things(row.len(), "cell");
            let what = format!("{cells} where the header has {}", self.width);
            let hint = "decimal commas need `;` or a tab between cells".to_owned();
            return Err(self.table_fault(&what, vec![hint]));
        }
        let time = match self.time {
            Some(column) => self.value(&row[column], "the time")?,
            None => self.times.len() as f64,
        };
        if time < 0.0 || self.times.last().is_some_and(|last| time <= *last) {
            let what =
                format!("time {time} s is out of order: times start at 0 or later and increase");
            let hint = "without a column `time`, row k is at k seconds".to_owned();
            return Err(self.table_fault(&what, vec![hint]));
        }
        self.times.push(time);
        for k in 0..self.columns.len() {
            let input = &self.mechanism.inputs[k];
            let value = self.value(&row[self.columns[k]], &format!("`{}`", input.name))?;
            self.values[k].push(value / self.mechanism.file_units(input.kind));
        }
        if self.times.len() > MAX_ROWS {
            let message = format!("{} has more than {MAX_ROWS} rows", self.path.display());
            return Err(Failure::usage(message, Vec::new()));
        }
        let numbers = (self.times.len() * (1 + self.columns.len())) as f64;
        Ok(current_limits().allow(Resource::Samples, numbers, &self.path.display())?)
    }

    fn value(&mut self, cell: &str, of: &str) -> Result<f64, Failure> {
        let value = self.cells.value(cell);
        value.map_err(|why| {
            let what = format!("`{cell}` is not a value for {of}");
            self.table_fault(&what, vec![why])
        })
    }
}
