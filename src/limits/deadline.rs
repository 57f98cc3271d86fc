//! An instant at which a search returns its best result so far.

use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// Fraction of a run's time after which searches end: the rest is for reporting their results.
const FOR_SEARCHES: f64 = 0.75;

/// Start of the run; only a program has one.
static BEGAN: OnceLock<Instant> = OnceLock::new();

/// Records the start of the run; only the first call counts.
pub fn run_began(instant: Instant) {
    let _ = BEGAN.set(instant);
}

/// When work must end; never, if nothing limits it or the platform has no clock.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Deadline(Option<Instant>);

impl Deadline {
    /// This number of seconds from now.
    pub fn after(seconds: f64) -> Self {
        let has_clock = !cfg!(target_family = "wasm");
        let wait = Duration::try_from_secs_f64(seconds.max(0.0)).ok();
        let wait = wait.filter(|_| has_clock);
        Self(wait.and_then(|wait| Instant::now().checked_add(wait)))
    }

    /// Early enough for what is found to be reported within the seconds that a run may take.
    pub(super) fn of_run(most: f64) -> Self {
        let wait = Duration::try_from_secs_f64(FOR_SEARCHES * most).ok();
        Self(
            BEGAN
                .get()
                .zip(wait)
                .and_then(|(began, wait)| began.checked_add(wait)),
        )
    }

    /// As far off as this many things in a row leave each of them.
    pub fn share(self, things: usize) -> Self {
        let left = |end: Instant| end.saturating_duration_since(Instant::now());
        let things = u32::try_from(things.max(1)).unwrap_or(u32::MAX);
        Self(self.0.map(|end| end - left(end) * (things - 1) / things))
    }

    /// The sooner one of two.
    pub fn or(self, other: Self) -> Self {
        match (self.0, other.0) {
            (Some(a), Some(b)) => Self(Some(a.min(b))),
            (a, b) => Self(a.or(b)),
        }
    }

    /// Whether it has passed.
    pub fn is_over(self) -> bool {
        self.0.is_some_and(|end| Instant::now() >= end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_sooner_one_counts() {
        let (past, far, never) = (
            Deadline::after(0.0),
            Deadline::after(1e6),
            Deadline::default(),
        );
        assert!(past.is_over() && !far.is_over() && !never.is_over());
        assert!(past.or(far).is_over() && never.or(past).is_over());
        assert_eq!(far.or(never), far);
        let share = far.share(1000);
        assert!(!share.is_over() && past.share(3).is_over());
        assert_eq!((share.or(far), never.share(2)), (share, never));
        for endless in [f64::INFINITY, 1e300] {
            assert_eq!(Deadline::after(endless), never);
        }
    }
}
