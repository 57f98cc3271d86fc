//! The inputs over a stretch of time as series.

use super::series::Series;
use crate::model::drive::{Drive, Ease};
use crate::numbers::interval::Interval;

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

#[cfg(test)]
mod tests {
    #![allow(clippy::panic)]
    use super::*;
    use crate::kinematics::certificate::tube::series::TERMS;
    use crate::model::expression::{Expression, Function, Op};
    use crate::numbers::series as taylor;

    /// t, then t + 1.3, and a function of both; `Floor` and `Mod` are smooth where the test looks.
    fn formula(function: Function) -> Expression {
        let arguments = match function {
            Function::Asin | Function::Acos => vec![Op::Constant(0.3), Op::Multiply(0, 1)],
            Function::Floor => vec![Op::Constant(0.01), Op::Multiply(0, 1)],
            _ => vec![Op::Constant(1.3), Op::Add(0, 1)],
        };
        let (a, b) = if function.accepts(2) { (0, 2) } else { (2, 2) };
        let mut ops = vec![Op::Slot(0)];
        ops.extend(arguments);
        ops.push(Op::Call(function, a, b));
        Expression::new(ops)
    }

    fn drives() -> Vec<Drive> {
        let mut drives: Vec<Drive> = Function::ALL.map(|f| Drive::Formula(formula(f))).into();
        for ops in [
            vec![Op::Slot(0), Op::Constant(-3.0), Op::Power(0, 1)],
            vec![Op::Slot(0), Op::Constant(4.0), Op::Power(0, 1)],
            vec![Op::Slot(0), Op::Constant(0.7), Op::Power(0, 1)],
            vec![Op::Constant(0.7), Op::Slot(0), Op::Power(0, 1)],
            vec![
                Op::Slot(0),
                Op::Multiply(0, 0),
                Op::Divide(0, 1),
                Op::Negate(2),
            ],
        ] {
            drives.push(Drive::Formula(Expression::new(ops)));
        }
        for (_, ease) in Ease::NAMES {
            let (times, values) = (vec![0.1, 1.9], vec![-0.7, 1.1]);
            drives.push(Drive::Keys {
                times,
                values,
                ease,
            });
        }
        drives
    }

    /// Coefficients about any place of the stretch, computed in f64, lie within the enclosures; so does the value.
    #[test]
    fn enclosures_hold_what_f64_finds_at_every_place() {
        for drive in drives() {
            let stretch = Stretch::new(0.62, 0.64);
            let (middle, everywhere) = (stretch.input(&drive, false), stretch.input(&drive, true));
            for share in [-1.0, -0.4, 0.0, 0.3, 1.0] {
                let time = (stretch.middle + share * stretch.half).clamp(0.62, 0.64);
                let numbers = taylor::drive(&drive, time, TERMS - 1);
                let mut scale = 1.0;
                for (k, c) in numbers.coefficients().iter().enumerate() {
                    let (c, all) = (c * scale, everywhere.0[k]);
                    let slack = 1e-13 * (1e-3 + c.abs());
                    let holds = all.lo <= c + slack && c <= all.hi + slack;
                    assert!(holds, "{drive:?}: {k} {c} {all:?}");
                    if share == 0.0 {
                        let off = middle.0[k].distance(c);
                        assert!(off <= 10.0 * slack, "{drive:?}: {k} {off:e}");
                    }
                    scale *= stretch.half;
                }
                let whole = middle.with_remainder_of(&everywhere);
                let value = whole.value_at(stretch.place(time));
                let exact = drive.value(time);
                assert!(
                    value.lo <= exact && exact <= value.hi && value.distance(exact) < 1e-3,
                    "{drive:?}: {exact} {value:?}"
                );
            }
        }
    }

    #[test]
    fn keys_part_the_time() {
        let key = |times: &[f64]| Drive::Keys {
            times: times.to_vec(),
            values: vec![0.0; times.len()],
            ease: Ease::Linear,
        };
        let drives = [key(&[0.0, 1.0, 2.0, 3.0]), key(&[1.5, 2.0])];
        assert_eq!(keys_between(&drives, 0.0, 2.0), [1.0, 1.5]);
        assert_eq!(keys_between(&drives, 0.2, 2.5), [1.0, 1.5, 2.0]);
    }
}
