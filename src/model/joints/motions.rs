//! The motions of chains in a normal form in which equal ones can be recognised: along z, by a combination of
//! coordinates.

use crate::math::Pose;
use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use glam::{DMat3, DVec3};
use std::collections::BTreeMap;

/// Half a turn about x: reverses a motion along z, and is its own inverse.
pub const FLIP: Pose = Pose {
    rotation: DMat3::from_cols(DVec3::X, DVec3::NEG_Y, DVec3::NEG_Z),
    translation: DVec3::ZERO,
};

/// An argument as a multiple ±1 of its label, and a constant.
#[derive(Clone, Copy)]
struct ArgumentKind {
    /// `None` if it is constant.
    label: Option<usize>,
    sign: f64,
    constant: f64,
}

/// The normal forms of a mechanism's arguments.
pub struct Motions(Vec<ArgumentKind>);

/// A motion of a chain: its label, and the position of its axis.
pub struct ChainMotion {
    pub motion: ElementaryMotion,
    /// The combination of coordinates that moves it.
    pub label: usize,
    pub argument: usize,
    /// Whether it is reversed relative to the combination.
    pub is_reversed: bool,
    /// From the frame before the step to the frame whose z is the axis, and back after it.
    pub to_axis: Pose,
    pub from_axis: Pose,
}

/// The combination of coordinates, and whether it is a rotation: motions that differ in it are not the same.
pub type MotionKey = (usize, bool);

impl ChainMotion {
    /// Its identity.
    pub fn motion_key(&self) -> MotionKey {
        (self.label, self.motion == ElementaryMotion::Rotation)
    }
}

impl Motions {
    /// Equal combinations of coordinates, their sign aside, get the same label.
    pub fn new(arguments: &[Argument]) -> Self {
        Self(argument_values(arguments))
    }

    /// The motion of a step; its pose if it is constant.
    pub fn met(&self, step: &ChainStep) -> Result<ChainMotion, Pose> {
        let (motion, axis, argument, sign) = match *step {
            ChainStep::Fixed(fixed) => return Err(fixed.pose),
            ChainStep::Joint {
                motion,
                axis,
                argument,
                sign,
            } => (motion, axis, argument, sign),
        };
        // The constant part of the argument is a displacement along the axis, which is turned onto z.
        let value = self.0[argument];
        let constant = along_z(motion, sign * value.constant);
        let axis = axis_as_z(axis);
        let Some(label) = value.label else {
            return Err(axis * constant * axis.inverse());
        };
        // A negative factor is the same motion along the reversed axis.
        let is_reversed = sign * value.sign < 0.0;
        let flip = if is_reversed { FLIP } else { Pose::IDENTITY };
        Ok(ChainMotion {
            motion,
            label,
            argument,
            is_reversed,
            to_axis: axis * constant * flip,
            from_axis: flip * axis.inverse(),
        })
    }
}

/// What every argument is: equal combinations of coordinates, their sign aside, get the same label.
fn argument_values(arguments: &[Argument]) -> Vec<ArgumentKind> {
    let mut labels: BTreeMap<Vec<(usize, u64)>, usize> = BTreeMap::new();
    let constants = arguments.iter().enumerate().map(|(index, argument)| {
        let Argument::Affine(affine) = argument else {
            // A formula equals only itself.
            return ArgumentKind {
                label: Some(usize::MAX - index),
                sign: 1.0,
                constant: 0.0,
            };
        };
        let sign = match affine.terms.first() {
            Some((_, factor)) if factor.number() < 0.0 => -1.0,
            _ => 1.0,
        };
        let numbers = affine.numbers();
        let terms = numbers.map(|(slot, c)| (slot, (sign * c).to_bits()));
        let next = labels.len();
        let label = *labels.entry(terms.collect()).or_insert(next);
        ArgumentKind {
            label: (!affine.terms.is_empty()).then_some(label),
            sign,
            constant: affine.constant.number(),
        }
    });
    constants.collect()
}

/// The rotation that takes z to a coordinate axis: the axes in turn.
fn axis_as_z(axis: usize) -> Pose {
    let rotation = match axis {
        0 => DMat3::from_cols(DVec3::Y, DVec3::Z, DVec3::X),
        1 => DMat3::from_cols(DVec3::Z, DVec3::X, DVec3::Y),
        _ => DMat3::IDENTITY,
    };
    Pose {
        rotation,
        translation: DVec3::ZERO,
    }
}

fn along_z(motion: ElementaryMotion, value: f64) -> Pose {
    match motion {
        ElementaryMotion::Rotation => Pose::from_axis_rotation(2, value),
        ElementaryMotion::Translation => Pose::from_translation(DVec3::Z * value),
    }
}
