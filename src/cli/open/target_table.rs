//! `--target TABLE.csv`: the required behaviour of a mechanism, row by row.

use super::named_table::{NamedTable, TIME};
use crate::analysis::synthesis::target::{FreeInput, Target, TargetColumn, TargetRow, slot_of};
use crate::cli::term::outcome::Failure;
use crate::diag::{list_names, name_hint};
use crate::kinematics::motion::sampling::is_cyclic;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::TAU;
use std::path::Path;

/// Name of the column of weights.
const WEIGHT: &str = "weight";

/// Maximum number of rows: every step of a search solves as many poses, and as many equations where inputs are free.
const MOST_ROWS: usize = 1000;

/// Instants at which the range of a free input is sampled.
const INSTANTS: usize = 64;

/// Content of a column.
enum TableColumn {
    Time,
    Weight,
    Input(usize),
    /// Index among the target's columns.
    Target(usize),
}

/// Reads a table for a mechanism whose own inputs are the first `own`.
pub fn read_target(
    path: &Path,
    (mechanism, actuation): (&Mechanism, &Actuation),
    own: usize,
) -> Result<Target, Failure> {
    let mut asked = TargetTable {
        mechanism,
        actuation,
        own,
        table: NamedTable::open(path)?,
        columns: Vec::new(),
        target: Target {
            columns: Vec::new(),
            rows: Vec::new(),
            free_input: None,
        },
        keys: Vec::new(),
        ignored: 0,
    };
    asked.read_header()?;
    while let Some(row) = asked.table.next_row()? {
        asked.read(&row)?;
    }
    asked.refuse_empty()?;
    asked.target.free_input = asked.free_input()?;
    Ok(asked.target)
}

/// A table being read.
struct TargetTable<'t> {
    mechanism: &'t Mechanism,
    actuation: &'t Actuation,
    own: usize,
    table: NamedTable<'static>,
    columns: Vec<TableColumn>,
    target: Target,
    /// Line numbers with the time or input values of each row.
    keys: Vec<(usize, Vec<f64>)>,
    /// Rows without weight.
    ignored: usize,
}

/// The values of a row, in the mechanism's units.
struct ReadRow {
    targets: Vec<f64>,
    weight: f64,
    time: Option<f64>,
    inputs: Vec<f64>,
    /// The first column that says when the row is met, and the time or the inputs as written.
    key: Option<(usize, Vec<f64>)>,
}

impl TargetTable<'_> {
    fn read_header(&mut self) -> Result<(), Failure> {
        self.table.refuse_unclear_columns()?;
        let is_quantity = |name: &str| slot_of(self.mechanism, name).is_some();
        let is_taken = |name: &str| self.own_input(name).is_some() || is_quantity(name);
        let time = self.table.find_time(is_taken)?;
        for k in 0..self.table.header.len() {
            let column = match time == Some(k) {
                true => TableColumn::Time,
                false => self.column_of(k)?,
            };
            self.columns.push(column);
        }
        self.refuse_inputs_beside(time)?;
        if self.target.columns.is_empty() {
            let names = self.known_names();
            let hint = list_names(names.iter().map(String::as_str));
            return Err(self.table.fault(0, "no column has targets", &hint));
        }
        Ok(())
    }

    fn own_input(&self, name: &str) -> Option<usize> {
        let mut inputs = self.mechanism.inputs.iter().take(self.own);
        inputs.position(|input| input.name == name)
    }

    /// What a column other than the time contains; that of a target is added to the others.
    fn column_of(&mut self, k: usize) -> Result<TableColumn, Failure> {
        let name = self.table.header[k].clone();
        if let Some(input) = self.own_input(&name) {
            return Ok(TableColumn::Input(input));
        }
        let Some(slot) = slot_of(self.mechanism, &name) else {
            return match name == WEIGHT {
                true => Ok(TableColumn::Weight),
                false => Err(self.unknown_column(k)),
            };
        };
        let is_angle = self.kind_of(slot) == Kind::Angle;
        self.target.columns.push(TargetColumn {
            name,
            slot,
            reach: if is_angle { self.mechanism.size } else { 1.0 },
            is_angle,
        });
        Ok(TableColumn::Target(self.target.columns.len() - 1))
    }

    fn unknown_column(&self, k: usize) -> Failure {
        let name = &self.table.header[k];
        let what =
            format!("`{name}` is not an input, unknown, output or coordinate of a traced point");
        let names = self.known_names();
        let hint = name_hint(name, names.iter().map(String::as_str));
        self.table.fault(k, &what, &hint)
    }

    fn refuse_inputs_beside(&self, time: Option<usize>) -> Result<(), Failure> {
        let is_input = |column: &TableColumn| matches!(column, TableColumn::Input(_));
        let input = self.columns.iter().position(is_input);
        let Some((input, _)) = input.zip(time) else {
            return Ok(());
        };
        let what = "both inputs and times say when a row is met";
        let hint = "leave out one of the two columns";
        Err(self.table.fault(input, what, hint))
    }

    fn kind_of(&self, slot: usize) -> Kind {
        let mechanism = self.mechanism;
        let behind = mechanism.coordinate_count() + 3 * mechanism.traces.len();
        match slot.checked_sub(behind) {
            Some(output) => mechanism.outputs[output].kind,
            None if slot < mechanism.coordinate_count() => mechanism.kind_of(slot),
            None => Kind::Length,
        }
    }

    /// Names that a column may have.
    fn known_names(&self) -> Vec<String> {
        let mechanism = self.mechanism;
        let inputs = mechanism.inputs.iter().take(self.own);
        let inputs = inputs.map(|input| input.name.clone());
        let traces = mechanism.traces.iter();
        let traces = traces.flat_map(|t| ["x", "y", "z"].map(|axis| format!("{}.{axis}", t.name)));
        let outputs = mechanism.outputs.iter().map(|o| o.name.clone());
        let unknowns = mechanism.unknowns.iter().map(|u| u.name.clone());
        let own = [TIME, WEIGHT].map(str::to_owned).into_iter();
        let all = traces
            .chain(outputs)
            .chain(unknowns)
            .chain(inputs)
            .chain(own);
        all.collect()
    }

    /// Stores the values of a row; rows without weight are no targets.
    fn read(&mut self, row: &[String]) -> Result<(), Failure> {
        if self.target.rows.len() >= MOST_ROWS {
            let message = format!("{} has more than {MOST_ROWS} rows", self.table.name);
            return Err(Failure::usage(message, Vec::new()));
        }
        let found = self.read_cells(row)?;
        if found.weight == 0.0 {
            self.ignored += 1;
            return Ok(());
        }
        let inputs = self.inputs_of(&found)?;
        self.refuse_repeated(&found)?;
        self.target.rows.push(TargetRow {
            line: self.table.line(),
            inputs,
            values: found.targets,
            weight: found.weight,
        });
        Ok(())
    }

    fn read_cells(&mut self, row: &[String]) -> Result<ReadRow, Failure> {
        let mut found = ReadRow {
            targets: vec![0.0; self.target.columns.len()],
            weight: 1.0,
            time: None,
            inputs: self.actuation.inputs_at(0.0)[..self.own].to_vec(),
            key: None,
        };
        for (k, cell) in row.iter().enumerate() {
            if cell.is_empty() {
                let hint = "leave the whole row out, or write any number there and 0 as its weight";
                return Err(self.table.fault(k, "a gap in the table", hint));
            }
            let value = self.table.number(row, k)?;
            self.read_cell(k, value, &mut found)?;
        }
        Ok(found)
    }

    fn read_cell(&self, k: usize, value: f64, found: &mut ReadRow) -> Result<(), Failure> {
        match self.columns[k] {
            TableColumn::Time => {
                found.time = Some(value);
                found.key = Some((k, vec![value]));
            }
            TableColumn::Weight if value < 0.0 => {
                let hint = "weights multiply squared errors";
                return Err(self.table.fault(k, "a weight below zero", hint));
            }
            TableColumn::Weight => found.weight = value,
            TableColumn::Input(input) => {
                let unit = self.mechanism.unit_of(self.mechanism.inputs[input].kind);
                found.inputs[input] = value * unit.number();
                let (_, list) = found.key.get_or_insert((k, Vec::new()));
                list.push(value);
            }
            TableColumn::Target(index) => {
                let kind = self.kind_of(self.target.columns[index].slot);
                found.targets[index] = value * self.mechanism.unit_of(kind).number();
            }
        }
        Ok(())
    }

    /// The inputs at which a row is met, if it says so: its own, or those of the drive at its time.
    fn inputs_of(&self, found: &ReadRow) -> Result<Option<Vec<f64>>, Failure> {
        let Some((k, _)) = found.key else {
            return Ok(None);
        };
        let Some(time) = found.time else {
            return Ok(Some(found.inputs.clone()));
        };
        let last = self.actuation.duration;
        if !(0.0..=last).contains(&time) {
            let what = format!("time {time} s is outside of the drive");
            let hint = format!("it lasts from 0 to {last} s");
            return Err(self.table.fault(k, &what, &hint));
        }
        Ok(Some(self.actuation.inputs_at(time)[..self.own].to_vec()))
    }

    fn refuse_repeated(&mut self, found: &ReadRow) -> Result<(), Failure> {
        let Some((k, key)) = &found.key else {
            return Ok(());
        };
        if let Some((other, _)) = self.keys.iter().find(|(_, known)| known == key) {
            let what = format!("line {other} has the same time or inputs");
            let hint = "write one row per time, with all targets of a pose in it";
            return Err(self.table.fault(*k, &what, hint));
        }
        self.keys.push((self.table.line(), key.clone()));
        Ok(())
    }

    /// Refuses a table that asks for nothing.
    fn refuse_empty(&self) -> Result<(), Failure> {
        let name = &self.table.name;
        if !self.target.rows.is_empty() {
            return Ok(());
        }
        if self.ignored == 0 {
            return Err(Failure::usage(format!("{name} has no rows"), Vec::new()));
        }
        let message = format!("every row of {name} has weight 0");
        let hint = "weights multiply squared errors: there would be nothing to fit".to_owned();
        Err(Failure::usage(message, vec![hint]))
    }

    /// The free input, where the table has no column for inputs.
    fn free_input(&self) -> Result<Option<FreeInput>, Failure> {
        if !self.keys.is_empty() {
            return Ok(None);
        }
        let actuation = self.actuation;
        let instants = (0..=INSTANTS)
            .map(|k| actuation.inputs_at(actuation.duration * k as f64 / INSTANTS as f64));
        let instants: Vec<Vec<f64>> = instants.collect();
        let range = |input: usize| {
            let values = instants.iter().map(|inputs| inputs[input]);
            let low = values.clone().fold(f64::INFINITY, f64::min);
            [low, values.fold(f64::NEG_INFINITY, f64::max)]
        };
        let moving: Vec<usize> = (0..self.own)
            .filter(|input| range(*input)[0] < range(*input)[1])
            .collect();
        let &[input] = moving.as_slice() else {
            let message = format!(
                "{} does not say when its rows are met, and {} inputs move",
                self.table.name,
                moving.len()
            );
            let hint = format!("add a column `{TIME}`, or one for every input");
            return Err(Failure::usage(message, vec![hint]));
        };
        let [low, high] = range(input);
        let is_angle = self.mechanism.inputs[input].kind == Kind::Angle;
        let is_cyclic = is_angle && is_cyclic(self.mechanism, actuation);
        Ok(Some(FreeInput {
            input,
            range: [low, if is_cyclic { low + TAU } else { high }],
            is_cyclic,
        }))
    }
}
