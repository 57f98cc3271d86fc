//! Many designs in one call, shared among threads.

use crate::arrow::stream;
use crate::errors::{OrRaise, argument_error, no_entry};
use mechanim::{ErrorKind, Motion, Samples, Scene};
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::types::PyCapsule;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::mpsc;
use std::time::{Duration, Instant};

/// How often signals are looked at while the threads work.
const PERIOD: Duration = Duration::from_millis(20);

/// Designs, one a row, with the values asked for.
#[pyclass(frozen, module = "mechanim")]
pub struct Table {
    designs: Vec<(String, Vec<f64>)>,
    values: Vec<String>,
    rows: Vec<Row>,
    samples: usize,
}

/// One design: its values, all samples of each, and a word for how it went.
#[derive(Clone)]
struct Row {
    values: Vec<Vec<f64>>,
    status: String,
}

/// Solves every design. Rows do not depend on each other, so neither on the number of threads.
pub fn run(
    py: Python<'_>,
    scene: &Scene,
    designs: Vec<(String, Vec<f64>)>,
    values: Vec<String>,
    samples: Samples,
    threads: Option<usize>,
) -> PyResult<Table> {
    let count = designs.first().map_or(0, |(_, column)| column.len());
    if let Some((name, column)) = designs.iter().find(|(_, column)| column.len() != count) {
        let why = format!("`{name}` has {} designs, others {count}", column.len());
        return Err(argument_error(py, why));
    }
    let known = scene.quantities();
    if let Some(name) = values
        .iter()
        .find(|name| known.iter().all(|q| q.name != **name))
    {
        let known = known.iter().map(|q| q.name.as_str());
        return Err(no_entry(py, "the scene", name, known));
    }
    // A name that is none is told at once.
    for (name, column) in &designs {
        if let Some(value) = column.first() {
            let changed = scene.with_parameter(name, format!("{value:?}"));
            if changed
                .as_ref()
                .is_err_and(|error| error.kind() == ErrorKind::Argument)
            {
                changed.or_raise(py)?;
            }
        }
    }
    let cores = std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or(cores).clamp(1, count.max(1));
    let work = |index: usize| row(scene, &designs, &values, &samples, index);
    let stop = AtomicBool::new(false);
    let mut rows = share(py, count, threads, &stop, &work)?;
    let samples = rows.iter().map(Row::samples).max().unwrap_or(0);
    for row in &mut rows {
        row.extend_to(samples);
    }
    Ok(Table {
        designs,
        values,
        rows,
        samples,
    })
}

/// All rows in their order; the calling thread looks at signals meanwhile.
fn share(
    py: Python<'_>,
    count: usize,
    threads: usize,
    stop: &AtomicBool,
    work: &(dyn Fn(usize) -> Row + Sync),
) -> PyResult<Vec<Row>> {
    let next = AtomicUsize::new(0);
    let mut rows: Vec<Option<Row>> = vec![None; count];
    let outcome = py.detach(|| {
        std::thread::scope(|scope| {
            let (sender, done) = mpsc::channel();
            for _ in 0..threads {
                let (sender, next) = (sender.clone(), &next);
                scope.spawn(move || {
                    loop {
                        let index = next.fetch_add(1, Ordering::Relaxed);
                        if index >= count || stop.load(Ordering::Relaxed) {
                            break;
                        }
                        if sender.send((index, work(index))).is_err() {
                            break;
                        }
                    }
                });
            }
            drop(sender);
            let mut asked = Instant::now();
            loop {
                match done.recv_timeout(PERIOD) {
                    Ok((index, row)) => rows[index] = Some(row),
                    Err(mpsc::RecvTimeoutError::Timeout) => {}
                    Err(mpsc::RecvTimeoutError::Disconnected) => return Ok(()),
                }
                // Rows may come without a pause.
                if asked.elapsed() < PERIOD {
                    continue;
                }
                asked = Instant::now();
                if let Err(error) = Python::attach(|py| py.check_signals()) {
                    stop.store(true, Ordering::Relaxed);
                    return Err(error);
                }
            }
        })
    });
    outcome?;
    Ok(rows.into_iter().flatten().collect())
}

/// What changing the parameters and solving gives.
fn row(
    scene: &Scene,
    designs: &[(String, Vec<f64>)],
    values: &[String],
    samples: &Samples,
    index: usize,
) -> Row {
    let mut own = scene.clone();
    for (name, column) in designs {
        own = match own.with_parameter(name, format!("{:?}", column[index])) {
            Ok(changed) => changed,
            Err(error) => return Row::refused(error.to_string()),
        };
    }
    match own.solve(samples.clone()) {
        Ok(motion) => Row::of(&motion, values),
        Err(error) => Row::refused(error.to_string()),
    }
}

impl Row {
    fn refused(why: String) -> Self {
        Self {
            values: Vec::new(),
            status: why,
        }
    }

    fn of(motion: &Motion, names: &[String]) -> Self {
        let columns = names
            .iter()
            .map(|name| motion.values(name).unwrap_or_default());
        let status = if motion.is_whole() {
            "ok".to_owned()
        } else {
            motion
                .events()
                .first()
                .cloned()
                .unwrap_or_else(|| "not closed".to_owned())
        };
        Self {
            values: columns.collect(),
            status,
        }
    }

    fn samples(&self) -> usize {
        self.values.first().map_or(0, Vec::len)
    }

    /// Follows the samples of a motion that has fewer of them with NaN.
    fn extend_to(&mut self, samples: usize) {
        let own = self.samples();
        if self.status == "ok" && own < samples {
            self.status = format!("{own} of {samples} samples: the motion is shorter");
        }
        for column in &mut self.values {
            column.resize(samples, f64::NAN);
        }
    }
}

#[pymethods]
impl Table {
    /// A parameter, shape (rows,), or a value, shape (rows, samples); NaN where a row has none.
    fn __getitem__<'py>(&self, py: Python<'py>, name: &str) -> PyResult<Bound<'py, PyAny>> {
        if let Some((_, column)) = self.designs.iter().find(|(own, _)| own == name) {
            return Ok(PyArray1::from_slice(py, column).into_any());
        }
        let Some(k) = self.values.iter().position(|own| own == name) else {
            return Err(no_entry(py, "the table", name, self.columns()));
        };
        let shape = [self.rows.len(), self.samples];
        let all = PyArray1::from_vec(py, self.values_of(k));
        Ok(all.reshape(shape)?.into_any())
    }

    /// How every row went: "ok", or why not.
    #[getter]
    fn status(&self) -> Vec<&str> {
        self.rows.iter().map(|row| row.status.as_str()).collect()
    }

    /// Names of all columns: parameters, then values.
    #[getter]
    fn columns(&self) -> Vec<&str> {
        let designs = self.designs.iter().map(|(name, _)| name.as_str());
        designs
            .chain(self.values.iter().map(String::as_str))
            .collect()
    }

    fn __len__(&self) -> usize {
        self.rows.len()
    }

    fn __contains__(&self, name: &Bound<'_, PyAny>) -> bool {
        let name = name.extract::<String>();
        name.is_ok_and(|name| self.columns().contains(&name.as_str()))
    }

    fn __iter__<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        self.columns().into_pyobject(py)?.call_method0("__iter__")
    }

    /// The table as an Arrow stream, one line a design and sample.
    #[pyo3(signature = (requested_schema = None))]
    fn __arrow_c_stream__<'py>(
        &self,
        py: Python<'py>,
        requested_schema: Option<Bound<'py, PyAny>>,
    ) -> PyResult<Bound<'py, PyCapsule>> {
        let _ = requested_schema;
        let spread = |column: &[f64]| -> Vec<f64> {
            column
                .iter()
                .flat_map(|v| std::iter::repeat_n(*v, self.samples))
                .collect()
        };
        let mut columns = Vec::new();
        for (name, column) in &self.designs {
            columns.push((name.clone(), String::new(), spread(column)));
        }
        let index: Vec<f64> = (0..self.samples).map(|k| k as f64).collect();
        columns.push((
            "sample".to_owned(),
            String::new(),
            index.repeat(self.rows.len()),
        ));
        for (k, name) in self.values.iter().enumerate() {
            columns.push((name.clone(), String::new(), self.values_of(k)));
        }
        stream(py, columns)
    }

    fn __repr__(&self) -> String {
        let failed = self.rows.iter().filter(|row| row.status != "ok").count();
        format!(
            "<mechanim.Table {} designs, {failed} not whole>",
            self.rows.len()
        )
    }
}

impl Table {
    /// Value `k` of every row, all samples of each; NaN where a row has none.
    fn values_of(&self, k: usize) -> Vec<f64> {
        let mut all = Vec::with_capacity(self.rows.len() * self.samples);
        for row in &self.rows {
            match row.values.get(k) {
                Some(own) => all.extend_from_slice(own),
                None => all.extend(std::iter::repeat_n(f64::NAN, self.samples)),
            }
        }
        all
    }
}
