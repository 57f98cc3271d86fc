//! Decides whether a closed pose is regular, as far as rounding permits.
//!
//! A small pivot alone is inconclusive: its size depends on units, and a block of one unknown has no other pivot for
//! comparison. The criterion is how far the block's residual would have to change for the pose to become singular,
//! which is the radius of convergence of the unknowns as series of the residual. Rounding changes the residual too; if
//! it could make the pose singular, rates are noise. Folds of any order are judged by the same comparison.

use super::coefficients::residual_coefficient;
use crate::kinematics::loops::residual::BlockWorkspace;
use crate::kinematics::structure::block::Block;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::{RANK_TOLERANCE, null_space};
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;
use crate::numbers::series::TaylorSeries;

/// Pivots above this fraction of the largest are those of regular poses, whatever the units: blocks are scaled by their
/// size, and no curvature exceeds the slopes a thousandfold.
const SOUND_PIVOT: f64 = 1e-3;

/// Highest order of the series whose radius is estimated: folds of the second to the fourth order show in it.
const WATCHED_ORDER: usize = 4;

/// A pose counts as singular within this many times its rounding: at sixteen times the rounding, the rates of a fold
/// have two digits. The estimate of the radius is up to four times too large.
const MARGIN: f64 = 64.0;

/// Whether a block, evaluated with its Jacobian at a closed pose, is regular there. `qr` then contains its factors;
/// otherwise they have at least the rank that is certain.
pub(super) fn is_regular(
    mechanism: &Mechanism,
    block: &Block,
    coordinates: &[f64],
    workspace: &BlockWorkspace,
    qr: &mut PivotedQr,
) -> bool {
    let (rows, columns) = (block.rows(), block.unknowns.len());
    if columns == 0 {
        return true;
    }
    // A rank that is certain settles most cases.
    qr.factor(&workspace.jacobian, rows, columns, RANK_TOLERANCE);
    if qr.rank() < columns {
        return false;
    }
    if columns > 1 && qr.smallest_pivot() > SOUND_PIVOT * qr.largest_pivot() {
        return true;
    }
    // Otherwise the residual is moved along its weakest direction: the block is regular if rounding cannot reach the
    // fold.
    let direction = weakest_direction(&workspace.jacobian, rows, columns);
    let radius = radius_of_regularity(mechanism, block, coordinates, &direction, qr);
    let off = rounding(mechanism, block, coordinates) + workspace.residual_norm();
    radius > MARGIN * off
}

/// The change of the residual that moves the unknowns most, normalised to a largest entry of one.
fn weakest_direction(jacobian: &[f64], rows: usize, columns: usize) -> Vec<f64> {
    let along = null_space(jacobian, rows, columns, columns - 1)
        .pop()
        .unwrap_or_default();
    let mut direction = vec![0.0; rows];
    for (column, share) in jacobian.chunks(rows).zip(&along) {
        let pairs = direction.iter_mut().zip(column);
        pairs.for_each(|(sum, entry)| *sum += share * entry);
    }
    let largest = direction.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
    direction.iter_mut().for_each(|v| *v /= largest);
    direction
}

/// Largest change of the residual along `direction` for which the unknowns are series of it; NaN if a formula is
/// undefined.
fn radius_of_regularity(
    mechanism: &Mechanism,
    block: &Block,
    coordinates: &[f64],
    direction: &[f64],
    qr: &mut PivotedQr,
) -> f64 {
    let constant = |q: &f64| TaylorSeries::linear(*q, 0.0, WATCHED_ORDER);
    let mut series: Vec<TaylorSeries> = coordinates.iter().map(constant).collect();
    let mut step = vec![0.0; block.unknowns.len()];
    let (mut first, mut radius) = (0.0, f64::INFINITY);
    for k in 1..=WATCHED_ORDER {
        // Newton on power series: coefficient k of the residual without x_k, then J x_k = -r_k; a unit step along
        // `direction` at first order.
        let mut right_side = residual_coefficient(mechanism, block, &series, k);
        right_side.iter_mut().for_each(|r| *r = -*r);
        if k == 1 {
            let pairs = right_side.iter_mut().zip(direction);
            pairs.for_each(|(r, d)| *r += d);
        }
        qr.solve(&mut right_side, &mut step);
        // Root test: the radius of convergence from the size of coefficient k relative to the first.
        let size = step.iter().fold(0.0, |m: f64, s| m + s.abs());
        if k == 1 {
            first = size;
        } else {
            radius = f64::min(radius, libm::pow(first / size, 1.0 / (k as f64 - 1.0)));
        }
        if !size.is_finite() {
            return f64::NAN;
        }
        for (unknown, step) in block.unknowns.iter().zip(&step) {
            series[*unknown].set(k, mechanism.scale_of(*unknown) * step);
        }
    }
    radius
}

/// Effect of rounding on the residual of a block: the factors of its loops one by one, its equations by interval
/// arithmetic.
fn rounding(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> f64 {
    let loops = block.loops.iter();
    let factors = loops.map(|part| mechanism.loops[part.index].chain.steps.len());
    let mut off = f64::EPSILON * factors.max().unwrap_or(1).max(1) as f64;
    let exact: Vec<Interval> = coordinates.iter().map(|q| Interval::point(*q)).collect();
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let value = equation.expression.value(&exact);
        let width = (value.hi - value.lo) * equation.weight;
        if width.is_finite() {
            off = off.max(width);
        }
    }
    off
}
