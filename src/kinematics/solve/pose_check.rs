//! Judges a pose given by the user: closed, open, or one of the known false closures.

use crate::kinematics::loops::forward::loop_gap;
use crate::model::mechanism::Mechanism;
use std::f64::consts::PI;

/// The product of a loop at the given pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum LoopVerdict {
    /// The identity within the requested tolerance.
    Closed,
    /// The ends meet, but rotated by π, which residuals of three off-diagonal entries, or of the skew part alone,
    /// accept as closed.
    HalfTurn,
    /// Ends do not meet.
    Open,
}

/// One loop at the given pose, or one equation.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosureCheck {
    /// Name of the loop or equation.
    pub name: String,
    /// What is left.
    pub gap: ClosureGap,
    /// The judgement.
    pub verdict: LoopVerdict,
}

/// The closure error at the given pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ClosureGap {
    /// Of a loop.
    Loop {
        /// Rotation of the product, radians.
        angle: f64,
        /// Translation of the product, in the scene's unit.
        distance: f64,
    },
    /// Of an equation: its value.
    Equation(f64),
}

/// Printed poses have four or five digits; a half-turn is recognised within this (radians, sizes).
const PRINTED_DIGITS: f64 = 5e-3;

/// Inputs are known to this fraction of their magnitude over the motion.
const ROUNDED: f64 = 1e-15;

/// Judges every loop and every equation at `coordinates` (unknowns, then inputs); `tolerance` is relative to the
/// loop's size.
pub fn judge_pose(mechanism: &Mechanism, coordinates: &[f64], tolerance: f64) -> Vec<ClosureCheck> {
    let arguments = mechanism.argument_values(coordinates);
    let loops = mechanism.loops.iter().map(|item| {
        let (angle, distance) = loop_gap(item, &arguments);
        let relative = distance / item.size;
        // A half-turn is recognised at the accuracy of printed digits, since given poses come from books.
        let verdict = if angle <= tolerance && relative <= tolerance {
            LoopVerdict::Closed
        } else if (PI - angle).abs() <= PRINTED_DIGITS && relative <= PRINTED_DIGITS {
            LoopVerdict::HalfTurn
        } else {
            LoopVerdict::Open
        };
        ClosureCheck {
            name: item.name.clone(),
            gap: ClosureGap::Loop { angle, distance },
            verdict,
        }
    });
    let equations = mechanism.equations.iter().map(|item| {
        let value = item.expression.value(coordinates);
        let relative = (value * item.weight).abs();
        // Relative to the largest terms of the motion, and to those of this pose or, where all of them vanish, to rounding.
        let own = item.largest_summand(&mut coordinates.to_vec());
        let gradient = item.expression.gradient(coordinates);
        let inputs = item.expression.slots().into_iter();
        let inputs = inputs.filter(|slot| *slot >= mechanism.unknowns.len());
        let moved = inputs.map(|slot| (gradient[slot] * mechanism.scale_of(slot)).abs());
        let rounding = ROUNDED * moved.sum::<f64>();
        let is_closed = relative <= tolerance && value.abs() <= (tolerance * own).max(rounding);
        ClosureCheck {
            name: item.name.clone(),
            gap: ClosureGap::Equation(value),
            verdict: match is_closed {
                true => LoopVerdict::Closed,
                false => LoopVerdict::Open,
            },
        }
    });
    loops.chain(equations).collect()
}
