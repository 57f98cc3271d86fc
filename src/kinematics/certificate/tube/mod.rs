//! A proof between samples: around the path from one sample to the next there is one motion, and it joins the two
//! certified poses. No jump to another assembly can hide there.
//!
//! The path over a stretch of time is a curve of polynomials in the unknowns; the drive is enclosed as it is. All poses of the
//! stretch take the Newton-Kantorovich test at once, which gives two radii: within the smaller one around the path there is
//! a solution at every instant, within the larger one it is the only one. So tubes are joined, and the samples' own
//! certified poses are joined to them, wherever one solution lies within the larger radius of the other. A stretch that fails is halved, down to [`FLOOR`] of the interval; keyframes always part stretches.
//!
//! Of an over-determined block the rows that are proved are chosen anew for every stretch. The others are bounded over the
//! whole of it, as in the certificate of a pose.

mod blocks;
mod chain;
mod constants;
mod drive;
mod form;
mod inverse;
mod partings;
mod path;
mod placed;
mod proof;
mod prover;
mod rows;
mod shown;
mod shown_value;
mod stretches;
mod taylor_model;

use crate::kinematics::results::certificate::{IntervalCertificate, Reason};
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use blocks::Blocks;
use path::TubePath;
pub use prover::{FLOOR, Prover};
pub use stretches::Tube;
pub use taylor_model::{Polynomial, TaylorCentre, TaylorModel};

/// Proves every interval between consecutive samples; one entry less than there are samples.
pub fn certify_motion(
    system: &System,
    actuation: &Actuation,
    trajectory: &Trajectory,
) -> Vec<IntervalCertificate> {
    let mut prover = Prover::new(system, actuation);
    let pairs = trajectory.samples.windows(2);
    pairs.map(|pair| prover.interval(pair).0).collect()
}

/// Proves single poses whose formulas have no affine form; laid out once.
#[derive(Clone, Debug)]
pub(crate) struct Standing<'m> {
    blocks: Blocks<'m>,
}

impl<'m> Standing<'m> {
    pub(crate) fn new(system: &'m System) -> Self {
        Self {
            blocks: Blocks::new(system),
        }
    }

    /// Proves the pose at coordinates and what comes to the inputs: error bound, radius of uniqueness and what
    /// redundant rows may be open by, in radians and sizes.
    pub(crate) fn prove(
        &mut self,
        [coordinates, rests]: [&[f64]; 2],
        bases: &[Vec<usize>],
    ) -> Result<(f64, f64, f64), Reason> {
        let mut path = TubePath::standing(self.blocks.unknowns, coordinates, rests);
        let proved = self.blocks.prove(bases, &mut path, false)?;
        Ok((proved.largest, proved.unique, proved.closes_to))
    }
}
