//! The limits of a run: read from the command line and the environment, and enforced while it runs.

use super::term::outcome::{BAD_USAGE, Failure};
use crate::diag::shown_text;
use crate::limits::{
    LimitExceeded, Limits, Resource, current_limits, memory_exceeded, run_began, set_limits,
};
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// The variable that holds limits for every run; `--limits` can only tighten them.
pub const VARIABLE: &str = "MECHANIM_LIMITS";

/// Polling interval: memory fills at a few gigabytes a second.
const POLLING: Duration = Duration::from_millis(20);

/// Stack size of the watching thread.
const STACK_BYTES: usize = 1 << 16;

/// Ends the process; only the program does this.
static END: OnceLock<fn(i32) -> !> = OnceLock::new();

/// Prints how the process ends where a run must be stopped at once.
pub fn ends_by(end: fn(i32) -> !) {
    let _ = END.set(end);
}

/// Sets the limits of this run, and ends it with exit code 2 if it exceeds its time or memory.
pub fn begin_watch(asked: Option<Limits>) -> Result<(), Failure> {
    let began = Instant::now();
    let mut all = asked.unwrap_or_default();
    if let Some(text) = std::env::var_os(VARIABLE) {
        let read = text
            .to_str()
            .ok_or_else(|| "no text".to_owned())
            .and_then(Limits::parse);
        let given = read
            .map_err(|why| Failure::usage(format!("the variable {VARIABLE}: {why}"), Vec::new()))?;
        all = all.and(given);
    }
    set_limits(all);
    run_began(began);
    let Some(end) = END.get() else { return Ok(()) };
    let watch = std::thread::Builder::new().stack_size(STACK_BYTES);
    // If the system cannot start the thread, predicted excesses are still refused.
    let _ = watch.spawn(move || {
        loop {
            std::thread::sleep(POLLING);
            if let Some(over) = time_exceeded(began).or_else(memory_exceeded) {
                crate::export::remove_unfinished();
                eprintln!("error: {}", shown_text(&over.to_string()));
                end(BAD_USAGE);
            }
        }
    });
    Ok(())
}

fn time_exceeded(began: Instant) -> Option<LimitExceeded> {
    let (wanted, most) = (
        began.elapsed().as_secs_f64(),
        current_limits().most(Resource::Time),
    );
    (wanted > most).then(|| LimitExceeded {
        resource: Resource::Time,
        most,
        wanted: (wanted * 1e2).round() / 1e2,
        who: "this run".to_owned(),
        needs: "takes",
    })
}
