//! How far a step may take what is driven: angles and lengths of joints in loops, and with them the inputs.

use crate::model::chain::{Argument, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Kind, Loop, Mechanism};
use crate::numbers::interval::Interval;
use std::f64::consts::FRAC_PI_8;

/// A step turns nothing that is driven farther than this, radians: linkages flatten at every half turn, and several inputs may
/// leave their reach together.
const FARTHEST_TURN: f64 = FRAC_PI_8;

/// A step slides it no farther than this, in sizes of its loop.
const FARTHEST_WAY: f64 = 0.125;

/// Within a step what is driven may leave the range between its ends by this much, radians, lengths of
/// its loop or such terms.
pub(super) const STRAY: f64 = 1e-4;

/// The same in shares of its value, far more than rounding.
const STRAY_OF_VALUE: f64 = 1e-9;

/// How far something may go within a step, and how far out of the range between its values at the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepBound {
    /// From one value to the other.
    pub farthest: f64,
    /// Beyond both.
    pub stray: f64,
}

impl StepBound {
    /// Times a unit.
    pub fn scaled(self, unit: f64) -> Self {
        Self {
            farthest: unit * self.farthest,
            stray: unit * self.stray,
        }
    }

    fn tighter(self, other: Self) -> Self {
        Self {
            farthest: self.farthest.min(other.farthest),
            stray: self.stray.min(other.stray),
        }
    }

    /// Whether it is too far from one value to another.
    pub fn is_far(self, a: f64, b: f64) -> bool {
        (b - a).abs() > self.farthest
    }

    /// Whether a range lies between two values, or leaves what is between them by no more than is allowed; so does no range.
    pub fn holds(self, [a, b]: [f64; 2], range: Option<Interval>) -> bool {
        let stray = self.stray + STRAY_OF_VALUE * a.abs().max(b.abs());
        range.is_none_or(|range| a.min(b) - stray <= range.lo && range.hi <= a.max(b) + stray)
    }

    /// Of every input: of its kind, and of the joints of loops that it moves by affine forms.
    pub fn of_inputs(mechanism: &Mechanism) -> Vec<Self> {
        let unknowns = mechanism.unknowns.len();
        let usual = mechanism.inputs.iter().map(|input| Self {
            farthest: match input.kind {
                Kind::Angle => FARTHEST_TURN,
                Kind::Length => FARTHEST_WAY * mechanism.size,
                Kind::Number => f64::INFINITY,
            },
            stray: f64::INFINITY,
        });
        let mut bounds: Vec<Self> = usual.collect();
        for (argument, bound) in joint_arguments(mechanism) {
            let Some(affine) = argument.affine() else {
                continue;
            };
            for (slot, factor) in affine.numbers().filter(|(slot, _)| *slot >= unknowns) {
                let known = &mut bounds[slot - unknowns];
                *known = known.tighter(bound.scaled(1.0 / factor.abs()));
            }
        }
        bounds
    }
}

/// Arguments of joints in loops, and how far a step may take them.
pub(super) fn joint_arguments(
    mechanism: &Mechanism,
) -> impl Iterator<Item = (&Argument, StepBound)> {
    // Every step of every chain, with the longest length that its loop is written with.
    let all = mechanism.loops.iter().flat_map(|item| {
        let own = own_size(mechanism, item);
        item.chain.steps.iter().map(move |step| (step, item, own))
    });
    all.filter_map(|(step, item, own)| match step {
        ChainStep::Joint {
            motion, argument, ..
        } => {
            // Rotations are bounded in radians, slides in sizes of their loop.
            let bound = match motion {
                ElementaryMotion::Rotation => StepBound {
                    farthest: FARTHEST_TURN,
                    stray: STRAY,
                },
                ElementaryMotion::Translation => StepBound {
                    farthest: FARTHEST_WAY * item.size,
                    stray: STRAY * own,
                },
            };
            Some((&mechanism.arguments[*argument], bound))
        }
        _ => None,
    })
}

/// The largest length that is written in a loop: it may be small beside others.
fn own_size(mechanism: &Mechanism, item: &Loop) -> f64 {
    let lengths = item.chain.written_lengths(&mechanism.arguments);
    let longest = lengths.fold(0.0, f64::max);
    if longest > 0.0 {
        longest.min(item.size)
    } else {
        item.size
    }
}
