//! Values along a track to one number, with the weights of its derivative.

use crate::model::study::Reducer;

/// The number, and for every formula and pose d(number)/d(value).
pub struct Reduced {
    pub value: f64,
    pub weights: Vec<Vec<f64>>,
}

/// Reduces `values[formula][pose]`.
pub fn reduce(reducer: Reducer, values: &[Vec<f64>]) -> Reduced {
    let first = &values[0];
    let count = first.len();
    let picked = |index: usize| {
        let mut weights = vec![0.0; count];
        weights[index] = 1.0;
        Reduced {
            value: first[index],
            weights: vec![weights],
        }
    };
    match reducer {
        Reducer::First => picked(0),
        Reducer::Last => picked(count - 1),
        Reducer::Largest => picked(extreme(first, |a, b| a > b)),
        Reducer::Smallest => picked(extreme(first, |a, b| a < b)),
        Reducer::Sum => weighted(first, 1.0),
        Reducer::Mean => weighted(first, 1.0 / count as f64),
        Reducer::Norm(power) => norm(first, power),
        Reducer::Bow => bow(first, values.get(1).unwrap_or(first)),
    }
}

/// Index of the extreme value; a number that is none wins.
fn extreme(values: &[f64], beats: impl Fn(f64, f64) -> bool) -> usize {
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

fn weighted(values: &[f64], weight: f64) -> Reduced {
    Reduced {
        value: values.iter().sum::<f64>() * weight,
        weights: vec![vec![weight; values.len()]],
    }
}

/// (Σ |v|ᵖ)^(1/p), scaled by the largest value so that high powers neither overflow nor vanish.
fn norm(values: &[f64], power: f64) -> Reduced {
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
    let share = |v: &f64| (v.abs() / largest).powf(power - 1.0);
    let sum: f64 = values.iter().map(|v| share(v) * v.abs() / largest).sum();
    let root = sum.powf(1.0 / power);
    let weight = |v: &f64| share(v) * v.signum() * root / sum;
    Reduced {
        value: largest * root,
        weights: vec![values.iter().map(weight).collect()],
    }
}

/// The distance from the chord that is largest, signed: [(y-y₀)(x₁-x₀) - (x-x₀)(y₁-y₀)] / |chord|.
fn bow(x: &[f64], y: &[f64]) -> Reduced {
    let count = x.len();
    let last = count - 1;
    let (a, b) = (x[last] - x[0], y[last] - y[0]);
    let chord = a.hypot(b);
    let distance = |k: usize| ((y[k] - y[0]) * a - (x[k] - x[0]) * b) / chord;
    let distances: Vec<f64> = (0..count).map(distance).collect();
    let k = extreme(&distances, |p, q| p.abs() > q.abs());
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
    use super::*;

    #[test]
    fn weights_are_the_derivatives() {
        let x = vec![0.3, -1.1, 2.5, 3.7, 5.0];
        let y = vec![0.1, 0.9, -1.4, 0.8, 0.6];
        let reducers = [
            Reducer::First,
            Reducer::Last,
            Reducer::Sum,
            Reducer::Mean,
            Reducer::Largest,
            Reducer::Smallest,
            Reducer::Norm(4.0),
            Reducer::Norm(64.0),
            Reducer::Bow,
        ];
        for reducer in reducers {
            let columns = if reducer == Reducer::Bow { 2 } else { 1 };
            let values = &[x.clone(), y.clone()][..columns];
            let reduced = reduce(reducer, values);
            for formula in 0..columns {
                for pose in 0..x.len() {
                    let moved = |h: f64| {
                        let mut values = values.to_vec();
                        values[formula][pose] += h;
                        reduce(reducer, &values).value
                    };
                    let slope = (moved(1e-6) - moved(-1e-6)) / 2e-6;
                    let weight = reduced.weights[formula][pose];
                    assert!(
                        (slope - weight).abs() < 1e-7,
                        "{reducer:?} {formula} {pose}: {slope} {weight}"
                    );
                }
            }
        }
    }

    #[test]
    fn known_values() {
        let y = [vec![3.0, -4.0, 0.0]];
        assert_eq!(reduce(Reducer::Norm(2.0), &y).value, 5.0);
        assert_eq!(reduce(Reducer::Smallest, &y).value, -4.0);
        let arc = [vec![0.0, 1.0, 2.0], vec![0.0, -1.0, 0.0]];
        assert_eq!(reduce(Reducer::Bow, &arc).value, -1.0);
        assert!(
            reduce(Reducer::Largest, &[vec![1.0, f64::NAN, 2.0]])
                .value
                .is_nan()
        );
        assert!(
            reduce(Reducer::Norm(4.0), &[vec![1.0, f64::NAN]])
                .value
                .is_nan()
        );
    }
}
