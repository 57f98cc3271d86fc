//! The whole program: signals, deadline, dispatch, exit code.

use super::interrupt::{CANCEL, wait_until_overdue};
use super::term::outcome::INTERRUPTED;
use std::ffi::OsString;
use std::panic::UnwindSafe;
use std::sync::atomic::Ordering;

/// Runs the program with the given arguments (the first is its own name) and returns its exit code. It handles the
/// signals of its process, and ends it after a second Ctrl-C or at the time limit.
pub fn main(arguments: impl IntoIterator<Item = OsString> + UnwindSafe) -> i32 {
    take_full_files_for_errors();
    // The first Ctrl-C ends a run cleanly, or after a short time at once; a second one does not wait.
    let handler = ctrlc::set_handler(|| {
        let end = || {
            wait_until_overdue();
            std::process::exit(INTERRUPTED)
        };
        if CANCEL.swap(true, Ordering::Relaxed) {
            std::process::exit(INTERRUPTED);
        }
        // On a thread of its own, so that a second signal is noticed; if none can be started, after this one.
        if std::thread::Builder::new().spawn(end).is_err() {
            end();
        }
    });
    if let Err(error) = handler {
        eprintln!("warning: Ctrl-C will not clean up: {error}");
    }
    super::watch::ends_by(|code| std::process::exit(code));
    super::run_guarded(|| super::run(arguments))
}

/// A file that grows beyond `ulimit -f` is a write error, as on a full disk, instead of a signal that kills the run and
/// leaves its temporary file behind.
#[cfg(unix)]
fn take_full_files_for_errors() {
    use nix::sys::signal::{SigSet, Signal};
    // Threads inherit it. Where it cannot be blocked, the signal kills the run as usual.
    let _ = SigSet::from(Signal::SIGXFSZ).thread_block();
}

#[cfg(not(unix))]
fn take_full_files_for_errors() {}
