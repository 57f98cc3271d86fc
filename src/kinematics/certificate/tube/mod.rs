//! A proof between samples: around the path from one sample to the next there is one motion, and it joins the two
//! certified poses. No jump to another assembly can hide there.
//!
//! The path over a stretch of time is a curve of polynomials in the unknowns; the drive is enclosed as it is. All poses of the
//! stretch take the Newton-Kantorovich test at once, which gives two radii: within the smaller one around the path there is
//! a solution at every instant, within the larger one it is the only one. So tubes are joined, and the samples' own
//! certified poses are joined to them, wherever one solution lies within the larger radius of the other. A stretch that fails is halved, down to [`FLOOR`] of the interval; keyframes always part stretches.

mod chain;
mod drive;
mod form;
mod model;
mod path;
mod proof;
mod prover;
mod rows;

use super::Reason;
use crate::kinematics::motion::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use form::Form;
pub use model::{Around, Model, Polynomial};
use path::Path;
use proof::{Earlier, Workspace};
pub use prover::{FLOOR, Prover, Tube};
use rows::Layout;

/// What could be proved about the motion between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalCertificate {
    /// Stretches that were proved, from the start of the interval on.
    pub tubes: usize,
    /// The motion is nowhere farther from the proved path (measured like the error bound of a pose).
    pub radius: f64,
    /// It is the only one within this distance of the path, measured likewise.
    pub unique_radius: f64,
    /// Where and why the proof ended before the interval did.
    pub refused: Option<Refusal>,
}

/// The end of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Refusal {
    /// Seconds: what lies right after it is not proved.
    pub time: f64,
    /// Why.
    pub obstacle: Obstacle,
}

/// Why a stretch is not proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Obstacle {
    /// A sample has no pose: the motion ends, or resumes, somewhere in between.
    NoPose,
    /// The drive jumps, or its formula has a kink or no value.
    Drive,
    /// There is a motion, but not one that joins the two samples.
    NotJoined,
    /// The test fails, at a sample or between.
    Test(Reason),
}

impl Obstacle {
    /// The word used in reports.
    pub const fn word(self) -> &'static str {
        match self {
            Self::NoPose => "no-pose",
            Self::Drive => "drive",
            Self::NotJoined => "not-joined",
            Self::Test(reason) => reason.word(),
        }
    }
}

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

/// Proves a single pose whose formulas have no affine form: error bound and radius of uniqueness in radians and sizes.
pub(crate) fn pose(
    system: &System,
    coordinates: &[f64],
    bases: &[Vec<usize>],
) -> Result<(f64, f64), Reason> {
    let mechanism = system.mechanism();
    let mut blocks = Blocks::new(system);
    let mut path = Path::still(mechanism.unknowns.len(), coordinates);
    let proved = blocks.prove(bases, &mut path, false)?;
    Ok((proved.largest, proved.unique))
}

/// The blocks of a mechanism, laid out for proofs.
#[derive(Debug)]
struct Blocks<'m> {
    forms: Vec<Form<'m>>,
    layouts: Vec<Layout<'m>>,
    unknowns: usize,
    work: Workspace,
}

impl<'m> Blocks<'m> {
    fn new(system: &'m System) -> Self {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let forms = Form::all(mechanism);
        let blocks = structure.blocks.iter();
        Self {
            layouts: blocks
                .map(|block| Layout::new(mechanism, &forms, block))
                .collect(),
            forms,
            unknowns: mechanism.unknowns.len(),
            work: Workspace::default(),
        }
    }

    /// The test along a path, block after block. `may_move`: the path is first brought to the motion.
    fn prove(
        &mut self,
        bases: &[Vec<usize>],
        path: &mut Path,
        may_move: bool,
    ) -> Result<Earlier, Reason> {
        let mut proved = Earlier {
            rest: vec![0.0; self.unknowns],
            largest: 0.0,
            unique: f64::INFINITY,
        };
        let work = &mut self.work;
        for (layout, basis) in self.layouts.iter().zip(bases) {
            proof::prove(
                layout,
                &self.forms,
                path,
                basis,
                &mut proved,
                may_move,
                work,
            )?;
        }
        Ok(proved)
    }
}
