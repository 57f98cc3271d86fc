//! A step of the minimax search: the quadratic programme of the linearised functions within the trust region.

use super::VariableBounds;
use super::curvature::Curvature;
use super::minimax_problem::{PeakGradients, PeakValues, TrustEdge, largest_value, merit_value};
use super::quadratic::QuadraticProgramme;
use nalgebra::{DMatrix, DVector};
use std::collections::VecDeque;

/// Curvature added in directions without any, relative to what would matter within the region: it keeps the programmes
/// solvable and has no other effect.
const STIFFNESS: f64 = 1e-9;

/// Least unit of a programme, as a share of the largest change within the region.
const LEAST_UNIT: f64 = 1e-6;

/// The unit of a programme's values: the merit, but at least a fraction of the largest change within the region.
pub(super) fn trust_unit(
    merit: f64,
    peak_gradients: &PeakGradients,
    scales: &[f64],
    radius: f64,
) -> f64 {
    let floor = LEAST_UNIT * largest_change(peak_gradients, scales, radius);
    merit.abs().max(floor).max(f64::MIN_POSITIVE)
}

/// The size of the values of a search: the first one, or, where it is about zero, the largest change within the first region.
pub(super) fn first_unit(
    merit: f64,
    peak_gradients: &PeakGradients,
    scales: &[f64],
    radius: f64,
) -> f64 {
    let change = largest_change(peak_gradients, scales, radius);
    let unit = match merit.abs() < LEAST_UNIT * change {
        true => change,
        false => merit.abs(),
    };
    unit.max(f64::MIN_POSITIVE)
}

fn largest_change(peak_gradients: &PeakGradients, scales: &[f64], radius: f64) -> f64 {
    let rows = peak_gradients.peaks.iter();
    rows.map(|row| row_reach(row, scales, radius))
        .fold(0.0, f64::max)
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
pub(super) struct MinimaxPoint<'a> {
    pub x: &'a [f64],
    pub gradients: &'a PeakGradients,
    pub edges: &'a VecDeque<TrustEdge>,
    pub curvature: &'a Curvature,
    pub scales: &'a [f64],
    pub bounds: &'a VariableBounds,
    pub weight: f64,
    /// Merit of the point, the unit of the programmes.
    pub unit: f64,
}

/// The best point of a programme.
pub(super) struct MinimaxStep {
    pub x: Vec<f64>,
    /// Its merit as predicted by the programme.
    pub merit: f64,
    /// The multiplier of each active peak and constraint, as (index, multiplier).
    pub peaks: Vec<(usize, f64)>,
    pub limits: Vec<(usize, f64)>,
}

impl MinimaxStep {
    /// Gradient of the Lagrangian in scaled variables.
    pub fn lagrangian_gradient(
        &self,
        peak_gradients: &PeakGradients,
        scales: &[f64],
    ) -> DVector<f64> {
        let mut sum = DVector::zeros(scales.len());
        let held = |list: &[(usize, f64)], rows: &[Vec<f64>], sum: &mut DVector<f64>| {
            for (index, multiplier) in list {
                for (k, d) in rows[*index].iter().enumerate() {
                    sum[k] += multiplier * d * scales[k];
                }
            }
        };
        held(&self.peaks, &peak_gradients.peaks, &mut sum);
        held(&self.limits, &peak_gradients.limits, &mut sum);
        sum
    }
}

impl MinimaxPoint<'_> {
    /// Values at `there` minus the first-order prediction: added to the linearised functions, they make them exact at
    /// `there` (second-order correction).
    pub fn corrected_values(&self, next: &[f64], there: &PeakValues) -> PeakValues {
        let less = |values: &[f64], peak_gradients: &[Vec<f64>]| -> Vec<f64> {
            let pairs = values.iter().zip(peak_gradients);
            pairs.map(|(v, row)| v - self.along(next, row)).collect()
        };
        PeakValues {
            peaks: less(&there.peaks, &self.gradients.peaks),
            limits: less(&there.limits, &self.gradients.limits),
        }
    }

    fn along(&self, next: &[f64], row: &[f64]) -> f64 {
        let moves = next.iter().zip(self.x).zip(row);
        moves.map(|((to, from), d)| (to - from) * d).sum()
    }

    /// Rows that can be active within the region: peaks that can become the largest, constraints that can be violated.
    fn relevant_rows(&self, peak_values: &PeakValues, radius: f64) -> [Vec<usize>; 2] {
        let lowest = |k: usize| {
            peak_values.peaks[k] - row_reach(&self.gradients.peaks[k], self.scales, radius)
        };
        let floor = (0..peak_values.peaks.len())
            .map(lowest)
            .fold(f64::NEG_INFINITY, f64::max);
        // By first-order change: rows that cannot reach the level within the region are omitted.
        let can_reach = |values: &[f64], rows: &[Vec<f64>], level: f64| -> Vec<usize> {
            (0..values.len())
                .filter(|k| values[*k] + row_reach(&rows[*k], self.scales, radius) >= level)
                .collect()
        };
        [
            can_reach(&peak_values.peaks, &self.gradients.peaks, floor),
            can_reach(&peak_values.limits, &self.gradients.limits, 0.0),
        ]
    }

    /// The best point within the region for the functions with these values, linearised and with the learnt curvature.
    ///
    /// The programme's variables are the steps in radii, the largest peak in units, and the worst violated constraint
    /// in units of its cost.
    pub fn step(&self, peak_values: &PeakValues, radius: f64) -> Option<MinimaxStep> {
        let n = self.x.len();
        let [peaks, limits] = self.relevant_rows(peak_values, radius);
        let count = peaks.len() + limits.len() + self.edges.len() + 1 + 2 * n;
        // Unknowns of the programme: the scaled step, the largest peak, the excess over the limits.
        let (top, excess) = (n, n + 1);
        let limit_unit = self.unit / self.weight;
        let mut rows = DMatrix::zeros(count, n + 2);
        let mut ends = DVector::zeros(count);
        let mut row = 0;
        let listed = peaks.iter().map(|k| {
            (
                peak_values.peaks[*k],
                &self.gradients.peaks[*k],
                self.unit,
                top,
            )
        });
        let listed = listed.chain(limits.iter().map(|k| {
            (
                peak_values.limits[*k],
                &self.gradients.limits[*k],
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
        let known = (&self.curvature.matrix + self.gradients.scaled_bend(self.scales))
            * (radius * radius / self.unit);
        bend.view_mut((0, 0), (n, n)).copy_from(&known);
        for k in 0..n + 2 {
            bend[(k, k)] += STIFFNESS;
        }
        let mut cost = DVector::zeros(n + 2);
        (cost[top], cost[excess]) = (1.0, 1.0);
        // A strictly feasible starting point.
        let mut start = DVector::zeros(n + 2);
        start[top] = largest_value(&peak_values.peaks) / self.unit + 0.1;
        start[excess] = largest_value(&peak_values.limits).max(0.0) / limit_unit + 0.1;
        let programme = QuadraticProgramme {
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
            merit: self.linearised_merit(peak_values, &next) + bending,
            x: next,
            peaks: held_peaks,
            limits: held_limits,
        })
    }

    /// Merit of the linearised functions.
    fn linearised_merit(&self, peak_values: &PeakValues, next: &[f64]) -> f64 {
        let moved = |values: &[f64], rows: &[Vec<f64>]| -> Vec<f64> {
            let pairs = values.iter().zip(rows);
            pairs.map(|(v, row)| v + self.along(next, row)).collect()
        };
        let there = PeakValues {
            peaks: moved(&peak_values.peaks, &self.gradients.peaks),
            limits: moved(&peak_values.limits, &self.gradients.limits),
        };
        merit_value(&there, self.weight)
    }
}
