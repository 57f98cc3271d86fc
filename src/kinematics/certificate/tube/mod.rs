//! A proof between samples: around the path from one sample to the next there is one motion, and it joins the two
//! certified poses. No jump to another assembly can hide there.
//!
//! The path over a stretch of time is a cubic curve in the unknowns; the drive is enclosed as it is. All poses of the
//! stretch take the Newton-Kantorovich test at once, which gives two radii: within the smaller one around the path there is
//! a solution at every instant, within the larger one it is the only one. So tubes are joined, and the samples' own
//! certified poses are joined to them, wherever one solution lies within the larger radius of the other. A stretch that fails is halved, down to [`FLOOR`] of the interval; keyframes always part stretches.

mod chain;
mod drive;
mod form;
mod gradient;
mod path;
mod proof;
mod prover;
mod rows;
mod series;

use super::{BALL, Reason};
use crate::kinematics::structure::{Block, Structure, StructureError};
use crate::kinematics::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use form::Form;
use path::Path;
use proof::Earlier;
pub use prover::{FLOOR, Prover, Tube};
use rows::Site;

/// Factor between the balls that are tried where a formula has no bounds in the largest.
const BALL_STEP: f64 = 16.0;

/// No smaller ball is tried: a motion so close to a kink is as good as on it.
const SMALLEST_BALL: f64 = 1e-6;

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
///
/// # Errors
/// Only where the mechanism itself is ill-posed.
pub fn certify_motion(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
) -> Result<Vec<IntervalCertificate>, StructureError> {
    let structure = Structure::new(mechanism)?;
    let mut prover = Prover::new(mechanism, &structure);
    let pairs = trajectory.samples.windows(2);
    Ok(pairs.map(|pair| prover.interval(pair).0).collect())
}

/// Proves a single pose whose formulas have no affine form: error bound and radius of uniqueness in radians and sizes.
pub(super) fn pose(
    mechanism: &Mechanism,
    structure: &Structure,
    coordinates: &[f64],
    bases: &[Vec<usize>],
) -> Result<(f64, f64), Reason> {
    let forms = Form::all(mechanism);
    let proved = prove_blocks(
        mechanism,
        structure,
        &forms,
        bases,
        &Path::still(coordinates),
    )?;
    Ok((proved.largest, proved.unique))
}

/// The test in the largest ball in which the formulas of the mechanism are smooth.
fn prove_blocks(
    mechanism: &Mechanism,
    structure: &Structure,
    forms: &[Form],
    bases: &[Vec<usize>],
    path: &Path,
) -> Result<Earlier, Reason> {
    let mut ball = BALL;
    loop {
        let proof = prove_in_ball(mechanism, structure, forms, bases, path, ball);
        if proof.as_ref().err() != Some(&Reason::Formula) || ball < SMALLEST_BALL {
            return proof;
        }
        ball /= BALL_STEP;
    }
}

fn prove_in_ball(
    mechanism: &Mechanism,
    structure: &Structure,
    forms: &[Form],
    bases: &[Vec<usize>],
    path: &Path,
    ball: f64,
) -> Result<Earlier, Reason> {
    let mut proved = Earlier {
        rest: vec![0.0; mechanism.unknowns.len()],
        largest: 0.0,
        unique: f64::INFINITY,
    };
    for (block, basis) in structure.blocks.iter().zip(bases) {
        let columns = columns(mechanism, forms, block);
        let site = Site {
            mechanism,
            forms,
            block,
            columns: &columns,
            ball,
        };
        proof::prove(site, path, basis, &mut proved)?;
    }
    Ok(proved)
}

/// The unknowns of a block, then those of earlier blocks that it depends on.
fn columns(mechanism: &Mechanism, forms: &[Form], block: &Block) -> Vec<usize> {
    let used = rows::used(mechanism, block);
    let mut others: Vec<usize> = used.flat_map(|form| forms[form].coordinates()).collect();
    others.sort_unstable();
    others.dedup();
    others.retain(|slot| *slot < mechanism.unknowns.len() && block.column_of[*slot].is_none());
    [block.unknowns.clone(), others].concat()
}
