//! The product of a chain, step by step, in any arithmetic: poses, series, derivatives, formulas, enclosures.
//!
//! Three products are separate, because they are performance-critical or exact: the joints of a loop with its
//! derivatives (`kinematics/loops`), eight poses at once (`kinematics/abreast`), and two f64 per number
//! (`kinematics/certificate/pose`). Tests compare the first and the last with this one, and lanes with the first.

use super::chain::{ArgumentValue, Chain, ChainJoint, ChainStep, ElementaryMotion};
use super::fixed::{FixedPose, PoseError};
use crate::math::Pose;
use crate::numbers::constant::Constant;
use crate::numbers::rounding::DECIMAL;
use crate::numbers::scalar::{Ring, Sign};
use glam::{DMat3, DVec3};

/// The state carried along a chain: a frame, in some arithmetic, that every step moves along its own axes.
pub trait Carried {
    /// Value of a joint in this arithmetic.
    type Argument;

    /// Applies a constant pose.
    fn fix(&mut self, fixed: &FixedPose);

    /// Moves the frame along its own axis.
    fn shift(&mut self, axis: usize, sign: f64, by: &Self::Argument);

    /// Rotates the frame about its own axis.
    fn turn(&mut self, axis: usize, sign: f64, by: &Self::Argument);
}

/// Carries `frame` along the steps. `meet` is called for every joint with the frame before its motion.
#[inline]
pub fn walk_chain<F: Carried>(
    steps: &[ChainStep],
    frame: &mut F,
    arguments: &[F::Argument],
    mut meet: impl FnMut(&F, ChainJoint),
) {
    for step in steps {
        if let Some(joint) = step.joint() {
            meet(frame, joint);
        }
        step.advance(frame, arguments);
    }
}

impl ChainStep {
    /// Applies this step to the frame.
    #[inline]
    pub fn advance<F: Carried>(&self, frame: &mut F, arguments: &[F::Argument]) {
        match *self {
            Self::Fixed(pose) => frame.fix(&pose),
            Self::Joint {
                motion,
                axis,
                argument,
                sign,
            } => match motion {
                ElementaryMotion::Translation => frame.shift(axis, sign, &arguments[argument]),
                ElementaryMotion::Rotation => frame.turn(axis, sign, &arguments[argument]),
            },
        }
    }
}

impl Chain {
    /// The product at the given argument values.
    pub fn pose(&self, arguments: &[ArgumentValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        walk_chain(&self.steps, &mut pose, arguments, |_, _| {});
        pose
    }
}

impl Carried for Pose {
    type Argument = ArgumentValue;

    #[inline]
    fn fix(&mut self, fixed: &FixedPose) {
        *self = *self * *fixed;
    }

    #[inline]
    fn shift(&mut self, axis: usize, sign: f64, by: &ArgumentValue) {
        self.translation += self.rotation.col(axis) * (sign * by.value);
    }

    /// Only two columns change.
    #[inline]
    fn turn(&mut self, axis: usize, sign: f64, by: &ArgumentValue) {
        let r = &mut self.rotation;
        let (sin, cos) = (sign * by.sin, by.cos);
        let turn = |a: DVec3, b: DVec3| (a * cos + b * sin, b * cos - a * sin);
        match axis {
            0 => (r.y_axis, r.z_axis) = turn(r.y_axis, r.z_axis),
            1 => (r.z_axis, r.x_axis) = turn(r.z_axis, r.x_axis),
            _ => (r.x_axis, r.y_axis) = turn(r.x_axis, r.y_axis),
        }
    }
}

/// Three numbers.
pub type Triple<S> = [S; 3];

/// A pose whose entries are numbers of any kind.
#[derive(Clone, Copy, Debug)]
pub struct WalkFrame<S> {
    /// The frame's axes in the base frame.
    pub axes: [Triple<S>; 3],
    /// Its origin.
    pub origin: Triple<S>,
}

impl<S: Ring> WalkFrame<S> {
    /// Where every chain begins.
    pub fn identity() -> Self {
        let unit = |k: usize| [0, 1, 2].map(|i| S::number(if i == k { 1.0 } else { 0.0 }));
        Self {
            axes: [0, 1, 2].map(unit),
            origin: [S::number(0.0); 3],
        }
    }

    /// The frame at the end of a chain.
    pub fn at_end_of(steps: &[ChainStep], arguments: &[ArgumentValue<S>]) -> Self {
        let mut frame = Self::identity();
        walk_chain(steps, &mut frame, arguments, |_, _| {});
        frame
    }

    /// One part of every number of the frame.
    pub fn map<T>(self, part: impl Fn(S) -> T + Copy) -> WalkFrame<T> {
        WalkFrame {
            axes: self.axes.map(|axis| axis.map(part)),
            origin: self.origin.map(part),
        }
    }

    /// A direction of the frame in the base frame.
    pub fn direction(&self, v: [f64; 3]) -> Triple<S> {
        self.combination(v.map(Constant::exact))
    }

    fn combination(&self, v: [Constant; 3]) -> Triple<S> {
        let [x, y, z] = &self.axes;
        [0, 1, 2].map(|k| x[k].scale_by(v[0]) + y[k].scale_by(v[1]) + z[k].scale_by(v[2]))
    }

    /// A point of the frame in the base frame. Its coordinates were rounded to f64: enclosures include the error.
    pub fn point(&self, v: [f64; 3]) -> Triple<S> {
        let meant = v.map(|c| Constant::within(c, DECIMAL * c.abs()));
        add_vectors(self.combination(meant), self.origin)
    }
}

/// a + b
pub fn add_vectors<S: Ring>(a: Triple<S>, b: Triple<S>) -> Triple<S> {
    [0, 1, 2].map(|k| a[k] + b[k])
}

impl<S: Ring> Carried for WalkFrame<S> {
    type Argument = ArgumentValue<S>;

    fn fix(&mut self, fixed: &FixedPose) {
        let PoseError {
            rotation,
            translation,
        } = fixed.error;
        let known = |v: [f64; 3], error| v.map(|v| Constant::within(v, error));
        let moved = self.combination(known(fixed.translation.to_array(), translation));
        self.origin = add_vectors(self.origin, moved);
        if fixed.rotation != DMat3::IDENTITY {
            let columns = fixed.rotation.to_cols_array_2d();
            self.axes = columns.map(|column| self.combination(known(column, rotation)));
        }
    }

    fn shift(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        let value = by.value.scale(sign);
        self.origin = add_vectors(self.origin, self.axes[axis].map(|c| c * value));
    }

    /// Only two axes change.
    fn turn(&mut self, axis: usize, sign: f64, by: &Self::Argument) {
        let (i, j) = ((axis + 1) % 3, (axis + 2) % 3);
        let (sin, cos) = (by.sin.scale(sign), by.cos);
        let (a, b) = (self.axes[i], self.axes[j]);
        let (plus, minus) = (Sign::Plus, Sign::Minus);
        self.axes[i] =
            [0, 1, 2].map(|k| S::signed_products([(plus, a[k], cos), (plus, b[k], sin)]));
        self.axes[j] =
            [0, 1, 2].map(|k| S::signed_products([(plus, b[k], cos), (minus, a[k], sin)]));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn joints_advance_like_products_of_poses() {
        let value = ArgumentValue::new(0.7);
        for axis in 0..3 {
            for (motion, sign) in [
                (ElementaryMotion::Rotation, 1.0),
                (ElementaryMotion::Rotation, -1.0),
                (ElementaryMotion::Translation, -1.0),
            ] {
                let start = Pose::from_axis_rotation(1, 0.4)
                    * Pose::from_translation(DVec3::new(1.0, 2.0, 3.0));
                let joint = ChainStep::Joint {
                    motion,
                    axis,
                    argument: 0,
                    sign,
                };
                let steps = [ChainStep::Fixed(start.into()), joint];
                let mut pose = Pose::IDENTITY;
                let mut met = Vec::new();
                walk_chain(&steps, &mut pose, &[value], |here, joint| {
                    met.push((*here, joint))
                });
                assert_eq!(met.len(), 1);
                assert_eq!(met[0].0, start);
                let right = match motion {
                    ElementaryMotion::Rotation => Pose::from_axis_rotation(axis, sign * 0.7),
                    ElementaryMotion::Translation => {
                        Pose::from_translation(DVec3::AXES[axis] * (sign * 0.7))
                    }
                };
                let product = start * right;
                assert!((product.translation - pose.translation).length() < 1e-15);
                let off = (product.rotation - pose.rotation).to_cols_array();
                assert!(off.iter().all(|v| v.abs() < 1e-15));
                // Plain numbers undergo the same operations, whether they are in lists or in vectors.
                let frame = WalkFrame::at_end_of(&steps, &[value]);
                assert_eq!(frame.axes, pose.rotation.to_cols_array_2d());
                assert_eq!(frame.origin, pose.translation.to_array());
            }
        }
    }
}
