//! Arguments from Python: arrays of numbers, of the shape asked for, lists of names, and values by name.

use crate::errors::argument_error;
use numpy::{PyReadonlyArray1, PyUntypedArray, PyUntypedArrayMethods};
use pyo3::exceptions::PyTypeError;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyMapping, PyString};

/// Several names.
#[derive(Clone, Debug, Default)]
pub struct NameList(pub Vec<String>);

impl<'py> FromPyObject<'_, 'py> for NameList {
    type Error = PyErr;

    fn extract(given: Borrowed<'_, 'py, PyAny>) -> PyResult<Self> {
        // A text is a sequence of letters, too, which nobody means.
        if given.is_instance_of::<PyString>() {
            let why = format!("a list of names is expected: [{}]", given.repr()?);
            return Err(PyTypeError::new_err(why));
        }
        let names = given.try_iter().and_then(|list| {
            list.map(|name| name?.extract::<String>())
                .collect::<PyResult<_>>()
        });
        let refused = |_| PyTypeError::new_err(format!("{:?} is no list of names", given));
        names.map(Self).map_err(refused)
    }
}

/// The entries of a mapping from names, in its order.
pub fn entries<'py>(values: &Bound<'py, PyMapping>) -> PyResult<Vec<(String, Bound<'py, PyAny>)>> {
    values.items()?.iter().map(|pair| pair.extract()).collect()
}

/// A row of numbers: the argument called `name`. A single number is a row of one.
pub fn numbers(py: Python<'_>, name: &str, values: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    // What is a row of numbers already takes no call of Python; a masked array is more than one.
    if values.is_exact_instance_of::<PyUntypedArray>()
        && let Ok(array) = values.extract::<PyReadonlyArray1<'_, f64>>()
        && let Ok(slice) = array.as_slice()
    {
        return Ok(slice.to_vec());
    }
    let (array, shape) = array_of(py, name, values)?;
    match shape.len() {
        0 | 1 => flat(&array),
        _ => {
            let why = format!(
                "`{name}` has the shape {}, not that of a row",
                shape_text(&shape)
            );
            Err(argument_error(py, why))
        }
    }
}

/// Numbers of exactly this shape, row after row.
pub fn numbers_shaped(
    py: Python<'_>,
    name: &str,
    values: &Bound<'_, PyAny>,
    wanted: &[usize],
) -> PyResult<Vec<f64>> {
    let (array, shape) = array_of(py, name, values)?;
    if shape != wanted {
        let [given, wanted] = [&shape[..], wanted].map(shape_text);
        let why = format!("`{name}` has the shape {given}, not {wanted}");
        return Err(argument_error(py, why));
    }
    flat(&array)
}

/// A contiguous array of floats, and its shape before: a number has none.
fn array_of<'py>(
    py: Python<'py>,
    name: &str,
    values: &Bound<'py, PyAny>,
) -> PyResult<(Bound<'py, PyAny>, Vec<usize>)> {
    let refused = |why: String| PyTypeError::new_err(format!("`{name}` {why}"));
    let numpy = py.import("numpy")?;
    let given = numpy
        .call_method1("asanyarray", (values,))
        .map_err(|error| refused(format!("is not an array of numbers: {error}")))?;
    if given.is_instance(&numpy.getattr("ma")?.getattr("MaskedArray")?)? {
        return Err(refused("is masked: fill it first".to_owned()));
    }
    // Text and complex numbers would lose what they are.
    let kind: String = given.getattr("dtype")?.getattr("kind")?.extract()?;
    let count: usize = given.getattr("size")?.extract()?;
    if !matches!(kind.as_str(), "f" | "i" | "u" | "b") && count > 0 {
        let dtype = given.getattr("dtype")?;
        return Err(refused(format!("holds {dtype}, not real numbers")));
    }
    let shape = given.cast::<PyUntypedArray>()?.shape().to_vec();
    let options = PyDict::new(py);
    options.set_item("dtype", "float64")?;
    let array = numpy.call_method("ascontiguousarray", (given,), Some(&options))?;
    Ok((array, shape))
}

fn flat(array: &Bound<'_, PyAny>) -> PyResult<Vec<f64>> {
    let array: PyReadonlyArray1<'_, f64> = array.call_method0("ravel")?.extract()?;
    Ok(array.as_slice()?.to_vec())
}

/// A shape as Python writes it.
fn shape_text(shape: &[usize]) -> String {
    let sizes: Vec<String> = shape.iter().map(usize::to_string).collect();
    match sizes.len() {
        1 => format!("({},)", sizes[0]),
        _ => format!("({})", sizes.join(", ")),
    }
}
