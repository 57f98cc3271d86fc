//! `--input-table TABLE.csv`: rows of input values instead of the scene's drive, one sample per row.

use super::named_table::{NamedTable, TIME};
use crate::cli::term::outcome::Failure;
use crate::diag::name_hint;
use crate::limits::{Resource, current_limits};
use crate::model::actuation::Actuation;
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::Mechanism;
use std::path::Path;

/// Maximum number of rows.
const MAX_ROWS: usize = crate::kinematics::motion::sampling::MAX_SAMPLES;

/// Replaces the drives. Columns are found by name, others are ignored. A time column gives the time of each row;
/// otherwise row k is at second k, and the warning returned says so if another column may have been meant as the time.
pub fn apply_inputs(
    mechanism: &Mechanism,
    actuation: &mut Actuation,
    path: &Path,
) -> Result<Option<String>, Failure> {
    let mut inputs = InputsTable {
        mechanism,
        table: NamedTable::open(path)?,
        columns: Vec::new(),
        time: None,
        times: Vec::new(),
        values: vec![Vec::new(); mechanism.inputs.len()],
    };
    inputs.find_columns()?;
    while let Some(row) = inputs.table.next_row()? {
        inputs.read(&row)?;
    }
    let Some(last) = inputs.times.last().copied() else {
        let message = format!("{} has no rows of values for the inputs", path.display());
        return Err(Failure::usage(message, Vec::new()));
    };
    let warning = inputs.ignored_columns();
    let InputsTable { times, values, .. } = inputs;
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
    mechanism: &'t Mechanism,
    table: NamedTable<'static>,
    /// Column of every input.
    columns: Vec<usize>,
    time: Option<usize>,
    times: Vec<f64>,
    values: Vec<Vec<f64>>,
}

impl InputsTable<'_> {
    fn is_input(&self, name: &str) -> bool {
        self.mechanism.inputs.iter().any(|i| i.name == name)
    }

    fn find_columns(&mut self) -> Result<(), Failure> {
        for input in &self.mechanism.inputs {
            let column = self.table.find_column(&input.name)?;
            self.columns
                .push(column.ok_or_else(|| self.missing(&input.name))?);
        }
        self.time = self.table.find_time(|name| self.is_input(name))?;
        Ok(())
    }

    fn missing(&self, input: &str) -> Failure {
        let what = format!("there is no column for the input `{input}`");
        let named = self.table.header.iter().filter(|name| !name.is_empty());
        // The columns of other inputs are not meant.
        let named = named.filter(|name| !self.is_input(name));
        let named: Vec<&str> = named.map(String::as_str).collect();
        let hint = match named.is_empty() {
            true => "every input needs a column of its name".to_owned(),
            false => name_hint(input, named),
        };
        self.table.fault(0, &what, &hint)
    }

    /// A warning of columns that are not read, where one of them may have been meant as the time.
    fn ignored_columns(&self) -> Option<String> {
        let header = self.table.header.iter();
        let others = header.filter(|name| !name.is_empty() && !self.is_input(name));
        let others: Vec<String> = others.map(|name| format!("`{name}`")).collect();
        if self.time.is_some() || others.is_empty() {
            return None;
        }
        let ignored = match others.len() {
            1 => format!("column {} is", others[0]),
            _ => format!("columns {} are", others.join(", ")),
        };
        let table = &self.table.name;
        Some(format!(
            "{table} has no column `{TIME}`: row k is at k seconds, {ignored} ignored"
        ))
    }

    /// Stores the values of a row.
    fn read(&mut self, row: &[String]) -> Result<(), Failure> {
        let time = self.time_of(row)?;
        self.times.push(time);
        for (k, input) in self.mechanism.inputs.iter().enumerate() {
            let value = self.table.number(row, self.columns[k])?;
            self.values[k].push(self.mechanism.inner_value(input.kind, value));
        }
        self.allow_rows()
    }

    fn time_of(&mut self, row: &[String]) -> Result<f64, Failure> {
        let time = match self.time {
            Some(column) => self.table.number(row, column)?,
            None => self.times.len() as f64,
        };
        if time < 0.0 || self.times.last().is_some_and(|last| time <= *last) {
            let what =
                format!("time {time} s is out of order: times start at 0 or later and increase");
            let hint = "without a column `time`, row k is at k seconds";
            return Err(self.table.fault(self.time.unwrap_or(0), &what, hint));
        }
        Ok(time)
    }

    fn allow_rows(&self) -> Result<(), Failure> {
        let name = &self.table.name;
        if self.times.len() > MAX_ROWS {
            let message = format!("{name} has more than {MAX_ROWS} rows");
            return Err(Failure::usage(message, Vec::new()));
        }
        let numbers = (self.times.len() * (1 + self.columns.len())) as f64;
        Ok(current_limits().allow(Resource::Samples, numbers, name)?)
    }
}
