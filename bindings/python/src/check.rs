//! Checks and assemblies as values.

use crate::errors::OrRaise;
use crate::signals::watched;
use pyo3::prelude::*;
use std::sync::Arc;

/// The smallest distance of two bodies over the motion, with its bound.
#[pyclass(frozen, get_all, module = "mechanim")]
pub struct PairClearance {
    /// Names of the two bodies.
    bodies: (String, String),
    /// Smallest permitted distance, in the scene's length unit.
    minimum: f64,
    /// Smallest distance found; negative if the bodies penetrate each other.
    distance: f64,
    /// Time of this distance in seconds.
    time: f64,
    /// Lower bound of the distance over the whole motion, if `is_proved`.
    bound: f64,
    /// Whether `bound` is proved.
    is_proved: bool,
    /// Of bodies that must touch: the largest distance found.
    apart: Option<f64>,
    /// Whether it is proved that the pair keeps its minimum, or touches all the time if it must.
    passed: bool,
}

#[pymethods]
impl PairClearance {
    fn __repr__(&self) -> String {
        let word = if self.passed { "passed" } else { "not passed" };
        let (a, b) = &self.bodies;
        let apart = self
            .apart
            .map(|apart| format!(" (must touch, largest gap found {apart:.4})"));
        format!(
            "<{a} / {b}: {:.4} at {:.4} s{}, {word}>",
            self.distance,
            self.time,
            apart.unwrap_or_default()
        )
    }
}

/// The result of a check.
#[pyclass(frozen, module = "mechanim")]
pub struct Check {
    inner: Arc<mechanim::Check>,
}

impl Check {
    pub(crate) fn new(inner: mechanim::Check) -> Self {
        Self {
            inner: Arc::new(inner),
        }
    }
}

#[pymethods]
impl Check {
    /// Whether all requirements are met.
    #[getter]
    fn passed(&self) -> bool {
        self.inner.passed()
    }

    /// The report as text, as the program prints it.
    #[getter]
    fn text(&self) -> &str {
        self.inner.text()
    }

    /// The report as a dictionary with the schema `mechanim-check/1`.
    #[getter]
    fn report<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        py.import("json")?
            .getattr("loads")?
            .call1((self.inner.to_json(),))
    }

    /// The report as JUnit XML.
    #[getter]
    fn junit(&self) -> String {
        self.inner.to_junit()
    }

    /// The report as one HTML page that works offline: the motion in three dimensions, curves, clearances, proofs.
    fn to_html(&self, py: Python<'_>) -> PyResult<String> {
        let inner = Arc::clone(&self.inner);
        watched(py, move |_| inner.to_html())?.or_raise(py)
    }

    /// The page in a frame of its own, for notebooks.
    fn _repr_html_(&self, py: Python<'_>) -> PyResult<String> {
        let page = self
            .to_html(py)?
            .replace('&', "&amp;")
            .replace('"', "&quot;");
        Ok(format!(
            "<iframe title=\"mechanim report\" style=\"width:100%;height:720px;border:0\" srcdoc=\"{page}\"></iframe>"
        ))
    }

    /// All judged pairs of bodies, the worst first.
    #[getter]
    fn pairs(&self) -> Vec<PairClearance> {
        let pairs = self.inner.pairs().iter();
        let pair = |p: &mechanim::PairClearance| {
            let [a, b] = p.bodies.clone();
            PairClearance {
                bodies: (a, b),
                minimum: p.minimum,
                distance: p.distance,
                time: p.time,
                bound: p.bound,
                is_proved: p.is_proved,
                apart: p.apart,
                passed: p.passed,
            }
        };
        pairs.map(pair).collect()
    }

    fn __bool__(&self) -> bool {
        self.inner.passed()
    }

    fn __repr__(&self) -> String {
        let word = if self.inner.passed() {
            "passed"
        } else {
            "not passed"
        };
        format!("<mechanim.Check {word}>")
    }
}

/// One of the assembly modes of a mechanism at the same inputs.
#[pyclass(frozen, get_all, module = "mechanim")]
pub struct Assembly {
    /// Signature of the assembly mode: one sign per block of equations.
    branch: String,
    /// Every unknown by name, in the scene's units.
    values: std::collections::BTreeMap<String, f64>,
    /// Assemblies with the same number place the bodies identically.
    placement: usize,
    /// Whether assemblies meet here, or it is a point of a continuous set.
    is_singular: bool,
}

impl Assembly {
    pub(crate) fn new(found: mechanim::Assembly) -> Self {
        Self {
            branch: found.branch,
            values: found.values.into_iter().collect(),
            placement: found.placement,
            is_singular: found.is_singular,
        }
    }
}

#[pymethods]
impl Assembly {
    fn __repr__(&self) -> String {
        format!(
            "<mechanim.Assembly {} placement {}>",
            self.branch, self.placement
        )
    }
}
