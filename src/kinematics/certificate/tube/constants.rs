//! The constants of the Newton-Kantorovich test over a time interval.

use super::rows::TubeLayout;
use crate::kinematics::certificate::majorant::{Root, root_within};
use crate::kinematics::results::certificate::Reason;
use crate::numbers::rounding::{GROW, largest_or_nan};

/// Proved bounds on the unknowns of earlier blocks.
#[derive(Clone, Debug)]
pub struct EarlierTube {
    /// Distance from the path, per unknown of the mechanism, in radians and sizes.
    pub rest: Vec<f64>,
    /// The largest of them.
    pub largest: f64,
    /// Distance within which the motion is the only one.
    pub unique: f64,
    /// Proved bound on the closure errors of redundant rows.
    pub closes_to: f64,
}

/// Bounds for one unknown, or for one redundant row.
#[derive(Clone, Copy, Debug)]
pub struct TubeConstants {
    /// Of R F: from its polynomial.
    pub residual: f64,
    /// Of R F: from rounding, digits, truncation and earlier blocks.
    pub rest: f64,
    /// Of R J: how far it is from the identity.
    pub q: f64,
    /// Of R F'': from the curvature of the equations.
    pub k: f64,
}

impl TubeConstants {
    fn eta(&self) -> f64 {
        self.residual + self.rest
    }

    /// The test's value in addition to the residual if no unknown is farther from the path than `error`.
    pub fn explained(&self, error: f64) -> f64 {
        (self.rest + self.q * error + 0.5 * self.k * error * error) * GROW
    }
}

/// The test of a block; its result is recorded for the later ones. Returns the error.
pub fn accept_constants(
    layout: &TubeLayout,
    constants: &[TubeConstants],
    ball: f64,
    earlier: &mut EarlierTube,
) -> Result<f64, Reason> {
    let worst = |f: fn(&TubeConstants) -> f64| largest_or_nan(constants.iter().map(f));
    let bounds = [worst(TubeConstants::eta), worst(|c| c.q), worst(|c| c.k)];
    let Root { error, unique } = root_within(ball, bounds).ok_or(Reason::Singular)?;
    // The uncertainty of this block is an uncertain input of the later ones.
    for (slot, c) in layout.block.unknowns.iter().zip(constants) {
        let rest = (c.residual + c.explained(error)) * GROW;
        earlier.rest[*slot] = rest;
        earlier.largest = earlier.largest.max(rest);
    }
    earlier.unique = earlier.unique.min(unique);
    Ok(error)
}
