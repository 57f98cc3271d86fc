//! Standard functions with known minima.

#![allow(clippy::panic)]

mod minimax_problems;

use super::constraints::{self, Constrained};
use super::*;

/// A function with its gradient, and how often each was asked for.
struct Function<F, G> {
    value: F,
    gradient: G,
    calls: usize,
}

impl<F: Fn(&[f64]) -> f64, G: Fn(&[f64]) -> Vec<f64>> Objective for Function<F, G> {
    fn value(&mut self, x: &[f64]) -> f64 {
        self.calls += 1;
        (self.value)(x)
    }
    fn gradient(&mut self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        self.calls += 1;
        Some(((self.value)(x), (self.gradient)(x)))
    }
}

fn rosenbrock() -> impl Objective {
    Function {
        value: |x: &[f64]| 100.0 * (x[1] - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2),
        gradient: |x: &[f64]| {
            let steep = 200.0 * (x[1] - x[0] * x[0]);
            vec![-2.0 * x[0] * steep - 2.0 * (1.0 - x[0]), steep]
        },
        calls: 0,
    }
}

fn near(found: &[f64], wanted: &[f64], tolerance: f64) {
    for (a, b) in found.iter().zip(wanted) {
        assert!((a - b).abs() <= tolerance, "{found:?} {wanted:?}");
    }
}

/// 85 iterations and 159 evaluations are what the common implementation of the same rules documents for this start.
#[test]
fn the_simplex_search_follows_the_published_rules() {
    let limits = nelder_mead::NelderMeadLimits {
        x_tolerance: 1e-4,
        value_tolerance: 1e-4,
        evaluations: 1000,
    };
    let found = nelder_mead::minimise_nelder_mead(
        &mut rosenbrock(),
        &[-1.2, 1.0],
        &VariableBounds::none(2),
        limits,
    );
    near(&found.x, &[1.0, 1.0], 1e-4);
    assert_eq!((found.iterations, found.evaluations), (85, 159));
    assert_eq!(found.ended, StopReason::Converged);
}

#[test]
fn bfgs_finds_the_valley_to_rounding() {
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-13,
        iterations: 200,
        first_step: 0.1,
    };
    let start = [-1.2, 1.0];
    let found = bfgs::minimise_bfgs(
        &mut rosenbrock(),
        &start,
        &[1.0, 1.0],
        &VariableBounds::none(2),
        limits,
    );
    near(&found.x, &[1.0, 1.0], 1e-9);
    assert!(found.evaluations < 80, "{found:?}");
    // The same in other units.
    let mut scaled = Function {
        value: |x: &[f64]| {
            1e6 * (100.0 * (x[1] / 1e3 - x[0] * x[0]).powi(2) + (1.0 - x[0]).powi(2))
        },
        gradient: |x: &[f64]| {
            let steep = 200.0 * (x[1] / 1e3 - x[0] * x[0]);
            vec![
                1e6 * (-2.0 * x[0] * steep - 2.0 * (1.0 - x[0])),
                1e3 * steep,
            ]
        },
        calls: 0,
    };
    let other = bfgs::minimise_bfgs(
        &mut scaled,
        &[-1.2, 1e3],
        &[1.0, 1e3],
        &VariableBounds::none(2),
        limits,
    );
    near(&other.x, &[1.0, 1e3], 1e-5);
}

#[test]
fn bounds_hold_and_are_left_again() {
    let bounds = VariableBounds {
        lower: vec![-2.0, -2.0],
        upper: vec![0.5, 2.0],
    };
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-12,
        iterations: 200,
        first_step: 0.1,
    };
    let found = bfgs::minimise_bfgs(
        &mut rosenbrock(),
        &[-1.2, 1.0],
        &[1.0, 1.0],
        &bounds,
        limits,
    );
    near(&found.x, &[0.5, 0.25], 1e-8);
    let simplex = nelder_mead::NelderMeadLimits {
        x_tolerance: 1e-9,
        value_tolerance: 1e-12,
        evaluations: 2000,
    };
    let found =
        nelder_mead::minimise_nelder_mead(&mut rosenbrock(), &[-1.2, 1.0], &bounds, simplex);
    near(&found.x, &[0.5, 0.25], 1e-6);
    // From a corner of the box to the inside.
    let wide = VariableBounds {
        lower: vec![-2.0, -1.0],
        upper: vec![2.0, 2.0],
    };
    let found = bfgs::minimise_bfgs(&mut rosenbrock(), &[-2.0, -1.0], &[1.0, 1.0], &wide, limits);
    near(&found.x, &[1.0, 1.0], 1e-8);
}

#[test]
fn evolution_finds_the_deepest_of_many_valleys_and_repeats() {
    let rastrigin = || Function {
        value: |x: &[f64]| {
            let wave = |x: &f64| x * x + 10.0 * (1.0 - (std::f64::consts::TAU * x).cos());
            x.iter().map(wave).sum::<f64>()
        },
        gradient: |_: &[f64]| Vec::new(),
        calls: 0,
    };
    let bounds = VariableBounds {
        lower: vec![-5.0; 4],
        upper: vec![5.1; 4],
    };
    let limits = evolution::EvolutionLimits {
        members: 60,
        generations: 600,
        seed: 3,
        value_tolerance: 1e-9,
    };
    let found = evolution::minimise_by_evolution(&mut rastrigin(), &[4.5; 4], &bounds, limits);
    near(&found.x, &[0.0; 4], 1e-4);
    assert_eq!(
        found,
        evolution::minimise_by_evolution(&mut rastrigin(), &[4.5; 4], &bounds, limits)
    );
}

/// The least x + y in a disc of radius √2, and on a half-plane that does not matter.
struct Disc;

impl Constrained for Disc {
    fn values(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        Some(vec![
            x[0] + x[1],
            x[0] * x[0] + x[1] * x[1] - 2.0,
            x[0] - 5.0,
        ])
    }
    fn gradients(&mut self, x: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let rows = vec![vec![1.0, 1.0], vec![2.0 * x[0], 2.0 * x[1]], vec![1.0, 0.0]];
        Some((self.values(x)?, rows))
    }
    fn progress(&mut self, _: usize, _: &[f64], _: f64) -> bool {
        true
    }
}

#[test]
fn constraints_hold_at_the_minimum() {
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-10,
        iterations: 200,
        first_step: 0.1,
    };
    let bounds = VariableBounds::none(2);
    let mut run =
        |f: &mut dyn Objective, x: &[f64]| bfgs::minimise_bfgs(f, x, &[1.0, 1.0], &bounds, limits);
    let found =
        constraints::minimise_constrained(&mut Disc, &[0.5, 0.3], &[1.0, 1.0], 1e-9, &mut run);
    near(&found.x, &[-1.0, -1.0], 1e-7);
    let simplex = nelder_mead::NelderMeadLimits {
        x_tolerance: 1e-9,
        value_tolerance: 1e-12,
        evaluations: 5000,
    };
    let mut run = |f: &mut dyn Objective, x: &[f64]| {
        nelder_mead::minimise_nelder_mead(f, x, &bounds, simplex)
    };
    let found =
        constraints::minimise_constrained(&mut Disc, &[0.5, 0.3], &[1.0, 1.0], 1e-7, &mut run);
    near(&found.x, &[-1.0, -1.0], 1e-4);
}

#[test]
fn refused_points_are_walked_around() {
    let mut guarded = Function {
        value: |x: &[f64]| {
            if x[0] < 0.0 {
                f64::INFINITY
            } else {
                (x[0] - 0.25).powi(2) + x[1] * x[1]
            }
        },
        gradient: |x: &[f64]| vec![2.0 * (x[0] - 0.25), 2.0 * x[1]],
        calls: 0,
    };
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-12,
        iterations: 100,
        first_step: 10.0,
    };
    let found = bfgs::minimise_bfgs(
        &mut guarded,
        &[3.0, 1.0],
        &[1.0, 1.0],
        &VariableBounds::none(2),
        limits,
    );
    near(&found.x, &[0.25, 0.0], 1e-8);
}
