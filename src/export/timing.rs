//! Exact frame times to the whole hundredths of a second that a GIF can say.

use super::error::ExportError;

/// Hundredths in a second, the unit of a GIF delay.
const HUNDREDTHS: f64 = 100.0;

/// Shortest delay in hundredths. Browsers show anything shorter at a tenth of a second.
pub const SHORTEST_DELAY: u16 = 2;

/// When each frame is shown, in seconds from the first.
#[derive(Clone, Debug, PartialEq)]
pub enum FrameTimes {
    /// Frame k at `k / fps`, each shown for `1 / fps`.
    Uniform {
        /// Frames per second, positive.
        fps: f64,
        /// Number of frames.
        count: usize,
    },
    /// Frame k at `starts[k]`; the last until `end`.
    At {
        /// Rising, in seconds.
        starts: Vec<f64>,
        /// End of the last frame, in seconds.
        end: f64,
    },
}

/// Delays of all frames of an animation.
#[derive(Clone, Debug, PartialEq)]
pub struct Schedule {
    times: FrameTimes,
    hold: f64,
    clamp: Option<Clamp>,
}

/// The frames come faster than a GIF can show them, so it plays slower than asked.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Clamp {
    /// Duration asked for, in seconds.
    pub asked_seconds: f64,
    /// Duration of the file, in seconds.
    pub written_seconds: f64,
}

impl FrameTimes {
    /// Number of frames.
    pub fn count(&self) -> usize {
        match self {
            Self::Uniform { count, .. } => *count,
            Self::At { starts, .. } => starts.len(),
        }
    }

    /// Start of frame `k` in seconds; the end of the last frame for `k = count`.
    pub fn start(&self, k: usize) -> f64 {
        match self {
            Self::Uniform { fps, .. } => k as f64 / fps,
            Self::At { starts, end } => starts.get(k).copied().unwrap_or(*end),
        }
    }
}

impl Schedule {
    /// Checks the times; `hold` seconds are added to the last frame.
    ///
    /// Errors: a time that is not finite or not after the one before.
    pub fn new(times: FrameTimes, hold: f64) -> Result<Self, ExportError> {
        for k in 0..times.count() {
            let (start, next) = (times.start(k), times.start(k + 1));
            if !start.is_finite() || !next.is_finite() || next <= start {
                return Err(ExportError::Times { frame: k + 1 });
            }
        }
        if !hold.is_finite() || hold < 0.0 {
            return Err(ExportError::Times {
                frame: times.count(),
            });
        }
        let mut schedule = Self {
            times,
            hold,
            clamp: None,
        };
        schedule.clamp = schedule.find_clamp();
        Ok(schedule)
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        self.times.count()
    }

    /// Delay of frame `k` in hundredths: the difference of rounded absolute times, so that rounding
    /// never adds up.
    pub fn delay(&self, k: usize) -> u32 {
        let delay = self.instant(k + 1) - self.instant(k);
        delay.clamp(f64::from(SHORTEST_DELAY), f64::from(u32::MAX)) as u32
    }

    /// Set when some delay had to be lengthened.
    pub fn clamp(&self) -> Option<Clamp> {
        self.clamp
    }

    /// Rounded start of frame `k` in hundredths.
    fn instant(&self, k: usize) -> f64 {
        let hold = if k >= self.count() { self.hold } else { 0.0 };
        ((self.times.start(k) - self.times.start(0) + hold) * HUNDREDTHS).round()
    }

    fn find_clamp(&self) -> Option<Clamp> {
        let shortest = f64::from(SHORTEST_DELAY);
        let clamped = (0..self.count()).any(|k| self.instant(k + 1) - self.instant(k) < shortest);
        clamped.then(|| Clamp {
            asked_seconds: self.times.start(self.count()) - self.times.start(0) + self.hold,
            written_seconds: (0..self.count())
                .map(|k| f64::from(self.delay(k)))
                .sum::<f64>()
                / HUNDREDTHS,
        })
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;

    fn uniform(fps: f64, count: usize) -> Schedule {
        Schedule::new(FrameTimes::Uniform { fps, count }, 0.0).unwrap()
    }

    #[test]
    fn thirty_frames_a_second_do_not_drift() {
        let schedule = uniform(30.0, 1000);
        let mut shown = 0u32;
        for k in 0..1000 {
            assert!(
                (f64::from(shown) - k as f64 / 0.3).abs() <= 0.5,
                "frame {k}"
            );
            shown += schedule.delay(k);
        }
        assert_eq!(shown, 3333);
        assert_eq!(schedule.clamp(), None);
    }

    #[test]
    fn fifty_is_the_fastest_rate_without_a_clamp() {
        assert_eq!(uniform(50.0, 500).clamp(), None);
        assert_eq!(uniform(45.0, 500).clamp(), None);
        let fast = uniform(100.0, 200);
        assert!((0..200).all(|k| fast.delay(k) == 2));
        let clamp = fast.clamp().unwrap();
        assert_eq!((clamp.asked_seconds, clamp.written_seconds), (2.0, 4.0));
    }

    #[test]
    fn uneven_times_start_at_the_first_and_hold_the_last() {
        let times = FrameTimes::At {
            starts: vec![7.0, 7.104, 7.5],
            end: 8.0,
        };
        let schedule = Schedule::new(times, 1.5).unwrap();
        let delays: Vec<u32> = (0..3).map(|k| schedule.delay(k)).collect();
        assert_eq!(delays, [10, 40, 200]);
    }

    #[test]
    fn times_that_do_not_rise_are_refused() {
        for starts in [vec![0.0, 0.0], vec![0.0, f64::NAN], vec![1.0, 0.5]] {
            let times = FrameTimes::At { starts, end: 2.0 };
            assert!(matches!(
                Schedule::new(times, 0.0),
                Err(ExportError::Times { frame: 1 })
            ));
        }
        for fps in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            assert!(Schedule::new(FrameTimes::Uniform { fps, count: 3 }, 0.0).is_err());
        }
    }
}
