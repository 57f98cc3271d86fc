//! Exact frame times in whole ticks of a file format's clock: a GIF's hundredths, an APNG's fractions.

use super::error::ExportError;

/// Hundredths in a second, the unit of a GIF delay.
const HUNDREDTHS: f64 = 100.0;

/// A fraction this near (relative) to a rate is taken for the rate: over a million frames it is off by a thousandth of
/// a frame.
const SAME_RATE: f64 = 1e-9;

/// Shortest delay in hundredths. Browsers show anything shorter for a tenth of a second.
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
    ticks_per_second: f64,
    /// Ticks for which each frame is shown, 0 for omitted ones.
    delays: Vec<u32>,
    left_out: usize,
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
    /// The clock of a GIF: hundredths of a second, at least [`SHORTEST_DELAY`] of them per frame. Checks the times;
    /// `hold` seconds are added to the last frame.
    ///
    /// Errors: a time that is not finite or not after the previous one.
    pub fn new(times: FrameTimes, hold: f64) -> Result<Self, ExportError> {
        Self::on_clock(times, hold, HUNDREDTHS, u32::from(SHORTEST_DELAY))
    }

    /// A clock of `ticks_per_second`, a frame being shown for one tick at least.
    ///
    /// Errors: as [`Self::new`].
    pub fn in_ticks(times: FrameTimes, ticks_per_second: u32) -> Result<Self, ExportError> {
        Self::on_clock(times, 0.0, f64::from(ticks_per_second.max(1)), 1)
    }

    fn on_clock(
        times: FrameTimes,
        hold: f64,
        ticks_per_second: f64,
        shortest: u32,
    ) -> Result<Self, ExportError> {
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
        let ticks = |seconds: f64| (seconds * ticks_per_second).round();
        let count = times.count();
        let mut schedule = Self {
            ticks_per_second,
            delays: vec![0; count],
            left_out: 0,
        };
        let mut shown = 0;
        let mut since = 0.0;
        let whole = ticks(times.start(count) - times.start(0) + hold);
        // Differences of rounded absolute times, so that rounding never adds up.
        for k in 1..=count {
            let last = if k == count { hold } else { 0.0 };
            let start = ticks(times.start(k) - times.start(0) + last);
            // A frame without time of its own, on either side, is omitted: the previous one remains.
            let left = whole - start;
            if k < count && (start - since).min(left) < f64::from(shortest) {
                schedule.left_out += 1;
                continue;
            }
            let delay = (start - since).clamp(f64::from(shortest), f64::from(u32::MAX));
            if let Some(own) = schedule.delays.get_mut(shown) {
                *own = delay as u32;
            }
            (shown, since) = (k, start);
        }
        Ok(schedule)
    }

    /// Number of frames.
    pub fn count(&self) -> usize {
        self.delays.len()
    }

    /// Delay of frame `k` in ticks (hundredths in a GIF); 0 if it is left out, because the next comes sooner than the
    /// format can show.
    pub fn delay(&self, k: usize) -> u32 {
        self.delays.get(k).copied().unwrap_or(0)
    }

    /// The same in seconds.
    pub fn delay_seconds(&self, k: usize) -> f64 {
        f64::from(self.delay(k)) / self.ticks_per_second
    }

    /// Number of omitted frames.
    pub fn left_out(&self) -> usize {
        self.left_out
    }
}

/// The fraction nearest to a positive `rate` whose two numbers are 1 to `limit`, as (numerator, denominator), from
/// its continued fraction: `29.97` gives 2997/100, and a rate that is `30000.0 / 1001.0` gives just that.
pub fn rate_fraction(rate: f64, limit: u32) -> (u32, u32) {
    let limit = f64::from(limit);
    let (mut before, mut last) = ([0.0, 1.0], [1.0, 0.0]);
    let mut rest = rate.clamp(1.0 / limit, limit);
    loop {
        let whole = rest.floor();
        let next = [0, 1].map(|i| whole * last[i] + before[i]);
        if next.iter().any(|n| *n > limit) {
            // A part of the next step, as large as the limit allows, may still be nearer.
            let steps = [0, 1].map(|i| ((limit - before[i]) / last[i]).floor());
            let steps = steps[0].min(steps[1]);
            let part = [0, 1].map(|i| steps * last[i] + before[i]);
            let off = |f: [f64; 2]| (f[0] / f[1] - rate).abs();
            if part[1] > 0.0 && off(part) < off(last) {
                last = part;
            }
            break;
        }
        (before, last) = (last, next);
        let error = (last[0] / last[1] - rate).abs();
        if error <= SAME_RATE * rate || rest == whole {
            break;
        }
        rest = 1.0 / (rest - whole);
    }
    // The first convergent of a rate below 1 is 0 / 1.
    if last[0] < 1.0 {
        return (1, limit as u32);
    }
    (last[0] as u32, last[1] as u32)
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
        assert_eq!(schedule.left_out(), 0);
    }

    #[test]
    fn above_fifty_frames_are_left_out_and_the_time_is_kept() {
        assert_eq!(uniform(50.0, 500).left_out(), 0);
        assert_eq!(uniform(45.0, 500).left_out(), 0);
        for (fps, count) in [(60.0, 240), (100.0, 200), (1000.0, 4000)] {
            let fast = uniform(fps, count);
            let delays: Vec<u32> = (0..count).map(|k| fast.delay(k)).collect();
            let shown = delays.iter().filter(|d| **d > 0).count();
            assert_eq!(shown + fast.left_out(), count);
            assert!(delays[0] > 0 && delays.iter().all(|d| *d == 0 || *d >= 2));
            let whole = (100.0 * count as f64 / fps).round() as u32;
            assert!(delays.iter().sum::<u32>().abs_diff(whole) <= 1, "{fps}");
        }
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
    fn rates_become_the_fractions_they_are() {
        for (rate, expected) in [
            (30.0, (30, 1)),
            (29.97, (2997, 100)),
            (30000.0 / 1001.0, (30000, 1001)),
            (0.01, (1, 100)),
            (23.976, (2997, 125)),
            (1000.0, (1000, 1)),
            (100.0 / 3.0, (100, 3)),
        ] {
            assert_eq!(rate_fraction(rate, 65535), expected, "{rate}");
        }
        for rate in [std::f64::consts::PI, 0.1234567, 47.11081547] {
            let (n, d) = rate_fraction(rate, 65535);
            assert!(
                (f64::from(n) / f64::from(d) - rate).abs() < 1e-6 * rate,
                "{rate}: {n}/{d}"
            );
        }
    }

    #[test]
    fn ticks_of_a_fraction_are_the_same_for_every_frame() {
        let times = FrameTimes::Uniform {
            fps: 30000.0 / 1001.0,
            count: 100_000,
        };
        let schedule = Schedule::in_ticks(times, 30000).unwrap();
        assert!((0..100_000).all(|k| schedule.delay(k) == 1001));
        assert_eq!(schedule.left_out(), 0);
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
