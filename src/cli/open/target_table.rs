//! `--target TABLE.csv`: the required behaviour of a mechanism, row by row.

use super::cells::Cells;
use crate::analysis::synthesis::target::{FreeInput, Target, TargetColumn, TargetRow, slot_of};
use crate::cli::term::outcome::Failure;
use crate::kinematics::motion::sampling::is_cyclic;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use crate::report::sentences::counted_things;
use crate::scene::source::open_input;
use std::f64::consts::TAU;
use std::io::{BufRead, BufReader};
use std::path::Path;

/// Name of the column of seconds.
const TIME: &str = "time";

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
    let name = path.display();
    let failed = |e: std::io::Error| Failure::usage(format!("cannot read {name}: {e}"), Vec::new());
    let file: Box<dyn BufRead> = match path == Path::new("-") {
        true => Box::new(std::io::stdin().lock()),
        false => Box::new(BufReader::new(open_input(path).map_err(failed)?)),
    };
    let mut table = TargetTable {
        path,
        mechanism,
        actuation,
        own,
        cells: Cells::new(file),
        columns: Vec::new(),
        target: Target {
            columns: Vec::new(),
            rows: Vec::new(),
            free_input: None,
        },
        keys: Vec::new(),
        ignored: 0,
    };
    table.read_header()?;
    while let Some(row) = table.next()? {
        table.read(&row)?;
    }
    let is_empty = table.target.rows.is_empty();
    if is_empty && table.ignored == 0 {
        return Err(Failure::usage(format!("{name} has no rows"), Vec::new()));
    }
    if is_empty {
        let message = format!("every row of {name} has weight 0");
        let hint = "weights multiply squared errors: there would be nothing to fit".to_owned();
        return Err(Failure::usage(message, vec![hint]));
    }
    table.target.free_input = table.free_input()?;
    Ok(table.target)
}

/// A table being read.
struct TargetTable<'t> {
    path: &'t Path,
    mechanism: &'t Mechanism,
    actuation: &'t Actuation,
    own: usize,
    cells: Cells<Box<dyn BufRead>>,
    columns: Vec<TableColumn>,
    target: Target,
    /// Line numbers with the time or input values of each row.
    keys: Vec<(usize, Vec<f64>)>,
    /// Rows without weight.
    ignored: usize,
}

impl TargetTable<'_> {
    /// An error at cell `column` of the last line read.
    fn wrong(&self, row: &[String], column: usize, what: &str, hint: &str) -> Failure {
        // Column at which the cell begins, if nothing before it is quoted.
        let before: usize = row.iter().take(column).map(|c| c.chars().count() + 1).sum();
        let place = format!(
            "{}:{}:{}",
            self.path.display(),
            self.cells.number,
            before + 1
        );
        Failure::usage(format!("{place}: {what}"), vec![hint.to_owned()])
    }

    fn next(&mut self) -> Result<Option<Vec<String>>, Failure> {
        let row = self.cells.row();
        row.map_err(|why| self.wrong(&[], 0, &why, "tables are CSV with a header"))
    }

    fn read_header(&mut self) -> Result<(), Failure> {
        let Some(header) = self.next()? else {
            let message = format!("{} is empty", self.path.display());
            let hint = "the first line names the columns".to_owned();
            return Err(Failure::usage(message, vec![hint]));
        };
        let mechanism = self.mechanism;
        for (k, name) in header.iter().enumerate() {
            if header[..k].contains(name) {
                let what = format!("there are two columns `{name}`");
                return Err(self.wrong(&header, k, &what, "write one column per quantity"));
            }
            let mut inputs = mechanism.inputs.iter().take(self.own);
            let input = inputs.position(|input| input.name == *name);
            let column = match (name.as_str(), input, slot_of(mechanism, name)) {
                (_, Some(input), _) => TableColumn::Input(input),
                (TIME, _, None) => TableColumn::Time,
                (WEIGHT, _, None) => TableColumn::Weight,
                (_, None, Some(slot)) => {
                    let is_angle = self.kind_of(slot) == Kind::Angle;
                    self.target.columns.push(TargetColumn {
                        name: name.clone(),
                        slot,
                        reach: if is_angle { mechanism.size } else { 1.0 },
                        is_angle,
                    });
                    TableColumn::Target(self.target.columns.len() - 1)
                }
                (_, None, None) => {
                    let what = format!(
                        "`{name}` is not an input, unknown, output or coordinate of a traced point"
                    );
                    let hint = format!("available: {}", self.known_names());
                    return Err(self.wrong(&header, k, &what, &hint));
                }
            };
            self.columns.push(column);
        }
        let is_timed = self.columns.iter().any(|c| matches!(c, TableColumn::Time));
        let place = self
            .columns
            .iter()
            .position(|c| matches!(c, TableColumn::Input(_)));
        if let Some(place) = place.filter(|_| is_timed) {
            let what = "both inputs and times say when a row is met";
            return Err(self.wrong(&header, place, what, "leave out one of the two columns"));
        }
        if self.target.columns.is_empty() {
            let what = "no column has targets";
            let hint = format!("available: {}", self.known_names());
            return Err(self.wrong(&header, 0, what, &hint));
        }
        Ok(())
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

    fn known_names(&self) -> String {
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
        all.collect::<Vec<_>>().join(", ")
    }

    /// Stores the values of a row.
    fn read(&mut self, row: &[String]) -> Result<(), Failure> {
        let width = self.columns.len();
        if row.len() != width {
            let cells = counted_things(row.len(), "cell");
            let what = format!("{cells} where the header has {width}");
            let hint = "decimal commas need `;` or a tab between cells";
            return Err(self.wrong(row, row.len().min(width), &what, hint));
        }
        if self.target.rows.len() >= MOST_ROWS {
            let message = format!("{} has more than {MOST_ROWS} rows", self.path.display());
            return Err(Failure::usage(message, Vec::new()));
        }
        let mut values = vec![0.0; self.target.columns.len()];
        let (mut weight, mut time) = (1.0, None);
        let mut inputs = self.actuation.inputs_at(0.0)[..self.own].to_vec();
        let mut key: Option<(usize, Vec<f64>)> = None;
        for (k, cell) in row.iter().enumerate() {
            if cell.is_empty() {
                let what = "a gap in the table";
                return Err(self.wrong(
                    row,
                    k,
                    what,
                    "leave the whole row out, or set its weight to 0",
                ));
            }
            let value = self.cells.value(cell);
            let value = value
                .map_err(|why| self.wrong(row, k, &format!("`{cell}` is not a number"), &why))?;
            match self.columns[k] {
                TableColumn::Time => {
                    time = Some((k, value));
                    key = Some((k, vec![value]));
                }
                TableColumn::Weight if value < 0.0 => {
                    return Err(self.wrong(
                        row,
                        k,
                        "a weight below zero",
                        "weights multiply squared errors",
                    ));
                }
                TableColumn::Weight => weight = value,
                TableColumn::Input(input) => {
                    let unit = self.mechanism.unit_of(self.mechanism.inputs[input].kind);
                    inputs[input] = value * unit.number();
                    let (_, list) = key.get_or_insert((k, Vec::new()));
                    list.push(value);
                }
                TableColumn::Target(index) => {
                    let kind = self.kind_of(self.target.columns[index].slot);
                    values[index] = value * self.mechanism.unit_of(kind).number();
                }
            }
        }
        // Rows without weight are no targets.
        if weight == 0.0 {
            self.ignored += 1;
            return Ok(());
        }
        if let Some((k, time)) = time {
            let last = self.actuation.duration;
            if !(0.0..=last).contains(&time) {
                let what = format!("time {time} s is outside of the drive");
                let hint = format!("it lasts from 0 to {last} s");
                return Err(self.wrong(row, k, &what, &hint));
            }
            inputs = self.actuation.inputs_at(time)[..self.own].to_vec();
        }
        let line = self.cells.number;
        if let Some((k, key)) = &key {
            if let Some((other, _)) = self.keys.iter().find(|(_, known)| known == key) {
                let what = format!("line {other} has the same time or inputs");
                let hint = "write one row per time, with all targets of a pose in it";
                return Err(self.wrong(row, *k, &what, hint));
            }
            self.keys.push((line, key.clone()));
        }
        self.target.rows.push(TargetRow {
            line,
            inputs: key.map(|_| inputs),
            values,
            weight,
        });
        Ok(())
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
                self.path.display(),
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
