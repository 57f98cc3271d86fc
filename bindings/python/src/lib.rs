//! The Python module: scenes, motions as NumPy arrays, checks, pictures.

mod arguments;
mod arrow;
mod check;
mod enclosure;
mod errors;
mod motion;
mod scene;
mod signals;
mod study;
mod sweep;

use pyo3::prelude::*;

/// The content of `import mechanim`; the package adds the exceptions and re-exports everything.
#[pymodule]
mod _mechanim {
    use super::{PyResult, Python, pyfunction};
    use pyo3::Bound;
    use pyo3::types::{PyAnyMethods, PyModule};

    #[pymodule_export]
    use super::check::{Assembly, Check, PairClearance};
    #[pymodule_export]
    use super::enclosure::Enclosure;
    #[pymodule_export]
    use super::motion::Motion;
    #[pymodule_export]
    use super::scene::{Scene, load, loads, scenes};
    #[pymodule_export]
    use super::study::{Optimum, Sensitivity, Study, Tolerance};
    #[pymodule_export]
    use super::sweep::Table;

    /// NumPy is looked up here, where no signal can be pending yet: later that could fail.
    #[pymodule_init]
    fn init(module: &Bound<'_, PyModule>) -> PyResult<()> {
        numpy::PyArray1::<f64>::zeros(module.py(), 0, false);
        Ok(())
    }

    /// Runs the `mechanim` program with the arguments of this process and ends with its exit code.
    #[pyfunction]
    fn program(py: Python<'_>) -> PyResult<()> {
        let arguments: Vec<std::ffi::OsString> = py.import("sys")?.getattr("argv")?.extract()?;
        let exit = py.import("sys")?.getattr("exit")?;
        match py.detach(|| super::run_program(arguments)) {
            Some(code) => exit.call1((code,))?,
            None => exit.call1(("mechanim: this wheel was built without the program",))?,
        };
        Ok(())
    }
}

/// Runs the program; `None` in a wheel without it.
#[cfg(feature = "program")]
fn run_program(arguments: Vec<std::ffi::OsString>) -> Option<i32> {
    Some(mechanim::cli::program::main(arguments))
}

/// Runs the program; `None` in a wheel without it.
#[cfg(not(feature = "program"))]
fn run_program(_: Vec<std::ffi::OsString>) -> Option<i32> {
    None
}
