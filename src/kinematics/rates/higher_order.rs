//! Rates of any order at a closed pose: the Taylor series of the unknowns along given series of the inputs.
//!
//! Block by block and order by order: with all lower coefficients in place, and the k-th one zero, the k-th coefficient
//! of the residual must be cancelled by the k-th coefficient of the unknowns, which enters linearly with the Jacobian
//! of the pose. One factorisation serves all orders, without finite differences.

use super::coefficients::residual_coefficient;
use super::regular::is_regular;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::mechanism::Mechanism;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::TaylorSeries;

/// Redundant equations hold along the series if what remains of a coefficient is at most this fraction of the fastest coordinate's:
/// far above the rounding of dimensions, far below the rate of inputs that cannot move alone.
const CONSISTENT: f64 = 1e-6;

/// What remains below this is rounding, even if nothing moves.
const ROUNDING: f64 = 1e-12;

/// Series of all coordinates (unknowns, then inputs) at a closed pose, up to `order`.
///
/// `coordinates` are the pose's; the constant coefficients of `inputs`, which go up to `order` too, are its inputs. `None` at a singular
/// pose, where the unknowns have no such series, or where they have no first derivatives, as for one of two inputs that only move
/// together; higher ones that are infinite or not known are NaN.
pub fn higher_rates(
    system: &System,
    coordinates: &[f64],
    inputs: &[TaylorSeries],
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let n = mechanism.unknowns.len();
    let mut series: Vec<TaylorSeries> = coordinates[..n]
        .iter()
        .map(|q| TaylorSeries::linear(*q, 0.0, order))
        .collect();
    series.extend_from_slice(inputs);
    let (mut workspace, mut qr) = (BlockWorkspace::default(), PivotedQr::default());
    let mut closed = order;
    for block in &structure.blocks {
        workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
        if !is_regular(mechanism, block, coordinates, &workspace, &mut qr) {
            return None;
        }
        let mut step = vec![0.0; block.unknowns.len()];
        // The k-th coefficient is linear in the k-th unknown: one factorisation serves all orders.
        for k in 1..=order {
            let mut right_side = residual_coefficient(mechanism, block, &series, k);
            right_side.iter_mut().for_each(|r| *r = -*r);
            // Equations between inputs have no unknowns, and no factors.
            if !step.is_empty() {
                qr.solve(&mut right_side, &mut step);
            }
            for (unknown, step) in block.unknowns.iter().zip(&step) {
                series[*unknown].set(k, mechanism.scale_of(*unknown) * step);
            }
            // What redundant equations leave is behind the reflected right side.
            let left = right_side[step.len()..].iter();
            let left = left.fold(0.0, |m: f64, r| m.max(r.abs()));
            if left > ROUNDING + CONSISTENT * speed(mechanism, &series, k) {
                closed = closed.min(k - 1);
            }
        }
    }
    for series in &mut series[..n] {
        (closed + 1..=order).for_each(|k| series.set(k, f64::NAN));
    }
    let have_rates = series[..n].iter().all(|s| s.truncated(1).is_finite());
    have_rates.then_some(series)
}

/// The largest coefficient up to the k-th, in the scale of its coordinate.
fn speed(mechanism: &Mechanism, series: &[TaylorSeries], k: usize) -> f64 {
    let all = series.iter().enumerate();
    let of_slot = all.map(|(slot, series)| {
        let coefficients = series.coefficients()[1..=k].iter();
        coefficients.fold(0.0, |m: f64, c| m.max(c.abs())) / mechanism.scale_of(slot)
    });
    of_slot.fold(0.0, f64::max)
}
