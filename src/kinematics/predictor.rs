//! Prediction of the pose at other inputs: the Taylor polynomial of the unknowns along a straight line of the inputs.
//!
//! At a closed pose the sum of the joints' twists ξⱼ times their rates vanishes, and goes on vanishing. A joint's twist
//! moves with the links before it, ξⱼ' = [V, ξⱼ] with V the sum of the twists times rates of the joints before. So the
//! coefficients of ξⱼ and V follow from one another, one pass along the loop an order, and the highest coefficient of the
//! unknowns comes from the Jacobian of the pose. (Brackets of twists: Murray, Li and Sastry, A Mathematical
//! Introduction to Robotic Manipulation, chapter 2.)

use super::closure::{JointTwist, residual_of};
use super::newton::{BlockBuffers, Corrector};
use super::plan::BlockPlan;
use super::structure::{Block, Structure};
use crate::model::chain::Motion;
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// Highest order. One more costs a pass along the joints, one less an iteration of Newton's method.
pub const HIGHEST_ORDER: usize = 4;

/// How a prediction was made.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Prediction {
    /// Length of the step along the tangent: largest change in scaled unknowns.
    pub length: f64,
    /// By how much the prediction departs from the tangent, likewise.
    pub bend: f64,
}

/// A screw: angular and linear part at the origin of the loop's base.
#[derive(Clone, Copy, Debug, Default)]
struct Twist {
    angular: DVec3,
    linear: DVec3,
}

impl Twist {
    fn of(joint: &JointTwist) -> Self {
        match joint.motion {
            Motion::Rotation => Self {
                angular: joint.axis,
                linear: joint.origin.cross(joint.axis),
            },
            Motion::Translation => Self {
                angular: DVec3::ZERO,
                linear: joint.axis,
            },
        }
    }

    #[inline]
    fn add(&mut self, other: &Self, factor: f64) {
        self.angular += other.angular * factor;
        self.linear += other.linear * factor;
    }

    /// [self, other].
    #[inline]
    fn bracket(&self, other: &Self) -> Self {
        Self {
            angular: self.angular.cross(other.angular),
            linear: self.angular.cross(other.linear) + self.linear.cross(other.angular),
        }
    }
}

/// Coefficients of a joint's twist, and of the twist of the link before it.
#[derive(Clone, Copy, Debug, Default)]
struct JointSeries {
    own: [Twist; HIGHEST_ORDER],
    before: [Twist; HIGHEST_ORDER],
}

/// Buffers of the series.
#[derive(Clone, Debug, Default)]
pub struct Predictor {
    /// Coefficients of all coordinates, order by order.
    series: Vec<f64>,
    joints: Vec<JointSeries>,
    /// Coefficients of the arguments' values.
    arguments: Vec<[f64; HIGHEST_ORDER + 1]>,
}

impl Predictor {
    /// Moves `coordinates` (unknowns and inputs of a closed pose) to the given inputs, the unknowns by the Taylor
    /// polynomial of `order`, 1 to [`HIGHEST_ORDER`]. Where a formula is involved the tangent is all.
    pub fn predict(
        &mut self,
        mechanism: &Mechanism,
        structure: &Structure,
        corrector: &mut Corrector,
        coordinates: &mut [f64],
        inputs: &[f64],
        order: usize,
    ) -> Prediction {
        let (n, count) = (mechanism.unknowns.len(), coordinates.len());
        let affine = structure.blocks.iter().all(|block| block.plan.is_affine);
        let order = if affine {
            order.clamp(1, HIGHEST_ORDER)
        } else {
            1
        };
        self.series.clear();
        self.series.resize(count * order, 0.0);
        for (k, input) in inputs.iter().enumerate() {
            self.series[n + k] = input - coordinates[n + k];
        }
        for (block, buffers) in structure.blocks.iter().zip(&mut corrector.blocks) {
            buffers.linearise(mechanism, block, coordinates);
            self.block_series(mechanism, block, buffers, count, order);
        }
        let mut prediction = Prediction {
            length: 0.0,
            bend: 0.0,
        };
        for (slot, value) in coordinates.iter_mut().enumerate().take(n) {
            let tangent = self.series[slot];
            let bend: f64 = (1..order).map(|k| self.series[k * count + slot]).sum();
            let scale = mechanism.scale_of(slot);
            prediction.length = largest(prediction.length, tangent / scale);
            prediction.bend = largest(prediction.bend, bend / scale);
            *value += tangent + bend;
        }
        // The inputs are exactly the drive's, not the sum of differences.
        coordinates[n..].copy_from_slice(inputs);
        prediction
    }

    /// Coefficients of the block's unknowns, given those of all coordinates from outside.
    fn block_series(
        &mut self,
        mechanism: &Mechanism,
        block: &Block,
        buffers: &mut BlockBuffers,
        count: usize,
        order: usize,
    ) {
        self.joints.clear();
        self.joints
            .extend(buffers.workspace.twists().iter().map(|joint| {
                let mut series = JointSeries::default();
                series.own[0] = Twist::of(joint);
                series
            }));
        self.arguments.clear();
        self.arguments
            .resize(block.plan.arguments.len(), [0.0; HIGHEST_ORDER + 1]);
        for k in 0..order {
            let outside = &self.series[k * count..(k + 1) * count];
            buffers.workspace.drift_along(&block.plan, outside);
            if k > 0 {
                self.add_bends(&block.plan, &mut buffers.workspace.drift, mechanism.size, k);
            }
            buffers.solve_drift();
            for (unknown, step) in block.unknowns.iter().zip(&buffers.step) {
                self.series[k * count + *unknown] = mechanism.scale_of(*unknown) * step;
            }
            let coefficients = &self.series[k * count..(k + 1) * count];
            take_rates(&mut self.arguments, &block.plan, coefficients, k + 1);
        }
    }

    /// Adds to the drift what the joints' own motion says about the coefficient of order `k + 1`.
    fn add_bends(&mut self, plan: &BlockPlan, drift: &mut [f64], size: f64, k: usize) {
        let share = 1.0 / (k + 1) as f64;
        for item in &plan.loops {
            let (mut link, mut sum) = (Twist::default(), Twist::default());
            let range = item.joints.clone();
            for (joint, series) in plan.joints[range.clone()]
                .iter()
                .zip(&mut self.joints[range])
            {
                let rates = &self.arguments[joint.argument];
                match k {
                    1 => series.advance::<1>(rates, &mut link, &mut sum),
                    2 => series.advance::<2>(rates, &mut link, &mut sum),
                    _ => series.advance::<3>(rates, &mut link, &mut sum),
                }
            }
            let (turn, shift) = (sum.angular * share, sum.linear * share);
            let six = residual_of(turn, shift, size);
            for (row, component) in drift[item.row..].iter_mut().zip(&item.components) {
                *row += six[*component];
            }
        }
    }
}

impl JointSeries {
    /// Coefficient `K` of the joint's twist, from the coefficients up to `K` of its argument. `link` is coefficient
    /// `K - 1` of the twist of the link before, then of the one after; to `sum` goes what the twist's change
    /// contributes to coefficient `K` of the loop's whole twist.
    #[inline]
    fn advance<const K: usize>(
        &mut self,
        argument: &[f64; HIGHEST_ORDER + 1],
        link: &mut Twist,
        sum: &mut Twist,
    ) {
        let rate = |i: usize| i as f64 * argument[i];
        self.before[K - 1] = *link;
        let mut next = Twist::default();
        for i in 0..K {
            link.add(&self.own[i], rate(K - i));
            next.add(&self.before[i].bracket(&self.own[K - 1 - i]), 1.0);
        }
        self.own[K] = Twist::default();
        self.own[K].add(&next, 1.0 / K as f64);
        for i in 1..=K {
            sum.add(&self.own[i], rate(K + 1 - i));
        }
    }
}

/// Coefficient `order` of the arguments' values from that of all coordinates.
fn take_rates(
    arguments: &mut [[f64; HIGHEST_ORDER + 1]],
    plan: &BlockPlan,
    coefficients: &[f64],
    order: usize,
) {
    for (argument, planned) in arguments.iter_mut().zip(&plan.arguments) {
        let shares = plan.shares[planned.shares.clone()].iter();
        let terms = shares.map(|share| share.coefficient * coefficients[share.slot]);
        argument[order] = terms.sum();
    }
}

/// The larger magnitude; what is no number wins.
fn largest(known: f64, value: f64) -> f64 {
    let value = value.abs();
    if value.is_nan() || value > known {
        value
    } else {
        known
    }
}
