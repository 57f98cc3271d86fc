//! One-sided rates at a fold, where the variable reverses: unknowns depend on the square root of its change, so that
//! most rates are infinite, but not all.
//!
//! Near a simple fold everything is a power series in the parameter d of the path, including the variable, whose series
//! begins with d². The block that folds gets one more unknown, the variable, and one more row, which states that d is
//! measured along the block's null vector. Its matrix is then regular, and every order is one more right-hand side, as
//! at other poses. A rate is the quotient of two series, finite if the numerator vanishes with the denominator.

use super::coefficients::residual_coefficient;
use super::regular::is_regular;
use crate::kinematics::loops::observed::observed_slots;
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::linalg::svd::null_space;
use crate::model::mechanism::Mechanism;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::{HIGHEST_ORDER, TaylorSeries};

/// Pivots below this fraction of the largest one cannot be divided by: a fold is located to the square root of
/// rounding.
const FOLD_TOLERANCE: f64 = 6e-8;

/// A pose is closed to about 1e-16, so a fold is located along the path to the square root of that.
const FARTHEST: f64 = 1e-6;

/// Another turning point within this distance along the path destroys the digits: folds of higher order are such pairs.
const LONELY: f64 = 1e-4;

/// The variable moves the block that folds if, over its whole range, it changes the residual by more than this. Less is
/// rounding of a constant drive, or occurs where branches cross, and does not determine the path.
const FELT: f64 = 1e-7;

/// A turning point is known to this fraction of the path's unit: a vanishing coefficient may contain this fraction of
/// the next one.
const FLAT: f64 = 1e-9;

/// If a formula's terms cancel, a vanishing coefficient contains rounding relative to the next but one, which comes
/// from the same terms. Later coefficients are useless: those of a fast oscillation grow without bound.
const CANCELLED: f64 = 1e-12;

/// Rounding of a coefficient, relative to its terms.
const ROUNDING: f64 = 1e-11;

/// Newton steps to the fold; each doubles the digits.
const STEPS: usize = 4;

/// Series of all slots that formulas may use along a variable, with the series `inputs` and the range `way`, at a fold:
/// for the side on which there are poses. Infinite coefficients and all after them are NaN.
///
/// `None` if the pose is not a simple fold.
pub fn series_beside_fold(
    system: &System,
    coordinates: &[f64],
    inputs: &[TaylorSeries],
    way: f64,
    order: usize,
) -> Option<Vec<TaylorSeries>> {
    let mechanism = system.mechanism();
    let mut path = FoldedPath::at(system, coordinates, inputs, way)?;
    path.expand()?;
    // Once more at the fold itself, since moving a series costs its last coefficients.
    let fold = path.turning_point()?;
    let mut there: Vec<f64> = path.series.iter().map(|s| s.value_at(fold)).collect();
    let unknowns = mechanism.unknowns.len();
    there[unknowns..].copy_from_slice(&coordinates[unknowns..]);
    let mut path = FoldedPath::at(system, &there, inputs, way)?;
    path.expand()?;
    let rest = path.turning_point()?;
    let moved: Vec<TaylorSeries> = path.series.iter().map(|s| shifted(s, rest)).collect();
    let variable = shifted(&path.variable, rest);
    let slots = observed_slots(mechanism, &moved);
    // The variable's derivative, divided by d.
    let slope: Vec<f64> = derivative(variable.coefficients()).split_off(1);
    if !turns_once(&slope) {
        return None;
    }
    let rates = |slot: &TaylorSeries| one_sided_series(slot, &slope, order);
    Some(slots.iter().map(rates).collect())
}

/// Whether a variable, whose derivative divided by d is `slope`, has no other turning point nearby.
fn turns_once(slope: &[f64]) -> bool {
    let mut higher = slope.iter().enumerate().skip(1);
    slope[0] != 0.0 && higher.all(|(k, c)| slope[0].abs() > c.abs() * LONELY.powi(k as i32))
}

/// The path through a fold, in its own parameter.
struct FoldedPath<'s> {
    mechanism: &'s Mechanism,
    blocks: &'s [Block],
    factors: Vec<PivotedQr>,
    /// The block that folds, its Jacobian and null vector.
    folded: usize,
    jacobian: Vec<f64>,
    along: Vec<f64>,
    /// Series of the inputs in the variable.
    inputs: &'s [TaylorSeries],
    /// The range of the variable.
    way: f64,
    /// Series of the coordinates in the path's parameter.
    series: Vec<TaylorSeries>,
    /// That of the variable.
    variable: TaylorSeries,
}

impl<'s> FoldedPath<'s> {
    /// At a pose at which one block lacks one rank.
    fn at(
        system: &'s System,
        coordinates: &[f64],
        inputs: &'s [TaylorSeries],
        way: f64,
    ) -> Option<Self> {
        let (mechanism, blocks) = (system.mechanism(), &system.structure().blocks);
        let constant = |q: &f64| TaylorSeries::linear(*q, 0.0, HIGHEST_ORDER);
        let (mut workspace, mut factors) = (BlockWorkspace::default(), Vec::new());
        let mut folded = None;
        for (index, block) in blocks.iter().enumerate() {
            let (rows, columns) = (block.rows(), block.unknowns.len());
            workspace.evaluate(mechanism, block, coordinates, Want::Jacobian);
            // Exactly one block may be singular, by one rank: its null vector is the tangent of the path at the fold.
            let mut qr = PivotedQr::default();
            if !is_regular(mechanism, block, coordinates, &workspace, &mut qr) {
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
            way,
            series: coordinates.iter().map(constant).collect(),
            variable: constant(&0.0),
        })
    }

    /// All orders, one after the other. `None` if the block stays singular: not a simple fold.
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

    /// Coefficient k of the unknowns of the block that folds, which is stored, and of the variable, which is returned.
    fn fold_step(&mut self, k: usize, column: &[f64], residual: &[f64]) -> Option<f64> {
        let blocks = self.blocks;
        let block = &blocks[self.folded];
        let (rows, columns) = (block.rows(), block.unknowns.len());
        let size = |values: &[f64]| values.iter().fold(0.0, |m: f64, v| m.max(v.abs()));
        if !(size(column) * self.way > FELT && size(column).is_finite()) {
            return None;
        }
        // The column and the rows are scaled like the null vector, whatever the units of the variable and the block. A
        // single unknown hardly moves its equation at a fold.
        let of_unknowns = if columns > 1 { 0.0 } else { size(column) };
        let of_rows = size(&self.jacobian).max(of_unknowns);
        let unit = size(column) / of_rows;
        let mut matrix = Vec::with_capacity((rows + 1) * (columns + 1));
        for (j, share) in self.along.iter().enumerate() {
            let entries = &self.jacobian[j * rows..][..rows];
            matrix.extend(entries.iter().map(|entry| entry / of_rows));
            matrix.push(*share);
        }
        matrix.extend(column.iter().map(|value| value / (unit * of_rows)));
        matrix.push(0.0);
        let mut qr = PivotedQr::default();
        qr.factor(&matrix, rows + 1, columns + 1, FOLD_TOLERANCE);
        if qr.rank() < columns + 1 {
            return None;
        }
        let mut right_side: Vec<f64> = residual.iter().map(|r| -r / of_rows).collect();
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

/// A coefficient and the magnitude of its terms, which determines its rounding.
#[derive(Clone, Copy)]
struct Summed {
    value: f64,
    size: f64,
}

/// Series of a slot in the variable, whose derivative by the parameter d is d times `slope`.
fn one_sided_series(slot: &TaylorSeries, slope: &[f64], order: usize) -> TaylorSeries {
    let order = order.min(HIGHEST_ORDER);
    let mut series = TaylorSeries::linear(slot.coefficients()[0], f64::NAN, order);
    let exact = |c: &f64| Summed {
        value: *c,
        size: c.abs(),
    };
    // d/dt = (1 / ṫ) d/du along the path: divide the derivative by the slope, which vanishes at the fold, order by
    // order.
    let mut rest: Vec<Summed> = slot.coefficients().iter().map(exact).collect();
    let mut factorial = 1.0;
    for k in 1..=order {
        let above = summed_derivative(&rest);
        // A rate is finite only if the numerator vanishes there as well.
        if above.len() < 2 || !vanishes(&above) {
            (k..=order).for_each(|j| series.set(j, f64::NAN));
            break;
        }
        rest = quotient(&above[1..], slope);
        factorial *= k as f64;
        series.set(k, rest[0].value / factorial);
    }
    series
}

/// Whether the first coefficient is zero up to rounding and the error of the turning point.
fn vanishes(series: &[Summed]) -> bool {
    let misplaced = series.iter().enumerate().skip(1);
    let misplaced = misplaced.map(|(k, c)| c.value.abs() * FLAT.powi(k as i32));
    let cancelled = series.get(2).map_or(0.0, |c| CANCELLED * c.value.abs());
    series[0].value.abs() <= misplaced.sum::<f64>() + cancelled + rounding_of(&series[0])
}

/// The error of a coefficient: none without a sum.
fn rounding_of(coefficient: &Summed) -> f64 {
    match coefficient.size > coefficient.value.abs() {
        true => ROUNDING * coefficient.size,
        false => 0.0,
    }
}

/// The derivative of a polynomial.
fn summed_derivative(coefficients: &[Summed]) -> Vec<Summed> {
    let terms = coefficients.iter().enumerate().skip(1);
    let term = |(k, c): (usize, &Summed)| Summed {
        value: k as f64 * c.value,
        size: k as f64 * c.size,
    };
    terms.map(term).collect()
}

/// The quotient of two series; the lower one does not begin with zero.
fn quotient(above: &[Summed], below: &[f64]) -> Vec<Summed> {
    let mut result: Vec<Summed> = Vec::with_capacity(above.len());
    for (k, over) in above.iter().enumerate() {
        let known: f64 = (0..k).map(|j| result[j].value * below[k - j]).sum();
        let sizes: f64 = (0..k).map(|j| result[j].size * below[k - j].abs()).sum();
        result.push(Summed {
            value: (over.value - known) / below[0],
            size: (over.size + sizes) / below[0].abs(),
        });
    }
    result
}
