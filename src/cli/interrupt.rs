//! Ctrl-C: what is asked of a run, and what it does about it.

use super::term::outcome::Failure;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Raised by Ctrl-C; everything that takes long looks at it.
pub static CANCEL: AtomicBool = AtomicBool::new(false);

/// Raised by what has results to save on Ctrl-C, and looks at [`CANCEL`] by itself as often as it can.
static SAVES: AtomicBool = AtomicBool::new(false);

/// How long a run may take to end in order after Ctrl-C: a frame, or a few poses of a large mechanism.
const GRACE: Duration = Duration::from_millis(350);

/// Waits for a run to end after Ctrl-C. Where it does not, removes what is half-written and says so; true if the process
/// is to end then.
pub fn overdue() -> bool {
    std::thread::sleep(GRACE);
    if SAVES.load(Ordering::Relaxed) {
        return false;
    }
    crate::export::remove_unfinished();
    eprintln!("error: {}", Failure::Interrupted);
    true
}

/// Says that this run has results to save on Ctrl-C.
pub fn save_results() {
    SAVES.store(true, Ordering::Relaxed);
}

/// Whether Ctrl-C came.
pub fn is_interrupted() -> bool {
    CANCEL.load(Ordering::Relaxed)
}

/// Ends a run in order if Ctrl-C came while the motion was being solved.
pub fn refuse_interrupted() -> Result<(), Failure> {
    if is_interrupted() {
        return Err(Failure::Interrupted);
    }
    Ok(())
}
