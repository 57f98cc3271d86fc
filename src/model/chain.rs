//! Products of elementary motions as the engine sees them: fixed poses and joints, in order.
//!
//! A joint refers to an argument by index, so that a motion which stands in several chains, or inverted, is
//! evaluated once.

use super::expression::{Affine, Expression};
use crate::math::{Pose, sin_cos};
use glam::DVec3;

/// Rotation about a coordinate axis, or translation along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Motion {
    /// `Tx`, `Ty`, `Tz`.
    Translation,
    /// `Rx`, `Ry`, `Rz`.
    Rotation,
}

/// One factor of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// A constant pose.
    Fixed(Pose),
    /// An elementary motion whose value changes.
    Joint {
        /// Kind of motion.
        motion: Motion,
        /// 0 x, 1 y, 2 z, of the frame reached so far.
        axis: usize,
        /// Index into `Mechanism::arguments`.
        argument: usize,
        /// +1, or -1 where the chain holds the inverse motion.
        sign: f64,
    },
}

/// A product of steps, from left to right.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Chain {
    /// The factors.
    pub steps: Vec<Step>,
}

/// Value of a joint: rotation angle in radians or translation in the scene's unit.
///
/// Slots are coordinates: unknowns first, then inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// Nearly always: a coordinate, perhaps scaled and shifted.
    Affine(Affine),
    /// Anything else.
    Formula(Expression),
}

impl Argument {
    /// Coordinates it depends on, ascending.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Affine(affine) => affine.terms.iter().map(|(slot, _)| *slot).collect(),
            Self::Formula(expression) => expression.slots(),
        }
    }

    /// Value at the coordinates.
    pub fn value(&self, coordinates: &[f64], scratch: &mut Vec<f64>) -> f64 {
        match self {
            Self::Affine(affine) => affine.terms.iter().fold(affine.constant, |sum, (slot, c)| {
                sum + c * coordinates[*slot]
            }),
            Self::Formula(expression) => expression.value_with(coordinates, scratch),
        }
    }
}

/// Sine, cosine and value of every argument, so that each is computed once per evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArgumentValue {
    /// Angle or length.
    pub value: f64,
    /// Sine of the value.
    pub sin: f64,
    /// Cosine of the value.
    pub cos: f64,
}

impl ArgumentValue {
    /// The value with its sine and cosine.
    pub fn new(value: f64) -> Self {
        let (sin, cos) = sin_cos(value);
        Self { value, sin, cos }
    }
}

impl Step {
    /// The step that undoes this one.
    pub fn inverse(&self) -> Self {
        match *self {
            Self::Fixed(pose) => Self::Fixed(pose.inverse()),
            Self::Joint {
                motion,
                axis,
                argument,
                sign,
            } => Self::Joint {
                motion,
                axis,
                argument,
                sign: -sign,
            },
        }
    }

    /// Multiplies `base_from_here` by this step from the right.
    #[inline]
    pub fn advance(&self, base_from_here: &mut Pose, arguments: &[ArgumentValue]) {
        match *self {
            Self::Fixed(pose) => *base_from_here = *base_from_here * pose,
            Self::Joint {
                motion,
                axis,
                argument,
                sign,
            } => {
                let value = &arguments[argument];
                match motion {
                    Motion::Translation => {
                        base_from_here.translation +=
                            base_from_here.rotation.col(axis) * (sign * value.value);
                    }
                    Motion::Rotation => {
                        turn_about(base_from_here, axis, sign * value.sin, value.cos)
                    }
                }
            }
        }
    }
}

/// Turns the frame about its own axis `axis` (0 x, 1 y, 2 z) by the angle of that sine and cosine: only two columns
/// change.
#[inline]
pub fn turn_about(pose: &mut Pose, axis: usize, sin: f64, cos: f64) {
    let (x, y, z) = (
        pose.rotation.x_axis,
        pose.rotation.y_axis,
        pose.rotation.z_axis,
    );
    let turn = |a: DVec3, b: DVec3| (a * cos + b * sin, b * cos - a * sin);
    match axis {
        0 => (pose.rotation.y_axis, pose.rotation.z_axis) = turn(y, z),
        1 => (pose.rotation.z_axis, pose.rotation.x_axis) = turn(z, x),
        _ => (pose.rotation.x_axis, pose.rotation.y_axis) = turn(x, y),
    }
}

impl Chain {
    /// The product at the given argument values.
    pub fn pose(&self, arguments: &[ArgumentValue]) -> Pose {
        let mut pose = Pose::IDENTITY;
        for step in &self.steps {
            step.advance(&mut pose, arguments);
        }
        pose
    }

    /// Indices of the arguments it uses, ascending.
    pub fn arguments(&self) -> Vec<usize> {
        let mut used: Vec<_> = self
            .steps
            .iter()
            .filter_map(|step| {
                if let Step::Joint { argument, .. } = step {
                    Some(*argument)
                } else {
                    None
                }
            })
            .collect();
        used.sort_unstable();
        used.dedup();
        used
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
                (Motion::Rotation, 1.0),
                (Motion::Rotation, -1.0),
                (Motion::Translation, -1.0),
            ] {
                let start = Pose::from_axis_rotation(1, 0.4)
                    * Pose::from_translation(DVec3::new(1.0, 2.0, 3.0));
                let mut pose = start;
                Step::Joint {
                    motion,
                    axis,
                    argument: 0,
                    sign,
                }
                .advance(&mut pose, &[value]);
                let right = match motion {
                    Motion::Rotation => Pose::from_axis_rotation(axis, sign * 0.7),
                    Motion::Translation => Pose::from_translation(DVec3::AXES[axis] * (sign * 0.7)),
                };
                let product = start * right;
                assert!((product.translation - pose.translation).length() < 1e-15);
                assert!(
                    (product.rotation - pose.rotation)
                        .to_cols_array()
                        .iter()
                        .all(|v| v.abs() < 1e-15)
                );
            }
        }
    }
}
