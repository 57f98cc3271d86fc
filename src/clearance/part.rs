//! Two bodies as they are judged, with the shapes that count, for whoever looks at them once more: for all pieces within the
//! tolerances of their dimensions.

use super::sweep::PairSweep;
use crate::distance::bodies::{BodyElements, LeftOut};
use crate::kinematics::results::certificate::Reason;

/// Two bodies that must keep a distance.
#[derive(Clone, Debug)]
pub struct JudgedPart {
    /// Indices of the bodies; the first one is the larger, from which the other is seen.
    pub bodies: [usize; 2],
    /// Their shapes, as they are cut at joints.
    pub hulls: [BodyElements; 2],
    /// Pairs of elements that do not count.
    pub left_out: LeftOut,
    /// Least distance that passes.
    pub minimum: f64,
    /// By how much a bound may stay below the minimum of a pair that passes.
    pub slack: f64,
    /// The least distance found of the motion as drawn, and when, in seconds.
    pub nominal: [f64; 2],
}

/// What is known of two bodies for all pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceClearance {
    /// Indices of the bodies, ascending.
    pub pair: [usize; 2],
    /// Least distance that passes.
    pub minimum: f64,
    /// By how much the bound may stay below the minimum of a pair that passes.
    pub slack: f64,
    /// The least distance found of the motion as drawn.
    pub nominal: f64,
    /// No piece comes nearer.
    pub bound: f64,
    /// The least distance of a piece that was found.
    pub found: f64,
    /// When, seconds.
    pub time: f64,
    /// Why there is no bound, if so.
    pub refusal: Option<PieceRefusal>,
}

/// A time at which nothing is proved of all pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceRefusal {
    /// Seconds.
    pub from: f64,
    /// Seconds.
    pub until: f64,
    /// What is missing.
    pub missing: Missing,
    /// The dimension that takes the mechanism farthest towards where the proof fails.
    pub dimension: Option<String>,
}

/// Why nothing is proved of all pieces at a time.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Missing {
    /// There is no pose as drawn.
    Pose,
    /// The time of the run was over.
    Time,
    /// The proof failed, in the words of certificates.
    Proof(Reason),
}

/// What is known of all pairs for all pieces.
#[derive(Clone, Debug, PartialEq)]
pub struct PieceReport {
    /// The dimensions with their tolerances, in the file's units.
    pub dimensions: Vec<(String, f64)>,
    /// Every judged pair.
    pub list: Vec<PieceClearance>,
}

impl PieceClearance {
    /// The bound keeps the minimum: the pair passes.
    pub fn is_kept(&self) -> bool {
        self.refusal.is_none() && self.bound >= self.minimum - self.slack
    }

    /// A piece breaks it.
    pub fn is_broken(&self) -> bool {
        self.found < self.minimum - self.slack
    }
}

impl PairSweep<'_> {
    /// The two bodies as they are judged.
    pub(super) fn part(&self, nominal: [f64; 2]) -> JudgedPart {
        JudgedPart {
            bodies: self.bodies,
            hulls: self.hulls.map(BodyElements::clone),
            left_out: self.left_out.clone(),
            minimum: self.minimum(),
            slack: self.slack(),
            nominal,
        }
    }
}
