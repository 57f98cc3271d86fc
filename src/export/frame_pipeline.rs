//! Draws frames on several threads and hands them to a sink in order, in bounded memory.
//!
//! The bytes that come out do not depend on the number of workers or their speed: every step is a function of the
//! frame's index, and only the writing is ordered.

use super::error::PipelineError;
use super::sampled_frames::{DrawnSamples, lock_mutex};
use super::{ExportSummary, FrameCoder, FrameSink};
use image::RgbaImage;
use std::collections::VecDeque;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::time::Duration;

/// Frames in flight per worker: one being drawn, two waiting.
const WINDOW_PER_WORKER: usize = 3;

/// How long the writing thread sleeps before it looks at the cancel flag again.
const CANCEL_POLL: Duration = Duration::from_millis(50);

/// Draws frames 0 to `frame_count - 1` with `workers` (each on its own thread) and writes them with `sink`.
///
/// `samples` are frames already drawn; they are used instead of drawing them again. `progress` is called on this
/// thread with (frames written, frames in all). Raising `cancel` stops after the frames being drawn.
///
/// Errors: a worker's, the sink's, or `Cancelled`; the sink is then dropped unfinished and nothing is left.
pub fn write_frames<W, E>(
    workers: Vec<W>,
    frame_count: usize,
    samples: DrawnSamples,
    mut sink: Box<dyn FrameSink>,
    progress: &dyn Fn(usize, usize),
    cancel: &AtomicBool,
) -> Result<ExportSummary, PipelineError<E>>
where
    W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
    E: std::error::Error + Send + 'static,
{
    if workers.is_empty() {
        return Err(PipelineError::NoWorkers);
    }
    let shared = Shared {
        frame_count,
        window: WINDOW_PER_WORKER * workers.len(),
        state: Mutex::new(State::new(samples)),
        changed: Condvar::new(),
    };
    let [width, height] = sink.size();
    std::thread::scope(|scope| {
        // Workers wait for a window that only this thread moves: when this thread ends, they must end, too.
        let _stop = StopOnDrop(&shared);
        let (mut working, mut alone) = (0, None);
        for draw in workers {
            let worker = PumpWorker {
                draw,
                coder: sink.coder(),
                image: RgbaImage::new(width, height),
                shared: &shared,
                cancel,
            };
            // Given to the thread, and taken back where it does not start.
            let lent = Arc::new(Mutex::new(Some(worker)));
            let (taken, shared) = (Arc::clone(&lent), &shared);
            let started = std::thread::Builder::new().spawn_scoped(scope, move || {
                let _stop = StopOnPanic(shared);
                let worker = lock_mutex(&taken).take();
                worker
                    .into_iter()
                    .for_each(|mut worker| while worker.step() {});
            });
            if started.is_err() {
                // If some threads do not start, the others do all the work; if none start, this thread does.
                alone = lock_mutex(&lent).take().filter(|_| working == 0);
                break;
            }
            working += 1;
        }
        for index in 0..frame_count {
            if let Some(worker) = &mut alone {
                worker.step();
            }
            let coded = shared.next_coded(cancel)?;
            sink.write(index, &coded)?;
            shared.written(coded);
            progress(index + 1, frame_count);
        }
        Ok::<(), PipelineError<E>>(())
    })?;
    if cancel.load(Ordering::Relaxed) {
        return Err(PipelineError::Cancelled);
    }
    Ok(sink.finish()?)
}

struct State<E: std::error::Error + 'static> {
    /// Coded frames from frame `written` on; `None` while in work.
    slots: VecDeque<Option<Vec<u8>>>,
    written: usize,
    samples: DrawnSamples,
    /// Buffers to use again.
    spare: Vec<Vec<u8>>,
    failure: Option<PipelineError<E>>,
    stop: bool,
}

impl<E: std::error::Error + 'static> State<E> {
    fn new(samples: DrawnSamples) -> Self {
        Self {
            slots: VecDeque::new(),
            written: 0,
            samples,
            spare: Vec::new(),
            failure: None,
            stop: false,
        }
    }
}

struct Shared<E: std::error::Error + 'static> {
    frame_count: usize,
    window: usize,
    state: Mutex<State<E>>,
    changed: Condvar,
}

/// A frame to draw: its index, its picture if it was drawn before, and a buffer.
struct Task {
    index: usize,
    sample: Option<RgbaImage>,
    coded: Vec<u8>,
}

impl<E: std::error::Error + 'static> Shared<E> {
    /// Waits until the next frame is coded and takes it.
    fn next_coded(&self, cancel: &AtomicBool) -> Result<Vec<u8>, PipelineError<E>> {
        let mut state = lock_mutex(&self.state);
        loop {
            if let Some(failure) = state.failure.take() {
                return Err(failure);
            }
            if cancel.load(Ordering::Relaxed) || state.stop {
                return Err(PipelineError::Cancelled);
            }
            if let Some(coded) = state.slots.front_mut().and_then(Option::take) {
                return Ok(coded);
            }
            let waited = self.changed.wait_timeout(state, CANCEL_POLL);
            state = waited.unwrap_or_else(PoisonError::into_inner).0;
        }
    }

    /// Moves the window on by one frame.
    fn written(&self, coded: Vec<u8>) {
        let mut state = lock_mutex(&self.state);
        state.spare.push(coded);
        state.slots.pop_front();
        state.written += 1;
        self.changed.notify_all();
    }

    /// The next frame to draw, or `None` when all are assigned or the work is stopped.
    fn next_task(&self, cancel: &AtomicBool) -> Option<Task> {
        let mut state = lock_mutex(&self.state);
        loop {
            let index = state.written + state.slots.len();
            if state.stop || cancel.load(Ordering::Relaxed) || index >= self.frame_count {
                return None;
            }
            if state.slots.len() < self.window {
                state.slots.push_back(None);
                let sample = state.samples.iter().position(|s| s.0 == index);
                let sample = sample.map(|s| state.samples.swap_remove(s).1);
                let coded = state.spare.pop().unwrap_or_default();
                return Some(Task {
                    index,
                    sample,
                    coded,
                });
            }
            state = self
                .changed
                .wait(state)
                .unwrap_or_else(PoisonError::into_inner);
        }
    }

    fn deliver_frame(&self, index: usize, coded: Vec<u8>) {
        let mut state = lock_mutex(&self.state);
        let place = index.checked_sub(state.written);
        if let Some(slot) = place.and_then(|place| state.slots.get_mut(place)) {
            *slot = Some(coded);
        }
        self.changed.notify_all();
    }

    fn record_failure(&self, failure: PipelineError<E>) {
        let mut state = lock_mutex(&self.state);
        state.failure.get_or_insert(failure);
        self.changed.notify_all();
    }

    fn stop_workers(&self) {
        lock_mutex(&self.state).stop = true;
        self.changed.notify_all();
    }
}

struct PumpWorker<'a, W, E: std::error::Error + 'static> {
    draw: W,
    coder: Box<dyn FrameCoder>,
    image: RgbaImage,
    shared: &'a Shared<E>,
    cancel: &'a AtomicBool,
}

impl<W, E> PumpWorker<'_, W, E>
where
    W: FnMut(usize, &mut RgbaImage) -> Result<(), E>,
    E: std::error::Error + 'static,
{
    /// Draws the next frame, if there is one; returns false after the last one.
    fn step(&mut self) -> bool {
        let Some(task) = self.shared.next_task(self.cancel) else {
            return false;
        };
        let drawn = self.frame(task);
        drawn
            .map_err(|failure| self.shared.record_failure(failure))
            .is_ok()
    }

    fn frame(&mut self, task: Task) -> Result<(), PipelineError<E>> {
        let Task {
            index,
            sample,
            mut coded,
        } = task;
        if sample.is_none() {
            let drawn = (self.draw)(index, &mut self.image);
            drawn.map_err(|source| PipelineError::Draw {
                frame: index,
                source,
            })?;
        }
        self.coder
            .code(sample.as_ref().unwrap_or(&self.image), &mut coded)?;
        self.shared.deliver_frame(index, coded);
        Ok(())
    }
}

/// Ends the workers when the writing thread leaves, for whatever reason.
struct StopOnDrop<'a, E: std::error::Error + 'static>(&'a Shared<E>);

impl<E: std::error::Error + 'static> Drop for StopOnDrop<'_, E> {
    fn drop(&mut self) {
        self.0.stop_workers();
    }
}

/// Ends everything when a worker panics, so that the panic is passed on instead of waited for.
struct StopOnPanic<'a, E: std::error::Error + 'static>(&'a Shared<E>);

impl<E: std::error::Error + 'static> Drop for StopOnPanic<'_, E> {
    fn drop(&mut self) {
        if std::thread::panicking() {
            self.0.stop_workers();
        }
    }
}
