//! Differential evolution (Storn and Price, J. Global Optimization 11, 1997) within a box: finds the best of several
//! valleys. Random numbers depend only on the seed, the generation and the member.

use super::{Minimum, Objective, StopReason, VariableBounds};
use crate::analysis::random::Random;

/// Factor on an added difference, drawn for every trial between these.
const DIFFERENCE: [f64; 2] = [0.4, 0.95];

/// Share of the coordinates taken from the new point.
const CROSSOVER: f64 = 0.85;

/// How large the search is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvolutionLimits {
    /// Members of a generation.
    pub members: usize,
    /// Generations.
    pub generations: usize,
    /// Where random numbers start.
    pub seed: u64,
    /// The search ends when the values of all members agree to this fraction.
    pub value_tolerance: f64,
}

/// Searches the box, which must be finite; `start` is one of the first members.
pub fn minimise_by_evolution(
    objective: &mut dyn Objective,
    start: &[f64],
    bounds: &VariableBounds,
    limits: EvolutionLimits,
) -> Minimum {
    let n = start.len();
    let mut evaluations = 0;
    let mut value = |objective: &mut dyn Objective, x: &[f64]| {
        evaluations += 1;
        let value = objective.value(x);
        if value.is_nan() { f64::INFINITY } else { value }
    };
    // First generation: the start, and draws from the box. Every member has a stream of its own.
    let members = limits.members.max(4);
    let mut population: Vec<(Vec<f64>, f64)> = Vec::with_capacity(members);
    for member in 0..members {
        let mut random = Random::new(limits.seed, 0, member as u64);
        let within =
            |k: usize, share: f64| bounds.lower[k] + share * (bounds.upper[k] - bounds.lower[k]);
        let x: Vec<f64> = if member == 0 {
            start.to_vec()
        } else {
            (0..n).map(|k| within(k, random.unit())).collect()
        };
        let v = value(objective, &x);
        population.push((x, v));
    }
    let mut ended = StopReason::OutOfBudget;
    let mut made = 0;
    // Each member is compared with one trial point, and the better one stays.
    for generation in 1..=limits.generations {
        made = generation;
        let best = best_of(&population);
        for member in 0..members {
            let mut random = Random::new(limits.seed, generation as u64, member as u64);
            let x = trial_point(&population, member, best, bounds, &mut random);
            let v = value(objective, &x);
            if v <= population[member].1 {
                population[member] = (x, v);
            }
        }
        let best = &population[best_of(&population)];
        if !objective.progress(generation, &best.0, best.1) {
            ended = StopReason::Stopped;
            break;
        }
        // Converged when all members are equally good.
        let worst = population
            .iter()
            .fold(f64::NEG_INFINITY, |m, (_, v)| m.max(*v));
        if worst - best.1 <= limits.value_tolerance * best.1.abs() {
            ended = StopReason::Converged;
            break;
        }
    }
    let best = best_of(&population);
    let (x, value) = population.swap_remove(best);
    Minimum {
        x,
        value,
        iterations: made,
        evaluations,
        gradients: 0,
        ended,
    }
}

fn best_of(population: &[(Vec<f64>, f64)]) -> usize {
    let by_value = |a: &usize, b: &usize| population[*a].1.total_cmp(&population[*b].1);
    (0..population.len()).min_by(by_value).unwrap_or(0)
}

/// Half of the trials start from the best member, half from a random one.
fn trial_point(
    population: &[(Vec<f64>, f64)],
    member: usize,
    best: usize,
    bounds: &VariableBounds,
    random: &mut Random,
) -> Vec<f64> {
    let (count, n) = (population.len(), population[member].0.len());
    let mut other = || loop {
        let index = (random.unit() * count as f64) as usize;
        if index != member && index < count {
            return index;
        }
    };
    // Three other members: a base, and a difference to add to it.
    let (a, b, c) = (other(), other(), other());
    let base = if random.unit() < 0.5 { best } else { a };
    let factor = DIFFERENCE[0] + (DIFFERENCE[1] - DIFFERENCE[0]) * random.unit();
    // Crossover; one variable at least changes.
    let forced = ((random.unit() * n as f64) as usize).min(n - 1);
    let mut x = population[member].0.clone();
    for (k, x) in x.iter_mut().enumerate() {
        if k == forced || random.unit() < CROSSOVER {
            let (low, high) = (bounds.lower[k], bounds.upper[k]);
            let difference = population[b].0[k] - population[c].0[k];
            let moved = population[base].0[k] + factor * difference;
            // Outside the box: between the old value and the bound, so that members do not collect at the bounds.
            *x = if moved < low {
                low + random.unit() * (*x - low)
            } else if moved > high {
                high - random.unit() * (high - *x)
            } else {
                moved
            };
        }
    }
    x
}
