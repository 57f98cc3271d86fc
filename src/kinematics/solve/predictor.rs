//! Prediction of the pose at other inputs: the Taylor polynomial of the unknowns along a straight line of the inputs.
//!
//! At a closed pose the sum of the joints' twists ξⱼ times their rates vanishes, and goes on vanishing. A joint's twist
//! moves with the links before it, ξⱼ' = [V, ξⱼ] with V the sum of the twists times rates of the joints before. So the
//! coefficients of ξⱼ and V follow from one another, one pass along the loop an order, and the highest coefficient of the
//! unknowns comes from the Jacobian of the pose. Of an equation of second degree that coefficient is a sum of products of
//! lower ones. (Brackets of twists: Murray, Li and Sastry, A Mathematical
//! Introduction to Robotic Manipulation, chapter 2.)

use super::linearisation::Linearisation;
use super::newton::Corrector;
use crate::kinematics::loops::joint_lanes::LaneTwists;
use crate::kinematics::loops::residual::residual_of;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::layout::{BlockPlan, PlannedGroup};
use crate::kinematics::structure::system::System;
use crate::linalg::lanes::{Lanes, all_lanes};
use wide::f64x4;

/// Highest order. One more costs a pass along the joints, one less an iteration of Newton's method.
pub use crate::kinematics::structure::planned_quadratic::HIGHEST_ORDER;

/// How a prediction was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Length of the step along the tangent: largest change in scaled unknowns.
    pub length: f64,
    /// By how much the prediction departs from the tangent, likewise.
    pub bend: f64,
}

/// Coefficients of the twists of four joints, and of the twists of the links before them.
#[derive(Clone, Copy, Debug, Default)]
struct GroupSeries {
    own: [LaneTwists; HIGHEST_ORDER],
    before: [LaneTwists; HIGHEST_ORDER],
    /// What the change of the twists contributes to the last coefficient of the loop's whole twist.
    bend: LaneTwists,
    /// Coefficients of the rates of the joints' arguments.
    rates: [Lanes; HIGHEST_ORDER],
}

/// Buffers of the series.
#[derive(Clone, Debug, Default)]
pub struct Predictor {
    /// Coefficients of all coordinates, order by order.
    series: Vec<f64>,
    groups: Vec<GroupSeries>,
    /// The last coefficient of the arguments' rates.
    rates: Vec<f64>,
    /// Coefficients of the factors of a block's equations of second degree.
    factors: Vec<[f64; HIGHEST_ORDER]>,
}

impl Predictor {
    /// Moves `coordinates` (unknowns and inputs of a closed pose) to the given inputs, the unknowns by the Taylor
    /// polynomial of `order`, 1 to [`HIGHEST_ORDER`]. Where a formula of more than second degree is involved the tangent is all.
    pub fn predict(
        &mut self,
        system: &System,
        corrector: &mut Corrector,
        coordinates: &mut [f64],
        inputs: &[f64],
        order: usize,
    ) -> Prediction {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let (n, count) = (mechanism.unknowns.len(), coordinates.len());
        let has_series = structure.blocks.iter().all(|block| block.plan.has_series);
        let order = if has_series {
            order.clamp(1, HIGHEST_ORDER)
        } else {
            1
        };
        // Power series of the unknowns; the inputs move linearly.
        self.series.clear();
        self.series.resize(count * order, 0.0);
        for (k, input) in inputs.iter().enumerate() {
            self.series[n + k] = input - coordinates[n + k];
        }
        for (block, buffers) in structure.blocks.iter().zip(&mut corrector.blocks) {
            buffers.linearise(mechanism, block, coordinates);
            self.block_series(block, buffers, count, order);
        }
        let mut prediction = Prediction {
            length: 0.0,
            bend: 0.0,
        };
        // The first power is the tangent, the others are its curvature and higher orders.
        let (first, higher) = self.series.split_at(count);
        for block in &structure.blocks {
            for (slot, scale) in block.unknowns.iter().zip(&block.plan.scales) {
                let tangent = first[*slot];
                let bend: f64 = higher.chunks_exact(count).map(|c| c[*slot]).sum();
                prediction.length = larger_or_nan(prediction.length, tangent / scale);
                prediction.bend = larger_or_nan(prediction.bend, bend / scale);
                coordinates[*slot] += tangent + bend;
            }
        }
        // The inputs are exactly the drive's, not the sum of differences.
        coordinates[n..].copy_from_slice(inputs);
        prediction
    }

    /// Coefficients of the block's unknowns, given those of all coordinates from outside.
    fn block_series(
        &mut self,
        block: &Block,
        buffers: &mut Linearisation,
        count: usize,
        order: usize,
    ) {
        self.groups
            .resize(block.plan.groups.len(), GroupSeries::default());
        let joints = buffers.workspace.joints().iter().zip(&block.plan.groups);
        for (series, (joints, planned)) in self.groups.iter_mut().zip(joints) {
            series.own[0] = joints.twists(planned);
            series.bend = LaneTwists::default();
        }
        for k in 0..order {
            let outside = &self.series[k * count..(k + 1) * count];
            buffers.workspace.drift_along(&block.plan, outside);
            if k > 0 {
                let drift = buffers.workspace.drift.as_flattened_mut();
                self.add_bends(&block.plan, drift, k);
                let before = &self.series[(k - 1) * count..k * count];
                bend_equations(&block.plan, (before, k), &mut self.factors, drift);
            }
            buffers.solve_drift();
            // Coefficients of higher orders are too small to gain.
            if k < 2 {
                buffers.refine(1);
            }
            let coefficients = &mut self.series[k * count..(k + 1) * count];
            for (unknown, change) in buffers.changes(block) {
                coefficients[unknown] = change;
            }
            take_rates(&mut self.rates, &block.plan, coefficients, k + 1);
        }
    }

    /// Adds to the drift what the joints' own motion says about the coefficient of order `k + 1`.
    fn add_bends(&mut self, plan: &BlockPlan, drift: &mut [f64], k: usize) {
        let share = 1.0 / (k + 1) as f64;
        for item in &plan.loops {
            let (mut link, mut sum) = ([0.0; 6], LaneTwists::default());
            let range = item.groups.clone();
            let groups = plan.groups[range.clone()].iter();
            for (planned, series) in groups.zip(&mut self.groups[range]) {
                let rates = &self.rates[..];
                // The joints' Taylor coefficients of order k follow from those of lower order.
                match k {
                    1 => series.advance::<1>(planned, rates, &mut link),
                    2 => series.advance::<2>(planned, rates, &mut link),
                    _ => series.advance::<3>(planned, rates, &mut link),
                }
                sum.add_scaled(&series.bend, f64x4::ONE);
            }
            let (turn, shift) = (sum.angular.total() * share, sum.linear.total() * share);
            let six = residual_of(turn, shift, item.size);
            for (row, component) in drift[item.row..].iter_mut().zip(&item.components) {
                *row += six[*component];
            }
        }
    }
}

impl GroupSeries {
    /// Coefficient `K` of the joints' twists, from coefficient `K - 1` of the arguments' `rates` and those before. `link` is
    /// coefficient `K - 1` of the twist of the link before, then of the one after.
    #[inline(never)]
    fn advance<const K: usize>(
        &mut self,
        planned: &PlannedGroup,
        rates: &[f64],
        link: &mut [f64; 6],
    ) {
        let [a, b, c, d] = planned.arguments;
        self.rates[K - 1] = [rates[a], rates[b], rates[c], rates[d]];
        let rate = |order: usize| f64x4::new(self.rates[order - 1]);
        let mut made = self.bend;
        // Leibniz: the K-th coefficient of every twist from those below it.
        made.add_scaled(&self.own[0], rate(K));
        self.before[K - 1] = made.sums_before(link);
        let mut next = LaneTwists::default();
        for i in 0..K {
            next.add_bracket(&self.before[i], &self.own[K - 1 - i]);
        }
        self.own[K] = next.scaled(all_lanes(1.0 / K as f64));
        let mut bend = LaneTwists::default();
        for i in 1..=K {
            bend.add_scaled(&self.own[i], rate(K + 1 - i));
        }
        self.bend = bend;
    }
}

/// Adds to the drift what equations of second degree say about the coefficient of order `k + 1`, from those of lower order:
/// those `before` have order `k`. Their factors' coefficients are kept in `factors`.
fn bend_equations(
    plan: &BlockPlan,
    (before, k): (&[f64], usize),
    factors: &mut Vec<[f64; HIGHEST_ORDER]>,
    drift: &mut [f64],
) {
    let mut first = 0;
    for equation in &plan.equations {
        let Some(form) = &equation.quadratic else {
            continue;
        };
        let own = first..first + form.factor_count();
        first = own.end;
        if factors.len() < first {
            factors.resize(first, [0.0; HIGHEST_ORDER]);
        }
        form.take_order(before, k, &mut factors[own.clone()]);
        drift[equation.row] += equation.scale * form.bend(&factors[own], k + 1);
    }
}

/// Coefficient `order - 1` of the arguments' rates from coefficient `order` of all coordinates.
fn take_rates(rates: &mut Vec<f64>, plan: &BlockPlan, coefficients: &[f64], order: usize) {
    rates.clear();
    rates.resize(plan.arguments.len(), 0.0);
    for term in &plan.terms {
        rates[term.argument] += order as f64 * term.coefficient * coefficients[term.slot];
    }
}

/// The larger magnitude; NaN propagates.
fn larger_or_nan(known: f64, value: f64) -> f64 {
    let value = value.abs();
    if value.is_nan() || value > known {
        value
    } else {
        known
    }
}
