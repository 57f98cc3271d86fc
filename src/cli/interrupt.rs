//! Ctrl-C: requests to stop, and the reaction to them.

use super::term::outcome::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// Raised by Ctrl-C; everything that takes long looks at it.
pub static CANCEL: AtomicBool = AtomicBool::new(false);

/// Raised by what has results to save on Ctrl-C, and looks at [`CANCEL`] by itself as often as it can.
static SAVES: AtomicBool = AtomicBool::new(false);

/// How long a run may take to end in order after Ctrl-C: a frame, or a few poses of a large mechanism.
const GRACE: Duration = Duration::from_millis(350);

/// How long the proof of a result may still take after Ctrl-C.
const GRACE_OF_PROOF: Duration = Duration::from_millis(150);

/// Waits for a run to end after Ctrl-C. Where it does not, and has nothing to save, removes what is half-written and says
/// so; the process is to end then.
pub fn wait_until_overdue() {
    std::thread::sleep(GRACE);
    while SAVES.load(Ordering::Relaxed) {
        std::thread::sleep(LOOK);
    }
    crate::export::remove_unfinished();
    eprintln!("error: {}", Failure::Interrupted);
}

/// How often the result of another thread is polled.
const LOOK: Duration = Duration::from_millis(10);

/// What is found, unless Ctrl-C comes and it takes longer than a little from then on: that is not waited for.
pub fn unless_interrupted<T: Send + 'static>(
    work: impl Fn() -> T + Send + Sync + 'static,
) -> Option<T> {
    let (sender, receiver) = std::sync::mpsc::channel();
    let work = Arc::new(work);
    let other = Arc::clone(&work);
    let send = move || drop(sender.send(other()));
    if std::thread::Builder::new().spawn(send).is_err() {
        return Some(work());
    }
    let mut left = GRACE_OF_PROOF;
    loop {
        match receiver.recv_timeout(LOOK) {
            Ok(found) => return Some(found),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if is_interrupted() => {
                left = left.checked_sub(LOOK)?;
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Says whether this run has results to save on Ctrl-C by now: none at first, and none once they are written.
pub fn save_results(has_some: bool) {
    SAVES.store(has_some, Ordering::Relaxed);
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
