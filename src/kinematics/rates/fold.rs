//! One-sided rates at a fold, where the variable turns back: unknowns go with its root there, so that most rates are
//! infinite, but not all.
//!
//! Beside a simple fold everything is a power series in the path's own parameter d, the variable too, whose series begins with
//! d². The block that folds gets one more unknown, the variable, and one more row, which says that d is measured along the
//! block's null vector; with that its matrix is regular, and every order is one more right side, as at other poses. A rate is
//! then the quotient of two series, finite where the numerator vanishes with the denominator.

use super::higher_order::{FOLD_TOLERANCE, residual_coefficient};
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::null_space;
use crate::model::mechanism::Mechanism;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::{HIGHEST_ORDER, TaylorSeries};

/// A pose is closed to about 1e-16, so a known fold is off by its root along the path.
const FARTHEST: f64 = 1e-6;

/// A numerator that is smaller, relative to its series, vanishes: what is left of it is rounding through a matrix that is regular.
const FLAT: f64 = 1e-9;

/// Steps of Newton's method to the fold; each doubles the digits.
const STEPS: usize = 4;

/// Series of all slots that formulas may use along a variable, of which `inputs` are the series, at a fold: those of the side on
/// which there are poses. Coefficients that are infinite are NaN, and so are all behind them.
///
/// `None` where the pose is no simple fold.
pub fn series_beside_fold(
    system: &System,
    coordinates: &[f64],
    inputs: &[TaylorSeries],
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let mut path = FoldedPath::at(system, coordinates, inputs)?;
    path.expand()?;
    let fold = path.turning_point()?;
    let moved: Vec<TaylorSeries> = path.series.iter().map(|s| shifted(s, fold)).collect();
    let variable = shifted(&path.variable, fold);
    let slots = observed_slots(mechanism, &moved);
    // The variable's derivative, divided by d.
    let slope: Vec<f64> = derivative(variable.coefficients()).split_off(1);
    let rates = |slot: &TaylorSeries| one_sided_series(slot, &slope, order);
    Some(slots.iter().map(rates).collect())
}

/// The path through a fold, in its own parameter.
struct FoldedPath<'s> {
    mechanism: &'s Mechanism,
    blocks: &'s [Block],
    factors: Vec<PivotedQr>,
    /// Which block folds, its Jacobian and null vector.
    folded: usize,
    jacobian: Vec<f64>,
    along: Vec<f64>,
    /// Series of the inputs in the variable.
    inputs: &'s [TaylorSeries],
    /// Series of the coordinates in the path's parameter.
    series: Vec<TaylorSeries>,
    /// That of the variable.
    variable: TaylorSeries,
}

impl<'s> FoldedPath<'s> {
    /// At a pose at which one block lacks one rank.
    fn at(system: &'s System, coordinates: &[f64], inputs: &'s [TaylorSeries]) -> Option<Self> {
        let (mechanism, blocks) = (system.mechanism(), &system.structure().blocks);
        let constant = |q: &f64| TaylorSeries::linear(*q, 0.0, HIGHEST_ORDER);
        let (mut workspace, mut factors) = (BlockWorkspace::default(), Vec::new());
        let mut folded = None;
        for (index, block) in blocks.iter().enumerate() {
            let (rows, columns) = (block.rows(), block.unknowns.len());
            workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
            let mut qr = PivotedQr::default();
            qr.factor(&workspace.jacobian, rows, columns, FOLD_TOLERANCE);
            if qr.rank() < columns {
                if folded.is_some() || qr.rank() + 1 < columns {
                    return None;
                }
                let jacobian = workspace.jacobian[..rows * columns].to_vec();
                let along = null_space(&jacobian, rows, columns, columns - 1).pop()?;
                folded = Some((index, jacobian, along));
            }
            factors.push(qr);
        }
        let (folded, jacobian, along) = folded?;
        Some(Self {
            mechanism,
            blocks,
            factors,
            folded,
            jacobian,
            along,
            inputs,
            series: coordinates.iter().map(constant).collect(),
            variable: constant(&0.0),
        })
    }

    /// All orders, one after the other. `None` where the block stays singular: no simple fold.
    fn expand(&mut self) -> Option<()> {
        for k in 1..=HIGHEST_ORDER {
            // The residual is linear in the variable's coefficient: two values tell its column.
            let [at_zero, at_one] = [0.0, 1.0].map(|value| self.residual_with(k, value));
            let column: Vec<f64> = at_one.iter().zip(&at_zero).map(|(a, b)| a - b).collect();
            let value = self.fold_step(k, &column, &at_zero)?;
            self.drive(k, value);
            for index in 0..self.blocks.len() {
                if index != self.folded {
                    self.solve_block(index, k);
                }
            }
        }
        let is_finite = self.series.iter().all(|s| s.is_finite()) && self.variable.is_finite();
        is_finite.then_some(())
    }

    /// Gives the variable its coefficient k, and with it the inputs theirs.
    fn drive(&mut self, k: usize, value: f64) {
        self.variable.set(k, value);
        let first = self.series.len() - self.inputs.len();
        for (series, input) in self.series[first..].iter_mut().zip(self.inputs) {
            let composed = composed(input, &self.variable);
            series.set(k, composed.coefficients()[k]);
        }
    }

    /// Coefficient k of the residual of the block that folds, if that of the variable is `value`.
    fn residual_with(&mut self, k: usize, value: f64) -> Vec<f64> {
        self.drive(k, value);
        for index in 0..self.folded {
            self.solve_block(index, k);
        }
        residual_coefficient(self.mechanism, &self.blocks[self.folded], &self.series, k)
    }

    /// Coefficient k of the unknowns of a regular block.
    fn solve_block(&mut self, index: usize, k: usize) {
        let blocks = self.blocks;
        let block = &blocks[index];
        self.fill(block, k, None);
        let mut right_side = residual_coefficient(self.mechanism, block, &self.series, k);
        right_side.iter_mut().for_each(|r| *r = -*r);
        let mut step = vec![0.0; block.unknowns.len()];
        self.factors[index].solve(&mut right_side, &mut step);
        self.fill(block, k, Some(&step));
    }

    /// Sets coefficient k of a block's unknowns, to zero without values.
    fn fill(&mut self, block: &Block, k: usize, step: Option<&[f64]>) {
        for (j, unknown) in block.unknowns.iter().enumerate() {
            let value = step.map_or(0.0, |step| self.mechanism.scale_of(*unknown) * step[j]);
            self.series[*unknown].set(k, value);
        }
    }

    /// Coefficient k of the unknowns of the block that folds, put in place, and of the variable: given.
    fn fold_step(&mut self, k: usize, column: &[f64], residual: &[f64]) -> Option<f64> {
        let blocks = self.blocks;
        let block = &blocks[self.folded];
        let (rows, columns) = (block.rows(), block.unknowns.len());
        // The column is made as large as the others, whatever the variable is measured in.
        let size = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        let unit = size(column) / size(&self.jacobian);
        if !(unit.is_finite() && unit > 0.0) {
            return None;
        }
        let mut matrix = Vec::with_capacity((rows + 1) * (columns + 1));
        for (j, share) in self.along.iter().enumerate() {
            matrix.extend_from_slice(&self.jacobian[j * rows..][..rows]);
            matrix.push(*share);
        }
        matrix.extend(column.iter().map(|value| value / unit));
        matrix.push(0.0);
        let mut qr = PivotedQr::default();
        qr.factor(&matrix, rows + 1, columns + 1, FOLD_TOLERANCE);
        if qr.rank() < columns + 1 {
            return None;
        }
        let mut right_side: Vec<f64> = residual.iter().map(|r| -r).collect();
        right_side.push(if k == 1 { 1.0 } else { 0.0 });
        let mut step = vec![0.0; columns + 1];
        qr.solve(&mut right_side, &mut step);
        self.fill(block, k, Some(&step[..columns]));
        Some(step[columns] / unit)
    }

    /// Where the variable turns back, near the pose.
    fn turning_point(&self) -> Option<f64> {
        let slope = derivative(self.variable.coefficients());
        let bend = derivative(&slope);
        let at = |coefficients: &[f64], d: f64| {
            let terms = coefficients.iter().rev();
            terms.fold(0.0, |sum, c| sum * d + c)
        };
        let mut d = 0.0;
        for _ in 0..STEPS {
            d -= at(&slope, d) / at(&bend, d);
            if !(d.is_finite() && f64::abs(d) < FARTHEST) {
                return None;
            }
        }
        Some(d)
    }
}

/// `outer` of `inner`, which begins with zero.
fn composed(outer: &TaylorSeries, inner: &TaylorSeries) -> TaylorSeries {
    let terms = outer.coefficients().iter().rev();
    terms.fold(TaylorSeries::constant(0.0), |sum, c| {
        sum * *inner + TaylorSeries::constant(*c)
    })
}

/// The same polynomial about another place.
fn shifted(series: &TaylorSeries, by: f64) -> TaylorSeries {
    composed(series, &TaylorSeries::linear(by, 1.0, HIGHEST_ORDER))
}

/// The derivative of a polynomial.
fn derivative(coefficients: &[f64]) -> Vec<f64> {
    let terms = coefficients.iter().enumerate().skip(1);
    terms.map(|(k, c)| k as f64 * c).collect()
}

/// Series of a slot in the variable, whose derivative by the parameter d is d times `slope`.
fn one_sided_series(slot: &TaylorSeries, slope: &[f64], order: usize) -> TaylorSeries {
    let mut series = TaylorSeries::linear(slot.coefficients()[0], f64::NAN, order);
    let mut rest = slot.coefficients().to_vec();
    let mut factorial = 1.0;
    for k in 1..=order.min(HIGHEST_ORDER) {
        let size = rest.iter().skip(1).fold(0.0, |m: f64, c| m.max(c.abs()));
        let above = derivative(&rest);
        let is_infinite = above.first().is_none_or(|first| first.abs() > FLAT * size);
        if is_infinite || above.len() < 2 {
            (k..=order.min(HIGHEST_ORDER)).for_each(|j| series.set(j, f64::NAN));
            break;
        }
        rest = quotient(&above[1..], slope);
        factorial *= k as f64;
        series.set(k, rest[0] / factorial);
    }
    series
}

/// The quotient of two series; the lower one does not begin with zero.
fn quotient(above: &[f64], below: &[f64]) -> Vec<f64> {
    let mut result: Vec<f64> = Vec::with_capacity(above.len());
    for (k, value) in above.iter().enumerate() {
        let known: f64 = (0..k).map(|j| result[j] * below[k - j]).sum();
        result.push((value - known) / below[0]);
    }
    result
}
