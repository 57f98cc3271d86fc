//! Works on a study: one missing unit after another, unless another worker is processing it.

use super::error::PartsError;
use super::folder::Folder;
use super::lease::LeaseSightings;
use super::part::write_part;
use std::ops::Range;
use std::time::{Duration, Instant};

/// How often a waiting worker checks the progress of the others.
const WAIT: Duration = Duration::from_millis(500);

/// The units for a worker, and its time.
#[derive(Clone, Debug)]
pub struct WorkShare {
    /// The units that it may process.
    pub units: Range<u64>,
    /// The unit with which it begins; it continues from there, and after the last one from the first.
    pub begin: u64,
    /// No unit is started after this instant.
    pub until: Option<Instant>,
}

/// How a worker finished.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum WorkEnd {
    /// All units of its share are done.
    Done,
    /// Its time is up.
    TimeOver,
    /// It was asked to stop; the unit it worked on is dropped.
    Stopped,
}

/// Processes all missing units of a worker's range. `compute` returns the numbers of some items, or nothing if it was
/// asked to stop; `is_stopped` is polled while waiting for others.
///
/// Errors: the folder cannot be written to.
pub fn work_on(
    folder: &Folder,
    share: &WorkShare,
    compute: &mut dyn FnMut(Range<u64>) -> Option<Vec<f64>>,
    is_stopped: &dyn Fn() -> bool,
) -> Result<WorkEnd, PartsError> {
    let mut seen = LeaseSightings::default();
    let mut missing: Vec<u64> = ordered_units(share)
        .filter(|unit| !folder.has(*unit))
        .collect();
    while !missing.is_empty() {
        let mut held = Vec::new();
        for unit in missing {
            if is_stopped() {
                return Ok(WorkEnd::Stopped);
            }
            if share.until.is_some_and(|end| Instant::now() >= end) {
                return Ok(WorkEnd::TimeOver);
            }
            if folder.has(unit) {
                continue;
            }
            let Some(_lease) = seen.take(&folder.lease(unit))? else {
                held.push(unit);
                continue;
            };
            // The previous holder may have finished in between.
            if folder.has(unit) {
                continue;
            }
            let items = folder.plan.items_of(unit);
            let Some(numbers) = compute(items.clone()) else {
                return Ok(WorkEnd::Stopped);
            };
            write_part(&folder.parts_folder(), &folder.plan, &items, &numbers)?;
        }
        missing = held;
        if !missing.is_empty() {
            std::thread::sleep(WAIT);
        }
    }
    Ok(WorkEnd::Done)
}

/// The units of a share in the order in which they are tried.
fn ordered_units(share: &WorkShare) -> impl Iterator<Item = u64> {
    let begin = share.begin.clamp(share.units.start, share.units.end);
    (begin..share.units.end).chain(share.units.start..begin)
}
