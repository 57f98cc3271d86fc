//! The `mechanim` program: parse, dispatch, exit code.

use std::sync::atomic::Ordering;

fn main() {
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
    let code = mechanim::cli::guarded(|| mechanim::cli::run(std::env::args_os()));
    std::process::exit(code);
}
