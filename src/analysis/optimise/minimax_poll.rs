//! Looks around the end of a minimax search for a way down that the derivatives there do not tell, because kinks are nearby: the
//! functions are linearised at points all around as well, and the programme takes them for further peaks (gradient sampling; Burke,
//! Lewis and Overton, SIAM J. Optim. 15, 2005).

use super::curvature::Curvature;
use super::minimax_problem::{
    MinimaxProblem, PeakGradients, PeakValues, largest_value, merit_value,
};
use super::minimax_step::MinimaxPoint;
use crate::analysis::random::Random;

/// Radii within which points are drawn, in scales of the variables: kinks that are far apart, and those that are close to each other.
const RADII: [f64; 4] = [1e-1, 1e-2, 1e-4, 1e-6];

/// Number of points within a radius for each variable: one more than the variables would be enough for a generic kink; twice as many
/// are the rule of the authors.
const POINTS_PER_VARIABLE: usize = 2;

/// Steps that are tried, as shares of the radius: kinks nearer than it are passed by long steps.
const SHARES: [f64; 4] = [1.0, 0.3, 0.1, 0.03];

/// Most times that a step which leads down is doubled: from the least radius to beyond the sizes of the variables.
const DOUBLINGS: usize = 24;

/// Where random numbers start: the same search always draws the same points.
const SEED: u64 = 1;

/// A look around the point `here`.
pub(super) struct Poll<'a> {
    pub here: MinimaxPoint<'a>,
    pub values: &'a PeakValues,
    /// What counts as a decrease of the merit.
    pub least_gain: f64,
    /// Number of earlier looks: each draws other points.
    pub number: usize,
}

/// What a look found.
pub(super) struct Polled {
    /// A better point.
    pub better: Option<Vec<f64>>,
    /// Values and gradients asked for.
    pub evaluations: usize,
    pub gradients: usize,
}

impl Poll<'_> {
    /// Looks around, from far to near.
    pub fn look(&self, problem: &mut dyn MinimaxProblem) -> Polled {
        let mut polled = Polled {
            better: None,
            evaluations: 0,
            gradients: 0,
        };
        let level = merit_value(self.values, self.here.weight) - self.least_gain;
        for (round, radius) in RADII.into_iter().enumerate() {
            let (values, gradients) = self.surroundings(problem, (round, radius), &mut polled);
            let curvature = Curvature::none(self.here.x.len());
            let model = MinimaxPoint {
                gradients: &gradients,
                curvature: &curvature,
                ..self.here
            };
            let steps = SHARES.into_iter();
            for step in steps.filter_map(|share| model.step(&values, share * radius)) {
                if problem.is_stopped() {
                    return polled;
                }
                let merit = self.merit(problem, &step.x, &mut polled);
                if merit < level {
                    polled.better = Some(self.far(problem, (step.x, merit), &mut polled));
                    return polled;
                }
            }
        }
        polled
    }

    fn merit(&self, problem: &mut dyn MinimaxProblem, x: &[f64], polled: &mut Polled) -> f64 {
        polled.evaluations += 1;
        let there = problem.values_at(x);
        there.map_or(f64::INFINITY, |there| merit_value(&there, self.here.weight))
    }

    /// The lowest of the points on the way to a better one and beyond it, twice as far each time.
    fn far(
        &self,
        problem: &mut dyn MinimaxProblem,
        (mut best, mut least): (Vec<f64>, f64),
        polled: &mut Polled,
    ) -> Vec<f64> {
        for _ in 0..DOUBLINGS {
            let ends = self.here.x.iter().zip(&best);
            let mut next: Vec<f64> = ends.map(|(from, to)| to + (to - from)).collect();
            self.here.bounds.clamp(&mut next);
            let merit = self.merit(problem, &next, polled);
            if merit >= least || merit.is_nan() {
                break;
            }
            (best, least) = (next, merit);
        }
        best
    }

    /// The functions here, and the largest ones at points around, linearised there.
    fn surroundings(
        &self,
        problem: &mut dyn MinimaxProblem,
        (round, radius): (usize, f64),
        polled: &mut Polled,
    ) -> (PeakValues, PeakGradients) {
        let (x, own) = (self.here.x, self.here.gradients);
        let mut values = self.values.clone();
        let mut gradients = PeakGradients {
            bend: None,
            ..own.clone()
        };
        let stream = (self.number * RADII.len() + round) as u64;
        for point in 0..POINTS_PER_VARIABLE * x.len() {
            if problem.is_stopped() {
                break;
            }
            let mut random = Random::new(SEED, stream, point as u64);
            let moved = x.iter().zip(self.here.scales);
            let mut y: Vec<f64> = moved
                .map(|(x, scale)| x + radius * scale * random.symmetric())
                .collect();
            self.here.bounds.clamp(&mut y);
            polled.gradients += 1;
            let Some((there, slopes)) = problem.gradients_at(&y) else {
                continue;
            };
            let from = (x, &y[..]);
            add_largest(
                from,
                (&there.peaks, &slopes.peaks),
                (&mut values.peaks, &mut gradients.peaks),
            );
            add_largest(
                from,
                (&there.limits, &slopes.limits),
                (&mut values.limits, &mut gradients.limits),
            );
        }
        (values, gradients)
    }
}

/// Adds the largest of some functions at `y`, linearised there, as it is at `x`: not more than what is largest at `x`, where the
/// functions are known.
fn add_largest(
    (x, y): (&[f64], &[f64]),
    (values, slopes): (&[f64], &[Vec<f64>]),
    (known, rows): (&mut Vec<f64>, &mut Vec<Vec<f64>>),
) {
    let largest = (0..values.len()).max_by(|a, b| values[*a].total_cmp(&values[*b]));
    let Some(k) = largest else {
        return;
    };
    let moves = x.iter().zip(y).zip(&slopes[k]);
    let back: f64 = moves.map(|((to, from), d)| (to - from) * d).sum();
    known.push((values[k] + back).min(largest_value(known)));
    rows.push(slopes[k].clone());
}
