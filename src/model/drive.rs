//! Motion of the driven coordinates over time: keyframes with easing, a formula, or rows of a table.

use super::expression::Expression;

/// How a keyframe's value turns into the next one's.
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
    pub fn progress(self, s: f64) -> f64 {
        match self {
            Self::Linear => s,
            Self::Smooth => s * s * (3.0 - 2.0 * s),
            Self::Smoother => s * s * s * (10.0 + s * (6.0 * s - 15.0)),
            Self::Step => 0.0,
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
        Self::Formula(Expression::constant(value))
    }

    /// The value at `time`; may be not finite where a formula has no value.
    pub fn value(&self, time: f64) -> f64 {
        match self {
            Self::Formula(expression) => expression.value(&[time]),
            Self::Keys {
                times,
                values,
                ease,
            } => {
                let next = times.partition_point(|t| *t <= time);
                if next == 0 {
                    return values.first().copied().unwrap_or(0.0);
                }
                if next == times.len() {
                    return values.last().copied().unwrap_or(0.0);
                }
                let s = (time - times[next - 1]) / (times[next] - times[next - 1]);
                values[next - 1] + (values[next] - values[next - 1]) * ease.progress(s)
            }
        }
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
}
