//! Judging a pose that somebody offers: closed, open, or one of the false closures by its name.

use crate::kinematics::loops::forward::loop_gap;
use crate::model::mechanism::Mechanism;
use std::f64::consts::PI;

/// What a loop's product is at the offered pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Verdict {
    /// The identity within the asked tolerance.
    Closed,
    /// Ends meet, but turned by π: what three off-diagonal entries, or the skew part alone, take for closed.
    HalfTurn,
    /// Ends do not meet.
    Open,
}

/// One loop at the offered pose.
#[derive(Clone, Debug, PartialEq)]
pub struct OfferedLoop {
    /// Name of the loop.
    pub name: String,
    /// Rotation of the product, radians.
    pub angle: f64,
    /// Translation of the product, in the scene's unit.
    pub distance: f64,
    /// The judgement.
    pub verdict: Verdict,
}

/// Poses in print have four or five digits; a half-turn is recognised within this (radians, sizes).
const PRINTED_DIGITS: f64 = 5e-3;

/// Judges every loop at `coordinates` (unknowns, then inputs); `tolerance` is relative to the mechanism's size.
pub fn judge(mechanism: &Mechanism, coordinates: &[f64], tolerance: f64) -> Vec<OfferedLoop> {
    let arguments = mechanism.argument_values(coordinates);
    let loops = mechanism.loops.iter().map(|item| {
        let (angle, distance) = loop_gap(item, &arguments);
        let relative = distance / mechanism.size;
        let verdict = if angle <= tolerance && relative <= tolerance {
            Verdict::Closed
        } else if (PI - angle).abs() <= PRINTED_DIGITS && relative <= PRINTED_DIGITS {
            Verdict::HalfTurn
        } else {
            Verdict::Open
        };
        OfferedLoop {
            name: item.name.clone(),
            angle,
            distance,
            verdict,
        }
    });
    loops.collect()
}
