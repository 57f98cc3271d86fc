//! The `mechanim` program: parse, dispatch, exit code.

use std::sync::atomic::Ordering;

fn main() {
    take_full_files_for_errors();
    // The first Ctrl-C ends a run in order, or after a short while without order; a second one does not wait.
    let handler = ctrlc::set_handler(|| {
        let is_second = mechanim::cli::interrupt::CANCEL.swap(true, Ordering::Relaxed);
        if is_second || mechanim::cli::interrupt::overdue() {
            std::process::exit(130);
        }
    });
    if let Err(error) = handler {
        eprintln!("warning: Ctrl-C will not clean up: {error}");
    }
    mechanim::cli::watch::ends_by(|code| std::process::exit(code));
    let code = mechanim::cli::guarded(|| mechanim::cli::run(std::env::args_os()));
    std::process::exit(code);
}

/// A file that grows beyond `ulimit -f` is an error of the write, as on a full disk, and no signal that kills the run with
/// its temporary file left.
#[cfg(unix)]
fn take_full_files_for_errors() {
    use nix::sys::signal::{SigSet, Signal};
    // Threads inherit it. Where it cannot be blocked the run is killed as before.
    let _ = SigSet::from(Signal::SIGXFSZ).thread_block();
}

#[cfg(not(unix))]
fn take_full_files_for_errors() {}
