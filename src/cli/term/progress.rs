//! Progress on standard error: a bar with rate and remaining time on a terminal, a line per tenth elsewhere if
//! asked for.

use crate::cli::args::files::ProgressArg;
use std::cell::Cell;
use std::io::{IsTerminal, Write};
use std::time::{Duration, Instant};

/// Minimum time between redraws of the bar: terminals are slow.
const REDRAW: Duration = Duration::from_millis(80);

/// Characters of the bar.
const WIDTH: usize = 28;

/// Work that takes longer than this is announced.
const PATIENCE: Duration = Duration::from_millis(500);

/// Does some work; if it takes long, a terminal shows what is done and the seconds so far.
pub fn announce_work<T>(what: &str, quiet: bool, work: impl FnOnce() -> T) -> T {
    if quiet || !std::io::stderr().is_terminal() {
        return work();
    }
    let (done, waits) = std::sync::mpsc::channel::<()>();
    let start = Instant::now();
    std::thread::scope(|scope| {
        let watch = move || {
            let mut is_shown = false;
            while waits.recv_timeout(PATIENCE) == Err(std::sync::mpsc::RecvTimeoutError::Timeout) {
                let seconds = start.elapsed().as_secs_f64();
                let mut stderr = std::io::stderr().lock();
                let _ = write!(stderr, "\r{what}, {seconds:.1} s\x1b[K");
                let _ = stderr.flush();
                is_shown = true;
            }
            if is_shown {
                let _ = write!(std::io::stderr(), "\r\x1b[K");
            }
        };
        // If the thread cannot be started, the work is not announced.
        let _ = std::thread::Builder::new().spawn_scoped(scope, watch);
        let result = work();
        drop(done);
        result
    })
}

enum Style {
    Bar,
    Lines,
    Silent,
}

/// Shows the progress of frames.
pub struct Progress {
    style: Style,
    start: Instant,
    last: Cell<Option<Instant>>,
    tenth: Cell<usize>,
    what: &'static str,
}

impl Progress {
    /// Starts the clock.
    pub fn new(choice: ProgressArg, quiet: bool) -> Self {
        let style = match choice {
            _ if quiet => Style::Silent,
            ProgressArg::None => Style::Silent,
            ProgressArg::Plain => Style::Lines,
            ProgressArg::Auto if std::io::stderr().is_terminal() => Style::Bar,
            ProgressArg::Auto => Style::Silent,
        };
        Self {
            style,
            start: Instant::now(),
            last: Cell::new(None),
            tenth: Cell::new(0),
            what: "frames",
        }
    }

    /// Counts other items than frames.
    pub fn counting(mut self, what: &'static str) -> Self {
        self.what = what;
        self
    }

    /// `done` of `total` frames are written.
    pub fn show(&self, done: usize, total: usize) {
        match self.style {
            Style::Silent => {}
            Style::Lines => {
                let tenth = 10 * done / total.max(1);
                if tenth > self.tenth.replace(tenth) {
                    let _ = writeln!(
                        std::io::stderr(),
                        "{done}/{total} {}, {}",
                        self.what,
                        self.rate(done, total)
                    );
                }
            }
            Style::Bar => {
                let now = Instant::now();
                if done < total && self.last.get().is_some_and(|last| now - last < REDRAW) {
                    return;
                }
                self.last.set(Some(now));
                let filled = WIDTH * done / total.max(1);
                let bar = format!("{}{}", "█".repeat(filled), "░".repeat(WIDTH - filled));
                let mut stderr = std::io::stderr().lock();
                let _ = write!(
                    stderr,
                    "\r{bar} {done}/{total} {}, {}\x1b[K",
                    self.what,
                    self.rate(done, total)
                );
                let _ = stderr.flush();
            }
        }
    }

    /// Prints one line of text, replacing the last one on a terminal; elsewhere only if it is `worth` a line of its
    /// own.
    pub fn say(&self, text: &str, worth: bool) {
        match self.style {
            Style::Silent => {}
            Style::Lines if worth => {
                let _ = writeln!(std::io::stderr(), "{text}");
            }
            Style::Lines => {}
            Style::Bar => {
                let now = Instant::now();
                if self.last.get().is_some_and(|last| now - last < REDRAW) {
                    return;
                }
                self.last.set(Some(now));
                let mut stderr = std::io::stderr().lock();
                let _ = write!(stderr, "\r{text}\x1b[K");
                let _ = stderr.flush();
            }
        }
    }

    /// Removes the bar.
    pub fn end(&self) {
        if matches!(self.style, Style::Bar) && self.last.get().is_some() {
            let mut stderr = std::io::stderr().lock();
            let _ = write!(stderr, "\r\x1b[K");
            let _ = stderr.flush();
        }
    }

    fn rate(&self, done: usize, total: usize) -> String {
        let seconds = self.start.elapsed().as_secs_f64();
        if done == 0 {
            return format!("{seconds:.0} s by now");
        }
        let rate = done as f64 / seconds.max(1e-9);
        format!(
            "{rate:.*} a second, {:.0} s left",
            usize::from(rate < 10.0),
            (total - done) as f64 / rate.max(1e-9)
        )
    }
}
