//! Standard functions with known minima.

#![allow(clippy::panic)]

mod flat_starts;
mod kinks;
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
        &[1.0; 2],
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
    let found = nelder_mead::minimise_nelder_mead(
        &mut rosenbrock(),
        &[-1.2, 1.0],
        &[1.0; 2],
        &bounds,
        simplex,
    );
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
        nelder_mead::minimise_nelder_mead(f, x, &[1.0; 2], &bounds, simplex)
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

/// A parabola with its minimum beside the start, in other units of the variables and of the value, and with another zero of the value.
#[test]
fn the_simplex_search_is_the_same_in_all_units() {
    let search = |length: f64, size: f64, zero: f64| {
        let mut parabola = Function {
            value: |x: &[f64]| {
                let (a, b) = (x[0] / length - 47.0, x[1] / length);
                size * (zero + a * a + 3.0 * (b - 0.1 * a - 0.2).powi(2))
            },
            gradient: |_: &[f64]| Vec::new(),
            calls: 0,
        };
        let limits = nelder_mead::NelderMeadLimits {
            x_tolerance: 1e-6,
            value_tolerance: 1e-6,
            evaluations: 2000,
        };
        // Powers of two do not change the rounding.
        let (start, scales) = ([50.0 * length, 0.0], [50.0 * length, 8.0 * length]);
        let bounds = VariableBounds::none(2);
        nelder_mead::minimise_nelder_mead(&mut parabola, &start, &scales, &bounds, limits)
    };
    let plain = search(1.0, 1.0, 0.0);
    near(&plain.x, &[47.0, 0.2], 1e-3);
    for (length, size) in [
        (2.0_f64.powi(-20), 1.0),
        (1.0, 2.0_f64.powi(-40)),
        (1024.0, 2.0_f64.powi(30)),
    ] {
        let other = search(length, size, 0.0);
        assert_eq!(
            (other.ended, other.evaluations),
            (plain.ended, plain.evaluations),
            "{length} {size}"
        );
        near(&[other.x[0] / length, other.x[1] / length], &plain.x, 0.0);
    }
    let lifted = search(1.0, 1.0, 1024.0);
    assert_eq!(lifted.ended, StopReason::Converged);
    near(&lifted.x, &[47.0, 0.2], 1e-3);
}

/// The least x + y above the hyperbola xy = 1, from starts that keep the limit.
struct Hyperbola;

impl Constrained for Hyperbola {
    fn values(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        Some(vec![x[0] + x[1], 1.0 - x[0] * x[1]])
    }
    fn gradients(&mut self, x: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        Some((self.values(x)?, vec![vec![1.0; 2], vec![-x[1], -x[0]]]))
    }
    fn progress(&mut self, _: usize, _: &[f64], _: f64) -> bool {
        true
    }
}

/// However coarse a search is, and however early it ends, what it returns keeps the constraints if any candidate did.
#[test]
fn a_search_returns_what_keeps_the_constraints() {
    let bounds = VariableBounds {
        lower: vec![-5.0; 2],
        upper: vec![5.0; 2],
    };
    let scales = [3.0, 2.0];
    for (tolerance, count) in [
        (1e-9, 4000),
        (1e-4, 4000),
        (1e-2, 4000),
        (1e-9, 12),
        (1e-9, 3),
    ] {
        let simplex = nelder_mead::NelderMeadLimits {
            x_tolerance: tolerance,
            value_tolerance: tolerance,
            evaluations: count,
        };
        let newton = bfgs::BfgsLimits {
            gradient_tolerance: tolerance,
            iterations: count,
            first_step: 0.02,
        };
        let evolution = evolution::EvolutionLimits {
            members: 12,
            generations: count.min(100),
            seed: 1,
            value_tolerance: tolerance,
        };
        type Run<'a> = &'a mut dyn FnMut(&mut dyn Objective, &[f64]) -> Minimum;
        let runs: [(&str, Run); 3] = [
            ("simplex", &mut |f, x| {
                nelder_mead::minimise_nelder_mead(f, x, &scales, &bounds, simplex)
            }),
            ("bfgs", &mut |f, x| {
                bfgs::minimise_bfgs(f, x, &scales, &bounds, newton)
            }),
            ("evolution", &mut |f, x| {
                evolution::minimise_by_evolution(f, x, &bounds, evolution)
            }),
        ];
        for (name, run) in runs {
            let found = constraints::minimise_constrained(
                &mut Hyperbola,
                &[3.0, 2.0],
                &[1.0],
                LET_PASS,
                run,
            );
            let product = found.x[0] * found.x[1];
            assert!(
                product >= 1.0 - 10.0 * LET_PASS,
                "{name} {tolerance} {count}: {found:?}"
            );
            assert!(
                found.value <= 5.0 && (found.value - found.x[0] - found.x[1]).abs() < 1e-12,
                "{name} {found:?}"
            );
            if tolerance <= 1e-4 && count == 4000 {
                assert!(found.value < 2.001, "{name} {tolerance}: {found:?}");
            }
        }
    }
}

/// A value without a derivative is a value.
#[test]
fn a_start_without_derivatives_keeps_its_value() {
    struct Corner;
    impl Objective for Corner {
        fn value(&mut self, x: &[f64]) -> f64 {
            x[0].abs().sqrt() + 2.0
        }
        fn gradient(&mut self, _: &[f64]) -> Option<(f64, Vec<f64>)> {
            None
        }
    }
    impl minimax::MinimaxProblem for Corner {
        fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
            let peaks = vec![self.value(x)];
            Some(minimax::PeakValues {
                peaks,
                limits: Vec::new(),
            })
        }
        fn gradients_at(
            &mut self,
            _: &[f64],
        ) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
            None
        }
    }
    let limits = bfgs::BfgsLimits {
        gradient_tolerance: 1e-9,
        iterations: 9,
        first_step: 0.1,
    };
    let search = minimax::MinimaxSearch {
        radius: 0.1,
        smallest_radius: 1e-9,
        tolerance: 1e-9,
        iterations: 9,
    };
    let bounds = VariableBounds::none(1);
    let found = [
        bfgs::minimise_bfgs(&mut Corner, &[0.0], &[1.0], &bounds, limits),
        minimax::minimise_largest(&mut Corner, &[0.0], &[1.0], &bounds, search),
    ];
    for found in found {
        assert_eq!(
            (found.value, found.ended),
            (2.0, StopReason::Stalled),
            "{found:?}"
        );
    }
}
