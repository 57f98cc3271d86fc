//! Minimises the largest of many smooth functions under smooth constraints: quadratic programmes of the linearised
//! functions within a trust region, with curvature learnt from the gradients of the last steps (Madsen and
//! Schjær-Jacobsen, Math. Programming 14, 1978, without curvature; Powell's damped BFGS of the Lagrangian; constraints
//! by an elastic variable and second-order correction as in Fletcher, Practical Methods of Optimization, 2nd ed.,
//! chapters 12 and 14).

use super::curvature::Curvature;
use super::quadratic::Programme;
use super::{Ended, Minimum, VariableBounds};
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Values at a point.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakValues {
    /// The functions whose maximum is minimised.
    pub peaks: Vec<f64>,
    /// The constraints: none may be positive.
    pub limits: Vec<f64>,
}

/// Derivatives at a point: a row for each peak and for each limit.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakGradients {
    /// Of the peaks.
    pub peaks: Vec<Vec<f64>>,
    /// Of the limits.
    pub limits: Vec<Vec<f64>>,
}

/// Many functions at once.
pub trait MinimaxProblem {
    /// Values at `x`; `None` if `x` is rejected.
    fn heights(&mut self, x: &[f64]) -> Option<PeakValues>;

    /// Values and derivatives at `x`; `None` if `x` is rejected.
    fn slopes(&mut self, x: &[f64]) -> Option<(PeakValues, PeakGradients)>;

    /// The constraint that rejected `x`, if it has a value and slopes only outside the feasible region.
    fn edge(&mut self, _x: &[f64]) -> Option<TrustEdge> {
        None
    }

    /// Called before every step and every evaluation: whether to end the search with the best point so far.
    fn is_stopped(&self) -> bool {
        false
    }

    /// Called after every accepted step; `false` ends the search.
    fn progress(&mut self, _iteration: usize, _x: &[f64], _value: f64) -> bool {
        true
    }
}

/// A rejected point: the violation of a constraint, and its gradient.
#[derive(Clone, Debug, PartialEq)]
pub struct TrustEdge {
    /// The point.
    pub x: Vec<f64>,
    /// Positive: how much is missed there.
    pub value: f64,
    /// Its derivatives.
    pub slope: Vec<f64>,
}

impl TrustEdge {
    /// The linearised constraint at `x`, seen from the rejected point; an accepted point satisfies it.
    fn at(&self, x: &[f64]) -> f64 {
        let moves = x.iter().zip(&self.x).zip(&self.slope);
        let value: f64 = moves.map(|((to, from), d)| (to - from) * d).sum();
        (self.value + value).min(0.0)
    }
}

/// The stopping criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MinimaxSearch {
    /// First radius of the trust region, in scales of the variables.
    pub radius: f64,
    /// The search ends below this radius.
    pub smallest_radius: f64,
    /// The search ends when the predicted decrease is below this fraction of the value.
    pub tolerance: f64,
    /// Most steps, accepted or not.
    pub iterations: usize,
}

/// Weight of the worst constraint relative to the largest peak, in first values of the peaks.
const WEIGHT: f64 = 100.0;

/// A step is accepted if it achieves this fraction of the predicted decrease.
const TAKEN: f64 = 0.01;

/// Above the first fraction the region grows, below the second it shrinks.
const GOOD: f64 = 0.75;
const POOR: f64 = 0.25;

/// Factors of the radius.
const GROW: f64 = 2.0;
const SHRINK: f64 = 0.4;

/// Curvature added in directions without any, relative to what would matter within the region: it keeps the programmes
/// solvable and has no other effect.
const STIFFNESS: f64 = 1e-9;

/// Edges that are remembered.
const MOST_EDGES: usize = 24;

/// Least unit of a programme, as a share of the largest change within the region.
const LEAST_UNIT: f64 = 1e-6;

/// Searches from `start`; `scales` are typical sizes of the variables, limits are of order one.
pub fn minimise_largest(
    landscape: &mut dyn MinimaxProblem,
    start: &[f64],
    scales: &[f64],
    bounds: &VariableBounds,
    search: MinimaxSearch,
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
    // Exact penalty: the weight of the constraints is so large that violating one never pays.
    let weight = WEIGHT * trust_unit(merit_value(&heights, 0.0), &slopes, scales, search.radius);
    let mut curvature = Curvature::none(x.len());
    let mut radius = search.radius;
    let mut accepted = 0;
    let mut edges: VecDeque<TrustEdge> = VecDeque::new();
    result.ended = loop {
        if result.iterations >= search.iterations {
            break Ended::OutOfBudget;
        }
        if radius < search.smallest_radius {
            break Ended::Converged;
        }
        if landscape.is_stopped() {
            break Ended::Stopped;
        }
        result.iterations += 1;
        // The model: linear peaks and constraints, the learnt curvature, and the edges found so far.
        let place = MinimaxPoint {
            x: &x,
            edges: &edges,
            slopes: &slopes,
            curvature: &curvature,
            scales,
            bounds,
            weight,
            unit: trust_unit(merit_value(&heights, weight), &slopes, scales, radius),
        };
        let here = merit_value(&heights, weight);
        let Some(step) = place.step(&heights, radius) else {
            radius *= SHRINK;
            continue;
        };
        // The predicted decrease; below the tolerance nothing is left to gain.
        let promise = here - step.merit;
        if promise <= search.tolerance * here.abs() {
            break Ended::Converged;
        }
        result.evaluations += 1;
        let gain = |there: &Option<PeakValues>| match there {
            Some(there) => (here - merit_value(there, weight)) / promise,
            None => f64::NEG_INFINITY,
        };
        let there = landscape.heights(&step.x);
        // Second-order correction: if the step disappoints, the curvature of the constraints is taken into account.
        let (mut next, mut gained) = (step.x.clone(), gain(&there));
        if landscape.is_stopped() {
            break Ended::Stopped;
        }
        if let Some(there) = there.filter(|_| gained < GOOD)
            && let Some(other) = place.step(&place.bent(&next, &there), radius)
        {
            result.evaluations += 1;
            let corrected = gain(&landscape.heights(&other.x));
            if corrected > gained {
                (next, gained) = (other.x, corrected);
            }
        }
        if gained > TAKEN {
            result.gradients += 1;
            let Some((new_heights, new_slopes)) = landscape.slopes(&next) else {
                // No gradient there: the edge of the region in which the mechanism can be assembled. It is kept as a
                // cut.
                edges.extend(landscape.edge(&next));
                if edges.len() > MOST_EDGES {
                    edges.pop_front();
                }
                radius *= SHRINK;
                continue;
            };
            // BFGS on the Lagrangian, with the multipliers of this step.
            let moved: Vec<f64> = (0..x.len()).map(|k| (next[k] - x[k]) / scales[k]).collect();
            let turn = |slopes: &PeakGradients| step.lagrangian_gradient(slopes, scales);
            let change = turn(&new_slopes) - turn(&slopes);
            curvature.damped_update(&DVector::from_vec(moved), change);
            (heights, slopes) = (new_heights, new_slopes);
            x = next;
            accepted += 1;
            if !landscape.progress(accepted, &x, largest_value(&heights.peaks)) {
                break Ended::Stopped;
            }
        }
        // Trust region: larger if the model is accurate, smaller if not.
        if gained > GOOD {
            radius *= GROW;
        } else if gained < POOR {
            radius *= SHRINK;
        }
    };
    result.value = largest_value(&heights.peaks);
    result.x = x;
    result
}

fn largest_value(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::NEG_INFINITY, f64::max)
}

fn merit_value(heights: &PeakValues, weight: f64) -> f64 {
    largest_value(&heights.peaks) + weight * largest_value(&heights.limits).max(0.0)
}

/// The unit of a programme's values: the merit, but at least a fraction of the largest change within the region.
fn trust_unit(merit: f64, slopes: &PeakGradients, scales: &[f64], radius: f64) -> f64 {
    let reaches = slopes
        .peaks
        .iter()
        .map(|row| row_reach(row, scales, radius));
    let floor = LEAST_UNIT * reaches.fold(0.0, f64::max);
    merit.abs().max(floor).max(f64::MIN_POSITIVE)
}

/// The largest change of a linearised function within the region.
fn row_reach(row: &[f64], scales: &[f64], radius: f64) -> f64 {
    radius
        * row
            .iter()
            .zip(scales)
            .map(|(d, s)| (d * s).abs())
            .sum::<f64>()
}

/// A point with its linearisation.
struct MinimaxPoint<'a> {
    x: &'a [f64],
    slopes: &'a PeakGradients,
    edges: &'a VecDeque<TrustEdge>,
    curvature: &'a Curvature,
    scales: &'a [f64],
    bounds: &'a VariableBounds,
    weight: f64,
    /// Merit of the point, the unit of the programmes.
    unit: f64,
}

/// The best point of a programme.
struct MinimaxStep {
    x: Vec<f64>,
    /// Its merit as predicted by the programme.
    merit: f64,
    /// The multiplier of each active peak and constraint, as (index, multiplier).
    peaks: Vec<(usize, f64)>,
    limits: Vec<(usize, f64)>,
}

impl MinimaxStep {
    /// Gradient of the Lagrangian in scaled variables.
    fn lagrangian_gradient(&self, slopes: &PeakGradients, scales: &[f64]) -> DVector<f64> {
        let mut sum = DVector::zeros(scales.len());
        let held = |list: &[(usize, f64)], rows: &[Vec<f64>], sum: &mut DVector<f64>| {
            for (index, multiplier) in list {
                for (k, d) in rows[*index].iter().enumerate() {
                    sum[k] += multiplier * d * scales[k];
                }
            }
        };
        held(&self.peaks, &slopes.peaks, &mut sum);
        held(&self.limits, &slopes.limits, &mut sum);
        sum
    }
}

impl MinimaxPoint<'_> {
    /// Values at `there` minus the first-order prediction: added to the linearised functions, they make them exact at
    /// `there` (second-order correction).
    fn bent(&self, next: &[f64], there: &PeakValues) -> PeakValues {
        let less = |values: &[f64], slopes: &[Vec<f64>]| -> Vec<f64> {
            let pairs = values.iter().zip(slopes);
            pairs.map(|(v, row)| v - self.along(next, row)).collect()
        };
        PeakValues {
            peaks: less(&there.peaks, &self.slopes.peaks),
            limits: less(&there.limits, &self.slopes.limits),
        }
    }

    fn along(&self, next: &[f64], row: &[f64]) -> f64 {
        let moves = next.iter().zip(self.x).zip(row);
        moves.map(|((to, from), d)| (to - from) * d).sum()
    }

    /// Rows that can be active within the region: peaks that can become the largest, constraints that can be violated.
    fn relevant_rows(&self, heights: &PeakValues, radius: f64) -> [Vec<usize>; 2] {
        let lowest =
            |k: usize| heights.peaks[k] - row_reach(&self.slopes.peaks[k], self.scales, radius);
        let floor = (0..heights.peaks.len())
            .map(lowest)
            .fold(f64::NEG_INFINITY, f64::max);
        // By first-order change: rows that cannot reach the level within the region are omitted.
        let can_reach = |values: &[f64], rows: &[Vec<f64>], level: f64| -> Vec<usize> {
            (0..values.len())
                .filter(|k| values[*k] + row_reach(&rows[*k], self.scales, radius) >= level)
                .collect()
        };
        [
            can_reach(&heights.peaks, &self.slopes.peaks, floor),
            can_reach(&heights.limits, &self.slopes.limits, 0.0),
        ]
    }

    /// The best point within the region for the functions with these values, linearised and with the learnt curvature.
    ///
    /// The programme's variables are the steps in radii, the largest peak in units, and the worst violated constraint
    /// in units of its cost.
    fn step(&self, heights: &PeakValues, radius: f64) -> Option<MinimaxStep> {
        let n = self.x.len();
        let [peaks, limits] = self.relevant_rows(heights, radius);
        let count = peaks.len() + limits.len() + self.edges.len() + 1 + 2 * n;
        // Unknowns of the programme: the scaled step, the largest peak, the excess over the limits.
        let (top, excess) = (n, n + 1);
        let limit_unit = self.unit / self.weight;
        let mut rows = DMatrix::zeros(count, n + 2);
        let mut ends = DVector::zeros(count);
        let mut row = 0;
        let listed = peaks
            .iter()
            .map(|k| (heights.peaks[*k], &self.slopes.peaks[*k], self.unit, top));
        let listed = listed.chain(limits.iter().map(|k| {
            (
                heights.limits[*k],
                &self.slopes.limits[*k],
                limit_unit,
                excess,
            )
        }));
        let edges = self.edges.iter();
        let listed =
            listed.chain(edges.map(|edge| (edge.at(self.x), &edge.slope, limit_unit, excess)));
        // A row for every peak and constraint: the linearised value stays below its maximum.
        for (value, slope, unit, under) in listed {
            for k in 0..n {
                rows[(row, k)] = slope[k] * self.scales[k] * radius / unit;
            }
            rows[(row, under)] = -1.0;
            ends[row] = -value / unit;
            row += 1;
        }
        // The excess is not negative.
        rows[(row, excess)] = -1.0;
        row += 1;
        // The trust region and the bounds of the variables.
        for k in 0..n {
            let room = |bound: f64| (bound - self.x[k]) / (self.scales[k] * radius);
            rows[(row, k)] = 1.0;
            ends[row] = room(self.bounds.upper[k]).clamp(0.0, 1.0);
            rows[(row + 1, k)] = -1.0;
            ends[row + 1] = (-room(self.bounds.lower[k])).clamp(0.0, 1.0);
            row += 2;
        }
        // The objective: curvature of the Lagrangian, a little stiffness, and the two tops.
        let mut bend = DMatrix::zeros(n + 2, n + 2);
        let known = &self.curvature.matrix * (radius * radius / self.unit);
        bend.view_mut((0, 0), (n, n)).copy_from(&known);
        for k in 0..n + 2 {
            bend[(k, k)] += STIFFNESS;
        }
        let mut cost = DVector::zeros(n + 2);
        (cost[top], cost[excess]) = (1.0, 1.0);
        // A strictly feasible starting point.
        let mut start = DVector::zeros(n + 2);
        start[top] = largest_value(&heights.peaks) / self.unit + 0.1;
        start[excess] = largest_value(&heights.limits).max(0.0) / limit_unit + 0.1;
        let programme = Programme {
            bend,
            cost,
            rows,
            ends,
        };
        let answer = programme.solve(start)?;
        let mut next: Vec<f64> = (0..n)
            .map(|k| self.x[k] + self.scales[k] * radius * answer.point[k].clamp(-1.0, 1.0))
            .collect();
        self.bounds.clamp(&mut next);
        // The multipliers of the rows, which weigh the gradients in the Lagrangian.
        let held = |list: &[usize], first: usize, unit: f64| -> Vec<(usize, f64)> {
            let pairs = list.iter().enumerate();
            pairs
                .map(|(k, index)| (*index, answer.multipliers[first + k] * self.unit / unit))
                .collect()
        };
        let (held_peaks, held_limits) = (
            held(&peaks, 0, self.unit),
            held(&limits, peaks.len(), limit_unit),
        );
        let moves = answer.point.rows(0, n);
        let bending = 0.5 * moves.dot(&(known * moves)) * self.unit;
        Some(MinimaxStep {
            merit: self.linearised_merit(heights, &next) + bending,
            x: next,
            peaks: held_peaks,
            limits: held_limits,
        })
    }

    /// Merit of the linearised functions.
    fn linearised_merit(&self, heights: &PeakValues, next: &[f64]) -> f64 {
        let moved = |values: &[f64], rows: &[Vec<f64>]| -> Vec<f64> {
            let pairs = values.iter().zip(rows);
            pairs.map(|(v, row)| v + self.along(next, row)).collect()
        };
        let there = PeakValues {
            peaks: moved(&heights.peaks, &self.slopes.peaks),
            limits: moved(&heights.limits, &self.slopes.limits),
        };
        merit_value(&there, self.weight)
    }
}
