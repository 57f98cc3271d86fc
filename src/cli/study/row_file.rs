//! The file of a sweep's rows: lines of text, or Parquet where the program writes it.

use crate::cli::args::sweep::RowsArgs;
use crate::cli::io;
use crate::cli::term::outcome::Failure;
use crate::export::Output;
#[cfg(feature = "parquet")]
use crate::export::parquet::{ParquetColumn, ParquetTable};
use crate::parts::plan::StudyPlan;
use crate::sweep::row::Row;
use crate::sweep::swept_scene::Sweep;
use crate::sweep::table::{RowFormat, RowTable};
use std::path::Path;

/// Size of the text that is written at once.
const BUFFER: usize = 1 << 16;

/// A file of rows under construction.
pub enum RowFile<'s> {
    /// Lines of text, and those not yet written.
    Lines(RowTable<'s>, Box<dyn Output>, String),
    /// Typed columns, from the sweep's rows.
    #[cfg(feature = "parquet")]
    Columns(&'s Sweep, Box<ParquetTable>),
}

/// The format that a file's name selects.
enum RowFileFormat {
    Lines(RowFormat),
    Parquet,
}

/// Refuses a file of rows of unknown format.
pub fn refuse_format(rows: &RowsArgs) -> Result<(), Failure> {
    rows.out.as_deref().map(kind_of).transpose().map(|_| ())
}

fn kind_of(path: &Path) -> Result<RowFileFormat, Failure> {
    if path == Path::new("-") {
        return Ok(RowFileFormat::Lines(RowFormat::Csv));
    }
    let extension = path.extension().map(|e| e.to_string_lossy().to_lowercase());
    match extension.as_deref() {
        Some("csv") => Ok(RowFileFormat::Lines(RowFormat::Csv)),
        Some("jsonl") => Ok(RowFileFormat::Lines(RowFormat::JsonLines)),
        Some("parquet") if cfg!(feature = "parquet") => Ok(RowFileFormat::Parquet),
        Some("parquet") => Err(without_parquet(path)),
        _ => {
            let known = "known kinds: .csv, .jsonl and .parquet";
            Err(Failure::unknown_kind(path, "table", known))
        }
    }
}

fn without_parquet(path: &Path) -> Failure {
    let message = format!("{}: this program was built without Parquet", path.display());
    let hint =
        "build it with `--features parquet`, or install the Python package, whose program has it";
    Failure::usage(message, vec![hint.to_owned()])
}

impl<'s> RowFile<'s> {
    /// Opens the file at `path` for the rows of `sweep`.
    pub fn open(sweep: &'s Sweep, plan: &StudyPlan, path: &Path) -> Result<Self, Failure> {
        match kind_of(path)? {
            RowFileFormat::Lines(format) => {
                let table = RowTable::new(sweep, format);
                let header = table.header();
                Ok(Self::Lines(table, io::open_output(path)?, header))
            }
            RowFileFormat::Parquet => Self::columns(sweep, plan, path),
        }
    }

    #[cfg(not(feature = "parquet"))]
    fn columns(_: &'s Sweep, _: &StudyPlan, path: &Path) -> Result<Self, Failure> {
        Err(without_parquet(path))
    }

    #[cfg(feature = "parquet")]
    fn columns(sweep: &'s Sweep, plan: &StudyPlan, path: &Path) -> Result<Self, Failure> {
        let mut names = RowTable::new(sweep, RowFormat::Csv).into_names();
        let numbers = names.split_off(3);
        let first = [
            ParquetColumn::Whole(Vec::new()),
            ParquetColumn::Word(Vec::new()),
            ParquetColumn::Flag(Vec::new()),
        ];
        let numbers = numbers
            .into_iter()
            .map(|name| (name, ParquetColumn::Number(Vec::new())));
        let columns = names.into_iter().zip(first).chain(numbers).collect();
        let units: serde_json::Map<String, serde_json::Value> = sweep
            .columns
            .iter()
            .filter(|(_, unit)| !unit.is_empty())
            .map(|(name, unit)| (name.clone(), unit.as_str().into()))
            .collect();
        let about = [
            ("mechanim.version", plan.version.clone()),
            ("mechanim.scene", plan.scene.clone()),
            ("mechanim.arguments", plan.arguments.join(" ")),
            ("mechanim.identity", plan.identity.clone()),
            ("mechanim.units", serde_json::Value::from(units).to_string()),
        ];
        let table = ParquetTable::create(io::open_output(path)?, columns, &about)?;
        Ok(Self::Columns(sweep, Box::new(table)))
    }

    /// Adds the row of design `item`.
    pub fn take(&mut self, item: u64, row: &Row) -> Result<(), Failure> {
        match self {
            Self::Lines(table, output, text) => {
                table.add(item, row, text);
                if text.len() > BUFFER {
                    output.emit(text.as_bytes())?;
                    text.clear();
                }
                Ok(())
            }
            #[cfg(feature = "parquet")]
            Self::Columns(sweep, table) => {
                let design = sweep.design.values(item);
                let mut numbers = row.numbers(&design);
                for column in &mut table.columns {
                    match column {
                        ParquetColumn::Whole(cells) => cells.push(item as i64),
                        ParquetColumn::Word(cells) => cells.push(row.status.word()),
                        ParquetColumn::Flag(cells) => cells.push(row.is_feasible),
                        ParquetColumn::Number(cells) => cells.extend(numbers.next()),
                    }
                }
                Ok(table.end_row()?)
            }
        }
    }

    /// Ends the file.
    pub fn commit(self) -> Result<(), Failure> {
        match self {
            Self::Lines(_, mut output, text) => {
                output.emit(text.as_bytes())?;
                Ok(output.commit()?)
            }
            #[cfg(feature = "parquet")]
            Self::Columns(_, table) => Ok(table.commit()?),
        }
    }
}
