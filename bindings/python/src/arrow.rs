//! Columns of numbers as an Arrow stream, which data frames read without copying.

use arrow_array::ffi_stream::FFI_ArrowArrayStream;
use arrow_array::{ArrayRef, Float64Array, RecordBatch, RecordBatchIterator};
use arrow_schema::{ArrowError, Field, Schema};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::collections::HashMap;
use std::sync::Arc;

/// The stream of one batch: names, units (in the metadata of the field) and values. NaN is a missing value.
pub fn stream(
    py: Python<'_>,
    columns: Vec<(String, String, Vec<f64>)>,
) -> PyResult<Bound<'_, PyCapsule>> {
    let batch = batch(columns).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    let schema = batch.schema();
    let reader = RecordBatchIterator::new([Ok(batch)], schema);
    let stream = FFI_ArrowArrayStream::new(Box::new(reader));
    PyCapsule::new_with_value(py, stream, c"arrow_array_stream")
}

fn batch(columns: Vec<(String, String, Vec<f64>)>) -> Result<RecordBatch, ArrowError> {
    let mut fields = Vec::new();
    let mut arrays: Vec<ArrayRef> = Vec::new();
    for (name, unit, values) in columns {
        let array: Float64Array = values
            .into_iter()
            .map(|value| (!value.is_nan()).then_some(value))
            .collect();
        let field = Field::new(name, arrow_schema::DataType::Float64, true);
        fields.push(field.with_metadata(HashMap::from([("unit".to_owned(), unit)])));
        arrays.push(Arc::new(array));
    }
    RecordBatch::try_new(Arc::new(Schema::new(fields)), arrays)
}
