//! The simplex search of Nelder and Mead (Computer Journal 7, 1965) in the form of Lagarias et al. (SIAM J. Optim. 9,
//! 1998): no derivatives, any dimension up to a dozen or so.

use super::{Minimum, Objective, StopReason, VariableBounds};
use crate::sorting::sort_by_number;

const REFLECTION: f64 = 1.0;
const EXPANSION: f64 = 2.0;
const CONTRACTION: f64 = 0.5;
const SHRINKAGE: f64 = 0.5;

/// First simplex: every coordinate in turn changed by this share of it.
const FIRST_STEP: f64 = 0.05;

/// The least first change of a coordinate, as a share of its scale: what one that is zero changes by.
const LEAST_FIRST_STEP: f64 = 0.00025;

/// The stopping criteria.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NelderMeadLimits {
    /// Largest distance of a corner from the best one, along any coordinate, as a share of its scale.
    pub x_tolerance: f64,
    /// Largest difference of a corner's value from the best one, as a share of the largest difference in any simplex so far: this
    /// depends neither on the unit of the values nor on what is added to them.
    pub value_tolerance: f64,
    /// Most values asked for.
    pub evaluations: usize,
}

/// Searches from `start`; `scales` are typical sizes of the variables. Points outside the bounds are moved to their edge.
pub fn minimise_nelder_mead(
    objective: &mut dyn Objective,
    start: &[f64],
    scales: &[f64],
    bounds: &VariableBounds,
    limits: NelderMeadLimits,
) -> Minimum {
    let mut search = SimplexSearch {
        objective,
        bounds,
        scales,
        evaluations: 0,
        widest: 0.0,
    };
    let mut simplex = search.first_simplex(start);
    // Making the first simplex is counted as an iteration, as others do.
    let mut iterations = 1;
    let ended = loop {
        sort_by_number(&mut simplex, |a| a.1);
        if search.is_small(&simplex, limits) {
            break StopReason::Converged;
        }
        if search.evaluations >= limits.evaluations {
            break StopReason::OutOfBudget;
        }
        iterations += 1;
        search.improve_simplex(&mut simplex);
        let best = simplex.iter().min_by(|a, b| a.1.total_cmp(&b.1));
        if let Some((x, value)) = best
            && !search.objective.progress(iterations, x, *value)
        {
            break StopReason::Stopped;
        }
    };
    sort_by_number(&mut simplex, |a| a.1);
    let evaluations = search.evaluations;
    let (x, value) = simplex.swap_remove(0);
    Minimum {
        x,
        value,
        iterations,
        evaluations,
        gradients: 0,
        ended,
    }
}

type SimplexCorner = (Vec<f64>, f64);

struct SimplexSearch<'a> {
    objective: &'a mut dyn Objective,
    bounds: &'a VariableBounds,
    scales: &'a [f64],
    evaluations: usize,
    /// The largest difference of two values in a simplex.
    widest: f64,
}

impl SimplexSearch<'_> {
    /// Whether the corners of a sorted simplex, and their values, are as near to each other as asked.
    fn is_small(&mut self, simplex: &[SimplexCorner], limits: NelderMeadLimits) -> bool {
        let (best, value) = &simplex[0];
        let apart = simplex.iter().map(|(_, v)| (v - value).abs());
        let spread = apart.filter(|v| v.is_finite()).fold(0.0, f64::max);
        self.widest = self.widest.max(spread);
        simplex[1..].iter().all(|(corner, v)| {
            let mut coordinates = corner.iter().zip(best).zip(self.scales);
            let is_near = coordinates.all(|((a, b), s)| (a - b).abs() <= limits.x_tolerance * s);
            (v - value).abs() <= limits.value_tolerance * self.widest && is_near
        })
    }

    fn corner(&mut self, mut x: Vec<f64>) -> SimplexCorner {
        self.bounds.clamp(&mut x);
        self.evaluations += 1;
        let value = self.objective.value(&x);
        (x, if value.is_nan() { f64::INFINITY } else { value })
    }

    fn first_simplex(&mut self, start: &[f64]) -> Vec<SimplexCorner> {
        let mut simplex = vec![self.corner(start.to_vec())];
        for k in 0..start.len() {
            let mut x = start.to_vec();
            let step = (FIRST_STEP * x[k].abs()).max(LEAST_FIRST_STEP * self.scales[k]);
            let step = step.copysign(x[k]);
            // A vertex on the edge of the box would flatten the simplex: step inwards instead.
            let outside = x[k] + step > self.bounds.upper[k] || x[k] + step < self.bounds.lower[k];
            x[k] += if outside { -step } else { step };
            simplex.push(self.corner(x));
        }
        simplex
    }

    /// One reflection, expansion, contraction or shrinkage of a sorted simplex.
    fn improve_simplex(&mut self, simplex: &mut [SimplexCorner]) {
        let last = simplex.len() - 1;
        let count = last as f64;
        // The centroid of all vertices but the worst.
        let centre: Vec<f64> = (0..last)
            .map(|k| simplex[..last].iter().map(|(x, _)| x[k]).sum::<f64>() / count)
            .collect();
        let worst = simplex[last].clone();
        let along = |share: f64| -> Vec<f64> {
            let pairs = centre.iter().zip(&worst.0);
            pairs.map(|(c, w)| c + share * (c - w)).collect()
        };
        // Reflect the worst vertex, and expand if the result is the best of all.
        let reflected = self.corner(along(REFLECTION));
        if reflected.1 < simplex[0].1 {
            let expanded = self.corner(along(REFLECTION * EXPANSION));
            simplex[last] = if expanded.1 < reflected.1 {
                expanded
            } else {
                reflected
            };
            return;
        }
        if reflected.1 < simplex[last - 1].1 {
            simplex[last] = reflected;
            return;
        }
        // Contract outside or inside.
        let outside = reflected.1 < worst.1;
        let share = if outside { CONTRACTION } else { -CONTRACTION };
        let contracted = self.corner(along(share));
        let accepted = if outside {
            contracted.1 <= reflected.1
        } else {
            contracted.1 < worst.1
        };
        if accepted {
            simplex[last] = contracted;
            return;
        }
        // No success: shrink towards the best vertex.
        let best = simplex[0].0.clone();
        for corner in &mut simplex[1..] {
            let pairs = best.iter().zip(&corner.0);
            let x = pairs.map(|(b, c)| b + SHRINKAGE * (c - b)).collect();
            *corner = self.corner(x);
        }
    }
}
