//! Tables as Parquet: typed columns in groups of rows, with names and values about the whole table beside them.
//!
//! A number that is not finite is a null, as it is an empty cell elsewhere. The same rows give the same bytes.

use super::error::ExportError;
use super::target::Output;
use parquet::basic::{ConvertedType, Repetition, Type as Physical};
use parquet::data_type::{BoolType, ByteArray, ByteArrayType, DoubleType, Int64Type};
use parquet::errors::ParquetError;
use parquet::file::metadata::KeyValue;
use parquet::file::properties::{EnabledStatistics, WriterProperties};
use parquet::file::writer::{SerializedColumnWriter, SerializedFileWriter};
use parquet::schema::types::{ColumnPath, Type, TypePtr};
use std::io;
use std::sync::Arc;

/// Bytes that a group of rows may take before it is written: readers skip whole groups, and memory holds one.
const GROUP_BYTES: usize = 8 << 20;

/// A column and its cells since the last group.
#[derive(Clone, Debug)]
pub enum ParquetColumn {
    /// Whole numbers.
    Whole(Vec<i64>),
    /// Words of a small set.
    Word(Vec<&'static str>),
    /// Yes or no.
    Flag(Vec<bool>),
    /// Numbers; what is not finite is null.
    Number(Vec<f64>),
}

impl ParquetColumn {
    fn primitive(&self, name: &str) -> Result<TypePtr, ParquetError> {
        let (physical, repetition) = match self {
            Self::Whole(_) => (Physical::INT64, Repetition::REQUIRED),
            Self::Word(_) => (Physical::BYTE_ARRAY, Repetition::REQUIRED),
            Self::Flag(_) => (Physical::BOOLEAN, Repetition::REQUIRED),
            Self::Number(_) => (Physical::DOUBLE, Repetition::OPTIONAL),
        };
        let builder = Type::primitive_type_builder(name, physical).with_repetition(repetition);
        let builder = match self {
            Self::Word(_) => builder.with_converted_type(ConvertedType::UTF8),
            _ => builder,
        };
        Ok(Arc::new(builder.build()?))
    }

    fn write(&self, column: &mut SerializedColumnWriter) -> Result<(), ParquetError> {
        match self {
            Self::Whole(cells) => {
                let writer = column.typed::<Int64Type>();
                writer.write_batch(cells, None, None)?;
            }
            Self::Word(cells) => {
                let words: Vec<ByteArray> = cells.iter().map(|word| (*word).into()).collect();
                let writer = column.typed::<ByteArrayType>();
                writer.write_batch(&words, None, None)?;
            }
            Self::Flag(cells) => {
                let writer = column.typed::<BoolType>();
                writer.write_batch(cells, None, None)?;
            }
            Self::Number(cells) => {
                let finite = cells.iter().copied().filter(|cell| cell.is_finite());
                let finite: Vec<f64> = finite.collect();
                let levels = cells.iter().map(|cell| i16::from(cell.is_finite()));
                let levels: Vec<i16> = levels.collect();
                let writer = column.typed::<DoubleType>();
                writer.write_batch(&finite, Some(&levels), None)?;
            }
        }
        Ok(())
    }

    fn clear(&mut self) {
        match self {
            Self::Whole(cells) => cells.clear(),
            Self::Word(cells) => cells.clear(),
            Self::Flag(cells) => cells.clear(),
            Self::Number(cells) => cells.clear(),
        }
    }
}

/// A Parquet file under construction.
pub struct ParquetTable {
    name: String,
    writer: SerializedFileWriter<Box<dyn Output>>,
    /// The columns, in the order of the file.
    pub columns: Vec<ParquetColumn>,
    rows: usize,
}

impl ParquetTable {
    /// Begins a table of empty columns, each with its name; `about` holds names and values of the whole table.
    ///
    /// # Errors
    ///
    /// Two columns with one name; a failed write.
    pub fn create(
        output: Box<dyn Output>,
        columns: Vec<(String, ParquetColumn)>,
        about: &[(&str, String)],
    ) -> Result<Self, ExportError> {
        let name = output.name().to_owned();
        let writer = begun(output, &columns, about).map_err(|e| failed(&name, e))?;
        Ok(Self {
            name,
            writer,
            columns: columns.into_iter().map(|(_, column)| column).collect(),
            rows: 0,
        })
    }

    /// Ends a row, for which every column has a cell.
    ///
    /// # Errors
    ///
    /// A failed write.
    pub fn end_row(&mut self) -> Result<(), ExportError> {
        self.rows += 1;
        if self.rows * self.columns.len() * size_of::<f64>() < GROUP_BYTES {
            return Ok(());
        }
        self.write_group()
    }

    /// Writes the remaining rows and makes the file final.
    ///
    /// # Errors
    ///
    /// A failed write.
    pub fn commit(mut self) -> Result<(), ExportError> {
        if self.rows > 0 {
            self.write_group()?;
        }
        let output = self.writer.into_inner();
        output.map_err(|e| failed(&self.name, e))?.commit()
    }

    fn write_group(&mut self) -> Result<(), ExportError> {
        let written = write_columns(&mut self.writer, &self.columns);
        written.map_err(|e| failed(&self.name, e))?;
        self.columns.iter_mut().for_each(ParquetColumn::clear);
        self.rows = 0;
        Ok(())
    }
}

fn begun(
    output: Box<dyn Output>,
    columns: &[(String, ParquetColumn)],
    about: &[(&str, String)],
) -> Result<SerializedFileWriter<Box<dyn Output>>, ParquetError> {
    let fields: Result<Vec<TypePtr>, _> = columns
        .iter()
        .map(|(name, column)| column.primitive(name))
        .collect();
    let schema = Type::group_type_builder("rows").with_fields(fields?);
    let about = about.iter();
    let about = about.map(|(key, value)| KeyValue::new((*key).to_owned(), value.clone()));
    let mut properties = WriterProperties::builder()
        .set_created_by(concat!("mechanim ", env!("CARGO_PKG_VERSION")).to_owned())
        .set_key_value_metadata(Some(about.collect()))
        .set_statistics_enabled(EnabledStatistics::Chunk);
    // Numbers rarely repeat: a dictionary of them would be a second copy.
    for (name, column) in columns {
        let repeats = matches!(column, ParquetColumn::Word(_));
        let path = ColumnPath::new(vec![name.clone()]);
        properties = properties.set_column_dictionary_enabled(path, repeats);
    }
    SerializedFileWriter::new(
        output,
        Arc::new(schema.build()?),
        Arc::new(properties.build()),
    )
}

fn write_columns(
    writer: &mut SerializedFileWriter<Box<dyn Output>>,
    columns: &[ParquetColumn],
) -> Result<(), ParquetError> {
    let mut group = writer.next_row_group()?;
    for column in columns {
        let Some(mut chunk) = group.next_column()? else {
            return Err(ParquetError::General("a column too many".to_owned()));
        };
        column.write(&mut chunk)?;
        chunk.close()?;
    }
    group.close()?;
    Ok(())
}

fn failed(name: &str, error: ParquetError) -> ExportError {
    let source = match error {
        ParquetError::External(inner) => match inner.downcast::<io::Error>() {
            Ok(error) => *error,
            Err(other) => io::Error::other(other),
        },
        other => io::Error::other(other),
    };
    ExportError::write(name, source)
}
