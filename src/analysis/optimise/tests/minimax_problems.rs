//! Minimax problems and quadratic programmes with known answers.

use super::*;

/// The best linear approximation of eˣ on 0 to 1 in the maximum norm, whose slope is e - 1; once with its value at 0
/// constrained.
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
    fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: self.errors(x),
            limits: self.limit.iter().map(|l| x[0] * x[0] - l * l).collect(),
        })
    }
    fn gradients_at(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let rows = (0..=1000).flat_map(|k| {
            let t = k as f64 / 1000.0;
            [vec![1.0, t], vec![-1.0, -t]]
        });
        let peak_gradients = minimax::PeakGradients {
            peaks: rows.collect(),
            limits: self.limit.iter().map(|_| vec![2.0 * x[0], 0.0]).collect(),
            bend: None,
        };
        Some((self.values_at(x)?, peak_gradients))
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

/// The error of a point, and its derivatives.
type PointError = (f64, [f64; 3]);

/// The fourth-order norm of the errors of a curve through points, with or without its known curvature.
struct CurveNorm {
    is_bent: bool,
}

impl CurveNorm {
    /// The errors of all points.
    fn errors(x: &[f64]) -> Vec<PointError> {
        let of_point = |k: i32| {
            let t = 0.1 * f64::from(k);
            let wave = (x[1] * t + x[2]).sin();
            let slope = x[0] * (x[1] * t + x[2]).cos();
            (
                x[0] * wave - 2.0 * (1.3 * t - 0.4).sin() - 0.1 * (7.0 * t).cos(),
                [wave, slope * t, slope],
            )
        };
        (0..40).map(of_point).collect()
    }

    fn norm(x: &[f64]) -> f64 {
        let sum: f64 = Self::errors(x).iter().map(|(e, _)| e.powi(4)).sum();
        sum.sqrt().sqrt()
    }
}

impl minimax::MinimaxProblem for CurveNorm {
    fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: vec![Self::norm(x)],
            limits: Vec::new(),
        })
    }
    fn gradients_at(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let (errors, norm) = (Self::errors(x), Self::norm(x));
        let sum = |term: &dyn Fn(&PointError) -> f64| errors.iter().map(term).sum::<f64>();
        let slope = |i: usize| sum(&|(e, d)| (e / norm).powi(3) * d[i]);
        let slopes = [0, 1, 2].map(slope);
        let entry = |i: usize, j: usize| {
            let own = sum(&|(e, d)| (e / norm).powi(2) * d[i] * d[j]);
            3.0 / norm * (own - slopes[i] * slopes[j])
        };
        let bend = (0..3).map(|i| (0..3).map(|j| entry(i, j)).collect());
        let gradients = minimax::PeakGradients {
            peaks: vec![slopes.to_vec()],
            limits: Vec::new(),
            bend: self.is_bent.then(|| bend.collect()),
        };
        Some((self.values_at(x)?, gradients))
    }
}

/// Known curvature leads to the same minimum in fewer steps.
#[test]
fn minimax_uses_known_curvature() {
    let search = minimax::MinimaxSearch {
        radius: 0.1,
        smallest_radius: 1e-10,
        tolerance: 1e-12,
        iterations: 200,
    };
    let [plain, bent] = [false, true].map(|is_bent| {
        minimax::minimise_largest(
            &mut CurveNorm { is_bent },
            &[1.0, 1.0, 0.0],
            &[1.0; 3],
            &VariableBounds::none(3),
            search,
        )
    });
    near(&bent.x, &plain.x, 1e-5);
    assert!(
        (bent.value - plain.value).abs() < 1e-9,
        "{bent:?} {plain:?}"
    );
    assert!(bent.iterations < plain.iterations, "{bent:?} {plain:?}");
}

/// A few smooth functions without limits, with their gradients by central differences of the same formulas.
struct Few<F>(F);

impl<F: Fn(&[f64]) -> Vec<f64>> minimax::MinimaxProblem for Few<F> {
    fn values_at(&mut self, x: &[f64]) -> Option<minimax::PeakValues> {
        Some(minimax::PeakValues {
            peaks: (self.0)(x),
            limits: Vec::new(),
        })
    }
    fn gradients_at(&mut self, x: &[f64]) -> Option<(minimax::PeakValues, minimax::PeakGradients)> {
        let peak_values = self.values_at(x)?;
        let mut peaks = vec![vec![0.0; x.len()]; peak_values.peaks.len()];
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
        let gradients = minimax::PeakGradients {
            peaks,
            limits,
            bend: None,
        };
        Some((peak_values, gradients))
    }
}

/// Problems of Charalambous and Conn, and of Rosen and Suzuki, with their published optima. In two of them fewer
/// functions are active than there are variables, so that only curvature determines the solution.
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

/// The optimality conditions of a convex programme: the point satisfies all rows, and its gradient is balanced by those
/// of the active rows.
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
        let programme = quadratic::QuadraticProgramme {
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
