//! Round numbers along an axis, and how they are written.

use super::scale::{Scale, ScaleKind};
use crate::numbers::decimal::{fixed, with_minus};
use std::f64::consts::PI;

/// A number on an axis.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    /// Its value.
    pub value: f64,
    /// Its text; empty for a mark without one.
    pub text: String,
}

/// Ticks of an axis and the power of ten that was taken out of their texts.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Ticks {
    /// Ascending.
    pub list: Vec<Tick>,
    /// The written numbers are to be multiplied by ten to this power.
    pub factor: i32,
}

/// Steps within a decade.
const STEPS: [f64; 4] = [1.0, 2.0, 5.0, 10.0];

/// Steps of an axis in degrees: fractions of a turn.
const DEGREES: [f64; 10] = [5.0, 10.0, 15.0, 30.0, 45.0, 60.0, 90.0, 180.0, 360.0, 720.0];

/// Steps of an axis in radians, in twelfths of π, and the range from which on they are used: in a smaller range they
/// are too coarse.
const TWELFTHS: [u32; 9] = [1, 2, 3, 4, 6, 12, 24, 48, 96];
const WIDE: f64 = PI / 3.0;

/// Fraction of a step by which a range may exceed its ticks, as 6.2832 exceeds 2π.
const OVERHANG: f64 = 1e-3;

/// Fraction of a step by which a tick may lie beyond an end, so that rounding loses none.
const END: f64 = 1e-6;

/// Rounding of a decimal logarithm, and of a step from one, generously.
const LOGARITHM: f64 = 1e-9;

/// More ticks than any axis has: the range has no digits left for its steps.
const MOST_TICKS: f64 = 1e4;

/// Numbers of this size and larger, or with steps smaller than the other, get a common power of ten.
const LARGE: f64 = 1e5;
const SMALL_STEP: f64 = 1e-4;

/// Ticks of `scale`, at most about `most` of them.
pub fn scale_ticks(scale: &Scale, most: usize, unit: &str) -> Ticks {
    match scale.kind {
        ScaleKind::Linear => linear_ticks(scale.low, scale.high, most.max(2), unit),
        ScaleKind::Log => decade_ticks(scale.low, scale.high, most.max(2)),
    }
}

/// The smallest round step of which no more than `most` fit into `range`.
pub fn least_round_step(range: f64, most: usize, unit: &str) -> f64 {
    let least = range / most as f64;
    let is_angle = unit == "deg" || unit == "°";
    let parts = DEGREES
        .into_iter()
        .filter(|_| is_angle && least > 0.5 * DEGREES[0]);
    if let Some(step) = parts.into_iter().find(|s| *s >= least) {
        return step;
    }
    let decade = libm::pow(10.0, libm::floor(libm::log10(least)));
    let step = STEPS
        .into_iter()
        .find(|s| s * decade >= least * (1.0 - LOGARITHM));
    step.unwrap_or(10.0) * decade
}

/// Ticks of an axis in radians as fractions of π; `None` if the range contains too few.
fn pi_ticks(low: f64, high: f64, most: usize) -> Option<Ticks> {
    let range = high - low;
    let most = most as f64 + OVERHANG;
    let fits = |twelfths: &u32| range / (f64::from(*twelfths) * PI / 12.0) <= most;
    let twelfths = TWELFTHS.into_iter().find(fits).filter(|_| range >= WIDE)?;
    let step = f64::from(twelfths) * PI / 12.0;
    let first = libm::ceil(low / step - END) as i64;
    let last = libm::floor(high / step + END) as i64;
    let tick = |k: i64| Tick {
        value: k as f64 * step,
        text: pi_text(k * i64::from(twelfths)),
    };
    let list: Vec<Tick> = (first..=last).map(tick).collect();
    (list.len() > 1).then_some(Ticks { list, factor: 0 })
}

/// This many twelfths of π: `−3π/4`.
fn pi_text(twelfths: i64) -> String {
    let common = (1..=12)
        .rev()
        .find(|k| twelfths % k == 0 && 12 % k == 0)
        .unwrap_or(1);
    let (above, below) = ((twelfths / common).abs(), 12 / common);
    let sign = if twelfths < 0 { "\u{2212}" } else { "" };
    let number = if above == 1 {
        String::new()
    } else {
        above.to_string()
    };
    match (above, below) {
        (0, _) => "0".to_owned(),
        (_, 1) => format!("{sign}{number}π"),
        _ => format!("{sign}{number}π/{below}"),
    }
}

fn linear_ticks(low: f64, high: f64, most: usize, unit: &str) -> Ticks {
    if unit == "rad"
        && let Some(ticks) = pi_ticks(low, high, most)
    {
        return ticks;
    }
    let step = least_round_step(high - low, most, unit);
    // Counted, not summed up.
    let first = libm::ceil(low / step - END);
    let last = libm::floor(high / step + END);
    if !(first.is_finite() && last.is_finite()) || last - first > MOST_TICKS {
        return Ticks::default();
    }
    let numbers: Vec<f64> = (0..=(last - first) as usize)
        .map(|k| first + k as f64)
        .collect();
    let largest = numbers.iter().fold(0.0_f64, |m, k| m.max((k * step).abs()));
    let factor = common_factor(largest, step);
    let unit_step = step / libm::pow(10.0, f64::from(factor));
    let decimals = step_decimals(unit_step);
    let list = numbers
        .into_iter()
        .map(|k| Tick {
            value: k * step,
            text: with_minus(&fixed(k * unit_step, decimals)),
        })
        .collect();
    Ticks { list, factor }
}

/// The power of ten to factor out, a multiple of three; zero for numbers that are readable as they are.
fn common_factor(largest: f64, step: f64) -> i32 {
    if largest == 0.0 || (largest < LARGE && step >= SMALL_STEP) {
        return 0;
    }
    let power = libm::floor(libm::log10(largest) / 3.0) as i32 * 3;
    // A power of ten does not help if numbers have many common digits (1000.00001).
    if largest < LARGE && power >= 0 {
        0
    } else {
        power
    }
}

/// Decimals needed to distinguish multiples of `step`.
fn step_decimals(step: f64) -> usize {
    let digits = -libm::floor(libm::log10(step) + LOGARITHM);
    digits.clamp(0.0, 12.0) as usize
}

/// `1e−6`, the way exponents are written in charts.
pub fn power_of_ten(exponent: i32) -> String {
    match exponent {
        0 => "1".to_owned(),
        1 => "10".to_owned(),
        2 => "100".to_owned(),
        3 => "1000".to_owned(),
        k => with_minus(&format!("1e{k}")),
    }
}

fn decade_ticks(low: f64, high: f64, most: usize) -> Ticks {
    let first = libm::ceil(libm::log10(low) - LOGARITHM) as i32;
    let last = libm::floor(libm::log10(high) + LOGARITHM) as i32;
    let every = ((last - first) as usize).div_ceil(most).max(1) as i32;
    let list = (first..=last)
        .map(|k| Tick {
            value: libm::pow(10.0, f64::from(k)),
            text: if k.rem_euclid(every) == 0 {
                power_of_ten(k)
            } else {
                String::new()
            },
        })
        .collect();
    Ticks { list, factor: 0 }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn texts(kind: ScaleKind, low: f64, high: f64, most: usize, unit: &str) -> (Vec<String>, i32) {
        let scale = Scale {
            kind,
            low,
            high,
            start: 0.0,
            end: 1.0,
        };
        let ticks = scale_ticks(&scale, most, unit);
        (
            ticks.list.into_iter().map(|t| t.text).collect(),
            ticks.factor,
        )
    }

    #[test]
    fn ticks_are_round_and_few() {
        let linear = ScaleKind::Linear;
        for (low, high, most, unit, expected, factor) in [
            (0.0, 10.0, 5, "", "0 2 4 6 8 10", 0),
            (-1.0, 1.0, 4, "", "−1.0 −0.5 0.0 0.5 1.0", 0),
            (0.0, 360.0, 8, "deg", "0 45 90 135 180 225 270 315 360", 0),
            (
                0.0,
                2.0 * PI + 2e-5,
                8,
                "rad",
                "0 π/4 π/2 3π/4 π 5π/4 3π/2 7π/4 2π",
                0,
            ),
            (-3.2, 3.2, 5, "rad", "−π −π/2 0 π/2 π", 0),
            (-0.6, 0.7, 6, "rad", "−π/6 −π/12 0 π/12 π/6", 0),
            (-0.2, 0.2, 4, "rad", "−0.2 −0.1 0.0 0.1 0.2", 0),
            (-0.3, 0.31, 4, "mm", "−0.2 0.0 0.2", 0),
            (0.0, 3e-6, 3, "", "0 1 2 3", -6),
            (0.0, 2.5e7, 3, "", "0 10 20", 6),
            (
                1000.0,
                1000.4,
                4,
                "",
                "1000.0 1000.1 1000.2 1000.3 1000.4",
                0,
            ),
            (40.0, 120.0, 5, "", "40 60 80 100 120", 0),
        ] {
            let (found, power) = texts(linear, low, high, most, unit);
            assert_eq!(found.join(" "), expected, "{low} {high}");
            assert_eq!(power, factor, "{low} {high}");
        }
    }

    #[test]
    fn ticks_lie_on_the_axis_for_any_range() {
        for k in 0..2000 {
            let (x, y) = (f64::from(k) * 0.7310585, f64::from(k % 37) - 18.0);
            let low = (x.sin() * 10f64.powi(k % 13 - 6)) * 3.0;
            let high = low + 10f64.powf(y / 3.0);
            let scale = Scale {
                kind: ScaleKind::Linear,
                low,
                high,
                start: 0.0,
                end: 1.0,
            };
            let list = scale_ticks(&scale, 6, "").list;
            let tolerance = 1e-5 * (high - low);
            assert!((2..=8).contains(&list.len()), "{low} {high} {}", list.len());
            assert!(
                list.iter()
                    .all(|t| t.value > low - tolerance && t.value < high + tolerance)
            );
        }
    }

    #[test]
    fn decades_are_thinned() {
        let (all, _) = texts(ScaleKind::Log, 1e-3, 1.0, 10, "");
        assert_eq!(all.join(" "), "1e−3 1e−2 1e−1 1");
        let (few, _) = texts(ScaleKind::Log, 1e-16, 1.0, 5, "");
        assert_eq!(few.len(), 17);
        assert_eq!(few.iter().filter(|t| !t.is_empty()).count(), 5);
    }
}
