//! Minimises the largest of many smooth functions under smooth constraints: quadratic programmes of the linearised
//! functions within a trust region, with curvature learnt from the gradients of the last steps (Madsen and
//! Schjær-Jacobsen, Math. Programming 14, 1978, without curvature; Powell's damped BFGS of the Lagrangian; constraints
//! by an elastic variable and second-order correction as in Fletcher, Practical Methods of Optimization, 2nd ed.,
//! chapters 12 and 14).

use super::beside::lowest_beside;
use super::curvature::Curvature;
use super::kept::BestKept;
use super::minimax_poll::Poll;
use super::minimax_problem::{largest_value, merit_value};
use super::minimax_step::{MinimaxPoint, MinimaxStep, first_unit, trust_unit};
use super::{LET_PASS, Minimum, StopReason, VariableBounds};
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

/// Number of looks around ends of the search that lead on: each costs as many gradients as dozens of steps.
const MOST_POLLS: usize = 40;

/// Decreases are judged relative to the value, but at least to this share of the first one: at an optimum of zero every decrease would
/// be large otherwise.
const LEAST_SIZE: f64 = 1e-6;

/// Searches from `start`; `scales` are typical sizes of the variables, limits are of order one.
pub fn minimise_largest(
    problem: &mut dyn MinimaxProblem,
    start: &[f64],
    scales: &[f64],
    bounds: &VariableBounds,
    search: MinimaxSearch,
) -> Minimum {
    let mut result = Minimum {
        x: start.to_vec(),
        value: f64::INFINITY,
        iterations: 0,
        evaluations: 0,
        gradients: 1,
        ended: StopReason::Stalled,
    };
    bounds.clamp(&mut result.x);
    let Some((values, gradients)) = problem.gradients_at(&result.x) else {
        // Without derivatives there is no way on, but there may be a value.
        let value = problem.values_at(&result.x);
        result.value = value.map_or(f64::INFINITY, |values| largest_value(&values.peaks));
        return result;
    };
    // Exact penalty: the weight of the constraints is so large that violating one never pays.
    let unit = first_unit(merit_value(&values, 0.0), &gradients, scales, search.radius);
    let mut state = MinimaxState {
        problem,
        scales,
        bounds,
        search,
        weight: WEIGHT * unit,
        first_unit: unit,
        kept: BestKept::within(LET_PASS),
        polls: 0,
        values,
        gradients,
        curvature: Curvature::none(start.len()),
        edges: VecDeque::new(),
        radius: search.radius,
        accepted: 0,
        result,
    };
    state.offer();
    let ended = loop {
        if let Some(reason) = state.advance() {
            break reason;
        }
    };
    state.go_back_if_violated();
    Minimum {
        value: largest_value(&state.values.peaks),
        ended,
        ..state.result
    }
}

/// A search on its way.
struct MinimaxState<'s> {
    problem: &'s mut dyn MinimaxProblem,
    scales: &'s [f64],
    bounds: &'s VariableBounds,
    search: MinimaxSearch,
    /// What violating a constraint costs.
    weight: f64,
    /// The size of the first value.
    first_unit: f64,
    /// The best point so far that keeps the constraints.
    kept: BestKept,
    /// Looks around so far.
    polls: usize,
    /// At the best point so far.
    values: PeakValues,
    gradients: PeakGradients,
    curvature: Curvature,
    /// The edges found so far.
    edges: VecDeque<TrustEdge>,
    radius: f64,
    /// Number of accepted steps.
    accepted: usize,
    /// The best point so far, and what was spent on it.
    result: Minimum,
}

/// A step of the model, before it is tried.
struct Forecast {
    step: MinimaxStep,
    /// The merit where it begins.
    here: f64,
    /// The predicted decrease.
    promise: f64,
    /// The unit of the programme.
    unit: f64,
    weight: f64,
}

impl Forecast {
    /// The decrease at a point, as a fraction of the predicted one.
    fn gain(&self, there: Option<&PeakValues>) -> f64 {
        match there {
            Some(there) => (self.here - merit_value(there, self.weight)) / self.promise,
            None => f64::NEG_INFINITY,
        }
    }
}

impl MinimaxState<'_> {
    /// One step, accepted or not; the reason why the search ends, if it does.
    fn advance(&mut self) -> Option<StopReason> {
        match self.reason_to_end() {
            Some(StopReason::Converged) => return self.look_around(),
            Some(reason) => return Some(reason),
            None => self.result.iterations += 1,
        }
        let here = merit_value(&self.values, self.weight);
        let unit = trust_unit(here, &self.gradients, self.scales, self.radius);
        let Some(step) = self.model(unit).step(&self.values, self.radius) else {
            self.radius *= SHRINK;
            return None;
        };
        let forecast = Forecast {
            here,
            promise: here - step.merit,
            unit,
            weight: self.weight,
            step,
        };
        // Below the tolerance nothing is left to gain.
        if forecast.promise <= self.search.tolerance * here.abs() {
            return self.look_around();
        }
        let Some((next, gained)) = self.trial_step(&forecast) else {
            return Some(StopReason::Stopped);
        };
        if gained > TAKEN {
            self.result.gradients += 1;
            let Some(there) = self.problem.gradients_at(&next) else {
                self.cut_off(&next);
                return None;
            };
            if !self.take(next, there, &forecast.step) {
                return Some(StopReason::Stopped);
            }
        }
        self.resize(gained);
        None
    }

    fn reason_to_end(&self) -> Option<StopReason> {
        if self.result.iterations >= self.search.iterations {
            Some(StopReason::OutOfBudget)
        } else if self.radius < self.search.smallest_radius {
            Some(StopReason::Converged)
        } else {
            self.problem.is_stopped().then_some(StopReason::Stopped)
        }
    }

    /// The model: linear peaks and constraints, the learnt curvature, and the edges found so far.
    fn model(&self, unit: f64) -> MinimaxPoint<'_> {
        MinimaxPoint {
            x: &self.result.x,
            edges: &self.edges,
            gradients: &self.gradients,
            curvature: &self.curvature,
            scales: self.scales,
            bounds: self.bounds,
            weight: self.weight,
            unit,
        }
    }

    /// Tries a step; if it disappoints, one that takes the curvature of the constraints into account as well
    /// (second-order correction). The better of them and the fraction of the predicted decrease that it achieves; `None`
    /// if the search is to end.
    fn trial_step(&mut self, forecast: &Forecast) -> Option<(Vec<f64>, f64)> {
        self.result.evaluations += 1;
        let next = &forecast.step.x;
        let there = self.problem.values_at(next);
        let gained = forecast.gain(there.as_ref());
        if self.problem.is_stopped() {
            return None;
        }
        let disappointing = there.filter(|_| gained < GOOD);
        let other = disappointing.and_then(|there| {
            let model = self.model(forecast.unit);
            model.step(&model.corrected_values(next, &there), self.radius)
        });
        if let Some(other) = other {
            self.result.evaluations += 1;
            let corrected = forecast.gain(self.problem.values_at(&other.x).as_ref());
            if corrected > gained {
                return Some((other.x, corrected));
            }
        }
        Some((next.clone(), gained))
    }

    /// Without a gradient at a point: that is the edge of the region in which the mechanism can be assembled. It is kept
    /// as a cut.
    fn cut_off(&mut self, next: &[f64]) {
        self.edges.extend(self.problem.edge(next));
        if self.edges.len() > MOST_EDGES {
            self.edges.pop_front();
        }
        self.radius *= SHRINK;
    }

    /// Goes to a point and learns the curvature on the way there: BFGS on the Lagrangian, with the multipliers of the
    /// step. False if the search is to end.
    fn take(
        &mut self,
        next: Vec<f64>,
        (new_values, new_gradients): (PeakValues, PeakGradients),
        step: &MinimaxStep,
    ) -> bool {
        let (x, scales) = (&self.result.x, self.scales);
        let moved = (0..x.len()).map(|k| (next[k] - x[k]) / scales[k]);
        let moved = DVector::from_iterator(x.len(), moved);
        let gradient = |gradients: &PeakGradients| step.lagrangian_gradient(gradients, scales);
        let change = gradient(&new_gradients) - gradient(&self.gradients);
        // What bends the peak by itself is known; only the rest is learnt.
        let known = self.gradients.scaled_bend(scales) * &moved;
        self.curvature.damped_update(&moved, change - known);
        self.arrive(next, (new_values, new_gradients))
    }

    /// Goes to a point; false if the search is to end.
    fn arrive(&mut self, next: Vec<f64>, there: (PeakValues, PeakGradients)) -> bool {
        (self.values, self.gradients) = there;
        self.result.x = next;
        self.accepted += 1;
        self.offer();
        let value = largest_value(&self.values.peaks);
        self.problem.progress(self.accepted, &self.result.x, value)
    }

    /// Remembers the point if it keeps the constraints.
    fn offer(&mut self) {
        let value = largest_value(&self.values.peaks);
        let violation = largest_value(&self.values.limits);
        self.kept.offer(&self.result.x, value, violation);
    }

    /// Goes back to the best point that keeps the constraints if this one does not.
    fn go_back_if_violated(&mut self) {
        let kept = std::mem::replace(&mut self.kept, BestKept::within(LET_PASS));
        let Some((x, _)) = kept.instead_of(largest_value(&self.values.limits)) else {
            return;
        };
        // The problem is asked again, so that what it remembers of its last point belongs to this one.
        self.result.gradients += 1;
        if let Some(there) = self.problem.gradients_at(&x) {
            (self.values, self.gradients) = there;
            self.result.x = x;
        }
    }

    /// Where the model promises nothing: a maximum is flat, too, and a kink may hide the way down. The search goes on from a better
    /// point nearby, and has converged if there is none.
    fn look_around(&mut self) -> Option<StopReason> {
        if self.polls == MOST_POLLS {
            return Some(StopReason::Stalled);
        }
        let here = merit_value(&self.values, self.weight);
        let size = here.abs().max(LEAST_SIZE * self.first_unit);
        let better = match self.problem.hides_kinks() {
            true => self.poll(size),
            false => self.step_aside(here - self.search.tolerance * size),
        };
        self.polls += 1;
        self.result.iterations += 1;
        self.result.gradients += 1;
        let next = better.unwrap_or_else(|| self.result.x.clone());
        let is_better = next != self.result.x;
        // Also without a better point: what the problem remembers of its last point belongs to this one then.
        let there = self.problem.gradients_at(&next);
        if self.problem.is_stopped() {
            return Some(StopReason::Stopped);
        }
        let Some(there) = there.filter(|_| is_better) else {
            return Some(StopReason::Converged);
        };
        let moves = next.iter().zip(&self.result.x).zip(self.scales);
        let moved = moves.fold(0.0, |most: f64, ((a, b), s)| most.max(((a - b) / s).abs()));
        self.radius = moved.max(self.search.smallest_radius);
        self.curvature = Curvature::none(next.len());
        (!self.arrive(next, there)).then_some(StopReason::Stopped)
    }

    /// A point beside this one whose merit is below a level.
    fn step_aside(&mut self, level: f64) -> Option<Vec<f64>> {
        let (problem, weight) = (&mut *self.problem, self.weight);
        let merit = |x: &[f64]| {
            let there = problem.values_at(x);
            there.map_or(f64::INFINITY, |there| merit_value(&there, weight))
        };
        let (lower, asked) = lowest_beside(&self.result.x, self.scales, self.bounds, level, merit);
        self.result.evaluations += asked;
        lower
    }

    /// A better point by a look at the kinks around.
    fn poll(&mut self, size: f64) -> Option<Vec<f64>> {
        let poll = Poll {
            here: MinimaxPoint {
                x: &self.result.x,
                edges: &self.edges,
                gradients: &self.gradients,
                curvature: &self.curvature,
                scales: self.scales,
                bounds: self.bounds,
                weight: self.weight,
                unit: size,
            },
            values: &self.values,
            least_gain: self.search.tolerance * size,
            number: self.polls,
        };
        let polled = poll.look(&mut *self.problem);
        self.result.evaluations += polled.evaluations;
        self.result.gradients += polled.gradients;
        polled.better
    }

    /// The trust region grows if the model is accurate, and shrinks if not.
    fn resize(&mut self, gained: f64) {
        if gained > GOOD {
            self.radius *= GROW;
        } else if gained < POOR {
            self.radius *= SHRINK;
        }
    }
}
