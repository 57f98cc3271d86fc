//! Motion of the driven coordinates over time: keyframes with easing, a formula, or rows of a table.

use super::expression::Expression;
use super::expression::continuity::Jumps;
use super::expression::pieces::around_instant;
use super::printed::printing_error;
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::{Series, TaylorSeries};

/// The interpolation from a keyframe's value to the next one's.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ease {
    /// Constant speed.
    Linear,
    /// Starts and ends at rest: 3s² - 2s³.
    Smooth,
    /// Starts and ends at rest without a jerk: 6s⁵ - 15s⁴ + 10s³.
    Smoother,
    /// Keeps the value until the next key.
    Step,
}

impl Ease {
    /// Names in scene files.
    pub const NAMES: [(&'static str, Self); 4] = [
        ("linear", Self::Linear),
        ("smooth", Self::Smooth),
        ("smoother", Self::Smoother),
        ("step", Self::Step),
    ];

    /// Progress of the value for progress `s` of time, both 0 to 1.
    pub fn progress<S: Scalar>(self, s: S) -> S {
        let number = S::number;
        match self {
            Self::Linear => s,
            Self::Smooth => s * s * (number(3.0) - s.scale(2.0)),
            Self::Smoother => s * s * s * (number(10.0) + s * (s.scale(6.0) - number(15.0))),
            Self::Step => number(0.0),
        }
    }
}

/// The value of one input over time in seconds.
#[derive(Clone, Debug, PartialEq)]
pub enum Drive {
    /// Values at ascending times; held before the first and after the last.
    Keys {
        /// Ascending times.
        times: Vec<f64>,
        /// One value per time.
        values: Vec<f64>,
        /// Between two keys.
        ease: Ease,
    },
    /// A formula whose only slot is the time.
    Formula(Expression),
}

impl Drive {
    /// Never moves.
    pub fn constant(value: f64) -> Self {
        Self::Formula(Expression::constant(Constant::rounded(value)))
    }

    /// The value at `time`; may be not finite where a formula has no value.
    pub fn value(&self, time: f64) -> f64 {
        match self {
            Self::Formula(formula) => formula.value_at_instant(time),
            Self::Keys { .. } => self.value_beside(time, time),
        }
    }

    /// Whether it is not proved to be undefined at `time`, read as a number or as a table prints it.
    pub fn may_have_value(&self, time: f64) -> bool {
        let printed = Interval::sum_of(time, printing_error(time, Constant::exact(1.0)));
        match self {
            Self::Formula(formula) => {
                let times = Interval::point(time).hull(printed);
                formula.range(&[times]).is_some()
            }
            Self::Keys { .. } => true,
        }
    }

    /// The value at a time of any number type, between the keys next to `place`: a key belongs to the piece after it.
    pub fn value_beside<S: Scalar>(&self, time: S, place: f64) -> S {
        match self {
            Self::Formula(expression) => expression.value(&[time]),
            Self::Keys {
                times,
                values,
                ease,
            } => {
                let next = times.partition_point(|t| *t <= place);
                drive_piece(times, values, *ease, next, time)
            }
        }
    }

    /// All values that it may have at an instant, beside the rounding of the formula; all numbers where that is open.
    pub fn range_at(&self, time: f64) -> Interval {
        let here = Interval::point(time);
        let range = match self {
            Self::Formula(formula) => {
                // At one instant all that jumps there has jumped; of a kink both sides count.
                let sided = formula.on_sides_of(time, here);
                let whole = || formula.range(&[here]).unwrap_or(Interval::ENTIRE);
                if sided.is_finite() { sided } else { whole() }
            }
            Self::Keys { .. } => self.value_beside(here, time),
        };
        match range.is_finite() {
            true => range.hull(Interval::point(self.value(time))),
            false => Interval::ENTIRE,
        }
    }

    /// The value from `time` on, as a series of the seconds since then, up to the power `order`.
    ///
    /// At a key it is the piece that begins there, at the last key the piece that ends there; held values have no
    /// rate.
    pub fn series(&self, time: f64, order: usize) -> TaylorSeries {
        let mut series = self.behind(time, TaylorSeries::linear(time, 1.0, order));
        series.set(0, self.value(time));
        series
    }

    /// Rate per second at `time`, by the same pieces; not finite where it has none.
    pub fn rate(&self, time: f64) -> f64 {
        self.behind(time, Series::<f64, 2>::linear(time, 1.0, 1))
            .derivative(1)
    }

    /// The value at a time of any number type, by the same piece as [`series`](Self::series) at `time`.
    fn behind<S: Scalar>(&self, time: f64, clock: S) -> S {
        match self {
            Self::Keys {
                times,
                values,
                ease,
            } if times.last() == Some(&time) => {
                drive_piece(times, values, *ease, times.len() - 1, clock)
            }
            Self::Formula(formula) if formula.has_pieces() => formula.on_sides_of(time, clock),
            _ => self.value_beside(clock, time),
        }
    }

    /// Times strictly between `from` and `to` at which it is not smooth, ascending: its keys, kinks and jumps of its
    /// formula.
    pub fn breaks(&self, from: f64, to: f64) -> Vec<f64> {
        match self {
            Self::Keys { times, .. } => {
                let inside = times.iter().copied();
                inside.filter(|t| from < *t && *t < to).collect()
            }
            Self::Formula(expression) => expression.breaks(from, to),
        }
    }

    /// Whether it may jump: formulas without functions that jump do not, as long as they have a value.
    pub fn may_jump(&self) -> bool {
        match self {
            Self::Keys { ease, .. } => *ease == Ease::Step && !self.is_constant(),
            Self::Formula(formula) => formula.has_jumps(),
        }
    }

    /// Whether it may turn back: not if it is constant or straight in time.
    pub fn may_turn_back(&self) -> bool {
        match self {
            Self::Formula(formula) => formula.affine().is_none(),
            Self::Keys { .. } => !self.is_constant(),
        }
    }

    /// Whether its values are bounded over an interval of time, without a pole in it.
    pub fn is_bounded_over(&self, times: Interval) -> bool {
        match self {
            Self::Formula(formula) => {
                let range = formula.range(&[times]);
                range.is_some_and(Scalar::is_finite) && !formula.may_have_pole(&[times])
            }
            Self::Keys { .. } => true,
        }
    }

    /// Bounds of its values over an interval of time; `None` if it may have none somewhere.
    pub fn range(&self, times: Interval) -> Option<Interval> {
        match self {
            Self::Formula(formula) => formula.range(&[times]),
            Self::Keys { times: keys, .. } => Some(self.range_of_keys(keys, times)),
        }
    }

    /// The same, sharper over short intervals.
    pub fn sharp_range(&self, times: Interval) -> Option<Interval> {
        match self {
            Self::Formula(formula) => formula.sharp_range(&[times]),
            Self::Keys { .. } => self.range(times),
        }
    }

    /// All its values and rates over an interval of time, if it is a formula.
    pub fn series_over(&self, times: Interval) -> Option<Series<Interval, 2>> {
        match self {
            Self::Formula(formula) => {
                Some(formula.value(&[Series::linear(times, Interval::ONE, 1)]))
            }
            Self::Keys { .. } => None,
        }
    }

    /// Monotone between two keys.
    fn range_of_keys(&self, keys: &[f64], times: Interval) -> Interval {
        let inside = keys.iter().copied();
        let inside = inside.filter(|t| times.lo < *t && *t < times.hi);
        let all = [times.lo, times.hi].into_iter().chain(inside);
        let all = all.map(|t| Interval::point(self.value(t)));
        all.reduce(Interval::hull).unwrap_or(Interval::ENTIRE)
    }

    /// Jumps between two instants, both included, recognised from the limits on both sides and not from their size.
    pub fn jumps_between(&self, from: f64, to: f64) -> Jumps {
        match self {
            Self::Formula(formula) => formula.jumps_between(from, to),
            Self::Keys { .. } if !self.may_jump() || from >= to => Jumps::default(),
            Self::Keys { times, .. } => {
                let [first, last] = [from, to].map(around_instant);
                let stops = times.iter().copied();
                let stops: Vec<f64> = stops.filter(|t| first.hi < *t && *t < last.lo).collect();
                // The value is constant between two keys.
                let start = stops.first().map_or(to, |t| *t);
                let end = stops.last().map_or(from, |t| *t);
                let level = |a: f64, b: f64| self.value(0.5 * a + 0.5 * b);
                let steps = |t: &f64| self.value(*t) != self.value(t.next_down());
                Jumps {
                    at_start: self.value(from) != level(from, start),
                    inside: stops.iter().copied().find(steps),
                    at_end: self.value(to) != level(end, to),
                }
            }
        }
    }

    /// Whether it jumps at an instant, its formula or to a key.
    pub fn steps_at(&self, time: f64) -> bool {
        match self {
            Self::Formula(_) => self.jumps_at(time),
            Self::Keys { .. } => {
                self.may_jump() && self.value(time) != self.value(time.next_down())
            }
        }
    }

    /// Whether its formula jumps at an instant.
    pub fn jumps_at(&self, time: f64) -> bool {
        matches!(self, Self::Formula(formula) if formula.has_pieces() && formula.jumps_at(time))
    }

    /// Times of its keys, ascending.
    pub fn keys(&self) -> &[f64] {
        match self {
            Self::Keys { times, .. } => times,
            Self::Formula(_) => &[],
        }
    }

    /// The same, mutable.
    pub fn keys_mut(&mut self) -> &mut [f64] {
        match self {
            Self::Keys { times, .. } => times,
            Self::Formula(_) => &mut [],
        }
    }

    /// Those of its keys among these times at which it may change its rate.
    pub fn keys_in(&self, these: Interval) -> impl Iterator<Item = f64> + '_ {
        let times = match self {
            Self::Keys { times, .. } if !self.is_constant() => times.as_slice(),
            _ => &[],
        };
        let is_here = move |t: &f64| these.lo <= *t && *t <= these.hi;
        times.iter().copied().filter(is_here)
    }

    /// Time of the last key; `None` for formulas.
    pub fn last_key(&self) -> Option<f64> {
        match self {
            Self::Keys { times, .. } => times.last().copied(),
            Self::Formula(_) => None,
        }
    }

    /// True when the value is the same at all times.
    pub fn is_constant(&self) -> bool {
        match self {
            Self::Keys { values, .. } => values.iter().all(|v| *v == values[0]),
            Self::Formula(expression) => expression.slots().is_empty(),
        }
    }
}

/// The value on the piece that ends at key `next`; held before the first and after the last key.
fn drive_piece<S: Scalar>(times: &[f64], values: &[f64], ease: Ease, next: usize, time: S) -> S {
    let value = |k: usize| {
        values
            .get(k)
            .map_or(S::number(0.0), |v| S::from_constant(Constant::rounded(*v)))
    };
    if next == 0 || next == times.len() {
        return value(next.saturating_sub(1));
    }
    let [from, to] = [times[next - 1], times[next]].map(S::number);
    let s = (time - from) / (to - from);
    value(next - 1) + (value(next) - value(next - 1)) * ease.progress(s)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_met_exactly_and_held_outside() {
        for (_, ease) in Ease::NAMES {
            let drive = Drive::Keys {
                times: vec![1.0, 2.0, 4.0],
                values: vec![3.0, -1.0, 5.0],
                ease,
            };
            for (time, value) in [(0.0, 3.0), (1.0, 3.0), (2.0, -1.0), (4.0, 5.0), (9.0, 5.0)] {
                assert_eq!(drive.value(time), value, "{ease:?} at {time}");
            }
        }
        let smooth = Drive::Keys {
            times: vec![0.0, 1.0],
            values: vec![0.0, 2.0],
            ease: Ease::Smooth,
        };
        assert_eq!(smooth.value(0.5), 1.0);
    }

    #[test]
    fn series_of_keyframes_are_their_polynomials() {
        for (_, ease) in Ease::NAMES {
            let keys = Drive::Keys {
                times: vec![1.0, 3.0, 4.0],
                values: vec![2.0, -1.0, 5.0],
                ease,
            };
            for (time, h) in [(0.2, 0.3), (1.0, 0.7), (2.2, -0.4), (3.0, 0.4), (4.5, 1.0)] {
                let series = keys.series(time, 5);
                let error = series.value_at(h) - keys.value(time + h);
                assert!(error.abs() < 1e-13, "{ease:?} {time} {error:e}");
            }
            let error = keys.series(4.0, 5).value_at(-0.3) - keys.value(3.7);
            let held = ease == Ease::Step;
            assert!(error.abs() < 1e-13 || held, "{ease:?} {error:e}");
        }
    }
}
