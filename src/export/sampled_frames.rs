//! Single frames drawn by all workers, before a film is written: for its palette and its colours.

use super::error::PipelineError;
use crate::sorting::sort_by_key;
use image::RgbaImage;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, MutexGuard, PoisonError};

/// Frames drawn for the palette, kept so that they are not drawn twice.
pub type DrawnSamples = Vec<(usize, RgbaImage)>;

/// Draws the frames `indices` (pixels `size`) with all `workers` at once and returns them in the order of `indices`.
///
/// Errors: the first a worker reports, or the cancel flag.
pub fn draw_samples<W, E>(
    workers: &mut [W],
    indices: &[usize],
    size: [u32; 2],
    cancel: &AtomicBool,
) -> Result<DrawnSamples, PipelineError<E>>
where
    W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
    E: std::error::Error + Send + 'static,
{
    let drawn = Mutex::new(Vec::new());
    let take = |place: usize, image: &mut RgbaImage| {
        let empty = RgbaImage::new(size[0], size[1]);
        lock_mutex(&drawn).push((place, std::mem::replace(image, empty)));
    };
    look_at(workers, indices, size, cancel, &take)?;
    let mut drawn = drawn.into_inner().unwrap_or_else(PoisonError::into_inner);
    sort_by_key(&mut drawn, |d| d.0);
    let frames = drawn.into_iter();
    Ok(frames
        .map(|(place, image)| (indices[place], image))
        .collect())
}

/// Draws the frames `indices` (pixels `size`) with all `workers` at once and shows each to `take`, with its place in
/// `indices` and in whatever order they are done.
///
/// Errors: the first a worker reports, or the cancel flag.
pub fn look_at<W, E>(
    workers: &mut [W],
    indices: &[usize],
    size: [u32; 2],
    cancel: &AtomicBool,
    take: &(dyn Fn(usize, &mut RgbaImage) + Sync),
) -> Result<(), PipelineError<E>>
where
    W: FnMut(usize, &mut RgbaImage) -> Result<(), E> + Send,
    E: std::error::Error + Send + 'static,
{
    let next = Mutex::new(indices.iter().copied().enumerate());
    let failed = Mutex::new(None);
    let work = |draw: &mut W| {
        let mut image = RgbaImage::new(size[0], size[1]);
        loop {
            let Some((place, frame)) = lock_mutex(&next).next() else {
                break;
            };
            if cancel.load(Ordering::Relaxed) || lock_mutex(&failed).is_some() {
                break;
            }
            match draw(frame, &mut image) {
                Ok(()) => take(place, &mut image),
                Err(source) => *lock_mutex(&failed) = Some(PipelineError::Draw { frame, source }),
            }
        }
    };
    std::thread::scope(|scope| {
        // The calling thread works, too, with whatever threads the system starts.
        let mut workers = workers.iter_mut();
        let own = workers.next();
        for draw in workers {
            let work = &work;
            let started = std::thread::Builder::new().spawn_scoped(scope, move || work(draw));
            if started.is_err() {
                break;
            }
        }
        own.into_iter().for_each(work);
    });
    match failed.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(failure) => Err(failure),
        None if cancel.load(Ordering::Relaxed) => Err(PipelineError::Cancelled),
        None => Ok(()),
    }
}

/// A panicking worker leaves the state consistent: it is changed in single steps under the lock.
pub(super) fn lock_mutex<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}
