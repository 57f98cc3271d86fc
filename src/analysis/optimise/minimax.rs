//! Minimises the largest of many smooth functions under smooth constraints: quadratic programmes of the linearised
//! functions within a trust region, with curvature learnt from the gradients of the last steps (Madsen and
//! Schjær-Jacobsen, Math. Programming 14, 1978, without curvature; Powell's damped BFGS of the Lagrangian; constraints
//! by an elastic variable and second-order correction as in Fletcher, Practical Methods of Optimization, 2nd ed.,
//! chapters 12 and 14).

use super::curvature::Curvature;
use super::minimax_problem::{largest_value, merit_value};
use super::minimax_step::{MinimaxPoint, trust_unit};
use super::{Minimum, StopReason, VariableBounds};
use nalgebra::DVector;
use std::collections::VecDeque;

pub use super::minimax_problem::{MinimaxProblem, PeakGradients, PeakValues, TrustEdge};

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

/// Edges that are remembered.
const MOST_EDGES: usize = 24;

/// Searches from `start`; `scales` are typical sizes of the variables, limits are of order one.
pub fn minimise_largest(
    problem: &mut dyn MinimaxProblem,
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
        ended: StopReason::Stalled,
    };
    let Some((mut peak_values, mut peak_gradients)) = problem.gradients_at(&x) else {
        return result;
    };
    // Exact penalty: the weight of the constraints is so large that violating one never pays.
    let weight = WEIGHT
        * trust_unit(
            merit_value(&peak_values, 0.0),
            &peak_gradients,
            scales,
            search.radius,
        );
    let mut curvature = Curvature::none(x.len());
    let mut radius = search.radius;
    let mut accepted = 0;
    let mut edges: VecDeque<TrustEdge> = VecDeque::new();
    result.ended = loop {
        if result.iterations >= search.iterations {
            break StopReason::OutOfBudget;
        }
        if radius < search.smallest_radius {
            break StopReason::Converged;
        }
        if problem.is_stopped() {
            break StopReason::Stopped;
        }
        result.iterations += 1;
        // The model: linear peaks and constraints, the learnt curvature, and the edges found so far.
        let place = MinimaxPoint {
            x: &x,
            edges: &edges,
            gradients: &peak_gradients,
            curvature: &curvature,
            scales,
            bounds,
            weight,
            unit: trust_unit(
                merit_value(&peak_values, weight),
                &peak_gradients,
                scales,
                radius,
            ),
        };
        let here = merit_value(&peak_values, weight);
        let Some(step) = place.step(&peak_values, radius) else {
            radius *= SHRINK;
            continue;
        };
        // The predicted decrease; below the tolerance nothing is left to gain.
        let promise = here - step.merit;
        if promise <= search.tolerance * here.abs() {
            break StopReason::Converged;
        }
        result.evaluations += 1;
        let gain = |there: &Option<PeakValues>| match there {
            Some(there) => (here - merit_value(there, weight)) / promise,
            None => f64::NEG_INFINITY,
        };
        let there = problem.values_at(&step.x);
        // Second-order correction: if the step disappoints, the curvature of the constraints is taken into account.
        let (mut next, mut gained) = (step.x.clone(), gain(&there));
        if problem.is_stopped() {
            break StopReason::Stopped;
        }
        if let Some(there) = there.filter(|_| gained < GOOD)
            && let Some(other) = place.step(&place.corrected_values(&next, &there), radius)
        {
            result.evaluations += 1;
            let corrected = gain(&problem.values_at(&other.x));
            if corrected > gained {
                (next, gained) = (other.x, corrected);
            }
        }
        if gained > TAKEN {
            result.gradients += 1;
            let Some((new_values, new_gradients)) = problem.gradients_at(&next) else {
                // No gradient there: the edge of the region in which the mechanism can be assembled. It is kept as a
                // cut.
                edges.extend(problem.edge(&next));
                if edges.len() > MOST_EDGES {
                    edges.pop_front();
                }
                radius *= SHRINK;
                continue;
            };
            // BFGS on the Lagrangian, with the multipliers of this step.
            // What bends the peak by itself is known; only the rest is learnt.
            let moved = (0..x.len()).map(|k| (next[k] - x[k]) / scales[k]);
            let moved = DVector::from_iterator(x.len(), moved);
            let gradient =
                |peak_gradients: &PeakGradients| step.lagrangian_gradient(peak_gradients, scales);
            let change = gradient(&new_gradients) - gradient(&peak_gradients);
            let known = peak_gradients.scaled_bend(scales) * &moved;
            curvature.damped_update(&moved, change - known);
            (peak_values, peak_gradients) = (new_values, new_gradients);
            x = next;
            accepted += 1;
            if !problem.progress(accepted, &x, largest_value(&peak_values.peaks)) {
                break StopReason::Stopped;
            }
        }
        // Trust region: larger if the model is accurate, smaller if not.
        if gained > GOOD {
            radius *= GROW;
        } else if gained < POOR {
            radius *= SHRINK;
        }
    };
    result.value = largest_value(&peak_values.peaks);
    result.x = x;
    result
}
