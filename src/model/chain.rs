//! Products of elementary motions as the engine uses them: fixed poses and joints, in order.
//!
//! A joint refers to an argument by index, so that a motion that appears in several chains, or inverted, is evaluated
//! once.

use super::expression::{Affine, Expression};
use super::fixed::FixedPose;
use super::pattern::RowPattern;
use crate::numbers::scalar::Scalar;

/// Rotation about a coordinate axis, or translation along it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum ElementaryMotion {
    /// `Tx`, `Ty`, `Tz`.
    Translation,
    /// `Rx`, `Ry`, `Rz`.
    Rotation,
}

/// One factor of a chain.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ChainStep {
    /// A constant pose.
    Fixed(FixedPose),
    /// An elementary motion whose value changes.
    Joint {
        /// Kind of motion.
        motion: ElementaryMotion,
        /// 0 x, 1 y, 2 z, of the frame reached so far.
        axis: usize,
        /// Index into `Mechanism::arguments`.
        argument: usize,
        /// +1, or -1 where the chain holds the inverse motion.
        sign: f64,
    },
}

/// A step whose value changes, as [`ChainStep::Joint`] holds it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChainJoint {
    /// Kind of motion.
    pub motion: ElementaryMotion,
    /// 0 x, 1 y, 2 z, of the frame reached so far.
    pub axis: usize,
    /// Index into `Mechanism::arguments`.
    pub argument: usize,
    /// +1, or -1 where the chain holds the inverse motion.
    pub sign: f64,
}

/// A product of steps, from left to right.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Chain {
    /// The factors.
    pub steps: Vec<ChainStep>,
}

/// Value of a joint: rotation angle in radians or translation in the scene's unit.
///
/// Slots are coordinates: unknowns first, then inputs.
#[derive(Clone, Debug, PartialEq)]
pub enum Argument {
    /// Usually a single coordinate, perhaps scaled and shifted.
    Affine(Affine),
    /// Anything else.
    Formula(Expression),
}

impl Argument {
    /// Its affine form, if it has one.
    pub fn affine(&self) -> Option<Affine> {
        match self {
            Self::Affine(affine) => Some(affine.clone()),
            Self::Formula(expression) => expression.affine(),
        }
    }

    /// Coordinates it depends on, ascending.
    pub fn coordinates(&self) -> Vec<usize> {
        match self {
            Self::Affine(affine) => affine.terms.iter().map(|(slot, _)| *slot).collect(),
            Self::Formula(expression) => expression.slots(),
        }
    }

    /// Rates of the value by the coordinates it depends on, at a pose.
    pub fn gradient(&self, coordinates: &[f64]) -> Vec<(usize, f64)> {
        match self {
            Self::Affine(affine) => affine.numbers().collect(),
            Self::Formula(expression) => {
                let gradient = expression.gradient(coordinates);
                let slots = expression.slots().into_iter();
                slots.map(|slot| (slot, gradient[slot])).collect()
            }
        }
    }

    /// Value at the coordinates.
    pub fn value<S: Scalar>(&self, coordinates: &[S], scratch: &mut Vec<S>) -> S {
        match self {
            Self::Affine(affine) => affine.value(coordinates),
            Self::Formula(expression) => expression.value_with(coordinates, scratch),
        }
    }
}

/// Sine, cosine and value of every argument, so that each is computed once per evaluation.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ArgumentValue<S = f64> {
    /// Angle or length.
    pub value: S,
    /// Sine of the value.
    pub sin: S,
    /// Cosine of the value.
    pub cos: S,
}

impl<S: Scalar> ArgumentValue<S> {
    /// The value with its sine and cosine.
    pub fn new(value: S) -> Self {
        let (sin, cos) = value.sin_cos();
        Self { value, sin, cos }
    }
}

impl ArgumentValue {
    /// Sets a value; its sine and cosine only if it `turns` something, and unless they are known already.
    #[inline]
    pub fn renew(&mut self, value: f64, turns: bool) {
        // Both are zero where they were not computed.
        let is_known = self.value == value && (self.sin != 0.0 || self.cos != 0.0);
        if turns && !is_known {
            *self = Self::new(value);
        } else if !turns {
            let (sin, cos) = (0.0, 0.0);
            *self = Self { value, sin, cos };
        }
    }
}

impl ChainStep {
    /// The inverse step.
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

    /// The joint, if it is one.
    pub fn joint(&self) -> Option<ChainJoint> {
        match *self {
            Self::Fixed(_) => None,
            Self::Joint {
                motion,
                axis,
                argument,
                sign,
            } => Some(ChainJoint {
                motion,
                axis,
                argument,
                sign,
            }),
        }
    }
}

impl Chain {
    /// Indices of the arguments it uses, ascending.
    pub fn arguments(&self) -> Vec<usize> {
        let joints = self.steps.iter().filter_map(ChainStep::joint);
        let mut used: Vec<_> = joints.map(|joint| joint.argument).collect();
        used.sort_unstable();
        used.dedup();
        used
    }

    /// Lengths that are written in it as numbers, one for every step: fixed offsets, and constants added to variable ones.
    pub fn written_lengths<'c>(&'c self, arguments: &'c [Argument]) -> impl Iterator<Item = f64> {
        self.steps.iter().map(|step| match step {
            ChainStep::Fixed(pose) => pose.translation.length(),
            ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                argument,
                ..
            } => match &arguments[*argument] {
                Argument::Affine(affine) => affine.constant.number().abs(),
                Argument::Formula(_) => 0.0,
            },
            ChainStep::Joint { .. } => 0.0,
        })
    }

    /// The entries of the product that are zero whatever the values of the joints.
    pub fn pattern(&self) -> RowPattern {
        let factors = self.steps.iter().map(|step| match step {
            ChainStep::Fixed(pose) => pose.pattern,
            ChainStep::Joint { motion, axis, .. } => match motion {
                ElementaryMotion::Translation => RowPattern::of_shift(*axis),
                ElementaryMotion::Rotation => RowPattern::of_turn(*axis),
            },
        });
        factors.fold(RowPattern::IDENTITY, |product, factor| product * factor)
    }
}
