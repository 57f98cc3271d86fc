//! The constants of the Newton-Kantorovich test over a stretch.

use super::rows::TubeLayout;
use crate::kinematics::certificate::majorant::{Root, root_within};
use crate::kinematics::results::certificate::Reason;
use crate::numbers::rounding::{GROW, largest_or_nan};

/// What is proved of the unknowns of earlier blocks.
#[derive(Clone, Debug)]
pub struct EarlierTube {
    /// Distance from the path, per unknown of the mechanism, in radians and sizes.
    pub rest: Vec<f64>,
    /// The largest of them.
    pub largest: f64,
    /// Distance within which the motion is the only one.
    pub unique: f64,
    /// No redundant row is open by more.
    pub closes_to: f64,
}

/// Bounds for one unknown, or for one redundant row.
#[derive(Clone, Copy, Debug)]
pub struct TubeConstants {
    /// Of R F: what its polynomial says.
    pub residual: f64,
    /// Of R F: what rounding, digits, cutting off and earlier blocks leave open.
    pub rest: f64,
    /// Of R J: how far it is from the identity.
    pub q: f64,
    /// Of R F'': how much the equations bend.
    pub k: f64,
}

impl TubeConstants {
    fn eta(&self) -> f64 {
        self.residual + self.rest
    }

    /// What is left beside the residual where no unknown is farther from the path than `error`.
    pub fn explained(&self, error: f64) -> f64 {
        (self.rest + self.q * error + 0.5 * self.k * error * error) * GROW
    }
}

/// The test of a block; what it proves is noted for the later ones. Returns the error.
pub fn accept_constants(
    layout: &TubeLayout,
    constants: &[TubeConstants],
    ball: f64,
    earlier: &mut EarlierTube,
) -> Result<f64, Reason> {
    let worst = |f: fn(&TubeConstants) -> f64| largest_or_nan(constants.iter().map(f));
    let bounds = [worst(TubeConstants::eta), worst(|c| c.q), worst(|c| c.k)];
    let Root { error, unique } = root_within(ball, bounds).ok_or(Reason::Singular)?;
    // What this block leaves open is an uncertain input of the later ones.
    for (slot, c) in layout.block.unknowns.iter().zip(constants) {
        let rest = (c.residual + c.explained(error)) * GROW;
        earlier.rest[*slot] = rest;
        earlier.largest = earlier.largest.max(rest);
    }
    earlier.unique = earlier.unique.min(unique);
    Ok(error)
}
