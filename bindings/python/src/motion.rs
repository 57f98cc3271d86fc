//! Motions as arrays.

use crate::arguments::{NameList, entries, numbers_shaped};
use crate::arrow::stream;
use crate::errors::{OrRaise, argument_error, no_entry, warn};
use crate::scene::Scene;
use crate::signals::watched;
use image::{ImageFormat, RgbaImage};
use mechanim::{Certificate, Pose, Samples};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use pyo3::types::{IntoPyDict, PyBytes, PyCapsule, PyDict, PyMapping, PyString, PyTuple};
use std::io::Cursor;
use std::sync::Arc;

/// A solved motion: its values as arrays with one entry per sample, in the scene's units. Samples without a pose are NaN.
/// Can be pickled: the pickle has what was asked for, and solves it again.
#[pyclass(frozen, module = "mechanim")]
pub struct Motion {
    scene: mechanim::Scene,
    inner: Arc<mechanim::Motion>,
    origin: Origin,
}

/// What a motion was solved from.
pub(crate) struct Origin {
    /// Before rows of inputs replaced its drives.
    pub scene: Scene,
    /// Its samples.
    pub samples: Samples,
    /// Rows of inputs by their names.
    pub columns: Columns,
}

/// Rows of inputs by their names.
pub(crate) type Columns = Vec<(String, Vec<f64>)>;

type Array<'py> = Bound<'py, PyAny>;

/// An array of some shape.
fn shaped<'py, T: numpy::Element>(
    py: Python<'py>,
    values: Vec<T>,
    shape: &[usize],
) -> PyResult<Array<'py>> {
    Ok(PyArray1::from_vec(py, values)
        .reshape(shape.to_vec())?
        .into_any())
}

impl Motion {
    pub(crate) fn new(
        py: Python<'_>,
        (scene, origin): (mechanim::Scene, Origin),
        inner: mechanim::Motion,
    ) -> PyResult<Self> {
        if !inner.is_whole() {
            let missing = (0..inner.len())
                .filter(|k| inner.pose(*k).is_none())
                .count();
            let events = inner.events().join("; ");
            let what = match missing {
                0 => "every sample has a pose, but not every instant between them".to_owned(),
                _ => format!("{missing} of {} samples have no pose", inner.len()),
            };
            let message = format!("{what}: {events}");
            warn(py, "MotionWarning", &message)?;
        }
        let inner = Arc::new(inner);
        Ok(Self {
            scene,
            inner,
            origin,
        })
    }

    /// A number of every pose, NaN where there is none.
    fn each<'py>(&self, py: Python<'py>, of: impl Fn(&Pose<'_>) -> f64) -> PyResult<Array<'py>> {
        let value = |k| self.inner.pose(k).map_or(f64::NAN, |pose| of(&pose));
        shaped(
            py,
            (0..self.inner.len()).map(value).collect(),
            &[self.inner.len()],
        )
    }

    fn picture(
        &self,
        py: Python<'_>,
        sample: usize,
        size: (u32, u32),
        dark: bool,
    ) -> PyResult<RgbaImage> {
        let motion = Arc::clone(&self.inner);
        let drawn = watched(py, move |_| {
            let film = motion.film().size(size.0, size.1).built_in_renderer();
            let film = if dark { film.dark() } else { film };
            film.picture(sample)
        })?;
        drawn.or_raise(py)
    }
}

#[pymethods]
impl Motion {
    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let module = py.import("mechanim._mechanim")?;
        let again = module.getattr("Scene")?.getattr("_solved")?;
        let (samples, times) = match &self.origin.samples {
            Samples::Even(count) => (Some(*count), None),
            Samples::At(times) => (None, Some(times.clone())),
            _ => (None, None),
        };
        let inputs = match self.origin.columns.is_empty() {
            true => None,
            false => Some(self.origin.columns.clone().into_py_dict(py)?),
        };
        let parts = (self.origin.scene.copied(), samples, times, inputs);
        Ok((again, parts.into_pyobject(py)?))
    }

    /// Names of all values: inputs, unknowns, traced points as `name.x`, outputs.
    #[getter]
    fn columns(&self) -> Vec<String> {
        self.scene
            .quantities()
            .into_iter()
            .map(|q| q.name)
            .collect()
    }

    /// Values by name, shape (n,); the name of a traced point gives all of its coordinates, shape (n, 3).
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Array<'py>> {
        let Some(point) = self.coordinates_of(name) else {
            let Ok(values) = self.inner.values(name) else {
                let known = self.columns();
                return Err(no_entry(
                    py,
                    "the motion",
                    name,
                    known.iter().map(String::as_str),
                ));
            };
            return shaped(py, values, &[self.inner.len()]);
        };
        let columns = point.iter().map(|name| self.inner.values(name));
        let columns: Vec<Vec<f64>> = columns.collect::<Result<_, _>>().or_raise(py)?;
        let rows = (0..self.inner.len()).flat_map(|k| columns.iter().map(move |column| column[k]));
        shaped(py, rows.collect(), &[self.inner.len(), 3])
    }

    fn __len__(&self) -> usize {
        self.inner.len()
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        let Ok(name) = name.extract::<String>() else {
            return false;
        };
        self.coordinates_of(&name).is_some()
            || self.scene.quantities().iter().any(|q| q.name == name)
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.columns().into_pyobject(py)?.call_method0("__iter__")
    }

    /// Times of the samples in seconds, shape (n,).
    #[getter]
    fn times<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        shaped(py, self.inner.times(), &[self.inner.len()])
    }

    /// World-from-body transforms, shape (n, bodies, 4, 4), in the order of `scene.bodies`.
    #[getter]
    fn poses<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        let bodies = self.scene.bodies().len();
        let mut values = Vec::with_capacity(self.inner.len() * bodies * 16);
        for k in 0..self.inner.len() {
            let Some(pose) = self.inner.pose(k) else {
                values.extend(std::iter::repeat_n(f64::NAN, bodies * 16));
                continue;
            };
            for placement in pose.placements() {
                values.extend_from_slice(placement.as_flattened());
            }
        }
        shaped(py, values, &[self.inner.len(), bodies, 4, 4])
    }

    /// Rates of an unknown per second, shape (n,).
    fn rate<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Array<'py>> {
        let rate = |k| match self.inner.pose(k) {
            Some(pose) => pose.rate(name),
            None => Ok(f64::NAN),
        };
        let rates: Result<Vec<f64>, _> = (0..self.inner.len()).map(rate).collect();
        shaped(py, rates.or_raise(py)?, &[self.inner.len()])
    }

    /// Status of every sample: "certified", "consistent", "locked", "refused", or "no pose".
    #[getter]
    fn status(&self) -> Vec<&'static str> {
        let word = |k| match self.inner.pose(k).map(|pose| pose.certificate()) {
            Some(Certificate::Certified { .. }) => "certified",
            Some(Certificate::Consistent { .. }) => "consistent",
            Some(Certificate::Locked { .. }) => "locked",
            Some(Certificate::Refused { .. }) => "refused",
            None => "no pose",
        };
        (0..self.inner.len()).map(word).collect()
    }

    /// Proved bound on the distance of the unknowns, as returned, to an exact closed pose, shape (n,); lengths in the scene's
    /// unit, angles in radians times the mechanism's size. That pose belongs to the inputs read as the decimals that Python
    /// prints. NaN if the proof failed.
    #[getter]
    fn error_bound<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.each(py, |pose| {
            pose.certificate().bounds().map_or(f64::NAN, |b| b[0])
        })
    }

    /// Proved radius within which that pose is the only one, shape (n,).
    #[getter]
    fn unique_radius<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.each(py, |pose| {
            pose.certificate().bounds().map_or(f64::NAN, |b| b[1])
        })
    }

    /// Smallest singular value of the scaled Jacobian, shape (n,).
    #[getter]
    fn sigma_min<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.each(py, |pose| pose.sigma_min())
    }

    /// Condition number of the scaled Jacobian, shape (n,).
    #[getter]
    fn condition<'py>(&self, py: Python<'py>) -> PyResult<Array<'py>> {
        self.each(py, |pose| pose.condition())
    }

    /// Signature of the assembly mode of every sample, empty without a pose.
    #[getter]
    fn branch(&self) -> Vec<String> {
        let branch = |k| {
            self.inner
                .pose(k)
                .map_or_else(String::new, |p| p.branch().to_owned())
        };
        (0..self.inner.len()).map(branch).collect()
    }

    /// Whether every sample has a pose.
    #[getter]
    fn is_whole(&self) -> bool {
        self.inner.is_whole()
    }

    /// Largest closure error of all samples with a pose, relative to the mechanism's size.
    #[getter]
    fn closure_error(&self) -> f64 {
        self.inner.closure_error()
    }

    /// Events between the samples, one sentence each: gaps, folds, changes of the assembly.
    #[getter]
    fn events(&self) -> Vec<String> {
        self.inner.events()
    }

    /// Values of the scene's measures by name; None where a measure has no value.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let measures = PyDict::new(py);
        for (name, value) in self.inner.measures() {
            measures.set_item(name, value)?;
        }
        Ok(measures)
    }

    /// Exact derivatives of values with respect to parameters, through the closed loops, at fixed times and inputs: shape
    /// (n, parameters) for one name, (n, names, parameters) for a list, (n, 3, parameters) for a traced point, which counts as
    /// three names in a list.
    ///
    /// Raises ArgumentError for values with rates and for parameters in a drive or in the axis of a rotation.
    fn jacobian<'py>(
        &self,
        py: Python<'py>,
        names: &Bound<'py, PyAny>,
        parameters: NameList,
    ) -> PyResult<Array<'py>> {
        let columns = |name: String| match self.coordinates_of(&name) {
            Some(point) => point.to_vec(),
            None => vec![name],
        };
        let (list, is_one) = match names.cast::<PyString>() {
            Ok(name) => {
                let list = columns(name.extract()?);
                let is_one = list.len() == 1;
                (list, is_one)
            }
            Err(_) => {
                let NameList(names) = names.extract()?;
                (names.into_iter().flat_map(columns).collect(), false)
            }
        };
        let parameters = parameters.0;
        let slopes = self.slopes(py, &list, &parameters)?;
        let [n, q, p] = [self.inner.len(), list.len(), parameters.len()];
        match is_one {
            true => shaped(py, slopes, &[n, p]),
            false => shaped(py, slopes, &[n, q, p]),
        }
    }

    /// The gradient, with respect to parameters, of the sum of values times `cotangents` (arrays by name, with the shapes of
    /// `motion[name]`): shape (parameters,). Samples whose cotangents are all zero are ignored, even without a pose.
    fn vjp<'py>(
        &self,
        py: Python<'py>,
        cotangents: &Bound<'py, PyMapping>,
        parameters: NameList,
    ) -> PyResult<Array<'py>> {
        let (mut weights, parameters) = (Vec::new(), parameters.0);
        let count = self.inner.len();
        for (name, values) in entries(cotangents)? {
            let names = self.coordinates_of(&name);
            let names = names.map_or_else(|| vec![name.clone()], Vec::from);
            let shape: &[usize] = match names.len() {
                1 => &[count],
                _ => &[count, 3],
            };
            let values = numbers_shaped(py, &name, &values, shape)?;
            for (k, own) in names.iter().enumerate() {
                let column = values.iter().skip(k).step_by(names.len()).copied();
                weights.push((own.clone(), column.collect::<Vec<f64>>()));
            }
        }
        weights.sort_by(|a, b| a.0.cmp(&b.0));
        let names: Vec<String> = weights.iter().map(|(name, _)| name.clone()).collect();
        let slopes = self.slopes(py, &names, &parameters)?;
        let [q, p] = [names.len(), parameters.len()];
        let mut gradient = vec![0.0; p];
        for (k, (_, values)) in weights.iter().enumerate() {
            for (sample, weight) in values.iter().enumerate().filter(|(_, w)| **w != 0.0) {
                let row = &slopes[(sample * q + k) * p..][..p];
                gradient
                    .iter_mut()
                    .zip(row)
                    .for_each(|(g, s)| *g += weight * s);
            }
        }
        shaped(py, gradient, &[p])
    }

    /// One sample as a picture, shape (height, width, 4), RGBA bytes.
    #[pyo3(signature = (sample = 0, *, size = (640, 480), dark = false))]
    fn render<'py>(
        &self,
        py: Python<'py>,
        sample: usize,
        size: (u32, u32),
        dark: bool,
    ) -> PyResult<Array<'py>> {
        let image = self.picture(py, sample, size, dark)?;
        shaped(py, image.into_raw(), &[size.1 as usize, size.0 as usize, 4])
    }

    /// Writes the motion as an animation, or its first sample as a picture, depending on the extension of `path` (.gif, .apng,
    /// .png …; frames in a folder without one); returns the number of bytes. Ctrl-C takes effect within 50 ms and leaves an existing file unchanged.
    #[pyo3(signature = (path, *, size = (640, 480), rate = None, quality = None, dark = false))]
    fn save(
        &self,
        py: Python<'_>,
        path: std::path::PathBuf,
        size: (u32, u32),
        rate: Option<f64>,
        quality: Option<u8>,
        dark: bool,
    ) -> PyResult<u64> {
        if let Some(quality) = quality.filter(|q| !(1..=100).contains(q)) {
            let why = format!("`quality` is {quality}, but must be 1 to 100");
            return Err(argument_error(py, why));
        }
        let motion = Arc::clone(&self.inner);
        let written = watched(py, move |flag| {
            let film = motion.film().size(size.0, size.1);
            let film = match quality {
                Some(quality) => film.quality(quality),
                None => film,
            };
            let film = film.built_in_renderer().until(flag);
            let film = if dark { film.dark() } else { film };
            match rate {
                Some(rate) => film.rate(rate).write(&path),
                None => film.write(&path),
            }
        })?;
        written.or_raise(py)
    }

    /// The same in memory: the bytes of a file with the extension `format`, "gif", "png", "apng", "mp4" …
    #[pyo3(signature = (format = "gif", *, size = (640, 480), rate = None, quality = None, dark = false))]
    fn encode<'py>(
        &self,
        py: Python<'py>,
        format: &str,
        size: (u32, u32),
        rate: Option<f64>,
        quality: Option<u8>,
        dark: bool,
    ) -> PyResult<Bound<'py, PyBytes>> {
        let folder = tempfile::tempdir()?;
        let path = folder.path().join(format!("film.{format}"));
        self.save(py, path.clone(), size, rate, quality, dark)?;
        Ok(PyBytes::new(py, &std::fs::read(path)?))
    }

    /// Curves of this motion as SVG: formulas as in a scene's plots, `"d(h, phi)"` for derivatives, plotted against another
    /// formula or time. Without curves, the scene's plots are drawn, otherwise its outputs. `IPython.display.SVG` shows them.
    #[pyo3(signature = (*curves, against = None))]
    fn plot(
        &self,
        py: Python<'_>,
        curves: Vec<String>,
        against: Option<String>,
    ) -> PyResult<String> {
        let motion = Arc::clone(&self.inner);
        let drawn = watched(py, move |_| {
            let curves: Vec<&str> = curves.iter().map(String::as_str).collect();
            motion.plot(&curves, against.as_deref())
        })?;
        drawn.or_raise(py)
    }

    /// The table as the program writes it.
    fn to_csv(&self, py: Python<'_>) -> PyResult<String> {
        let motion = Arc::clone(&self.inner);
        watched(py, move |_| motion.to_csv())
    }

    fn _repr_png_<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyBytes>> {
        let image = self.picture(py, 0, (480, 360), false)?;
        let mut bytes = Cursor::new(Vec::new());
        let written = image.write_to(&mut bytes, ImageFormat::Png);
        written.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        Ok(PyBytes::new(py, bytes.get_ref()))
    }

    /// The values as an Arrow stream, for data frames: `polars.DataFrame(motion)`, `pyarrow.table(motion)`.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        // A reader may ask for other types; one that does casts what it gets.
        let _ = requested_schema;
        let mut columns = vec![("time".to_owned(), "s".to_owned(), self.inner.times())];
        for quantity in self.scene.quantities() {
            let values = self.inner.values(&quantity.name).or_raise(py)?;
            columns.push((quantity.name, quantity.unit, values));
        }
        stream(py, columns)
    }

    fn __repr__(&self) -> String {
        let whole = if self.inner.is_whole() {
            ""
        } else {
            ", not whole"
        };
        format!(
            "<mechanim.Motion {}, {} samples{whole}>",
            self.scene.name(),
            self.inner.len()
        )
    }
}

impl Motion {
    /// The coordinates of a traced point, if that is its name.
    fn coordinates_of(&self, name: &str) -> Option<[String; 3]> {
        let names = ["x", "y", "z"].map(|axis| format!("{name}.{axis}"));
        let known = self.scene.quantities();
        let is_known = |name: &String| known.iter().any(|q| q.name == *name);
        names.iter().all(is_known).then_some(names)
    }

    fn slopes(
        &self,
        py: Python<'_>,
        names: &[String],
        parameters: &[String],
    ) -> PyResult<Vec<f64>> {
        let names: Vec<&str> = names.iter().map(String::as_str).collect();
        let parameters: Vec<&str> = parameters.iter().map(String::as_str).collect();
        py.detach(|| self.inner.jacobian(&names, &parameters))
            .or_raise(py)
    }
}
