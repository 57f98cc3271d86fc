//! The least largest of many smooth functions under smooth limits: linear programmes of the linearised functions within
//! a trust region (Madsen and Schjær-Jacobsen, Math. Programming 14, 1978; limits by an elastic variable as in Fletcher,
//! Practical Methods of Optimization, 2nd ed., chapter 12).

use super::{Bounds, Ended, Minimum};
use microlp::{ComparisonOp, OptimizationDirection, Problem, SolveOutcome};

/// Values at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct Heights {
    /// The largest of these is to be small.
    pub peaks: Vec<f64>,
    /// None of these is to be positive.
    pub limits: Vec<f64>,
}

/// Derivatives at a point: a row for each peak and for each limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Slopes {
    /// Of the peaks.
    pub peaks: Vec<Vec<f64>>,
    /// Of the limits.
    pub limits: Vec<Vec<f64>>,
}

/// Many functions at once.
pub trait Landscape {
    /// Values at `x`; `None` where `x` is refused.
    fn heights(&mut self, x: &[f64]) -> Option<Heights>;

    /// Values and derivatives at `x`; `None` where `x` is refused.
    fn slopes(&mut self, x: &[f64]) -> Option<(Heights, Slopes)>;

    /// Called after every accepted step; `false` ends the search.
    fn progress(&mut self, _iteration: usize, _x: &[f64], _value: f64) -> bool {
        true
    }
}

/// When the search is over.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Search {
    /// First radius of the trust region, in scales of the variables.
    pub radius: f64,
    /// The search is over below this radius.
    pub smallest_radius: f64,
    /// The search is over when a step promises less than this share of the value.
    pub tolerance: f64,
    /// Most steps, accepted or not.
    pub iterations: usize,
}

/// Weight of the worst limit beside the largest peak, in first values of the peaks.
const WEIGHT: f64 = 100.0;

/// A step is taken when it gains this share of what the linear programme promised.
const TAKEN: f64 = 0.01;

/// Above this share the region grows, below the second it shrinks.
const GOOD: f64 = 0.75;
const POOR: f64 = 0.25;

/// Factors of the radius.
const GROW: f64 = 2.0;
const SHRINK: f64 = 0.4;

/// Searches from `start`; `scales` are typical sizes of the variables, limits are of order one.
pub fn minimise(
    landscape: &mut dyn Landscape,
    start: &[f64],
    scales: &[f64],
    bounds: &Bounds,
    search: Search,
) -> Minimum {
    let mut x = start.to_vec();
    bounds.clamp(&mut x);
    let mut result = Minimum {
        x: x.clone(),
        value: f64::INFINITY,
        iterations: 0,
        evaluations: 0,
        gradients: 1,
        ended: Ended::Stalled,
    };
    let Some((mut heights, mut slopes)) = landscape.slopes(&x) else {
        return result;
    };
    let weight = WEIGHT * largest(&heights.peaks).abs().max(f64::MIN_POSITIVE);
    let mut radius = search.radius;
    let mut accepted = 0;
    result.ended = loop {
        if result.iterations >= search.iterations {
            break Ended::OutOfBudget;
        }
        if radius < search.smallest_radius {
            break Ended::Converged;
        }
        result.iterations += 1;
        let place = Place {
            x: &x,
            heights: &heights,
            slopes: &slopes,
            scales,
            bounds,
            weight,
        };
        let here = merit(&heights, weight);
        let Some((next, promised)) = place.step(radius) else {
            radius *= SHRINK;
            continue;
        };
        let promise = here - promised;
        if promise <= search.tolerance * here.abs() {
            break Ended::Converged;
        }
        result.evaluations += 1;
        let gained = match landscape.heights(&next) {
            Some(there) => (here - merit(&there, weight)) / promise,
            None => f64::NEG_INFINITY,
        };
        if gained > TAKEN {
            result.gradients += 1;
            match landscape.slopes(&next) {
                Some(found) => (heights, slopes) = found,
                None => {
                    radius *= SHRINK;
                    continue;
                }
            }
            x = next;
            accepted += 1;
            if !landscape.progress(accepted, &x, largest(&heights.peaks)) {
                break Ended::Stopped;
            }
        }
        if gained > GOOD {
            radius *= GROW;
        } else if gained < POOR {
            radius *= SHRINK;
        }
    };
    result.value = largest(&heights.peaks);
    result.x = x;
    result
}

fn largest(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn merit(heights: &Heights, weight: f64) -> f64 {
    largest(&heights.peaks) + weight * largest(&heights.limits).max(0.0)
}

/// A point with its linearisation.
struct Place<'a> {
    x: &'a [f64],
    heights: &'a Heights,
    slopes: &'a Slopes,
    scales: &'a [f64],
    bounds: &'a Bounds,
    weight: f64,
}

impl Place<'_> {
    /// The best point of the linearised functions within the region, and their merit there.
    fn step(&self, radius: f64) -> Option<(Vec<f64>, f64)> {
        let mut problem = Problem::new(OptimizationDirection::Minimize);
        // The programme is in scaled variables and in shares of the first merit, so that all its numbers are moderate.
        let unit = merit(self.heights, self.weight)
            .abs()
            .max(f64::MIN_POSITIVE);
        let top = problem.add_var(1.0, (f64::NEG_INFINITY, f64::INFINITY));
        let excess = problem.add_var(self.weight / unit, (0.0, f64::INFINITY));
        let moves: Vec<_> = (0..self.x.len())
            .map(|k| {
                let room = |bound: f64| (bound - self.x[k]) / self.scales[k];
                let low = room(self.bounds.lower[k]).max(-radius).min(0.0);
                let high = room(self.bounds.upper[k]).min(radius).max(0.0);
                problem.add_var(0.0, (low, high))
            })
            .collect();
        let mut add = |value: f64, row: &[f64], unit: f64, under| {
            let terms = moves.iter().zip(row).zip(self.scales);
            let mut terms: Vec<_> = terms.map(|((m, d), s)| (*m, d * s / unit)).collect();
            terms.push((under, -1.0));
            problem.add_constraint(terms, ComparisonOp::Le, -value / unit);
        };
        for (value, row) in self.heights.peaks.iter().zip(&self.slopes.peaks) {
            add(*value, row, unit, top);
        }
        for (value, row) in self.heights.limits.iter().zip(&self.slopes.limits) {
            add(*value, row, 1.0, excess);
        }
        let SolveOutcome::Solution(solution) = problem.solve().ok()? else {
            return None;
        };
        let mut next: Vec<f64> = (0..self.x.len())
            .map(|k| self.x[k] + self.scales[k] * solution[moves[k]])
            .collect();
        self.bounds.clamp(&mut next);
        let promised = solution[top] * unit + self.weight * solution[excess];
        next.iter()
            .all(|v| v.is_finite())
            .then_some((next, promised))
    }
}
