//! Reduces the values over a sequence of poses to one number, with the weights of its derivative.

use crate::model::measure::Taking;

/// The number, and for every formula and pose d(number)/d(value).
pub struct Reduced {
    /// The number; NaN if any value it depends on is NaN.
    pub value: f64,
    /// As many rows as formulas, one entry per pose.
    pub weights: Vec<Vec<f64>>,
}

/// Reduces `values[formula][pose]` to one number; `None` without poses. `power` is that of a norm. `times` are those of the poses;
/// unless they ascend the poses count as evenly spaced.
pub fn reduce_values(
    taking: Taking,
    power: f64,
    values: &[Vec<f64>],
    times: &[f64],
) -> Option<Reduced> {
    let first = values.first()?;
    let last = first.len().checked_sub(1)?;
    let second = values.get(1).unwrap_or(first);
    // Linear reductions have their weights as gradient.
    let sum_of = |parts: &[(usize, f64)]| {
        let mut weights = vec![0.0; first.len()];
        parts.iter().for_each(|(k, w)| weights[*k] += w);
        Reduced {
            value: parts.iter().map(|(k, w)| w * first[*k]).sum(),
            weights: vec![weights],
        }
    };
    let (least, most) = (
        extreme_index(first, |a, b| a < b),
        extreme_index(first, |a, b| a > b),
    );
    Some(match taking {
        Taking::First => sum_of(&[(0, 1.0)]),
        Taking::Last => sum_of(&[(last, 1.0)]),
        Taking::Change => sum_of(&[(last, 1.0), (0, -1.0)]),
        Taking::Min => sum_of(&[(least, 1.0)]),
        Taking::Max => sum_of(&[(most, 1.0)]),
        Taking::Range => sum_of(&[(most, 1.0), (least, -1.0)]),
        Taking::Largest => {
            let k = extreme_index(first, |a, b| a.abs() > b.abs());
            sum_of(&[(k, if first[k] < 0.0 { -1.0 } else { 1.0 })])
        }
        Taking::Sum => weighted_mean(first, 1.0),
        Taking::Mean => weighted_mean(first, 1.0 / first.len() as f64),
        Taking::Norm => power_norm(first, power),
        Taking::Positive => positive_part(first, times),
        Taking::Chord => chord_length(first, second),
        Taking::Bow => bow_height(first, second),
    })
}

/// Index of the extreme value; NaN counts as the most extreme.
fn extreme_index(values: &[f64], beats: impl Fn(f64, f64) -> bool) -> usize {
    let mut best = 0;
    for (index, value) in values.iter().enumerate() {
        if value.is_nan() || beats(*value, values[best]) {
            best = index;
        }
        if values[best].is_nan() {
            break;
        }
    }
    best
}

fn weighted_mean(values: &[f64], weight: f64) -> Reduced {
    Reduced {
        value: values.iter().sum::<f64>() * weight,
        weights: vec![vec![weight; values.len()]],
    }
}

/// (Σ |v|ᵖ)^(1/p), scaled by the largest value so that high powers neither overflow nor vanish.
fn power_norm(values: &[f64], power: f64) -> Reduced {
    let largest = values.iter().fold(
        0.0,
        |m: f64, v| if v.is_nan() { *v } else { m.max(v.abs()) },
    );
    if largest == 0.0 || largest.is_nan() {
        return Reduced {
            value: largest,
            weights: vec![vec![0.0; values.len()]],
        };
    }
    // d/dv (Σ|v|ᵖ)^(1/p) = |v|^(p-1) sign v · (Σ|v|ᵖ)^(1/p - 1), with values relative to the largest.
    let share = |v: &f64| libm::pow(v.abs() / largest, power - 1.0);
    let sum: f64 = values.iter().map(|v| share(v) * v.abs() / largest).sum();
    let root = libm::pow(sum, 1.0 / power);
    let weight = |v: &f64| share(v) * v.signum() * root / sum;
    Reduced {
        value: largest * root,
        weights: vec![values.iter().map(weight).collect()],
    }
}

/// What bends a norm N of these values: d²N/dvᵢdvⱼ is the i-th entry where i = j, less (p - 1)/N times the product of the
/// weights i and j. Without a bend below the power 2, where it is infinite at zero.
pub fn norm_bends(values: &[f64], power: f64, norm: f64) -> Option<Vec<f64>> {
    let is_bent = power >= 2.0 && norm > 0.0;
    let bend = |v: &f64| (power - 1.0) / norm * libm::pow(v.abs() / norm, power - 2.0);
    is_bent.then(|| values.iter().map(bend).collect())
}

/// The fraction of the way on which the values are positive. Between two values of opposite sign the zero is that of
/// the cubic through four values: the error is of fourth order in the step for smooth values.
fn positive_part(values: &[f64], times: &[f64]) -> Reduced {
    let mut weights = vec![0.0; values.len()];
    let even: Vec<f64>;
    let ascends = times.windows(2).all(|pair| pair[0] < pair[1]);
    let times = match ascends && times.len() == values.len() {
        true => times,
        false => {
            even = (0..values.len()).map(|k| k as f64).collect();
            &even
        }
    };
    let whole = match (times.first(), times.last()) {
        (Some(first), Some(last)) if last > first => last - first,
        _ => 1.0,
    };
    let mut value = 0.0;
    for (k, pair) in values.windows(2).enumerate() {
        let (a, b) = (pair[0], pair[1]);
        let share = (times[k + 1] - times[k]) / whole;
        if (a > 0.0) == (b > 0.0) {
            value += if a > 0.0 { share } else { a * 0.0 + b * 0.0 };
            continue;
        }
        // The part above zero is before the crossing where the values fall, behind it where they rise.
        let crossing = Crossing::new(values, times, k);
        let (above, sign) = match a > 0.0 {
            true => (crossing.at, share),
            false => (1.0 - crossing.at, -share),
        };
        value += share * above;
        for (weight, slope) in weights[crossing.first..].iter_mut().zip(&crossing.slopes) {
            *weight += sign * slope;
        }
    }
    Reduced {
        value,
        weights: vec![weights],
    }
}

/// Halvings that locate a crossing to the last digit.
const HALVINGS: u32 = 60;

/// A zero crossing of values given at some times.
struct Crossing {
    /// Position after the previous value, as a fraction of the way to the next one.
    at: f64,
    /// The first of the values that it depends on, ...
    first: usize,
    /// ... and its derivatives by them.
    slopes: Vec<f64>,
}

impl Crossing {
    /// Between values `k` and `k` + 1, which have opposite signs: a zero of the polynomial through the four values
    /// around, or through all if there are fewer.
    fn new(values: &[f64], times: &[f64], k: usize) -> Self {
        let count = values.len().min(4);
        let first = k.saturating_sub(1).min(values.len() - count);
        let near = &values[first..first + count];
        let step = times[k + 1] - times[k];
        let node = |i: usize| (times[first + i] - times[k]) / step;
        let basis = |i: usize, s: f64| -> f64 {
            let others = (0..count).filter(|j| *j != i);
            others
                .map(|j| (s - node(j)) / (node(i) - node(j)))
                .product()
        };
        let value = |s: f64| -> f64 { (0..count).map(|i| near[i] * basis(i, s)).sum() };
        // A value that is zero is the crossing.
        let (mut from, mut to) = (0.0, 1.0);
        if values[k] == 0.0 {
            to = 0.0;
        } else if values[k + 1] == 0.0 {
            from = 1.0;
        }
        for _ in 0..HALVINGS {
            let middle = 0.5 * (from + to);
            match (value(middle) > 0.0) == (values[k] > 0.0) {
                true => from = middle,
                false => to = middle,
            }
        }
        let at = 0.5 * (from + to);
        // Lagrange's polynomials, derived term by term.
        let rate = |i: usize| -> f64 {
            let without = |m: usize| -> f64 {
                let others = (0..count).filter(|j| *j != i && *j != m);
                others
                    .map(|j| (at - node(j)) / (node(i) - node(j)))
                    .product()
            };
            let terms = (0..count).filter(|m| *m != i);
            terms.map(|m| without(m) / (node(i) - node(m))).sum()
        };
        let slope: f64 = (0..count).map(|i| near[i] * rate(i)).sum();
        Self {
            at,
            first,
            slopes: (0..count).map(|i| -basis(i, at) / slope).collect(),
        }
    }
}

/// Distance from the first to the last point of a path.
fn chord_length(x: &[f64], y: &[f64]) -> Reduced {
    let last = x.len() - 1;
    let (a, b) = (x[last] - x[0], y[last] - y[0]);
    let length = libm::hypot(a, b);
    let ends = |share: f64| {
        let mut weights = vec![0.0; x.len()];
        weights[last] += share;
        weights[0] -= share;
        weights
    };
    // A path that closes has a chord of zero, with zero among its subgradients.
    let share = |way: f64| if length == 0.0 { 0.0 } else { way / length };
    Reduced {
        value: length,
        weights: vec![ends(share(a)), ends(share(b))],
    }
}

/// Ends of a path that are nearer to each other than this fraction of its extent are one point: poses are closed to rounding.
const CLOSED: f64 = 1e-12;

/// The distance from the chord that is largest, signed: [(y-y₀)(x₁-x₀) - (x-x₀)(y₁-y₀)] / |chord|.
fn bow_height(x: &[f64], y: &[f64]) -> Reduced {
    let count = x.len();
    let last = count - 1;
    let (a, b) = (x[last] - x[0], y[last] - y[0]);
    let first = [x[0], y[0]];
    let extent = x
        .iter()
        .zip(y)
        .map(|(x, y)| (x - first[0]).abs().max((y - first[1]).abs()));
    // A path that closes has no chord, only the rounding of its ends.
    let chord = match libm::hypot(a, b) {
        chord if chord <= CLOSED * extent.fold(0.0, f64::max) => f64::NAN,
        chord => chord,
    };
    let distance = |k: usize| ((y[k] - y[0]) * a - (x[k] - x[0]) * b) / chord;
    let distances: Vec<f64> = (0..count).map(distance).collect();
    let k = extreme_index(&distances, |p, q| p.abs() > q.abs());
    let value = distances[k];
    let (mut by_x, mut by_y) = (vec![0.0; count], vec![0.0; count]);
    let (u, v) = (x[k] - x[0], y[k] - y[0]);
    // d(value) = [a dv + v da - b du - u db]/chord - value (a da + b db)/chord².
    let (da, db) = (
        v / chord - value * a / (chord * chord),
        -u / chord - value * b / (chord * chord),
    );
    by_x[last] += da;
    by_x[0] -= da;
    by_y[last] += db;
    by_y[0] -= db;
    by_x[k] -= b / chord;
    by_x[0] += b / chord;
    by_y[k] += a / chord;
    by_y[0] -= a / chord;
    Reduced {
        value,
        weights: vec![by_x, by_y],
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    fn value(taking: Taking, power: f64, values: &[Vec<f64>]) -> f64 {
        reduce_values(taking, power, values, &[]).unwrap().value
    }

    #[test]
    fn weights_are_the_derivatives() {
        let x = vec![0.3, -1.1, 2.5, 3.7, 5.0];
        let y = vec![0.1, 0.9, -1.4, 0.8, 0.6];
        for (name, taking) in Taking::NAMES {
            for power in [4.0, 64.0] {
                let values = &[x.clone(), y.clone()][..taking.width()];
                let reduced = reduce_values(taking, power, values, &[]).unwrap();
                for formula in 0..taking.width() {
                    for pose in 0..x.len() {
                        let moved = |h: f64| {
                            let mut values = values.to_vec();
                            values[formula][pose] += h;
                            value(taking, power, &values)
                        };
                        let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                        let weight = reduced.weights[formula][pose];
                        assert!(
                            (slope - weight).abs() < 1e-7,
                            "{name} {formula} {pose}: {slope} {weight}"
                        );
                    }
                }
            }
        }
    }

    /// The bends of a norm are the differences of its weights.
    #[test]
    fn bends_of_norms_are_the_rates_of_their_weights() {
        let weights = |power: f64, values: &[f64]| {
            let reduced = reduce_values(Taking::Norm, power, &[values.to_vec()], &[]).unwrap();
            (reduced.value, reduced.weights[0].clone())
        };
        for power in [2.0, 3.5, 4.0, 8.0] {
            let values = [0.7, -1.3, 0.0, 0.4];
            let (norm, slopes) = weights(power, &values);
            let own = norm_bends(&values, power, norm).unwrap();
            for k in 0..values.len() {
                let at = |h: f64| {
                    let mut moved = values;
                    moved[k] += h;
                    weights(power, &moved).1
                };
                let (ahead, behind) = (at(1e-5), at(-1e-5));
                for i in 0..values.len() {
                    let found = (ahead[i] - behind[i]) / 2e-5;
                    let common = (power - 1.0) / norm * slopes[i] * slopes[k];
                    let expected = if i == k { own[k] } else { 0.0 } - common;
                    assert!(
                        (found - expected).abs() < 1e-5,
                        "{power} {i} {k}: {found} {expected}"
                    );
                }
            }
        }
        assert!(norm_bends(&[1.0], 1.5, 1.0).is_none());
        assert!(norm_bends(&[0.0], 4.0, 0.0).is_none());
    }

    #[test]
    fn numbers_are_taken_as_named() {
        let path = [vec![0.0, 1.0, 4.0, 3.0], vec![0.0, 2.0, -1.0, 4.0]];
        let expected = [
            0.0,
            3.0,
            3.0,
            0.0,
            4.0,
            4.0,
            4.0,
            8.0,
            2.0,
            26.0_f64.sqrt(),
            1.0,
            5.0,
            -19.0 / 5.0,
        ];
        for ((name, taking), expected) in Taking::NAMES.into_iter().zip(expected) {
            let found = value(taking, 2.0, &path[..taking.width()]);
            assert!((found - expected).abs() < 1e-15 * 8.0, "{name}: {found}");
        }
        assert!(reduce_values(Taking::Mean, 2.0, &[Vec::new()], &[]).is_none());
        let share = value(Taking::Positive, 2.0, &[vec![1.0, -3.0]]);
        assert!((share - 0.25).abs() < 1e-15, "{share}");
        assert!(value(Taking::Positive, 2.0, &[vec![-1.0, f64::NAN]]).is_nan());
        assert!(value(Taking::Max, 2.0, &[vec![1.0, f64::NAN, 2.0]]).is_nan());
        assert!(value(Taking::Norm, 4.0, &[vec![1.0, f64::NAN]]).is_nan());
    }

    /// Cubics exactly, smooth functions to the fourth power of the step.
    #[test]
    fn positive_shares_are_those_of_the_function() {
        let share = |count: usize, f: &dyn Fn(f64) -> f64| {
            let at = |k: usize| f(k as f64 / (count - 1) as f64);
            value(Taking::Positive, 2.0, &[(0..count).map(at).collect()])
        };
        for root in [0.03, 0.31, 0.5, 0.99] {
            let cubic = |x: f64| (x - root) * (x * x + 0.3 * x + 1.0);
            let found = share(8, &cubic);
            assert!((found - (1.0 - root)).abs() < 1e-14, "{root}: {found}");
            // So are they where samples stand close together.
            let times: Vec<f64> = (0..8).map(|k| 2.0 + f64::from(k * k) / 49.0).collect();
            let values = times.iter().map(|t| cubic(t - 2.0)).collect();
            let found = reduce_values(Taking::Positive, 2.0, &[values], &times).unwrap();
            assert!(
                (found.value - (1.0 - root)).abs() < 1e-13,
                "{root}: {}",
                found.value
            );
        }
        let wave = |x: f64| (2.0 * std::f64::consts::PI * x).sin() - 0.4;
        let exact = 0.5 - 0.4_f64.asin() / std::f64::consts::PI;
        let errors = [41, 81].map(|count| (share(count, &wave) - exact).abs());
        assert!(
            errors[0] < 1e-5 && errors[1] < 0.1 * errors[0],
            "{errors:?}"
        );
    }
}
