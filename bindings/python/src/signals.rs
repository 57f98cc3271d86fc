//! Long work without the interpreter's lock, given up when a signal handler raises.

use pyo3::prelude::*;
use std::cell::{Cell, RefCell};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// How often signals are looked at; `benches/peers/package.py` prints how soon Ctrl-C is answered.
const PERIOD: Duration = Duration::from_millis(20);

/// Looks at the clock that are nearer to each other become half as many, up to [`MOST_STEPS`] steps apart.
const GLANCE: Duration = Duration::from_millis(1);
const MOST_STEPS: u32 = 64;

/// How often a thread is looked at.
const POLL: Duration = Duration::from_millis(1);

/// How long work may take to end after a signal: by then Ctrl-C is to be answered.
const GRACE: Duration = Duration::from_millis(25);

/// Runs `work` on a thread of its own while other Python threads go on. It is given a flag that is raised when a signal
/// handler raises; work that does not end soon then is left to itself, and what it finds is dropped.
pub fn watched<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&Arc<AtomicBool>) -> T + Send + 'static,
) -> PyResult<T> {
    let flag = Arc::new(AtomicBool::new(false));
    let raised = Arc::clone(&flag);
    let worker = std::thread::spawn(move || work(&flag));
    let ended = |within: Duration| {
        let begun = Instant::now();
        while !worker.is_finished() && begun.elapsed() < within {
            std::thread::sleep(POLL);
        }
        worker.is_finished()
    };
    let answer = py.detach(|| {
        while !ended(PERIOD) {
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                raised.store(true, Ordering::Relaxed);
                ended(GRACE);
                return Err(error);
            }
        }
        Ok(())
    });
    answer?;
    worker
        .join()
        .or_else(|panic| std::panic::resume_unwind(panic))
}

/// Runs `work` while other Python threads go on. It is given a question that it asks between its steps: whether to give up.
/// What it had found by then is dropped by a thread of its own: to free a long motion takes longer than to answer.
pub fn interruptible<T: Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce(&dyn Fn() -> bool) -> T + Send,
) -> PyResult<T> {
    let (result, raised) = py.detach(|| {
        // The clock is asked as seldom as short steps allow: it takes a tenth of a small pose.
        let (asked, looked) = (Cell::new(Instant::now()), Cell::new(Instant::now()));
        let (stride, left) = (Cell::new(1_u32), Cell::new(0_u32));
        let raised = RefCell::new(None);
        let cancelled = || {
            if raised.borrow().is_some() {
                return true;
            }
            if left.get() > 0 {
                left.set(left.get() - 1);
                return false;
            }
            let now = Instant::now();
            stride.set(match now - looked.get() < GLANCE {
                true => (2 * stride.get()).min(MOST_STEPS),
                false => 1,
            });
            left.set(stride.get() - 1);
            looked.set(now);
            if now - asked.get() < PERIOD {
                return false;
            }
            asked.set(now);
            if let Err(error) = Python::attach(|py| py.check_signals()) {
                *raised.borrow_mut() = Some(error);
                return true;
            }
            false
        };
        let result = work(&cancelled);
        (result, raised.into_inner())
    });
    match raised {
        Some(error) => {
            std::thread::spawn(move || drop(result));
            Err(error)
        }
        None => Ok(result),
    }
}
