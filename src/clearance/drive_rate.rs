//! Between which rates an input moves over a stretch of time. Holds no motion.

use crate::kinematics::certificate::flow::Drift;
use crate::model::drive::{Drive, Ease};
use crate::model::expression::{Expression, Function, Op};

/// Widens ranges by more than their rounding.
const WIDER: f64 = 1e-12;

/// A range of values.
#[derive(Clone, Copy, Debug)]
struct Range {
    low: f64,
    high: f64,
}

impl Range {
    const fn point(v: f64) -> Self {
        Self { low: v, high: v }
    }

    fn of(values: [f64; 4]) -> Self {
        Self {
            low: values.iter().copied().fold(f64::INFINITY, f64::min),
            high: values.iter().copied().fold(f64::NEG_INFINITY, f64::max),
        }
    }

    fn plus(self, b: Self) -> Self {
        Self {
            low: self.low + b.low,
            high: self.high + b.high,
        }
    }

    fn times(self, b: Self) -> Self {
        Self::of([
            self.low * b.low,
            self.low * b.high,
            self.high * b.low,
            self.high * b.high,
        ])
    }

    fn negated(self) -> Self {
        Self {
            low: -self.high,
            high: -self.low,
        }
    }

    /// Sine over the range, shifted by a quarter turn for the cosine: the slope is at most one.
    fn wave(self, f: fn(f64) -> f64) -> Self {
        let (middle, half) = (0.5 * (self.low + self.high), 0.5 * (self.high - self.low));
        let value = f(middle);
        Self {
            low: (value - half).max(-1.0),
            high: (value + half).min(1.0),
        }
    }
}

/// The times at which a drive may bend: it is smooth in between.
pub fn breaks(drive: &Drive) -> &[f64] {
    match drive {
        Drive::Keys { times, .. } => times,
        Drive::Formula(_) => &[],
    }
}

/// Rate and deviation of a drive from `start` to `end`, which hold no break inside; `None` where no bound is known.
pub fn drift(drive: &Drive, start: f64, end: f64) -> Option<Drift> {
    let range = match drive {
        Drive::Formula(expression) => of_formula(expression, start, end)?,
        Drive::Keys {
            times,
            values,
            ease,
        } => {
            let next = times.partition_point(|t| *t <= 0.5 * (start + end));
            if next == 0 || next == times.len() {
                Range::point(0.0)
            } else {
                let (t0, t1) = (times[next - 1], times[next]);
                let place = |t: f64| ((t - t0) / (t1 - t0)).clamp(0.0, 1.0);
                let slope = Range::point((values[next] - values[next - 1]) / (t1 - t0));
                slope.times(of_ease(*ease, place(start), place(end)))
            }
        }
    };
    let (rate, half) = (
        0.5 * (range.low + range.high),
        0.5 * (range.high - range.low),
    );
    let deviation = half + WIDER * (rate.abs() + half);
    let drift = Drift {
        rate,
        deviation,
        play: (rate.abs() + deviation) * 0.5 * (end - start) * (1.0 + WIDER),
        tube: f64::INFINITY,
    };
    (drift.rate.is_finite() && drift.play.is_finite()).then_some(drift)
}

/// Slope of an easing from place `a` to `b`: each is largest in the middle and falls to both sides.
fn of_ease(ease: Ease, a: f64, b: f64) -> Range {
    let slope = |s: f64| match ease {
        Ease::Linear => 1.0,
        Ease::Smooth => 6.0 * s * (1.0 - s),
        Ease::Smoother => 30.0 * s * s * (1.0 - s) * (1.0 - s),
        Ease::Step => 0.0,
    };
    let top = if a <= 0.5 && b >= 0.5 { 0.5 } else { a };
    Range::of([slope(a), slope(b), slope(top), slope(b)])
}

/// Derivative of a formula of time, by values and slopes over the whole stretch.
fn of_formula(expression: &Expression, start: f64, end: f64) -> Option<Range> {
    if let Some(affine) = expression.affine() {
        return Some(Range::point(affine.terms.iter().map(|(_, c)| c).sum()));
    }
    let time = Range {
        low: start,
        high: end,
    };
    let zero = Range::point(0.0);
    let mut known: Vec<(Range, Range)> = Vec::with_capacity(expression.ops().len());
    for op in expression.ops() {
        let next = match *op {
            Op::Constant(c) => (Range::point(c), zero),
            Op::Slot(_) => (time, Range::point(1.0)),
            Op::Negate(a) => (known[a].0.negated(), known[a].1.negated()),
            Op::Add(a, b) => (known[a].0.plus(known[b].0), known[a].1.plus(known[b].1)),
            Op::Subtract(a, b) => (
                known[a].0.plus(known[b].0.negated()),
                known[a].1.plus(known[b].1.negated()),
            ),
            Op::Multiply(a, b) => {
                let ((f, df), (g, dg)) = (known[a], known[b]);
                (f.times(g), df.times(g).plus(f.times(dg)))
            }
            Op::Divide(a, b) if known[b].1.low == 0.0 && known[b].1.high == 0.0 => {
                let divisor = known[b].0;
                if divisor.low <= 0.0 && divisor.high >= 0.0 {
                    return None;
                }
                let inverse = Range {
                    low: 1.0 / divisor.high,
                    high: 1.0 / divisor.low,
                };
                (known[a].0.times(inverse), known[a].1.times(inverse))
            }
            Op::Call(Function::Sin, a, _) => {
                let (f, df) = known[a];
                (f.wave(libm::sin), f.wave(libm::cos).times(df))
            }
            Op::Call(Function::Cos, a, _) => {
                let (f, df) = known[a];
                (f.wave(libm::cos), f.wave(libm::sin).negated().times(df))
            }
            _ => return None,
        };
        known.push(next);
    }
    known.last().map(|(_, slope)| *slope)
}
