//! Formal solutions: Kaucher vectors x with A x = b exactly, by the subdifferential Newton method on the immersion into
//! twice as many numbers.
//!
//! If the formal solution of A x = b is proper it lies in the tolerable set; that of dual A x = b in the united set;
//! that of dual A x = dual b in the controllable set. Otherwise it proves nothing, and the report says so.

use super::kaucher::Kaucher;
use super::system::IntervalSystem;
use crate::linalg::gauss_jordan::GaussJordan;
use crate::linalg::lanes::LaneMatrix;
use crate::numbers::rounding::OPERATION;

/// What came of it.
#[derive(Clone, Debug, PartialEq)]
pub enum Formal {
    /// A solution, with the steps that it took. It is improper in the components listed, if any.
    Solved {
        /// The solution.
        x: Vec<Kaucher>,
        /// Newton steps.
        steps: usize,
        /// Unknowns that are improper.
        improper: Vec<usize>,
    },
    /// A subgradient is singular: the method says nothing about the system.
    Singular {
        /// Steps made before.
        steps: usize,
    },
    /// No solution within the maximum number of steps.
    NotConverged,
    /// The system must be square.
    NotSquare,
}

/// Most steps.
const MOST_STEPS: usize = 500;

/// The residual of a solution, relative to the right side.
const CLOSED: f64 = 1e-13;

/// Ends nearer to each other than this, relative, may be in either order.
const SAME_END: f64 = 1e-12;

/// Solves A x = b formally; `tau` damps the steps, 0 < tau ≤ 1.
pub fn formal_solution(system: &IntervalSystem, tau: f64) -> Formal {
    let n = system.unknowns();
    if system.b.len() != n {
        return Formal::NotSquare;
    }
    let side: Vec<f64> = immersed_vector(&system.b);
    let size = side.iter().fold(f64::MIN_POSITIVE, |s, v| s.max(v.abs()));
    let Some(mut y) = solved_numbers(&immersed_middle(system), &side) else {
        return Formal::Singular { steps: 0 };
    };
    for steps in 0..=MOST_STEPS {
        let (value, gradient) = immersed_product(system, &y);
        let rest: Vec<f64> = value.iter().zip(&side).map(|(v, b)| v - b).collect();
        let largest = rest.iter().fold(0.0, |s: f64, v| s.max(v.abs()));
        if largest <= CLOSED * size {
            return formal_from(&y, steps);
        }
        let Some(step) = solved_numbers(&gradient, &rest) else {
            return Formal::Singular { steps };
        };
        let moved: f64 = step.iter().fold(0.0, |s: f64, v| s.max(v.abs()));
        let length = y.iter().fold(0.0, |s: f64, v| s.max(v.abs()));
        y.iter_mut().zip(&step).for_each(|(y, s)| *y -= tau * s);
        // Only rounding is left, though the residual is that of long sums.
        if moved <= 4.0 * OPERATION * length {
            return formal_from(&y, steps + 1);
        }
    }
    Formal::NotConverged
}

fn formal_from(y: &[f64], steps: usize) -> Formal {
    let n = y.len() / 2;
    let x: Vec<Kaucher> = (0..n).map(|j| Kaucher::new(-y[j], y[n + j])).collect();
    let is_improper = |k: &Kaucher| k.lo - k.hi > SAME_END * k.magnitude();
    let improper = (0..n).filter(|j| is_improper(&x[*j])).collect();
    Formal::Solved { x, steps, improper }
}

/// (-lo, hi)
fn immersed_vector(vector: &[Kaucher]) -> Vec<f64> {
    let lows = vector.iter().map(|k| -k.lo);
    lows.chain(vector.iter().map(|k| k.hi)).collect()
}

/// The immersion of the middle of A.
fn immersed_middle(system: &IntervalSystem) -> Vec<Vec<f64>> {
    let n = system.unknowns();
    let mut matrix = vec![vec![0.0; 2 * n]; 2 * n];
    for (i, row) in system.a.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let c = entry.middle();
            let (plus, minus) = (c.max(0.0), (-c).max(0.0));
            (matrix[i][j], matrix[n + i][n + j]) = (plus, plus);
            (matrix[i][n + j], matrix[n + i][j]) = (minus, minus);
        }
    }
    matrix
}

/// The immersed product A x and a subgradient of it.
fn immersed_product(system: &IntervalSystem, y: &[f64]) -> (Vec<f64>, Vec<Vec<f64>>) {
    let n = system.unknowns();
    let (mut value, mut matrix) = (vec![0.0; 2 * n], vec![vec![0.0; 2 * n]; 2 * n]);
    for (i, row) in system.a.iter().enumerate() {
        for (j, entry) in row.iter().enumerate() {
            let (lo, hi) = (-y[j], y[n + j]);
            let [low, high] = product_ends(*entry, lo, hi);
            // Signs: the first half of y are minus lower ends.
            value[i] -= low[0];
            matrix[i][j] += low[1];
            matrix[i][n + j] -= low[2];
            value[n + i] += high[0];
            matrix[n + i][j] -= high[1];
            matrix[n + i][n + j] += high[2];
        }
    }
    (value, matrix)
}

/// Both ends of a product with [lo, hi], each with its derivatives by lo and hi.
fn product_ends(a: Kaucher, lo: f64, hi: f64) -> [[f64; 3]; 2] {
    let (p, q) = (a.lo, a.hi);
    // Parts of the ends above and below zero with the derivative of each.
    let up = |x: f64| if x > 0.0 { (x, 1.0) } else { (0.0, 0.0) };
    let down = |x: f64| if x < 0.0 { (-x, -1.0) } else { (0.0, 0.0) };
    let of = |factor: f64, (size, slope): (f64, f64), is_lo: bool| {
        let rate = factor * slope;
        match is_lo {
            true => [factor * size, rate, 0.0],
            false => [factor * size, 0.0, rate],
        }
    };
    let larger = |a: [f64; 3], b: [f64; 3]| if a[0] >= b[0] { a } else { b };
    let less = |a: [f64; 3], b: [f64; 3]| [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
    let (plus, minus) = (|x: f64| x.max(0.0), |x: f64| (-x).max(0.0));
    [
        less(
            larger(of(plus(p), up(lo), true), of(minus(q), down(hi), false)),
            larger(of(plus(q), down(lo), true), of(minus(p), up(hi), false)),
        ),
        less(
            larger(of(plus(q), up(hi), false), of(minus(p), down(lo), true)),
            larger(of(plus(p), down(hi), false), of(minus(q), up(lo), true)),
        ),
    ]
}

/// The solution of a square real system; `None` if a pivot is rounding.
pub fn solved_numbers(matrix: &[Vec<f64>], side: &[f64]) -> Option<Vec<f64>> {
    let n = side.len();
    let (mut rows, mut inverse) = (LaneMatrix::default(), LaneMatrix::default());
    rows.reset(n, n);
    for (i, row) in matrix.iter().enumerate() {
        for (j, value) in row.iter().enumerate() {
            *rows.at_mut(i, j) = *value;
        }
    }
    let pivots = GaussJordan::default().invert_matrix(&rows, &mut inverse)?;
    /// A pivot below this, relative to the largest entry, is rounding.
    const NO_PIVOT: f64 = 1e-13;
    let largest = matrix
        .iter()
        .flatten()
        .fold(0.0, |s: f64, v| s.max(v.abs()));
    if pivots.smallest <= NO_PIVOT * largest {
        return None;
    }
    // One product per component; a solution that is not finite is none.
    let solution: Vec<f64> = (0..n)
        .map(|i| (0..n).map(|j| inverse.at(i, j) * side[j]).sum())
        .collect();
    solution.iter().all(|v| v.is_finite()).then_some(solution)
}
