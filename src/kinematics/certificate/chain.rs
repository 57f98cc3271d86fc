//! A loop's product with 31 digits, its skew residual, and bounds of its derivatives.
//!
//! The residual here is the skew part of the rotation and the translation over the size: unlike the rotation vector
//! that Newton uses, it is a plain entry of a product, so that its second derivatives have simple bounds.

use super::double::Double;
use crate::math::{Pose, sin_cos};
use crate::model::chain::{Motion, Step};
use crate::model::expression::Affine;
use glam::{DMat3, DVec3};

/// Unit roundoff of f64.
pub const U: f64 = f64::EPSILON / 2.0;

/// A fixed rotation that is not a quarter turn was folded from a few rounded factors (radians).
const FIXED_ROTATION: f64 = 8.0 * U;

/// Relative: a translation folded through such a rotation.
const FOLDED_TRANSLATION: f64 = 8.0 * U;

/// An argument's value and how far the numbers it was made from leave it open.
#[derive(Clone, Copy, Debug, Default)]
pub struct ArgumentDouble {
    value: Double,
    sin: Double,
    cos: Double,
    /// As a length: scene's unit.
    pub open_length: f64,
    /// As an angle, sine and cosine included: radians.
    pub open_angle: f64,
}

impl ArgumentDouble {
    /// Evaluates an affine form. The coefficients that are no whole numbers are known to half a unit only.
    pub fn new(form: &Affine, coordinates: &[f64]) -> Self {
        let (value, open_length) = affine_value(form, coordinates);
        let (sin, cos) = sin_cos(value.hi);
        // The pair is scaled to the unit circle; `open_by_functions` says how far its angle can be off.
        let excess = Double::product(sin, sin) + Double::product(cos, cos) - Double::from(1.0);
        let shrink = Double::from(1.0) - excess * 0.5 + excess * excess * 0.375;
        Self {
            value,
            sin: shrink * sin,
            cos: shrink * cos,
            open_length,
            open_angle: open_length + value.lo.abs() + open_by_functions(sin, cos),
        }
    }
}

/// The angle (radians) by which a sine and a cosine can be off that are each right within one unit in the last place:
/// the stated assumption about `libm::sincos`.
fn open_by_functions(sin: f64, cos: f64) -> f64 {
    let unit = |v: f64| v.abs().next_up() - v.abs();
    (unit(sin) * cos.abs() + unit(cos) * sin.abs()) * (1.0 + 1e-10)
}

/// The value with 31 digits, and the effect of coefficients that are rounded decimals.
pub fn affine_value(form: &Affine, coordinates: &[f64]) -> (Double, f64) {
    let rounded = |v: f64| if v.fract() == 0.0 { 0.0 } else { 2.0 * U };
    let mut open = rounded(form.constant) * form.constant.abs();
    let mut value = Double::from(form.constant);
    for &(slot, c) in &form.terms {
        value = value + Double::product(c, coordinates[slot]);
        open += rounded(c) * (c * coordinates[slot]).abs();
    }
    (value, open)
}

/// A joint at the pose.
#[derive(Clone, Copy, Debug)]
pub struct Joint {
    /// Kind of motion.
    pub motion: Motion,
    /// Index of its argument.
    pub argument: usize,
    axis: DVec3,
    origin: DVec3,
    /// No pose in the ball has the loop's end farther from the joint (sizes).
    pub reach: f64,
}

/// A loop at a pose.
#[derive(Clone, Debug)]
pub struct LoopAtPose {
    /// Skew part, then translation over the size.
    pub residual: [f64; 6],
    /// How far rounding and rounded dimensions leave rotation and translation rows open.
    pub open: [f64; 2],
    /// Trace of the rotation.
    pub trace: f64,
    /// Joints in order.
    pub joints: Vec<Joint>,
    spin_to_skew: DMat3,
    translation: DVec3,
    size: f64,
}

type Columns = [[Double; 3]; 3];

struct Product {
    rotation: Columns,
    translation: [Double; 3],
}

fn hi(v: &[Double; 3]) -> DVec3 {
    DVec3::new(v[0].hi, v[1].hi, v[2].hi)
}

impl Product {
    fn identity() -> Self {
        let e = |k: usize| [0, 1, 2].map(|i| Double::from(if i == k { 1.0 } else { 0.0 }));
        Self {
            rotation: [e(0), e(1), e(2)],
            translation: Default::default(),
        }
    }

    fn shift(&mut self, axis: usize, by: Double) {
        for k in 0..3 {
            self.translation[k] = self.translation[k] + self.rotation[axis][k] * by;
        }
    }

    fn rotate(&mut self, axis: usize, sin: Double, cos: Double) {
        let (b, c) = ((axis + 1) % 3, (axis + 2) % 3);
        for k in 0..3 {
            let (x, y) = (self.rotation[b][k], self.rotation[c][k]);
            self.rotation[b][k] = x * cos + y * sin;
            self.rotation[c][k] = y * cos - x * sin;
        }
    }

    fn fixed(&mut self, pose: &Pose) {
        for axis in 0..3 {
            if pose.translation[axis] != 0.0 {
                self.shift(axis, Double::from(pose.translation[axis]));
            }
        }
        if pose.rotation == DMat3::IDENTITY {
            return;
        }
        let old = self.rotation;
        for (j, column) in self.rotation.iter_mut().enumerate() {
            let m = pose.rotation.col(j);
            for (k, entry) in column.iter_mut().enumerate() {
                *entry = old[0][k] * m.x + old[1][k] * m.y + old[2][k] * m.z;
            }
        }
    }
}

/// Rotation (radians) and translation (scene's unit) by which a stored fixed pose may differ from the one meant.
fn open_fixed(pose: &Pose) -> [f64; 2] {
    let r = pose.rotation;
    let quarter_turns = r.to_cols_array().iter().all(|v| v.fract() == 0.0);
    let length = pose.translation.length();
    if quarter_turns {
        let whole = pose.translation.to_array().iter().all(|v| v.fract() == 0.0);
        return [0.0, if whole { 0.0 } else { 2.0 * U * length }];
    }
    let defect = (r.transpose() * r - DMat3::IDENTITY)
        .to_cols_array()
        .iter()
        .map(|v| v * v)
        .sum::<f64>()
        .sqrt();
    [FIXED_ROTATION + defect, FOLDED_TRANSLATION * length]
}

/// The product, and the joints with their axes and places but not yet their reaches.
fn walk(steps: &[Step], arguments: &[ArgumentDouble]) -> (Product, Vec<Joint>) {
    let mut product = Product::identity();
    let mut joints = Vec::new();
    for step in steps {
        match step {
            Step::Fixed(pose) => product.fixed(pose),
            Step::Joint {
                motion,
                axis,
                argument,
                sign,
            } => {
                joints.push(Joint {
                    motion: *motion,
                    argument: *argument,
                    axis: hi(&product.rotation[*axis]) * *sign,
                    origin: hi(&product.translation),
                    reach: 0.0,
                });
                let a = &arguments[*argument];
                match motion {
                    Motion::Translation => product.shift(*axis, a.value * *sign),
                    Motion::Rotation => product.rotate(*axis, a.sin * *sign, a.cos),
                }
            }
        }
    }
    (product, joints)
}

/// The loop at the pose. `play` is by how much an argument can change in the ball.
pub fn evaluate(
    steps: &[Step],
    arguments: &[ArgumentDouble],
    play: impl Fn(usize) -> f64,
    size: f64,
) -> LoopAtPose {
    let (product, mut joints) = walk(steps, arguments);
    let (open, total) = reaches(steps, arguments, play, size, &mut joints);
    let r = &product.rotation;
    let skew = |a: Double, b: Double| (a - b).hi * 0.5;
    let t = hi(&product.translation) / size;
    let trace = r[0][0].hi + r[1][1].hi + r[2][2].hi;
    let rotation = DMat3::from_cols(hi(&r[0]), hi(&r[1]), hi(&r[2]));
    let residual = [
        skew(r[1][2], r[2][1]),
        skew(r[2][0], r[0][2]),
        skew(r[0][1], r[1][0]),
        t.x,
        t.y,
        t.z,
    ];
    // Products of two f64 parts lose less than this a step; the last rounding loses a few units of the residual.
    let lost = 1e-29 * steps.len() as f64;
    let last = |v: f64| 4.0 * U * v.abs();
    LoopAtPose {
        residual,
        open: [
            open[0] + lost + residual[..3].iter().map(|v| last(*v)).fold(0.0, f64::max),
            open[1] + lost * (1.0 + total) + last(t.length()),
        ],
        trace,
        joints,
        spin_to_skew: (DMat3::from_diagonal(DVec3::splat(trace)) - rotation) * 0.5,
        translation: hi(&product.translation),
        size,
    }
}

/// Fills the joints' reaches from the end of the chain; returns what fixed poses leave open, and the whole length.
fn reaches(
    steps: &[Step],
    arguments: &[ArgumentDouble],
    play: impl Fn(usize) -> f64,
    size: f64,
    joints: &mut [Joint],
) -> ([f64; 2], f64) {
    let mut open = [0.0; 2];
    let mut reach = 0.0;
    let mut joint = joints.len();
    for step in steps.iter().rev() {
        match step {
            Step::Fixed(pose) => {
                let [turn, shift] = open_fixed(pose);
                open[0] += turn;
                open[1] += shift / size + turn * reach;
                reach += pose.translation.length() / size;
            }
            Step::Joint {
                motion, argument, ..
            } => {
                joint -= 1;
                joints[joint].reach = reach * (1.0 + 1e-12);
                if *motion == Motion::Translation {
                    reach += (arguments[*argument].value.hi.abs() + play(*argument)) / size;
                }
            }
        }
    }
    (open, reach)
}

impl LoopAtPose {
    /// Derivative of the six residuals by the joint's own motion.
    pub fn column(&self, joint: &Joint) -> [f64; 6] {
        let (turn, shift) = match joint.motion {
            Motion::Translation => (DVec3::ZERO, joint.axis),
            Motion::Rotation => (
                self.spin_to_skew * joint.axis,
                joint.axis.cross(self.translation - joint.origin),
            ),
        };
        super::super::closure::residual_of(turn, shift, self.size)
    }

    /// Bounds of the second derivative of rotation and translation rows along any direction in which argument `a`
    /// changes by at most `rate(a)`.
    pub fn second_derivatives(&self, rate: impl Fn(usize) -> f64) -> [f64; 2] {
        let (mut turned, mut translation) = (0.0, 0.0);
        for joint in &self.joints {
            let alpha = rate(joint.argument);
            match joint.motion {
                Motion::Rotation => {
                    translation += joint.reach * alpha * (alpha + 2.0 * turned);
                    turned += alpha;
                }
                Motion::Translation => translation += 2.0 * turned * alpha / self.size,
            }
        }
        [turned * turned, translation]
    }

    /// Bounds of the third derivative of rotation and translation rows, twice along a direction in which argument `a`
    /// changes by at most `one(a)` and once along one in which it changes by `two(a)`.
    pub fn third_derivatives(
        &self,
        one: impl Fn(usize) -> f64,
        two: impl Fn(usize) -> f64,
    ) -> [f64; 2] {
        let (mut p, mut q, mut translation) = (0.0, 0.0, 0.0);
        for joint in &self.joints {
            let (alpha, beta) = (one(joint.argument), two(joint.argument));
            match joint.motion {
                Motion::Rotation => {
                    let before = p * p * q;
                    p += alpha;
                    q += beta;
                    translation += joint.reach * (p * p * q - before).max(0.0) * (1.0 + 1e-12);
                }
                Motion::Translation => {
                    translation += (p * p * beta + 2.0 * p * q * alpha) / self.size;
                }
            }
        }
        [p * p * q, translation]
    }

    /// Rates of the columns of all joints when the arguments move at `rate(a)`. Taken at a closed pose, whose rotation
    /// is the identity.
    pub fn column_rates(&self, rate: impl Fn(usize) -> f64) -> Vec<[f64; 6]> {
        // Velocity field of the frame reached so far: v(p) = shift + spin x p.
        let (mut spin, mut shift) = (DVec3::ZERO, DVec3::ZERO);
        let mut here = Vec::with_capacity(self.joints.len());
        for joint in &self.joints {
            here.push((spin, shift + spin.cross(joint.origin)));
            let twist = joint.axis * rate(joint.argument);
            match joint.motion {
                Motion::Translation => shift += twist,
                Motion::Rotation => {
                    spin += twist;
                    shift -= twist.cross(joint.origin);
                }
            }
        }
        let end = shift + spin.cross(self.translation);
        let of = |(joint, (turning, moving)): (&Joint, (DVec3, DVec3))| {
            let axis_rate = turning.cross(joint.axis);
            let (turn, go) = match joint.motion {
                Motion::Translation => (DVec3::ZERO, axis_rate),
                Motion::Rotation => (
                    axis_rate - spin.cross(joint.axis) * 0.5,
                    axis_rate.cross(self.translation - joint.origin)
                        + joint.axis.cross(end - moving),
                ),
            };
            super::super::closure::residual_of(turn, go, self.size)
        };
        self.joints.iter().zip(here).map(of).collect()
    }

    /// Bounds of the first derivative of rotation and translation rows, likewise; by how much the rotation can turn
    /// is the first.
    pub fn first_derivatives(&self, rate: impl Fn(usize) -> f64) -> [f64; 2] {
        let mut bounds = [0.0; 2];
        for joint in &self.joints {
            let alpha = rate(joint.argument);
            match joint.motion {
                Motion::Rotation => {
                    bounds[0] += alpha;
                    bounds[1] += alpha * joint.reach;
                }
                Motion::Translation => bounds[1] += alpha / self.size,
            }
        }
        bounds
    }
}
