//! The method of the centre: the largest cube about a point that lies in a solution set, and the best point for it.
//!
//! For the tolerable set the radius is the least of (rad bᵢ - |mid bᵢ - Σ aᵢⱼ tⱼ|) / Σ |aᵢⱼ| over the rows, where |.|
//! is the magnitude of an interval. (The source prints a plain bracket, and calls rad bᵢ and mid bᵢ R and M without
//! saying that they belong to b.)

use super::kaucher::Kaucher;
use super::simplex::{ProgrammeResult, maximise};
use super::system::{IntervalSystem, SolutionSet};
use crate::numbers::rounding::SUMS;

/// Halvings in the search for the largest radius that fits.
const HALVINGS: usize = 60;

/// No radius is searched beyond this: there a cube in the united set is as good as unbounded.
const LARGEST_RADIUS: f64 = 1e300;

/// How far all A x of a point stay inside b: the point is tolerable if this is not negative.
pub fn tolerance_at(system: &IntervalSystem, t: &[f64]) -> f64 {
    let rows = row_slacks(system, t).into_iter();
    rows.fold(f64::INFINITY, f64::min)
}

/// rad b - |mid b - A t| of every row.
fn row_slacks(system: &IntervalSystem, t: &[f64]) -> Vec<f64> {
    let point: Vec<Kaucher> = t.iter().map(|v| Kaucher::point(*v)).collect();
    let products = system.times(&point);
    let pairs = system.b.iter().zip(products);
    pairs
        .map(|(b, g)| b.radius() - (Kaucher::point(b.middle()) - g).magnitude())
        .collect()
}

/// Sum of the magnitudes of a row.
fn row_magnitude(row: &[Kaucher]) -> f64 {
    row.iter().map(|a| a.magnitude()).sum()
}

/// The radius of the largest cube about `t` in the tolerable set; negative if `t` itself is not.
pub fn tolerable_radius(system: &IntervalSystem, t: &[f64]) -> f64 {
    let rows = row_slacks(system, t).into_iter().zip(&system.a);
    let radii = rows.map(|(slack, row)| slack / row_magnitude(row));
    radii.fold(f64::INFINITY, f64::min)
}

/// The radius of a cube about `t` in the united set, by a row test that is sufficient; negative if that fails at `t`.
pub fn united_radius(system: &IntervalSystem, t: &[f64]) -> f64 {
    let fits = |r: f64| {
        system.a.iter().zip(&system.b).all(|(row, b)| {
            let middle: f64 = row.iter().zip(t).map(|(a, t)| a.middle() * t).sum();
            let reach: f64 = row.iter().map(|a| a.middle().abs()).sum();
            // The slack that the width of a row gives to the box.
            let open: f64 = row
                .iter()
                .zip(t)
                .map(|(a, t)| a.radius() * (t.abs() - r).max(0.0))
                .sum();
            let slack = SUMS * (middle.abs() + r * reach + open + b.magnitude());
            (middle - b.middle()).abs() + r * reach + slack <= open + b.radius()
        })
    };
    largest_fitting(fits, LARGEST_RADIUS).unwrap_or(-1.0)
}

/// The largest radius that fits, up to about `limit`: doubled until it fails, then bisected. `None` if not even zero does.
pub(super) fn largest_fitting(fits: impl Fn(f64) -> bool, limit: f64) -> Option<f64> {
    let (mut low, mut high) = (0.0, 1.0);
    if !fits(low) {
        return None;
    }
    while fits(high) && high < limit {
        (low, high) = (high, 2.0 * high);
    }
    for _ in 0..HALVINGS {
        let middle = 0.5 * low + 0.5 * high;
        match fits(middle) {
            true => low = middle,
            false => high = middle,
        }
    }
    Some(low)
}

/// The largest cube about `t` in the united or the tolerable set; `None` for other sets.
pub fn centre_radius(system: &IntervalSystem, t: &[f64], kind: &SolutionSet) -> Option<f64> {
    match kind {
        SolutionSet::Tolerable => Some(tolerable_radius(system, t)),
        SolutionSet::United => Some(united_radius(system, t)),
        SolutionSet::Controllable | SolutionSet::Mask(..) => None,
    }
}

/// The most tolerable point, and its tolerability: a linear programme, since the functional is concave. `None` if it is
/// unbounded, as for a matrix whose columns contain only intervals around zero.
pub fn best_centre(system: &IntervalSystem) -> Option<(Vec<f64>, f64)> {
    let n = system.unknowns();
    // t = u - v and the functional = p - q, all non-negative; parts of t that are both positive only tighten rows.
    let mut objective = vec![0.0; 2 * n];
    objective.extend([1.0, -1.0]);
    let (mut rows, mut sides) = (Vec::new(), Vec::new());
    for (row, b) in system.a.iter().zip(&system.b) {
        let highs = row.iter().map(|a| a.hi).chain(row.iter().map(|a| -a.lo));
        rows.push(highs.chain([1.0, -1.0]).collect());
        sides.push(b.hi);
        let lows = row.iter().map(|a| -a.lo).chain(row.iter().map(|a| a.hi));
        rows.push(lows.chain([1.0, -1.0]).collect());
        sides.push(-b.lo);
    }
    match maximise(&objective, &rows, &sides) {
        ProgrammeResult::Optimal { value, x } => {
            let t = (0..n).map(|j| x[j] - x[n + j]).collect();
            Some((t, value))
        }
        ProgrammeResult::Infeasible | ProgrammeResult::Unbounded => None,
    }
}
