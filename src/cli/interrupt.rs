//! Ctrl-C: requests to stop, and the reaction to them.

use super::term::outcome::Failure;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::RecvTimeoutError;
use std::time::Duration;

/// Set by Ctrl-C; every long computation polls it.
pub static CANCEL: AtomicBool = AtomicBool::new(false);

/// Set by commands that save partial results on Ctrl-C, and poll [`CANCEL`] themselves as often as they can.
static SAVES: AtomicBool = AtomicBool::new(false);

/// Time that a run may take to end cleanly after Ctrl-C: a frame, or a few poses of a large mechanism.
const GRACE: Duration = Duration::from_millis(350);

/// Time that the proof of a result may still take after Ctrl-C.
const GRACE_OF_PROOF: Duration = Duration::from_millis(150);

/// Waits for a run to end after Ctrl-C. If it does not, and has nothing to save, removes unfinished files and says so;
/// the process must end then.
pub fn wait_until_overdue() {
    std::thread::sleep(GRACE);
    while SAVES.load(Ordering::Relaxed) {
        std::thread::sleep(POLLING);
    }
    abandon();
}

/// Removes unfinished files and says that the run was interrupted; the process must end then.
pub fn abandon() {
    crate::export::remove_unfinished();
    eprintln!("error: {}", Failure::Interrupted);
}

/// Polling interval for the result of another thread.
const POLLING: Duration = Duration::from_millis(10);

/// The result of `work`, unless Ctrl-C comes and it takes more than a short time from then on: then it is abandoned.
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
        match receiver.recv_timeout(POLLING) {
            Ok(found) => return Some(found),
            Err(RecvTimeoutError::Disconnected) => return None,
            Err(RecvTimeoutError::Timeout) if is_interrupted() => {
                left = left.checked_sub(POLLING)?;
            }
            Err(RecvTimeoutError::Timeout) => {}
        }
    }
}

/// Sets whether this run now has results to save on Ctrl-C: none at first, and none once they are written.
pub fn save_results(has_some: bool) {
    SAVES.store(has_some, Ordering::Relaxed);
}

/// Whether Ctrl-C was pressed.
pub fn is_interrupted() -> bool {
    CANCEL.load(Ordering::Relaxed)
}

/// Ends a run cleanly if Ctrl-C came while the motion was being solved.
pub fn refuse_interrupted() -> Result<(), Failure> {
    if is_interrupted() {
        return Err(Failure::Interrupted);
    }
    Ok(())
}
