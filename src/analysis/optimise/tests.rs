//! Standard functions with known minima.

#![allow(clippy::panic)]

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
    assert_eq!(found.ended, Ended::Converged);
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

/// The best straight line to eˣ on 0 to 1 under the largest error, whose slope is e - 1; once with its value at 0 limited.
struct Line {
    limit: Option<f64>,
}

impl Line {
    fn errors(&self, x: &[f64]) -> Vec<f64> {
        let at = |k: usize| k as f64 / 1000.0;
        let error = |k| x[0] + x[1] * at(k) - at(k).exp();
        (0..=1000).flat_map(|k| [error(k), -error(k)]).collect()
    }
}

impl minimax::MinimaxProblem for Line {
    fn heights(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: self.errors(x),
            limits: self.limit.iter().map(|l| x[0] * x[0] - l * l).collect(),
        })
    }
    fn slopes(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let rows = (0..=1000).flat_map(|k| {
            let t = k as f64 / 1000.0;
            [vec![1.0, t], vec![-1.0, -t]]
        });
        let slopes = minimax::PeakGradients {
            peaks: rows.collect(),
            limits: self.limit.iter().map(|_| vec![2.0 * x[0], 0.0]).collect(),
        };
        Some((self.heights(x)?, slopes))
    }
}

#[test]
fn minimax_finds_the_line_of_equal_errors() {
    let search = minimax::MinimaxSearch {
        radius: 0.1,
        smallest_radius: 1e-12,
        tolerance: 1e-12,
        iterations: 200,
    };
    let slope = std::f64::consts::E - 1.0;
    let error = (2.0 - std::f64::consts::E + slope * slope.ln()) / 2.0;
    let start = [0.0, 0.0];
    let found = minimax::minimise_largest(
        &mut Line { limit: None },
        &start,
        &[1.0; 2],
        &VariableBounds::none(2),
        search,
    );
    assert!(
        (found.value - error.abs()).abs() < 1e-6,
        "{found:?} {error}"
    );
    near(
        &found.x,
        &[1.0 + error.abs() - 2.0 * error.abs(), slope],
        2e-3,
    );
    // With |x0| at most 0.8 the error at 0 is 0.2.
    let mut limited = Line { limit: Some(0.8) };
    let found = minimax::minimise_largest(
        &mut limited,
        &start,
        &[1.0; 2],
        &VariableBounds::none(2),
        search,
    );
    assert!(
        (found.value - 0.2).abs() < 1e-9 && (found.x[0] - 0.8).abs() < 1e-9,
        "{found:?}"
    );
}

/// A few smooth functions without limits, with their gradients by central differences of the same formulas.
struct Few<F>(F);

impl<F: Fn(&[f64]) -> Vec<f64>> minimax::MinimaxProblem for Few<F> {
    fn heights(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: (self.0)(x),
            limits: Vec::new(),
        })
    }
    fn slopes(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let heights = self.heights(x)?;
        let mut peaks = vec![vec![0.0; x.len()]; heights.peaks.len()];
        for k in 0..x.len() {
            let at = |h: f64| {
                let mut moved = x.to_vec();
                moved[k] += h;
                (self.0)(&moved)
            };
            let (ahead, behind) = (at(1e-5), at(-1e-5));
            for (row, (a, b)) in peaks.iter_mut().zip(ahead.iter().zip(&behind)) {
                row[k] = (a - b) / 2e-5;
            }
        }
        let limits = Vec::new();
        Some((heights, minimax::PeakGradients { peaks, limits }))
    }
}

/// Problems of Charalambous and Conn, and of Rosen and Suzuki, with their published optima; two of them have fewer
/// functions at the top than variables, so that only curvature leads to the end.
#[test]
fn minimax_solves_the_standard_problems() {
    type Functions = fn(&[f64]) -> Vec<f64>;
    let cb2: Functions = |x| {
        vec![
            x[0].powi(2) + x[1].powi(4),
            (2.0 - x[0]).powi(2) + (2.0 - x[1]).powi(2),
            2.0 * (x[1] - x[0]).exp(),
        ]
    };
    let cb3: Functions = |x| {
        vec![
            x[0].powi(4) + x[1].powi(2),
            (2.0 - x[0]).powi(2) + (2.0 - x[1]).powi(2),
            2.0 * (x[1] - x[0]).exp(),
        ]
    };
    let rosen_suzuki: Functions = |x| {
        let [a, b, c, d] = [x[0], x[1], x[2], x[3]];
        let f = a * a + b * b + 2.0 * c * c + d * d - 5.0 * a - 5.0 * b - 21.0 * c + 7.0 * d;
        let limits = [
            a * a + b * b + c * c + d * d + a - b + c - d - 8.0,
            a * a + 2.0 * b * b + c * c + 2.0 * d * d - a - d - 10.0,
            2.0 * a * a + b * b + c * c + 2.0 * a - b - d - 5.0,
        ];
        let with = limits.map(|g| f + 10.0 * g);
        std::iter::once(f).chain(with).collect()
    };
    let cases: [(Functions, &[f64], f64, &[f64]); 3] = [
        (cb2, &[1.0, -0.1], 1.952_224_5, &[1.139_038, 0.899_560]),
        (cb3, &[2.0, 2.0], 2.0, &[1.0, 1.0]),
        (rosen_suzuki, &[0.0; 4], -44.0, &[0.0, 1.0, 2.0, -1.0]),
    ];
    let search = minimax::MinimaxSearch {
        radius: 0.5,
        smallest_radius: 1e-10,
        tolerance: 1e-12,
        iterations: 100,
    };
    for (functions, start, value, place) in cases {
        let n = start.len();
        let (scales, bounds) = (vec![1.0; n], VariableBounds::none(n));
        let found = minimax::minimise_largest(&mut Few(functions), start, &scales, &bounds, search);
        assert!((found.value - value).abs() < 1e-6, "{found:?} {value}");
        near(&found.x, place, 2e-4);
        assert!(found.evaluations < 60, "{found:?}");
    }
}

/// What makes a point the minimum of a convex programme: it keeps the rows, and its gradient is what the rows that hold
/// it push against.
#[test]
fn quadratic_programmes_meet_the_conditions_of_their_minimum() {
    use crate::analysis::random::Random;
    use nalgebra::{DMatrix, DVector};
    for item in 0..30 {
        let mut random = Random::new(5, 0, item);
        let (n, count) = (3 + item as usize % 10, 40);
        let factor = DMatrix::from_fn(n, n, |_, _| random.symmetric());
        // A third of them linear, a third of low rank.
        let bend = match item % 3 {
            0 => DMatrix::zeros(n, n),
            1 => factor.columns(0, 2) * factor.columns(0, 2).transpose(),
            _ => &factor * factor.transpose(),
        };
        let mut rows = DMatrix::from_fn(count, n, |_, _| random.symmetric());
        let mut ends = DVector::from_fn(count, |_, _| 0.2 + random.unit());
        for k in 0..2 * n {
            rows.row_mut(k).fill(0.0);
            rows[(k, k / 2)] = if k % 2 == 0 { 1.0 } else { -1.0 };
            ends[k] = 1.0;
        }
        let programme = quadratic::Programme {
            cost: DVector::from_fn(n, |_, _| random.symmetric()),
            bend,
            rows,
            ends,
        };
        let found = programme.solve(DVector::zeros(n));
        let found = found.unwrap_or_else(|| panic!("programme {item} is not solved"));
        let slack = &programme.ends - &programme.rows * &found.point;
        let gradient = &programme.bend * &found.point
            + &programme.cost
            + programme.rows.tr_mul(&found.multipliers);
        assert!(
            slack.min() > -1e-8 && found.multipliers.min() >= 0.0,
            "{item}"
        );
        assert!(gradient.amax() < 1e-8, "{item}: {gradient}");
        assert!(
            slack.component_mul(&found.multipliers).amax() < 1e-8,
            "{item}"
        );
    }
}
