//! Rates of any order at a closed pose: the Taylor series of the unknowns along given series of the inputs.
//!
//! Block by block and order by order: with all lower coefficients in place, and the k-th one zero, the k-th
//! coefficient of the residual is what the k-th coefficient of the unknowns must cancel, and it enters linearly with
//! the Jacobian of the pose. One factorisation serves all orders; nothing is differenced.

use super::residual_part;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::model::mechanism::Mechanism;
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::TaylorSeries;

/// Pivots below this share of the largest one have no direction to divide by. A fold is found to the square root of
/// rounding (1.5e-8), so a pose within four times that may be the fold itself, where most rates are infinite.
pub(super) const FOLD_TOLERANCE: f64 = 6e-8;

/// Series of all coordinates (unknowns, then inputs) at a closed pose, up to `order`.
///
/// `coordinates` are the pose's; the constant coefficients of `inputs`, which go up to `order` too, are its inputs. `None` at a singular
/// pose, where the unknowns have no such series, or where a formula has no value.
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
    for block in &structure.blocks {
        let (rows, columns) = (block.rows(), block.unknowns.len());
        workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
        qr.factor(&workspace.jacobian, rows, columns, FOLD_TOLERANCE);
        if qr.rank() < columns {
            return None;
        }
        let mut step = vec![0.0; columns];
        // The k-th coefficient is linear in the k-th unknown: one factorisation serves all orders.
        for k in 1..=order {
            let mut right_side = residual_coefficient(mechanism, block, &series, k);
            right_side.iter_mut().for_each(|r| *r = -*r);
            qr.solve(&mut right_side, &mut step);
            for (unknown, step) in block.unknowns.iter().zip(&step) {
                series[*unknown].set(k, mechanism.scale_of(*unknown) * step);
            }
        }
    }
    let all_finite = series.iter().all(|s| s.is_finite());
    all_finite.then_some(series)
}

/// Coefficient k of the block's residual.
///
/// Up to order k the loop's product is I + hᵏ E, and E is skew because the product is a rotation: its three entries
/// are the coefficient of the rotation vector.
pub(super) fn residual_coefficient(
    mechanism: &Mechanism,
    block: &Block,
    series: &[TaylorSeries],
    k: usize,
) -> Vec<f64> {
    let mut residual = Vec::with_capacity(block.rows());
    let series: Vec<TaylorSeries> = series.iter().map(|s| s.truncated(k)).collect();
    let arguments = output_arguments(mechanism, &block.arguments, &series);
    for part in &block.loops {
        let item = &mechanism.loops[part.index];
        let end = WalkFrame::at_end_of(&item.chain.steps, &arguments);
        // Coefficient k of the loop's product, as a residual.
        let six = residual_part(end.map(|c| c.coefficients()[k]), item.size);
        residual.extend(part.components.iter().map(|c| six[*c]));
    }
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let scale = mechanism.weight_of(*index);
        let value = equation.expression.value(&series);
        residual.push(value.coefficients()[k] * scale);
    }
    residual
}
