//! The inputs over a stretch of time as series.

use super::super::interval::Interval;
use super::series::{Series, TERMS};
use crate::model::drive::{Drive, Ease};

/// A stretch of time, from -1 to 1 in `s`.
#[derive(Clone, Copy, Debug)]
pub struct Stretch {
    /// Time at s = 0, seconds.
    pub middle: f64,
    /// Half the length, rounded up so that both ends are inside.
    pub half: f64,
    all: Interval,
}

impl Stretch {
    /// From `start` to `end`.
    pub fn new(start: f64, end: f64) -> Self {
        let middle = 0.5 * start + 0.5 * end;
        let half = (end - middle).max(middle - start).next_up();
        Self {
            middle,
            half,
            all: Interval::new(start, end),
        }
    }

    /// Where a time lies in it.
    pub fn place(&self, time: f64) -> Interval {
        (Interval::point(time) - Interval::point(self.middle)) / Interval::point(self.half)
    }

    /// The time as a series about s = 0, or about every place at once.
    fn time(&self, everywhere: bool) -> Series {
        let mut time = Series::constant(Interval::point(self.middle));
        time.0[1] = Interval::point(self.half);
        if everywhere {
            time.0[0] = self.all;
        }
        time
    }

    /// An input over the stretch, which holds no keyframe inside.
    pub fn input(&self, drive: &Drive, everywhere: bool) -> Series {
        let time = self.time(everywhere);
        match drive {
            Drive::Formula(expression) => Series::of(expression, &[time]),
            Drive::Keys {
                times,
                values,
                ease,
            } => {
                let next = times.partition_point(|t| *t <= self.middle);
                let value = |k: usize| Series::constant(Interval::decimal(values[k]));
                if next == 0 || next == times.len() {
                    return if values.is_empty() {
                        Series::ZERO
                    } else {
                        value(next.saturating_sub(1))
                    };
                }
                let from = Interval::point(times[next - 1]);
                let length = Interval::point(times[next]) - from;
                let progress = (time - Series::constant(from)).scale(Interval::ONE / length);
                value(next - 1) + (value(next) - value(next - 1)) * eased(*ease, progress)
            }
        }
    }
}

/// The progress of a value, as [`Ease::progress`] has it for numbers.
fn eased(ease: Ease, s: Series) -> Series {
    let number = |v: f64| Series::constant(Interval::point(v));
    match ease {
        Ease::Linear => s,
        Ease::Smooth => s * s * (number(3.0) - s.scale(Interval::point(2.0))),
        Ease::Smoother => {
            let inner = s * (s.scale(Interval::point(6.0)) - number(15.0));
            s * s * s * (number(10.0) + inner)
        }
        Ease::Step => Series::ZERO,
    }
}

/// Keyframes strictly between two times, ascending: there the drive has no single series.
pub fn keys_between(drives: &[Drive], start: f64, end: f64) -> Vec<f64> {
    let mut keys: Vec<f64> = Vec::new();
    for drive in drives {
        if let Drive::Keys { times, .. } = drive {
            let from = times.partition_point(|t| *t <= start);
            keys.extend(times[from..].iter().take_while(|t| **t < end));
        }
    }
    keys.sort_unstable_by(f64::total_cmp);
    keys.dedup();
    keys
}

/// Coefficients of order three at most, all that a path has.
pub const PATH_ORDER: usize = TERMS - 2;
