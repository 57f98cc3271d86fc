//! Bands that contain every piece within its tolerances, as arrays.

use crate::errors::OrRaise;
use numpy::{IntoPyArray, PyArray2, PyArrayMethods};
use pyo3::prelude::*;

/// Proved bands that contain the motion of every piece within its tolerances. Returned by `Scene.enclose`.
///
/// `enclosure["M.x"]` has shape (n, 2): the lower and the upper end at every sample, in the scene's units; NaN where nothing
/// is proved.
#[pyclass(frozen, module = "mechanim")]
pub struct Enclosure {
    inner: mechanim::study::Enclosure,
}

impl Enclosure {
    pub(crate) fn new(inner: mechanim::study::Enclosure) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl Enclosure {
    /// Lower and upper end of the band of an unknown, of `name.x` of a traced point, or of an output, shape (n, 2).
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyArray2<f64>>> {
        let bands = self.inner.bands(name).or_raise(py)?;
        let rows = bands.len();
        let flat: Vec<f64> = bands.into_iter().flatten().collect();
        flat.into_pyarray(py).reshape([rows, 2])
    }

    /// All samples with values, bands, status, the smallest and largest piece found, and refusals, as a dictionary (schema `mechanim-enclosure/1`).
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?
            .getattr("loads")?
            .call1((self.inner.to_json(),))
    }
}
