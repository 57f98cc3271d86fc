//! Studies: derivatives of measures, tolerances, optima.

use crate::errors::{OrRaise, no_entry};
use crate::signals::watched;
use mechanim::study::{Distribution, OptimiseOptions, SearchMethod, ToleranceOptions};
use numpy::{IntoPyArray, PyArray1};
use pyo3::exceptions::PyValueError;
use pyo3::prelude::*;
use pyo3::types::PyDict;

/// The measures of a scene as functions of its parameters. Returned by `Scene.study`.
#[pyclass(frozen, module = "mechanim")]
pub struct Study {
    inner: mechanim::Study,
}

impl Study {
    pub(crate) fn new(inner: mechanim::Study) -> Self {
        Self { inner }
    }
}

#[pymethods]
impl Study {
    /// The exact derivative of every measure with respect to every variable, in the scene's units.
    fn sensitivity(&self, py: Python<'_>) -> PyResult<Sensitivity> {
        let study = self.inner.clone();
        let inner = watched(py, move |_| study.sensitivity())?.or_raise(py)?;
        Ok(Sensitivity { inner })
    }

    /// Tolerance analysis of the measures: linear rules, random pieces, proved bands.
    ///
    /// `tolerance`: half the width for every variable without a tolerance in the study. `distribution`: "uniform" or "normal".
    #[pyo3(signature = (tolerance = None, *, pieces = 10_000, distribution = "uniform", seed = 1))]
    fn tolerance(
        &self,
        py: Python<'_>,
        tolerance: Option<f64>,
        pieces: usize,
        distribution: &str,
        seed: u64,
    ) -> PyResult<Tolerance> {
        let distribution = match distribution {
            "uniform" => Distribution::Uniform,
            "normal" => Distribution::Normal,
            _ => return Err(PyValueError::new_err("distribution: 'uniform' or 'normal'")),
        };
        let options = ToleranceOptions {
            tolerance,
            pieces,
            distribution,
            seed,
        };
        let study = self.inner.clone();
        let found = watched(py, move |flag| study.until(flag).tolerance(&options))?;
        let inner = found.or_raise(py)?;
        Ok(Tolerance { inner })
    }

    /// The values of the variables that minimise the objective within the limits, proved afterwards. Ctrl-C ends the
    /// search; other threads continue.
    ///
    /// `method`: "bfgs", "nelder-mead", "evolution" or "minimax". `within`: lets every variable move by this share of its
    /// value, in place of the study's ranges.
    #[pyo3(signature = (method = "bfgs", *, iterations = 1000, tolerance = None, within = None, seed = 1))]
    fn optimise(
        &self,
        py: Python<'_>,
        method: &str,
        iterations: usize,
        tolerance: Option<f64>,
        within: Option<f64>,
        seed: u64,
    ) -> PyResult<Optimum> {
        let method = match method {
            "bfgs" => SearchMethod::Bfgs,
            "nelder-mead" => SearchMethod::NelderMead,
            "evolution" => SearchMethod::Evolution,
            "minimax" => SearchMethod::Minimax,
            _ => {
                let known = "method: 'bfgs', 'nelder-mead', 'evolution' or 'minimax'";
                return Err(PyValueError::new_err(known));
            }
        };
        let options = OptimiseOptions {
            method,
            iterations,
            tolerance,
            within,
            seed,
        };
        let study = self.inner.clone();
        let found = watched(py, move |flag| study.until(flag).optimise(&options))?;
        let inner = found.or_raise(py)?;
        Ok(Optimum { inner })
    }
}

/// Derivatives of measures with respect to variables, in the scene's units. `sensitivity["F"]` is the row of a measure.
#[pyclass(frozen, module = "mechanim")]
pub struct Sensitivity {
    inner: mechanim::study::Sensitivity,
}

#[pymethods]
impl Sensitivity {
    /// Names of the variables, those with the largest derivatives of the objective first: the order of all rows.
    #[getter]
    fn variables(&self) -> Vec<&str> {
        self.inner.variables()
    }

    /// The measures with their values.
    #[getter]
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, self.inner.measures())
    }

    /// The derivative of a measure with respect to a variable.
    fn derivative(&self, py: Python<'_>, measure: &str, variable: &str) -> PyResult<f64> {
        self.inner.derivative(measure, variable).or_raise(py)
    }

    /// The table that the program prints.
    #[getter]
    fn text(&self) -> String {
        self.inner.text()
    }

    fn __getitem__<'py>(
        &self,
        py: Python<'py>,
        measure: &str,
    ) -> PyResult<Bound<'py, PyArray1<f64>>> {
        let variables = self.inner.variables();
        let row = variables.iter().map(|v| self.inner.derivative(measure, v));
        let row: Vec<f64> = row.collect::<Result<_, _>>().or_raise(py)?;
        Ok(row.into_pyarray(py))
    }
}

/// The result of a tolerance analysis, in the scene's units. `tolerance["F"]` contains the numbers of a measure.
#[pyclass(frozen, module = "mechanim")]
pub struct Tolerance {
    inner: mechanim::study::Tolerance,
}

#[pymethods]
impl Tolerance {
    /// Names of the measures.
    #[getter]
    fn measures(&self) -> Vec<&str> {
        let measures = self.inner.measures().iter();
        measures.map(|m| m.name.as_str()).collect()
    }

    /// The share of the random pieces that can be assembled and keep the limits of all measures.
    #[getter]
    fn yield_share(&self) -> f64 {
        self.inner.yield_share()
    }

    /// The table that the program prints.
    #[getter]
    fn text(&self) -> &str {
        self.inner.text()
    }

    /// nominal, root_sum_square, linear_sum, mean, deviation; found: smallest and largest value found; band: proved
    /// band for all pieces within the tolerances, or None.
    fn __getitem__<'py>(&self, py: Python<'py>, measure: &str) -> PyResult<Bound<'py, PyDict>> {
        let mut measures = self.inner.measures().iter();
        let Some(m) = measures.find(|m| m.name == measure) else {
            let known = self.inner.measures().iter().map(|m| m.name.as_str());
            return Err(no_entry(py, "the analysis", measure, known));
        };
        let figures = [
            ("nominal", m.nominal),
            ("root_sum_square", m.root_sum_square),
            ("linear_sum", m.linear_sum),
            ("mean", m.mean),
            ("deviation", m.deviation),
        ];
        let found = named(py, figures)?;
        found.set_item("found", (m.found[0], m.found[1]))?;
        found.set_item("band", m.band.map(|[low, high]| (low, high)))?;
        Ok(found)
    }
}

/// The best values of a study's variables.
#[pyclass(frozen, module = "mechanim")]
pub struct Optimum {
    inner: mechanim::study::Optimum,
}

#[pymethods]
impl Optimum {
    /// The objective before and after.
    #[getter]
    fn objective(&self) -> (f64, f64) {
        let [before, after] = self.inner.objective();
        (before, after)
    }

    /// The variables with their best values.
    #[getter]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        named(py, self.inner.values())
    }

    /// Whether an independent motion has the same objective, and all limits and clearances are kept.
    #[getter]
    fn holds(&self) -> bool {
        self.inner.holds()
    }

    /// The text of the scene with the best values, for `loads`.
    #[getter]
    fn scene_text(&self, py: Python<'_>) -> PyResult<String> {
        self.inner.scene_text().or_raise(py)
    }

    /// The report that the program prints.
    #[getter]
    fn text(&self) -> String {
        self.inner.text()
    }
}

fn named<'py, 'a>(
    py: Python<'py>,
    pairs: impl IntoIterator<Item = (&'a str, f64)>,
) -> PyResult<Bound<'py, PyDict>> {
    let values = PyDict::new(py);
    for (name, value) in pairs {
        values.set_item(name, value)?;
    }
    Ok(values)
}
