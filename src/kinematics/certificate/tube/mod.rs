//! Proofs between samples: around the path from one sample to the next there is exactly one motion, and it connects the
//! two certified poses, so that no jump to another assembly can be hidden.
//!
//! The path over a time interval is given by polynomials in the unknowns; the drive is enclosed exactly. All poses of
//! the interval are subjected to the Newton-Kantorovich test at once, which gives two radii: within the smaller one
//! around the path there is a solution at every instant, within the larger one it is the only one. Tubes are connected
//! to each other, and to the certified poses of the samples, where one solution lies within the larger radius of the
//! other. A time interval that fails is halved, down to [`FLOOR`] of the sampling interval; keyframes always separate
//! tubes.
//!
//! For an over-determined block the rows to be proved are chosen for every tube. The others are bounded over the whole
//! of it, as in the certificate of a pose.

mod arguments;
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
pub use drive::input_range;
use path::TubePath;
pub use prover::{FLOOR, Prover};
pub use stretches::Tube;
pub use taylor_model::{Polynomial, TaylorCentre, TaylorModel};

/// Proves every interval between consecutive samples; one result less than there are samples.
pub fn certify_motion(
    system: &System,
    actuation: &Actuation,
    trajectory: &Trajectory,
) -> Vec<IntervalCertificate> {
    let mut prover = Prover::new(system, actuation).through(&trajectory.passed);
    let pairs = trajectory.samples.windows(2);
    pairs.map(|pair| prover.interval(pair).0).collect()
}

/// Proves single poses with general formulas; the layout is computed once.
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

    /// Proves the pose at coordinates with given rests of the inputs: error bound, radius of uniqueness and closure
    /// error of redundant rows, in radians and sizes.
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
