//! The whole program: signals, deadline, dispatch, exit code.

use super::interrupt::{CANCEL, abandon, wait_until_overdue};
use super::term::outcome::INTERRUPTED;
use std::ffi::OsString;
use std::panic::UnwindSafe;
use std::sync::OnceLock;
use std::sync::atomic::Ordering;
use std::time::{Duration, Instant};

/// Runs the program with the given arguments (the first is its own name) and returns its exit code. It handles the
/// signals of its process, and ends it after a second Ctrl-C or at the time limit.
pub fn main(arguments: impl IntoIterator<Item = OsString> + UnwindSafe) -> i32 {
    take_full_files_for_errors();
    leave_ignored_hangups();
    // The first Ctrl-C ends a run cleanly, or after a short time at once; a second one does not wait.
    let first = OnceLock::new();
    let handler = ctrlc::set_handler(move || {
        let end = || {
            wait_until_overdue();
            std::process::exit(INTERRUPTED)
        };
        let begun: &Instant = first.get_or_init(Instant::now);
        if CANCEL.swap(true, Ordering::Relaxed) {
            if begun.elapsed() >= ONE_SIGNAL {
                abandon();
                std::process::exit(INTERRUPTED);
            }
            return;
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

/// Signals that follow each other within this time are one: `timeout` sends its own to the process and to its group.
const ONE_SIGNAL: Duration = Duration::from_millis(200);

/// A hangup that was ignored when the program began stays ignored: it was started with `nohup`.
#[cfg(unix)]
fn leave_ignored_hangups() {
    use nix::sys::signal::{SigSet, Signal};
    // Elsewhere than on Linux nothing tells.
    let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
    let ignored = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    let ignored = ignored.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
    let bit = 1_u64 << (Signal::SIGHUP as u32 - 1);
    if ignored.is_some_and(|mask| mask & bit != 0) {
        let _ = SigSet::from(Signal::SIGHUP).thread_block();
    }
}

#[cfg(not(unix))]
fn leave_ignored_hangups() {}

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
