//! Steps to both sides of every variable from where a search by derivatives ends: at a maximum and at a saddle the slopes are
//! zero as well, and beside a jump they tell nothing of it.

use super::VariableBounds;

/// Length of the steps, in scales of the variables: a curvature shows in half of the digits, and a slope within the tolerances does
/// not.
pub(super) const LENGTH: f64 = 1e-4;

/// Most times that a search goes on from such a point.
pub(super) const MOST: usize = 20;

/// A decrease below this fraction of the value is rounding.
pub(super) const ROUNDING: f64 = 1e-12;

/// The lowest of the points beside `x` whose value is below `level`, and the number of values asked for.
pub(super) fn lowest_beside(
    x: &[f64],
    scales: &[f64],
    bounds: &VariableBounds,
    level: f64,
    mut value: impl FnMut(&[f64]) -> f64,
) -> (Option<Vec<f64>>, usize) {
    let (mut lowest, mut least, mut asked) = (None, level, 0);
    for (k, scale) in scales.iter().enumerate() {
        for step in [LENGTH, -LENGTH] {
            let mut beside = x.to_vec();
            beside[k] += step * scale;
            bounds.clamp(&mut beside);
            if beside[k] == x[k] {
                continue;
            }
            asked += 1;
            let there = value(&beside);
            if there < least {
                (lowest, least) = (Some(beside), there);
            }
        }
    }
    (lowest, asked)
}
