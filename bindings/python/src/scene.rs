//! Scenes: read, changed, solved, checked.

use crate::arguments::{NameList, entries, numbers};
use crate::check::{Assembly, Check};
use crate::enclosure::Enclosure;
use crate::errors::{OrRaise, warn};
use crate::motion::{Columns, Motion, Origin};
use crate::signals::{interruptible, watched};
use crate::study::Study;
use crate::sweep::{self, Table};
use mechanim::Samples;
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString, PyTuple};
use std::hash::{DefaultHasher, Hash, Hasher};

/// Which value of the text is replaced.
#[derive(Clone, Copy, Hash, PartialEq, Eq)]
enum Replaced {
    Parameter,
    Input,
    Guess,
}

/// A value put in place of the text's own: what, its name, and a number or formula.
#[derive(Clone, Hash, PartialEq, Eq)]
struct Change(Replaced, String, String);

/// A mechanism with its drive, bodies and view, read from the text of a scene. Scenes are immutable: `with_` returns a new
/// one.
///
/// Lengths are in the scene's own unit, angles in its angle unit (degrees or radians), times in seconds. Scenes can be
/// pickled, compared and hashed, by their text, the folder of their meshes and the replaced values.
#[pyclass(frozen, module = "mechanim")]
pub struct Scene {
    pub(crate) inner: mechanim::Scene,
    folder: String,
    changes: Vec<Change>,
}

/// Reads a scene from a file (a path), or a built-in one (a name); keywords replace parameters.
///
/// Raises SceneError with all errors and their positions.
#[pyfunction]
#[pyo3(signature = (path_or_name, /, **parameters))]
pub fn load(
    py: Python<'_>,
    path_or_name: &Bound<'_, PyAny>,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Scene> {
    let is_text = path_or_name.is_instance_of::<PyString>();
    let path: String = py
        .import("os")?
        .getattr("fspath")?
        .call1((path_or_name,))?
        .extract()?;
    let builtin = is_text && mechanim::Scene::builtin_names().contains(&path.as_str());
    let (inner, folder) = if builtin {
        (mechanim::Scene::builtin(&path).or_raise(py)?, String::new())
    } else {
        let parent = std::path::Path::new(&path).parent();
        let folder = parent.map_or_else(String::new, |p| p.to_string_lossy().into_owned());
        (mechanim::Scene::open(&path).or_raise(py)?, folder)
    };
    Scene::new(py, inner, folder, parameters)
}

/// Reads a scene from a text, called `name` in messages; meshes are searched in `folder`.
///
/// Raises SceneError with all errors and their positions.
#[pyfunction]
#[pyo3(signature = (text, /, *, name = "<text>", folder = "", **parameters))]
pub fn loads(
    py: Python<'_>,
    text: &str,
    name: &str,
    folder: &str,
    parameters: Option<&Bound<'_, PyDict>>,
) -> PyResult<Scene> {
    let inner = mechanim::Scene::parse_in(folder, name, text).or_raise(py)?;
    Scene::new(py, inner, folder.to_owned(), parameters)
}

/// Names of the built-in scenes.
#[pyfunction]
pub fn scenes() -> Vec<&'static str> {
    mechanim::Scene::builtin_names()
}

/// A number or a formula as the engine reads it: numbers keep all their digits.
fn written(value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(text) = value.cast::<PyString>() {
        return Ok(text.to_string());
    }
    match value.extract::<f64>() {
        Ok(number) => Ok(format!("{number:?}")),
        Err(_) => Err(PyTypeError::new_err("a number or a formula is expected")),
    }
}

impl Scene {
    fn new(
        py: Python<'_>,
        inner: mechanim::Scene,
        folder: String,
        parameters: Option<&Bound<'_, PyDict>>,
    ) -> PyResult<Self> {
        for warning in inner.warnings() {
            warn(py, "SceneWarning", &warning)?;
        }
        let scene = Self {
            inner,
            folder,
            changes: Vec::new(),
        };
        match parameters {
            Some(parameters) => scene.changed(py, Replaced::Parameter, parameters),
            None => Ok(scene),
        }
    }

    fn changed(
        &self,
        py: Python<'_>,
        what: Replaced,
        values: &Bound<'_, PyDict>,
    ) -> PyResult<Self> {
        let mut scene = self.copied();
        for (name, value) in values.iter() {
            scene = scene.replaced(py, Change(what, name.extract()?, written(&value)?))?;
        }
        Ok(scene)
    }

    fn replaced(mut self, py: Python<'_>, change: Change) -> PyResult<Self> {
        let Change(what, name, value) = &change;
        self.inner = match what {
            Replaced::Parameter => self.inner.with_parameter(name, value),
            Replaced::Input => self.inner.with_input(name, value),
            Replaced::Guess => self.inner.with_guess(name, value),
        }
        .or_raise(py)?;
        let same = |c: &Change| c.0 == change.0 && c.1 == change.1;
        self.changes.retain(|c| !same(c));
        self.changes.push(change);
        Ok(self)
    }

    pub(crate) fn copied(&self) -> Self {
        Self {
            inner: self.inner.clone(),
            folder: self.folder.clone(),
            changes: self.changes.clone(),
        }
    }

    /// What makes two scenes the same, whatever the order of their changes.
    fn identity(&self) -> (&str, &str, Vec<&Change>) {
        let mut changes: Vec<&Change> = self.changes.iter().collect();
        changes.sort_by_key(|Change(what, name, _)| (*what as u8, name.clone()));
        (&self.folder, self.inner.text(), changes)
    }
}

#[pymethods]
impl Scene {
    /// The scene with changed parameters: numbers in its units, or formulas as text.
    #[pyo3(signature = (**parameters))]
    fn with_(&self, py: Python<'_>, parameters: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        match parameters {
            Some(parameters) => self.changed(py, Replaced::Parameter, parameters),
            None => Ok(self.copied()),
        }
    }

    /// The scene with other drives of its inputs: formulas of the time `t`, or numbers.
    #[pyo3(signature = (**inputs))]
    fn with_inputs(&self, py: Python<'_>, inputs: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        match inputs {
            Some(inputs) => self.changed(py, Replaced::Input, inputs),
            None => Ok(self.copied()),
        }
    }

    /// The scene with start values for unknowns: the assembly closest to them is used.
    #[pyo3(signature = (**values))]
    fn with_guess(&self, py: Python<'_>, values: Option<&Bound<'_, PyDict>>) -> PyResult<Self> {
        match values {
            Some(values) => self.changed(py, Replaced::Guess, values),
            None => Ok(self.copied()),
        }
    }

    /// Solves the motion at the scene's own frames, at `samples` evenly spaced times, at `times` in seconds (followed from the
    /// start of the drive), or through rows of `inputs`, where row k is at `times[k]`, or at k seconds. An input that is one
    /// number has it in every row.
    ///
    /// Samples without a pose are rows of NaN and cause a MotionWarning. Ctrl-C takes effect within 50 ms; other threads continue.
    #[pyo3(signature = (samples = None, *, times = None, inputs = None))]
    fn solve(
        &self,
        py: Python<'_>,
        samples: Option<usize>,
        times: Option<&Bound<'_, PyAny>>,
        inputs: Option<Bound<'_, PyMapping>>,
    ) -> PyResult<Motion> {
        let times = times.map(|t| numbers(py, "times", t)).transpose()?;
        let mut columns = Vec::new();
        let (scene, asked) = match (samples, times, inputs) {
            (None, None, None) => (self.inner.clone(), Samples::Frames),
            (Some(count), None, None) => (self.inner.clone(), Samples::Even(count)),
            (None, Some(times), None) => (self.inner.clone(), Samples::At(times)),
            (None, times, Some(inputs)) => {
                let (scene, times, own) = self.driven(py, times, &inputs)?;
                columns = own;
                (scene, Samples::At(times))
            }
            _ => {
                let why =
                    "one of `samples`, `times` and `inputs`; `times` may stand beside `inputs`";
                return Err(PyTypeError::new_err(why));
            }
        };
        let origin = Origin {
            scene: self.copied(),
            samples: asked.clone(),
            columns,
        };
        let motion = interruptible(py, |cancelled| scene.solve_until(asked, cancelled))?;
        Motion::new(py, (scene.clone(), origin), motion.or_raise(py)?)
    }

    /// What the pickle of a motion calls.
    #[staticmethod]
    #[pyo3(signature = (scene, samples, times, inputs))]
    fn _solved(
        py: Python<'_>,
        scene: &Self,
        samples: Option<usize>,
        times: Option<Bound<'_, PyAny>>,
        inputs: Option<Bound<'_, PyMapping>>,
    ) -> PyResult<Motion> {
        scene.solve(py, samples, times.as_ref(), inputs)
    }

    /// Checks all requirements of the scene: closure, proofs, limits of measures, clearances between bodies.
    /// Ctrl-C takes effect within 50 ms; other threads continue.
    ///
    /// `motion`: also proves the motion between the samples. `closure`: the largest permitted closure error, relative to the
    /// mechanism's size. `tolerance`: required agreement of bound and distance, as a fraction of the pair's minimum.
    #[pyo3(signature = (samples = None, *, motion = false, closure = 1e-9, tolerance = 1e-3))]
    fn check(
        &self,
        py: Python<'_>,
        samples: Option<usize>,
        motion: bool,
        closure: f64,
        tolerance: f64,
    ) -> PyResult<Check> {
        let options = mechanim::CheckOptions {
            samples: samples.map_or(Samples::Frames, Samples::Even),
            closure,
            motion,
            tolerance,
        };
        let scene = self.inner.clone();
        let check = watched(py, move |_| scene.check(&options))?;
        Ok(Check::new(check.or_raise(py)?))
    }

    /// The assemblies for the inputs at a given time, as far as a search from many starts finds them.
    #[pyo3(signature = (time = 0.0))]
    fn modes(&self, py: Python<'_>, time: f64) -> PyResult<Vec<Assembly>> {
        let scene = self.inner.clone();
        let found = watched(py, move |_| scene.assemblies(time))?.or_raise(py)?;
        Ok(found.into_iter().map(Assembly::new).collect())
    }

    /// Proved bands that contain every piece whose dimensions are within their tolerances: at the scene's own frames, at
    /// `samples` evenly spaced times, or at `times` in seconds. Ctrl-C interrupts it; other threads continue.
    ///
    /// `tolerance`: half the width for every dimension without a tolerance in the scene. `vary`: names in place of the scene's
    /// own choice; "all" for every length and angle.
    #[pyo3(signature = (tolerance = None, *, vary = NameList::default(), samples = None, times = None))]
    fn enclose(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        vary: NameList,
        samples: Option<usize>,
        times: Option<&Bound<'_, PyAny>>,
    ) -> PyResult<Enclosure> {
        let samples = match (samples, times) {
            (None, None) => Samples::Frames,
            (Some(count), None) => Samples::Even(count),
            (None, Some(times)) => Samples::At(numbers(py, "times", times)?),
            _ => return Err(PyTypeError::new_err("one of `samples` and `times`")),
        };
        let names: Vec<&str> = vary.0.iter().map(String::as_str).collect();
        let study = self.inner.study().vary(&names);
        let found = watched(py, move |flag| {
            study.until(flag).enclose(tolerance, samples)
        })?;
        Ok(Enclosure::new(found.or_raise(py)?))
    }

    /// The measures of the scene as functions of the given parameters, or of those that the scene varies by default.
    /// "all" selects every length and angle.
    #[pyo3(signature = (*variables))]
    fn study(&self, variables: Vec<String>) -> Study {
        let names: Vec<&str> = variables.iter().map(String::as_str).collect();
        Study::new(self.inner.study().vary(&names))
    }

    /// Solves one design per row: parameters by name as arrays of one length, values by name at `samples` evenly spaced times.
    ///
    /// Every row equals the result of `with_(...)` and `solve(...)`. Rows are shared among threads; the result does not depend
    /// on their number. A row that cannot be read or closed is NaN, and its status says why. Without `samples`, a design with a
    /// shorter motion has fewer of them: NaN follow, and its status says so.
    #[pyo3(signature = (designs, values, *, samples = None, threads = None))]
    fn sweep(
        &self,
        py: Python<'_>,
        designs: Bound<'_, PyMapping>,
        values: NameList,
        samples: Option<usize>,
        threads: Option<usize>,
    ) -> PyResult<Table> {
        let mut columns = Vec::new();
        for (name, column) in entries(&designs)? {
            let column = numbers(py, &name, &column)?;
            columns.push((name, column));
        }
        let asked = samples.map_or(Samples::Frames, Samples::Even);
        sweep::run(py, &self.inner, columns, values.0, asked, threads)
    }

    /// Its title.
    #[getter]
    fn title(&self) -> &str {
        self.inner.title()
    }

    /// Its name in messages.
    #[getter]
    fn name(&self) -> &str {
        self.inner.name()
    }

    /// The text that it was read from.
    #[getter]
    fn text(&self) -> &str {
        self.inner.text()
    }

    /// The duration of the motion in seconds.
    #[getter]
    fn duration(&self) -> f64 {
        self.inner.duration()
    }

    /// Names of the bodies.
    #[getter]
    fn bodies(&self) -> Vec<&str> {
        self.inner.bodies()
    }

    /// Units of all values of a pose, by name: inputs, unknowns, traced points as `name.x`, outputs.
    #[getter]
    fn units<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let units = PyDict::new(py);
        for quantity in self.inner.quantities() {
            units.set_item(quantity.name, quantity.unit)?;
        }
        Ok(units)
    }

    /// Names of the inputs.
    #[getter]
    fn inputs(&self) -> Vec<String> {
        self.inner.inputs().into_iter().map(|q| q.name).collect()
    }

    /// Names of the unknowns.
    #[getter]
    fn unknowns(&self) -> Vec<String> {
        self.inner.unknowns().into_iter().map(|q| q.name).collect()
    }

    fn __repr__(&self) -> String {
        let changes: Vec<String> = self
            .changes
            .iter()
            .map(|c| format!(", {}={}", c.1, c.2))
            .collect();
        format!("<mechanim.Scene {}{}>", self.inner.name(), changes.concat())
    }

    fn __eq__(&self, other: &Self) -> bool {
        self.identity() == other.identity()
    }

    fn __hash__(&self) -> u64 {
        let mut hasher = DefaultHasher::new();
        self.identity().hash(&mut hasher);
        hasher.finish()
    }

    fn __reduce__<'py>(
        &self,
        py: Python<'py>,
    ) -> PyResult<(Bound<'py, PyAny>, Bound<'py, PyTuple>)> {
        let changes = |what: Replaced| -> Vec<(String, String)> {
            let own = self.changes.iter().filter(|c| c.0 == what);
            own.map(|c| (c.1.clone(), c.2.clone())).collect()
        };
        let again = py
            .import("mechanim._mechanim")?
            .getattr("Scene")?
            .getattr("_again")?;
        let parts = (
            self.folder.as_str(),
            self.inner.name(),
            self.inner.text(),
            changes(Replaced::Parameter),
            changes(Replaced::Input),
            changes(Replaced::Guess),
        );
        Ok((again, parts.into_pyobject(py)?))
    }

    /// What a pickle calls.
    #[staticmethod]
    fn _again(
        py: Python<'_>,
        folder: String,
        name: &str,
        text: &str,
        parameters: Vec<(String, String)>,
        inputs: Vec<(String, String)>,
        guess: Vec<(String, String)>,
    ) -> PyResult<Self> {
        let inner = mechanim::Scene::parse_in(&folder, name, text).or_raise(py)?;
        let mut scene = Self {
            inner,
            folder,
            changes: Vec::new(),
        };
        let kinds = [
            (Replaced::Parameter, parameters),
            (Replaced::Input, inputs),
            (Replaced::Guess, guess),
        ];
        for (what, list) in kinds {
            for (name, value) in list {
                scene = scene.replaced(py, Change(what, name, value))?;
            }
        }
        Ok(scene)
    }
}

impl Scene {
    /// The scene driven through rows of inputs, and the times of the rows.
    fn driven(
        &self,
        py: Python<'_>,
        times: Option<Vec<f64>>,
        inputs: &Bound<'_, PyMapping>,
    ) -> PyResult<(mechanim::Scene, Vec<f64>, Columns)> {
        let (mut columns, mut numbers_alone) = (Vec::new(), Vec::new());
        for (name, values) in entries(inputs)? {
            let column = numbers(py, &name, &values)?;
            // What has a length is a row, though it be of one.
            numbers_alone.push(values.len().is_err());
            columns.push((name, column));
        }
        let of_rows = columns
            .iter()
            .zip(&numbers_alone)
            .find(|(_, alone)| !**alone);
        let rows = match (&times, of_rows) {
            (Some(times), _) => times.len(),
            (None, Some(((_, values), _))) => values.len(),
            (None, None) => columns.len().min(1),
        };
        for ((_, column), _) in columns
            .iter_mut()
            .zip(&numbers_alone)
            .filter(|(_, alone)| **alone)
        {
            column.resize(rows, column[0]);
        }
        let times = times.unwrap_or_else(|| (0..rows).map(|k| k as f64).collect());
        let slices: Vec<(&str, &[f64])> = columns
            .iter()
            .map(|(n, v)| (n.as_str(), v.as_slice()))
            .collect();
        let scene = self.inner.with_rows(&times, &slices).or_raise(py)?;
        Ok((scene, times, columns))
    }
}
