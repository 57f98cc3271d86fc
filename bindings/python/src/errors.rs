//! Errors of the engine as Python exceptions.

use mechanim::{Error, ErrorKind};
use pyo3::prelude::*;

/// The exception for an error: a class of `mechanim` with the message and `hints` on how to fix it.
pub fn raised(py: Python<'_>, error: &Error) -> PyErr {
    let class = match error.kind() {
        ErrorKind::Source | ErrorKind::Scene => "SceneError",
        ErrorKind::Mechanism => "MechanismError",
        ErrorKind::Limit => "LimitError",
        ErrorKind::File => "FileError",
        _ => "ArgumentError",
    };
    exception(py, class, error.to_string(), error.hints().to_vec())
}

/// An exception of a class of `mechanim.errors`.
fn exception(py: Python<'_>, class: &str, message: String, hints: Vec<String>) -> PyErr {
    let made = || {
        let class = py.import("mechanim.errors")?.getattr(class)?;
        class.call1((message, hints))
    };
    match made() {
        Ok(exception) => PyErr::from_value(exception),
        Err(error) => error,
    }
}

/// An argument that the engine never sees, refused in the same way.
pub fn argument_error(py: Python<'_>, message: String) -> PyErr {
    exception(py, "ArgumentError", message, Vec::new())
}

/// A name that a result does not have: also a `KeyError`.
pub fn no_entry<'a>(
    py: Python<'_>,
    what: &str,
    name: &str,
    known: impl IntoIterator<Item = &'a str>,
) -> PyErr {
    let known: Vec<&str> = known.into_iter().collect();
    let hint = format!("known: {}", known.join(", "));
    exception(
        py,
        "UnknownNameError",
        format!("{what} has no `{name}`"),
        vec![hint],
    )
}

/// Gives a Python warning of a category of `mechanim`.
pub fn warn(py: Python<'_>, category: &str, message: &str) -> PyResult<()> {
    let category = py.import("mechanim.errors")?.getattr(category)?;
    py.import("warnings")?
        .getattr("warn")?
        .call1((message, category, 1))?;
    Ok(())
}

/// The value, or the exception.
pub trait OrRaise<T> {
    /// Turns an error of the engine into an exception.
    fn or_raise(self, py: Python<'_>) -> PyResult<T>;
}

impl<T> OrRaise<T> for Result<T, Error> {
    fn or_raise(self, py: Python<'_>) -> PyResult<T> {
        self.map_err(|error| raised(py, &error))
    }
}
