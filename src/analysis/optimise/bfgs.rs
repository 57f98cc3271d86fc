//! The quasi-Newton method of Broyden, Fletcher, Goldfarb and Shanno with exact gradients (Nocedal and Wright,
//! Numerical Optimization, 2nd ed., chapter 6), within bounds: variables are held at a bound if the gradient points
//! outwards.

use super::beside::{self, lowest_beside};
use super::{Minimum, Objective, StopReason, VariableBounds};

/// A step must achieve this fraction of the decrease predicted by the gradient (Armijo).
const SUFFICIENT_GAIN: f64 = 1e-4;

/// A step is long enough if the slope along it has fallen to this fraction (Wolfe).
const SLOPE_SHARE: f64 = 0.9;

/// A direction whose predicted decrease is below this fraction of the value gains nothing above rounding.
const LEAST_PROMISE: f64 = 4.0 * f64::EPSILON;

/// Maximum number of trials along one direction.
const MOST_TRIALS: usize = 40;

/// When the search is over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BfgsLimits {
    /// Largest entry of the gradient times the scale of its variable, relative to the first value.
    pub gradient_tolerance: f64,
    /// Most iterations.
    pub iterations: usize,
    /// Longest first step, in scales of the variables.
    pub first_step: f64,
}

/// Searches from `start`; `scales` are typical sizes of the variables.
pub fn minimise_bfgs(
    objective: &mut dyn Objective,
    start: &[f64],
    scales: &[f64],
    bounds: &VariableBounds,
    limits: BfgsLimits,
) -> Minimum {
    let mut x = start.to_vec();
    bounds.clamp(&mut x);
    let mut search = BfgsSearch {
        objective,
        bounds,
        scales,
        evaluations: 0,
    };
    let Some(mut here) = search.at(&x) else {
        // Without derivatives there is no way on, but there may be a value.
        let value = search.objective.value(&x);
        return search.result(x, value, 0, StopReason::Stalled);
    };
    let first_value = here.value.abs().max(f64::MIN_POSITIVE);
    let mut inverse = Inverse::identity(x.len());
    let mut iterations = 0;
    let mut is_fresh = true;
    let mut restarts = 0;
    let ended = loop {
        // Projected gradient: variables at a bound that they push against are held.
        let free = search.free(&here);
        let steepest = (0..x.len()).filter(|k| free[*k]);
        let largest = steepest.fold(0.0_f64, |m, k| m.max(here.gradient[k].abs()));
        // Quasi-Newton direction among the free variables.
        let mut direction = inverse.times(&here.gradient, &free);
        let slope: f64 = direction
            .iter()
            .zip(&here.gradient)
            .map(|(d, g)| d * g)
            .sum();
        let gains_nothing = !is_fresh && slope < 0.0 && -slope <= LEAST_PROMISE * here.value.abs();
        let flat = limits.gradient_tolerance * first_value;
        if largest <= flat || gains_nothing {
            // A minimum, unless it is lower beside it.
            match search.lower_beside(&here, flat.max(largest)) {
                None => break StopReason::Converged,
                Some(_) if restarts == beside::MOST => break StopReason::Stalled,
                Some(next) => here = next,
            }
            restarts += 1;
            inverse = Inverse::identity(x.len());
            is_fresh = true;
            continue;
        }
        if iterations >= limits.iterations {
            break StopReason::OutOfBudget;
        }
        iterations += 1;
        // Where the direction does not descend, the memory is dropped.
        let length = direction.iter().fold(0.0_f64, |m, d| m.max(d.abs()));
        if slope >= 0.0 || slope.is_nan() {
            if is_fresh {
                break StopReason::Stalled;
            }
            inverse = Inverse::identity(x.len());
            is_fresh = true;
            continue;
        }
        if is_fresh && length > 0.0 {
            // The gradient gives the direction, but no step length.
            direction
                .iter_mut()
                .for_each(|d| *d *= limits.first_step / length);
        }
        // Line search, then the update of the inverse Hessian.
        match search.line(&here, &direction) {
            Some(next) => {
                inverse.update(&here, &next, &free, is_fresh);
                is_fresh = false;
                here = next;
            }
            None if is_fresh => break StopReason::Stalled,
            None => {
                inverse = Inverse::identity(x.len());
                is_fresh = true;
            }
        }
        let place = search.unscaled(&here.x);
        if !search.objective.progress(iterations, &place, here.value) {
            break StopReason::Stopped;
        }
    };
    x = search.unscaled(&here.x);
    search.result(x, here.value, iterations, ended)
}

/// A point in scaled variables.
#[derive(Clone)]
struct BfgsPoint {
    x: Vec<f64>,
    value: f64,
    gradient: Vec<f64>,
}

struct BfgsSearch<'a> {
    objective: &'a mut dyn Objective,
    bounds: &'a VariableBounds,
    scales: &'a [f64],
    evaluations: usize,
}

impl BfgsSearch<'_> {
    fn unscaled(&self, x: &[f64]) -> Vec<f64> {
        let mut x: Vec<f64> = x.iter().zip(self.scales).map(|(x, s)| x * s).collect();
        self.bounds.clamp(&mut x);
        x
    }

    fn at(&mut self, x: &[f64]) -> Option<BfgsPoint> {
        self.evaluations += 1;
        let (value, gradient) = self.objective.gradient(x)?;
        if !value.is_finite() {
            return None;
        }
        Some(BfgsPoint {
            x: x.iter().zip(self.scales).map(|(x, s)| x / s).collect(),
            value,
            gradient: gradient
                .iter()
                .zip(self.scales)
                .map(|(g, s)| g * s)
                .collect(),
        })
    }

    /// A point beside this one that is lower by more than slopes within the tolerance and rounding explain.
    fn lower_beside(&mut self, here: &BfgsPoint, slope: f64) -> Option<BfgsPoint> {
        let place = self.unscaled(&here.x);
        let explained = 2.0 * slope * beside::LENGTH + beside::ROUNDING * here.value.abs();
        let level = here.value - explained;
        let Self {
            objective,
            scales,
            bounds,
            ..
        } = self;
        let (lower, asked) = lowest_beside(&place, scales, bounds, level, |x| objective.value(x));
        self.evaluations += asked;
        self.at(&lower?).filter(|there| there.value < level)
    }

    /// Variables that are not held at a bound.
    fn free(&self, here: &BfgsPoint) -> Vec<bool> {
        let bound = |k: usize, list: &[f64]| list[k] / self.scales[k];
        (0..here.x.len())
            .map(|k| {
                let low = here.x[k] <= bound(k, &self.bounds.lower) && here.gradient[k] > 0.0;
                let high = here.x[k] >= bound(k, &self.bounds.upper) && here.gradient[k] < 0.0;
                !low && !high
            })
            .collect()
    }

    /// A point along `direction` that satisfies both conditions; `None` if there is none.
    fn line(&mut self, here: &BfgsPoint, direction: &[f64]) -> Option<BfgsPoint> {
        let (mut low, mut high, mut share) = (0.0, f64::INFINITY, 1.0);
        let mut best: Option<BfgsPoint> = None;
        for _ in 0..MOST_TRIALS {
            let scaled: Vec<f64> = here
                .x
                .iter()
                .zip(direction)
                .map(|(x, d)| x + share * d)
                .collect();
            let place = self.unscaled(&scaled);
            let trial = self.at(&place);
            // Armijo: sufficient decrease. Wolfe, below: the slope must have flattened.
            let gained = trial.as_ref().is_some_and(|t| {
                let promised: f64 = (0..here.x.len())
                    .map(|k| here.gradient[k] * (t.x[k] - here.x[k]))
                    .sum();
                t.value <= here.value + SUFFICIENT_GAIN * promised && t.value < here.value
            });
            let slope = |p: &BfgsPoint| -> f64 {
                p.gradient.iter().zip(direction).map(|(g, d)| g * d).sum()
            };
            match trial {
                Some(trial) if gained => {
                    let steep = slope(&trial) < SLOPE_SHARE * slope(here);
                    if best.as_ref().is_none_or(|b| trial.value < b.value) {
                        best = Some(trial);
                    }
                    if !steep {
                        return best;
                    }
                    low = share;
                }
                _ => high = share,
            }
            // Doubled until it is too long, then bisected.
            share = if high.is_finite() {
                0.5 * (low + high)
            } else {
                2.0 * share
            };
            if high - low <= f64::EPSILON * high {
                break;
            }
        }
        best
    }

    fn result(&self, x: Vec<f64>, value: f64, iterations: usize, ended: StopReason) -> Minimum {
        Minimum {
            x,
            value,
            iterations,
            evaluations: self.evaluations,
            gradients: self.evaluations,
            ended,
        }
    }
}

/// The approximation of the inverse of the second derivatives.
struct Inverse {
    n: usize,
    entries: Vec<f64>,
}

impl Inverse {
    fn identity(n: usize) -> Self {
        let mut entries = vec![0.0; n * n];
        (0..n).for_each(|k| entries[k * n + k] = 1.0);
        Self { n, entries }
    }

    /// The direction of descent among the free variables.
    fn times(&self, gradient: &[f64], free: &[bool]) -> Vec<f64> {
        let row = |i: usize| -> f64 {
            let entries = &self.entries[i * self.n..(i + 1) * self.n];
            let terms = entries.iter().zip(gradient).zip(free).filter(|(_, f)| **f);
            -terms.map(|((e, g), _)| e * g).sum::<f64>()
        };
        (0..self.n)
            .map(|i| if free[i] { row(i) } else { 0.0 })
            .collect()
    }

    fn update(&mut self, from: &BfgsPoint, to: &BfgsPoint, free: &[bool], is_fresh: bool) {
        let n = self.n;
        let moved = |k: usize| if free[k] { to.x[k] - from.x[k] } else { 0.0 };
        let turned = |k: usize| {
            if free[k] {
                to.gradient[k] - from.gradient[k]
            } else {
                0.0
            }
        };
        let (s, y): (Vec<f64>, Vec<f64>) = (0..n).map(|k| (moved(k), turned(k))).unzip();
        let dot = |a: &[f64], b: &[f64]| -> f64 { a.iter().zip(b).map(|(a, b)| a * b).sum() };
        let sy = dot(&s, &y);
        // Only a positive curvature keeps the matrix positive.
        let least = f64::EPSILON * dot(&s, &s).sqrt() * dot(&y, &y).sqrt();
        if sy <= least || sy.is_nan() {
            return;
        }
        if is_fresh {
            let scale = sy / dot(&y, &y);
            self.entries.iter_mut().for_each(|e| *e *= scale);
        }
        let hy: Vec<f64> = (0..n)
            .map(|i| dot(&self.entries[i * n..(i + 1) * n], &y))
            .collect();
        let factor = (sy + dot(&y, &hy)) / (sy * sy);
        for i in 0..n {
            for j in 0..n {
                self.entries[i * n + j] +=
                    factor * s[i] * s[j] - (hy[i] * s[j] + s[i] * hy[j]) / sy;
            }
        }
    }
}
