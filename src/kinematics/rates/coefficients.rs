//! Coefficients of a block's residual where its coordinates are power series.

use super::residual_part;
use crate::kinematics::structure::block::Block;
use crate::model::mechanism::Mechanism;
use crate::model::outputs::output_arguments;
use crate::model::walk::WalkFrame;
use crate::numbers::series::TaylorSeries;

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
        let scale = equation.weight;
        let value = equation.expression.value(&series);
        residual.push(value.coefficients()[k] * scale);
    }
    residual
}
