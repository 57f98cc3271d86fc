//! Reads the reference tables of `tests/data`, and sets up the mechanisms that are compared with them.

pub mod scenes;

use crate::driven::Model;
use mechanim::diag::Source;
use mechanim::model::drive::{Drive, Ease};
use mechanim::model::mechanism::Mechanism;

use mechanim::scene::{Overrides, load_scene};

/// The mechanism of a scene, with some of its inputs driven otherwise.
pub fn mechanism(source: &Source, inputs: &[(&str, &str)]) -> Model {
    let pairs = inputs.iter().map(|(n, v)| (n.to_string(), v.to_string()));
    let overrides = Overrides {
        inputs: pairs.collect(),
        ..Overrides::default()
    };
    let scene = load_scene(source, &overrides).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    scene.into()
}

/// Drives the inputs by the columns of a table that bear their names; returns the times of the rows.
pub fn drive_by_rows(mechanism: &mut Model, table: &Table) -> Vec<f64> {
    let times: Vec<f64> = (0..table.len()).map(|k| k as f64).collect();
    mechanism.actuation.drives = mechanism
        .inputs
        .iter()
        .map(|input| Drive::Keys {
            times: times.clone(),
            values: table.column(&input.name),
            ease: Ease::Linear,
        })
        .collect();
    mechanism.actuation.duration = times[times.len() - 1];
    times
}

/// A CSV table with a header row and no quoted cells.
pub struct Table {
    header: Vec<String>,
    rows: Vec<Vec<String>>,
}

impl Table {
    /// Reads `tests/data/NAME.csv`.
    pub fn read(name: &str) -> Self {
        let path = format!("{}/tests/data/{name}.csv", env!("CARGO_MANIFEST_DIR"));
        let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        let cells = |line: &str| line.split(',').map(str::to_owned).collect::<Vec<_>>();
        let mut lines = text.lines();
        let header = cells(lines.next().expect("a header"));
        let rows: Vec<_> = lines.map(cells).collect();
        assert!(
            !rows.is_empty() && rows.iter().all(|r| r.len() == header.len()),
            "{path} is not a full table"
        );
        Self { header, rows }
    }

    /// Number of rows.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// A cell as text.
    pub fn text(&self, row: usize, column: &str) -> &str {
        let index = self
            .header
            .iter()
            .position(|h| h == column)
            .unwrap_or_else(|| panic!("no column {column}"));
        &self.rows[row][index]
    }

    /// A cell as a number.
    pub fn value(&self, row: usize, column: &str) -> f64 {
        self.text(row, column)
            .parse()
            .unwrap_or_else(|_| panic!("{column} row {row} is not a number"))
    }

    /// A column of numbers.
    pub fn column(&self, column: &str) -> Vec<f64> {
        (0..self.len()).map(|row| self.value(row, column)).collect()
    }
}

/// The mechanism of `tests/hard/NAME.toml` with some parameters, inputs or start values replaced.
pub fn hard(name: &str, changes: &[(&str, &str, &str)]) -> Model {
    let path = format!("{}/tests/hard/{name}.toml", env!("CARGO_MANIFEST_DIR"));
    let text = std::fs::read_to_string(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
    let source = Source {
        name: name.to_owned(),
        text,
    };
    let of = |section: &str| {
        let chosen = changes.iter().filter(|(s, _, _)| *s == section);
        chosen
            .map(|(_, n, v)| (n.to_string(), v.to_string()))
            .collect()
    };
    let overrides = Overrides {
        parameters: of("param"),
        inputs: of("input"),
        guess: of("guess"),
        ..Overrides::default()
    };
    let scene = load_scene(&source, &overrides).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    scene.into()
}

/// Index of an unknown.
pub fn slot(mechanism: &Mechanism, name: &str) -> usize {
    let position = mechanism.unknowns.iter().position(|c| c.name == name);
    position.unwrap_or_else(|| panic!("no unknown `{name}`"))
}

/// A difference of angles without whole turns.
pub fn turned(difference: f64) -> f64 {
    (difference - std::f64::consts::TAU * (difference / std::f64::consts::TAU).round()).abs()
}
