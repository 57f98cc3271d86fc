//! Inequality constraints by the augmented Lagrangian (Nocedal and Wright, Numerical Optimization, 2nd ed., chapter
//! 17): a few minimisations of a penalised function with updated multipliers, so that the weights stay moderate.

use super::kept::BestKept;
use super::{Minimum, Objective, StopReason};

/// An objective and functions that must not be positive.
pub trait Constrained {
    /// The value, then every constraint; `None` if `x` is rejected.
    fn values(&mut self, x: &[f64]) -> Option<Vec<f64>>;

    /// The same with a gradient each.
    fn gradients(&mut self, x: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)>;

    /// Called after every iteration with the value without penalties; `false` ends the search.
    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool;
}

/// Most searches.
const ROUNDS: usize = 12;

/// First weight of a squared violation, relative to the first value of the function and the constraints' scale.
const FIRST_WEIGHT: f64 = 10.0;

/// Factor on the weight after a round that did not reduce the violation enough.
const HEAVIER: f64 = 8.0;

/// What counts as enough.
const LESSENED: f64 = 0.25;

/// The function with its penalties.
struct Penalised<'a> {
    inner: &'a mut dyn Constrained,
    multipliers: Vec<f64>,
    weight: f64,
    /// Typical size of each constraint.
    scales: Vec<f64>,
    /// The best candidate that keeps the constraints.
    kept: BestKept,
    /// Iterations of earlier rounds.
    before: usize,
    stopped: bool,
}

impl Penalised<'_> {
    /// Active part of constraint `k` and its penalty.
    fn penalty(&self, k: usize, g: f64) -> (f64, f64) {
        let (g, multiplier) = (g / self.scales[k], self.multipliers[k]);
        let active = (multiplier + self.weight * g).max(0.0);
        let penalty = (active * active - multiplier * multiplier) / (2.0 * self.weight);
        (active / self.scales[k], penalty)
    }

    /// The largest violation among the function and its constraints, in the constraints' scales.
    fn violation(&self, values: &[f64]) -> f64 {
        let scaled = values[1..].iter().zip(&self.scales).map(|(g, s)| g / s);
        scaled.fold(
            0.0,
            |worst, g| if g > worst || g.is_nan() { g } else { worst },
        )
    }

    /// Remembers a candidate that keeps the constraints.
    fn offer(&mut self, x: &[f64], values: &[f64]) {
        self.kept.offer(x, values[0], self.violation(values));
    }

    /// The values at a point without penalties.
    fn plain_values(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        let values = self.inner.values(x)?;
        self.offer(x, &values);
        Some(values)
    }
}

impl Objective for Penalised<'_> {
    fn value(&mut self, x: &[f64]) -> f64 {
        let Some(values) = self.plain_values(x) else {
            return f64::INFINITY;
        };
        let penalties = values[1..]
            .iter()
            .enumerate()
            .map(|(k, g)| self.penalty(k, *g).1);
        values[0] + penalties.sum::<f64>()
    }

    fn gradient(&mut self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (values, rows) = self.inner.gradients(x)?;
        self.offer(x, &values);
        let (mut value, mut gradient) = (values[0], rows[0].clone());
        for (k, (g, row)) in values[1..].iter().zip(&rows[1..]).enumerate() {
            // Augmented Lagrangian: only the active part of a constraint has a gradient.
            let (active, penalty) = self.penalty(k, *g);
            value += penalty;
            gradient
                .iter_mut()
                .zip(row)
                .for_each(|(sum, d)| *sum += active * d);
        }
        Some((value, gradient))
    }

    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool {
        let on = self.inner.progress(self.before + iteration, x, value);
        self.stopped |= !on;
        on
    }
}

/// Minimises under constraints by repeated calls of `run`, which minimises without constraints.
///
/// `tolerance` is the accepted violation, in the constraints' own `scales`. The value of the minimum is that of the
/// function without penalties. If the search ends at a point that violates constraints although some candidate, the start
/// among them, keeps them all, the best such candidate is the minimum.
pub fn minimise_constrained(
    inner: &mut dyn Constrained,
    start: &[f64],
    scales: &[f64],
    tolerance: f64,
    run: &mut dyn FnMut(&mut dyn Objective, &[f64]) -> Minimum,
) -> Minimum {
    let mut penalised = Penalised {
        inner,
        multipliers: vec![0.0; scales.len()],
        weight: 0.0,
        scales: scales.to_vec(),
        kept: BestKept::within(tolerance),
        before: 0,
        stopped: false,
    };
    // The initial penalty is as large as the objective.
    let first = penalised.plain_values(start).map_or(1.0, |v| v[0].abs());
    penalised.weight = FIRST_WEIGHT * first.max(f64::MIN_POSITIVE);
    let mut total = run(&mut penalised, start);
    let mut worst = f64::INFINITY;
    for _ in 1..ROUNDS {
        let Some(values) = penalised.plain_values(&total.x) else {
            break;
        };
        total.value = values[0];
        let scaled: Vec<f64> = values[1..].iter().zip(scales).map(|(g, s)| g / s).collect();
        let violation = penalised.violation(&values);
        let idle = penalised
            .multipliers
            .iter()
            .zip(&scaled)
            .all(|(m, g)| *m == 0.0 && *g <= 0.0);
        if scales.is_empty() || idle || penalised.stopped {
            break;
        }
        // First-order update of the multipliers; it settles when they stop changing.
        let settled = (0..scales.len()).all(|k| {
            let next = (penalised.multipliers[k] + penalised.weight * scaled[k]).max(0.0);
            let change = (next - penalised.multipliers[k]).abs();
            penalised.multipliers[k] = next;
            change <= tolerance * (penalised.weight + next.abs())
        });
        if violation <= tolerance && settled {
            break;
        }
        // A violation that does not decrease needs a larger weight.
        if violation > LESSENED * worst {
            penalised.weight *= HEAVIER;
        }
        // An objective that is about zero at the start has its size elsewhere.
        if violation > tolerance {
            penalised.weight = penalised.weight.max(FIRST_WEIGHT * values[0].abs());
        }
        worst = worst.min(violation);
        penalised.before = total.iterations;
        let next = run(&mut penalised, &total.x);
        total = Minimum {
            iterations: total.iterations + next.iterations,
            evaluations: total.evaluations + next.evaluations,
            gradients: total.gradients + next.gradients,
            ..next
        };
    }
    let mut violation = f64::NAN;
    if let Some(values) = penalised.plain_values(&total.x) {
        (total.value, violation) = (values[0], penalised.violation(&values));
    }
    let kept = std::mem::replace(&mut penalised.kept, BestKept::within(tolerance));
    if let Some((x, value)) = kept.instead_of(violation) {
        (total.x, total.value) = (x, value);
    }
    if penalised.stopped {
        total.ended = StopReason::Stopped;
    }
    total
}
