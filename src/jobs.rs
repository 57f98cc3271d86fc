//! Numbered jobs shared among threads. Results are returned in the order of their numbers, so that they do not depend on the
//! number of threads.

use crate::sorting::sort_by_key;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// Interval between progress reports; work that finishes sooner is not delayed by it.
const WATCH: Duration = Duration::from_millis(5);

/// A stopwatch; it reads zero where the platform has no clock, as in a web page.
#[derive(Clone, Copy, Debug)]
pub struct Stopwatch(Option<Instant>);

impl Stopwatch {
    /// Starts now.
    pub fn start() -> Self {
        Self((!cfg!(target_family = "wasm")).then(Instant::now))
    }

    /// Seconds since the start.
    pub fn seconds(&self) -> f64 {
        self.0.map_or(0.0, |begun| begun.elapsed().as_secs_f64())
    }
}

/// Number of threads that the machine can run at once.
pub fn core_count() -> usize {
    std::thread::available_parallelism().map_or(1, usize::from)
}

/// Runs the jobs with the numbers below `count` on up to `threads` threads, each with its own tool from `make`. A
/// thread whose `work` returns `None` stops. Returns the results with their numbers, ascending.
///
/// If the system starts fewer threads than requested, those do all the work; the calling one always takes part.
pub fn share_work<W, T: Send>(
    count: usize,
    threads: usize,
    make: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, usize) -> Option<T> + Sync,
) -> Vec<(usize, T)> {
    let jobs = Jobs::new(count, &make, &work);
    std::thread::scope(|scope| {
        for _ in 1..threads.min(count) {
            let started = std::thread::Builder::new().spawn_scoped(scope, || jobs.run());
            if started.is_err() {
                break;
            }
        }
        jobs.run();
    });
    jobs.results()
}

/// The same, while the calling thread reports the number of finished jobs to `watch`.
pub fn share_watched<W, T: Send>(
    count: usize,
    threads: usize,
    make: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, usize) -> Option<T> + Sync,
    watch: &dyn Fn(usize),
) -> Vec<(usize, T)> {
    let jobs = Jobs::new(count, &make, &work);
    std::thread::scope(|scope| {
        let mut workers = Vec::new();
        for _ in 0..threads.clamp(1, count.max(1)) {
            match std::thread::Builder::new().spawn_scoped(scope, || jobs.run()) {
                Ok(worker) => workers.push(worker),
                Err(_) => break,
            }
        }
        if workers.is_empty() {
            jobs.run();
        }
        while !workers.iter().all(|worker| worker.is_finished()) {
            std::thread::sleep(WATCH);
            watch(jobs.done.load(Ordering::Relaxed));
        }
    });
    jobs.results()
}

struct Jobs<'f, W, T> {
    count: usize,
    make: &'f (dyn Fn() -> W + Sync),
    work: &'f (dyn Fn(&mut W, usize) -> Option<T> + Sync),
    next: AtomicUsize,
    done: AtomicUsize,
    found: Mutex<Vec<(usize, T)>>,
}

impl<'f, W, T: Send> Jobs<'f, W, T> {
    fn new(
        count: usize,
        make: &'f (dyn Fn() -> W + Sync),
        work: &'f (dyn Fn(&mut W, usize) -> Option<T> + Sync),
    ) -> Self {
        Self {
            count,
            make,
            work,
            next: AtomicUsize::new(0),
            done: AtomicUsize::new(0),
            found: Mutex::new(Vec::new()),
        }
    }

    fn run(&self) {
        let mut tool = (self.make)();
        let mut own = Vec::new();
        loop {
            let index = self.next.fetch_add(1, Ordering::Relaxed);
            if index >= self.count {
                break;
            }
            let Some(result) = (self.work)(&mut tool, index) else {
                break;
            };
            own.push((index, result));
            self.done.fetch_add(1, Ordering::Relaxed);
        }
        let mut found = self.found.lock().unwrap_or_else(|e| e.into_inner());
        found.append(&mut own);
    }

    fn results(self) -> Vec<(usize, T)> {
        let mut found = self.found.into_inner().unwrap_or_else(|e| e.into_inner());
        sort_by_key(&mut found, |(index, _)| *index);
        found
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_job_is_done_once_and_in_order() {
        for threads in [0, 1, 3, 50] {
            let squares = share_work(20, threads, || 0, |_, k| Some(k * k));
            assert_eq!(squares, (0..20).map(|k| (k, k * k)).collect::<Vec<_>>());
            let watched = share_watched(20, threads, || (), |_, k| Some(k * k), &|_| ());
            assert_eq!(watched, squares);
            assert!(share_work(0, threads, || (), |_, k| Some(k)).is_empty());
        }
    }

    /// A worker that is cancelled stops; the results so far are kept.
    #[test]
    fn work_ends_early() {
        let found = share_work(1000, 1, || 0, |_, k| (k < 7).then_some(k));
        assert_eq!(found.len(), 7);
    }
}
