//! A loop's product with 23 digits, its skew residual, and bounds of its derivatives.
//!
//! The residual here is the skew part of the rotation and the translation over the size: unlike the rotation vector
//! that Newton uses, it is a plain entry of a product, so that its second derivatives have simple bounds.

use super::product::Product;
use crate::kinematics::structure::proof_chain::{LoopPlan, PlannedJoint};
use crate::kinematics::structure::proof_plan::ProofArgument;
use crate::model::chain::ElementaryMotion;
use crate::model::expression::Affine;
use crate::numbers::double_double::DoubleDouble;
use crate::numbers::rounding::{DECIMAL, GROW, LONG_STEP, SIN_COS, U};
use crate::numbers::sin_cos::{SinCosFactor, sin_cos};
use glam::{DMat3, DVec3};

/// An argument's value and the uncertainty of its constants.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArgumentDouble {
    value: SinCosFactor,
    sin: SinCosFactor,
    cos: SinCosFactor,
    /// As a length: scene's unit.
    pub open_length: f64,
    /// As an angle, sine and cosine included: radians.
    pub open_angle: f64,
}

impl ArgumentDouble {
    /// Evaluates an affine form at `coordinates + rests`; missing rests are zero.
    pub fn new(form: &Affine, coordinates: &[f64], rests: &[f64]) -> Self {
        let (value, open) = affine_value(form, coordinates, rests);
        let (sin, cos) = sin_cos(value);
        Self {
            sin,
            cos,
            // An error of either function rotates and stretches the pair by as much; twice that covers both.
            open_angle: open + 2.0 * SIN_COS,
            ..Self::length(value, open)
        }
    }

    /// Values needed for the loops: none of arguments outside loops, no sine and cosine of a length.
    pub fn of(argument: &ProofArgument, coordinates: &[f64], rests: &[f64]) -> Self {
        match argument {
            ProofArgument { is_used: false, .. } => Self::default(),
            ProofArgument {
                turns: true, form, ..
            } => Self::new(form, coordinates, rests),
            ProofArgument { form, .. } => {
                let (value, open) = affine_value(form, coordinates, rests);
                Self::length(value, open)
            }
        }
    }

    fn length(value: DoubleDouble, open: f64) -> Self {
        Self {
            value: SinCosFactor::short(value),
            open_length: open,
            ..Self::default()
        }
    }
}

/// The value with 31 digits, and the uncertainty from the errors of its constants.
pub fn affine_value(form: &Affine, coordinates: &[f64], rests: &[f64]) -> (DoubleDouble, f64) {
    let mut open = form.constant.error();
    let mut value = form.constant.value();
    for &(slot, c) in &form.terms {
        value = value + c.value() * coordinates[slot];
        if let Some(rest) = rests.get(slot).filter(|rest| **rest != 0.0) {
            value = value + c.value() * *rest;
        }
        open += c.error() * coordinates[slot].abs();
    }
    (value, open)
}

/// A joint at the pose.
#[derive(Clone, Copy, Debug)]
pub struct PoseJoint {
    /// Kind of motion.
    pub motion: ElementaryMotion,
    /// Place of its argument.
    pub argument: usize,
    axis: DVec3,
    origin: DVec3,
    /// For every pose in the ball, the distance of the loop's end from the joint is at most this (sizes).
    pub reach: f64,
}

/// A loop at a pose.
#[derive(Clone, Debug, Default)]
pub struct LoopAtPose {
    /// Skew part, then translation over the size.
    pub residual: [f64; 6],
    /// Uncertainty of rotation and translation rows from rounding and dimensions.
    pub open: [f64; 2],
    /// Trace of the rotation.
    pub trace: f64,
    /// Joints in order.
    pub joints: Vec<PoseJoint>,
    spin_to_skew: DMat3,
    translation: DVec3,
    size: f64,
}

/// Applies the fixed pose before a joint.
fn pass_fixed(product: &mut Product, joint: &PlannedJoint) {
    for (axis, shift) in joint.shift.iter().enumerate() {
        if let Some(shift) = shift {
            product.shift(axis, shift);
        }
    }
    if let Some(turn) = &joint.turn {
        product.turn(turn);
    }
}

impl LoopAtPose {
    /// Evaluates a loop. `play` bounds the change of an argument in the ball.
    pub fn evaluate(
        &mut self,
        plan: &LoopPlan,
        arguments: &[ArgumentDouble],
        play: impl Fn(usize) -> f64,
        size: f64,
    ) {
        let product = self.walk(plan, arguments);
        let (open, total) = self.reaches(plan, arguments, play, size);
        let r = product.rotation.map(|column| column.entries());
        let skew = |i: (usize, usize), j: (usize, usize)| (r[i.0][i.1] - r[j.0][j.1]).hi * 0.5;
        let t = product.translation.leading() / size;
        self.trace = r[0][0].hi + r[1][1].hi + r[2][2].hi;
        self.residual = [
            skew((1, 2), (2, 1)),
            skew((2, 0), (0, 2)),
            skew((0, 1), (1, 0)),
            t.x,
            t.y,
            t.z,
        ];
        // The last rounding loses a few units of the residual.
        let lost = LONG_STEP * plan.steps as f64;
        let last = |v: f64| 4.0 * U * v.abs();
        let turned = self.residual[..3].iter().map(|v| last(*v));
        self.open = [
            open[0] + lost + turned.fold(0.0, f64::max),
            open[1] + lost * (1.0 + total) + last(t.length()),
        ];
        let rotation = {
            let [x, y, z] = product.rotation.map(|column| column.leading());
            DMat3::from_cols(x, y, z)
        };
        self.spin_to_skew = (DMat3::from_diagonal(DVec3::splat(self.trace)) - rotation) * 0.5;
        self.translation = product.translation.leading();
        self.size = size;
    }

    /// The product, and the joints with their axes and places but not yet their reaches.
    fn walk(&mut self, plan: &LoopPlan, arguments: &[ArgumentDouble]) -> Product {
        let mut product = Product::identity();
        self.joints.clear();
        for joint in &plan.joints {
            pass_fixed(&mut product, joint);
            // The joint's axis and a point of it, as the start of the loop sees them: they make its column.
            self.joints.push(PoseJoint {
                motion: joint.motion,
                argument: joint.argument,
                axis: product.rotation[joint.axis].leading() * joint.sign,
                origin: product.translation.leading(),
                reach: 0.0,
            });
            let argument = &arguments[joint.argument];
            // Its own motion with more digits than f64 has; a reversed turn changes only the sign of the sine.
            match joint.motion {
                ElementaryMotion::Translation => {
                    product.shift(joint.axis, &argument.value.signed(joint.sign));
                }
                ElementaryMotion::Rotation => {
                    product.rotate(joint.axis, &argument.sin.signed(joint.sign), &argument.cos);
                }
            }
        }
        // The fixed pose at the end. Of a closed loop the product is the identity.
        if let Some(end) = &plan.end {
            pass_fixed(&mut product, end);
        }
        product
    }

    /// Fills the joints' reaches from the end of the chain; returns the uncertainty of fixed poses, and the whole
    /// length.
    fn reaches(
        &mut self,
        plan: &LoopPlan,
        arguments: &[ArgumentDouble],
        play: impl Fn(usize) -> f64,
        size: f64,
    ) -> ([f64; 2], f64) {
        let mut open = [0.0; 2];
        let mut reach = 0.0;
        // A rotation that is off moves the end of the loop by as much times its distance.
        let mut add = |[turn, shift]: [f64; 2], reach: f64| {
            open[0] += turn;
            open[1] += shift / size + turn * reach;
        };
        // From the end back: by the triangle inequality the reach is at most the sum of all lengths behind.
        for (joint, planned) in self.joints.iter_mut().zip(&plan.joints).rev() {
            add(planned.open_behind, reach);
            reach += planned.length_behind / size;
            // Grown for the rounding of the sum.
            joint.reach = reach * GROW;
            // A slide counts with its largest length in the ball.
            if joint.motion == ElementaryMotion::Translation {
                let length = arguments[joint.argument].value.whole.abs() + play(joint.argument);
                reach += length / size;
            }
        }
        add(plan.open_before, reach);
        (open, reach + plan.length_before / size)
    }

    /// Largest change of rotation and translation rows if every number of the loop that f64 cannot represent differs by
    /// a unit in its last place.
    pub fn last_units(&self, plan: &LoopPlan, arguments: &[ArgumentDouble]) -> [f64; 2] {
        let unit = |is_open: bool, size: f64| if is_open { DECIMAL * size } else { 0.0 };
        let mut sums = [0.0; 2];
        // First order, as for the uncertainties: a turn moves the end by its angle times the reach.
        let mut add = |[turn, shift]: [f64; 2], reach: f64| {
            sums[0] += turn;
            sums[1] += shift / self.size + turn * reach;
        };
        // Only what has an error bound at all is not representable.
        let fixed = |[turn, shift]: [f64; 2], [angle, length]: [f64; 2]| {
            [unit(turn > 0.0, angle), unit(shift > 0.0, length)]
        };
        // The fixed pose before the first joint turns all that follows, the slide of that joint included.
        let whole = self.joints.first().map_or(0.0, |joint| {
            let length = match joint.motion {
                ElementaryMotion::Rotation => 0.0,
                ElementaryMotion::Translation => arguments[joint.argument].value.whole.abs(),
            };
            joint.reach + length / self.size
        });
        add(
            fixed(plan.open_before, [plan.angle_before, plan.length_before]),
            whole,
        );
        // After each joint its own value, and the fixed pose behind it.
        for (joint, planned) in self.joints.iter().zip(&plan.joints) {
            add(
                fixed(
                    planned.open_behind,
                    [planned.angle_behind, planned.length_behind],
                ),
                joint.reach,
            );
            let argument = &arguments[joint.argument];
            let value = unit(argument.open_length > 0.0, argument.value.whole.abs());
            match joint.motion {
                ElementaryMotion::Rotation => add([value, 0.0], joint.reach),
                ElementaryMotion::Translation => add([0.0, value], 0.0),
            }
        }
        sums
    }

    /// Derivative of the six residuals by the joint's own motion.
    pub fn column(&self, joint: &PoseJoint) -> [f64; 6] {
        let (turn, shift) = match joint.motion {
            ElementaryMotion::Translation => (DVec3::ZERO, joint.axis),
            ElementaryMotion::Rotation => (
                self.spin_to_skew * joint.axis,
                joint.axis.cross(self.translation - joint.origin),
            ),
        };
        crate::kinematics::loops::residual::residual_of(turn, shift, self.size)
    }

    /// Bounds of the second derivative of rotation and translation rows along any direction in which argument `a`
    /// changes by at most `rate(a)`.
    pub fn second_derivatives(&self, rate: impl Fn(usize) -> f64) -> [f64; 2] {
        let (mut turned, mut translation) = (0.0, 0.0);
        for joint in &self.joints {
            let alpha = rate(joint.argument);
            match joint.motion {
                ElementaryMotion::Rotation => {
                    translation += joint.reach * alpha * (alpha + 2.0 * turned);
                    turned += alpha;
                }
                ElementaryMotion::Translation => translation += 2.0 * turned * alpha / self.size,
            }
        }
        [turned * turned, translation]
    }

    /// Bounds of the first derivative of rotation and translation rows in the same way; the first bounds the rotation
    /// itself.
    pub fn first_derivatives(&self, rate: impl Fn(usize) -> f64) -> [f64; 2] {
        let mut bounds = [0.0; 2];
        for joint in &self.joints {
            let alpha = rate(joint.argument);
            match joint.motion {
                ElementaryMotion::Rotation => {
                    bounds[0] += alpha;
                    bounds[1] += alpha * joint.reach;
                }
                ElementaryMotion::Translation => bounds[1] += alpha / self.size,
            }
        }
        bounds
    }
}
