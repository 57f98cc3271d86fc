//! The solved motion as values: samples with their proof, and the events between them.

use super::certificate::{Certificate, IntervalCertificate};
use super::passed::PassedPoses;
use crate::math::Pose;
use crate::model::mechanism::Kind;
use glam::DVec3;
use std::sync::Arc;

/// A closed pose with its proof.
#[derive(Clone, Debug, PartialEq)]
pub struct ClosedPose {
    /// Unknowns: radians, or the scene's length unit.
    pub unknowns: Vec<f64>,
    /// `world_from_body` of every body.
    pub bodies: Vec<Pose>,
    /// World positions of the traced points.
    pub traces: Vec<DVec3>,
    /// Values of the outputs; infinite or NaN if an output's formula is undefined.
    pub outputs: Vec<f64>,
    /// Rates of the unknowns per second, from the drive's rates; NaN for angles that are gimbal-locked.
    pub rates: Vec<f64>,
    /// Rates of higher order, as [`RateColumns`](crate::kinematics::rates::columns::RateColumns) names them; empty unless asked for.
    pub derivatives: Vec<f64>,
    /// Largest closure error of any loop relative to the mechanism's size, from an independent product.
    pub closure_error: f64,
    /// Smallest singular value over the blocks of the Jacobian; unknowns and residuals scaled by the size.
    pub sigma_min: f64,
    /// Largest ratio of singular values of a block.
    pub condition: f64,
    /// Rank of the Jacobian; the number of unknowns at a regular pose.
    pub rank: usize,
    /// One sign per block: the side of the singular poses on which the assembly is.
    pub branch: String,
    /// The proved distance of the exact pose, or why nothing was proved.
    pub certificate: Certificate,
    /// Newton iterations since the sample before.
    pub iterations: u32,
}

/// Inputs that agree within this (relative to the size, or radians) are the same: they differ by rounding.
pub const SAME_INPUT: f64 = 1e-9;

/// One instant of the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample {
    /// Seconds.
    pub time: f64,
    /// Inputs: radians, or the scene's length unit.
    pub inputs: Vec<f64>,
    /// The pose, or `None` if the mechanism cannot be closed.
    pub pose: Option<ClosedPose>,
}

/// Something between two samples that the user must know.
#[derive(Clone, Debug, PartialEq)]
pub struct Event {
    /// Seconds: the last time at which there is a pose, or the first; of a singular pose its own.
    pub time: f64,
    /// Inputs at that time.
    pub inputs: Vec<f64>,
    /// What happened.
    pub kind: EventKind,
}

impl EventKind {
    /// Whether the gap that begins or ends there says the same.
    pub fn is_told_by_gap(&self) -> bool {
        matches!(
            self,
            Self::MotionEnds(_) | Self::MotionResumes { same_branch: true }
        )
    }
}

/// Kinds of events.
#[derive(Clone, Debug, PartialEq)]
pub enum EventKind {
    /// The motion is not followed any farther.
    MotionEnds(Ending),
    /// The drive has entered the feasible range (again); the pose was assembled anew.
    MotionResumes {
        /// The branch is the one before the gap, or there was none before.
        same_branch: bool,
    },
    /// The pose is singular; the motion was continued straight through it.
    SingularPosePassed,
    /// The pose of a sample is singular, and the drive reverses there: the motion returned on the branch on which it
    /// came, though another one begins there.
    SingularPoseMet,
    /// The first and last axis of a ball joint that is written as three rotations are parallel, or nearly: only the
    /// sum or difference of their angles is determined. The position is not affected.
    GimbalLock {
        /// The three unknowns.
        names: [String; 3],
        /// Cosine of the middle angle, measured from the pose with perpendicular axes: zero at a locked pose.
        distance: f64,
    },
    /// A coordinate or an output reverses while the drive continues: a dead point. Only on request.
    LimitPosition {
        /// Name of the unknown or output.
        name: String,
        /// What it measures.
        measure: Kind,
        /// Its value there.
        value: f64,
        /// The value is larger than those around it, not smaller.
        is_largest: bool,
    },
    /// An input has no value, for example after a division by zero in its formula.
    InputUndefined {
        /// Whether its formula is undefined; otherwise its value exceeds the range of f64.
        proved: bool,
        /// Name of the input.
        name: String,
    },
    /// No pose was found at the start of the drive from the start values.
    StartNotClosed {
        /// None exists, in any assembly.
        proved: bool,
        /// Loop with the largest closure error.
        name: String,
        /// Smallest remaining rotation, radians.
        angle: f64,
        /// Smallest remaining distance.
        distance: f64,
    },
    /// The first pose is singular: several assemblies may meet there, and which one is followed is not determined.
    StartSingular,
    /// Which of the branches that meet at a singular first pose the motion took.
    BranchChosen {
        /// Its signature.
        taken: String,
        /// Signatures of the others that were found.
        others: Vec<String>,
    },
    /// Two cylinders in contact have parallel axes at the start: they touch along a line, and the contact point is not
    /// determined.
    AxesParallel {
        /// Name of the contact.
        contact: String,
    },
    /// The first pose is far from a named start value, and another assembly is nearer.
    StartMoved {
        /// Name of the unknown with the largest difference.
        name: String,
        /// What it is.
        measure: Kind,
        /// Its start value: radians, or the scene's length unit.
        wanted: f64,
        /// Its value in the first pose.
        found: f64,
        /// Its value in the other assembly.
        nearer: f64,
        /// Number or signature of the other assembly.
        mode: String,
    },
    /// The start values did not lead to a pose; another start did, perhaps on another branch.
    OtherStart,
}

/// Why a motion is not followed any farther.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// A fold: the path continues in arc length, but the drive reverses along it. Beyond it this assembly has no pose.
    Fold {
        /// Whether tubes in arc length prove the reversal; otherwise its place was computed.
        proved: bool,
        /// Proofs were asked for.
        asked: bool,
    },
    /// An equation is undefined beyond: the end of a formula's domain.
    NoValue {
        /// The equation.
        name: String,
        /// Whether it is undefined beyond for all possible values of the unknowns there; otherwise for those of the
        /// last pose.
        proved: bool,
        /// Proofs were asked for.
        asked: bool,
    },
    /// An input ceases to have a value.
    InputUndefined {
        /// Its name.
        name: String,
        /// Whether its formula is undefined; otherwise its value exceeds the range of f64.
        proved: bool,
    },
    /// No step could be trusted, and no fold was found: it is unknown whether the motion continues.
    GivenUp {
        /// Smallest singular value at the last pose.
        sigma_min: f64,
    },
    /// A formula in a loop or an equation jumps: poses exist on both sides, but no motion leads from one to the other.
    Jump {
        /// The loop or equation.
        name: String,
    },
    /// Angles are so large that their own rounding leaves the loops open.
    AngleTooLarge,
    /// Places are so far from the origin, beside the lengths there, that their own rounding leaves loops or bars open.
    PlaceTooFar,
    /// There is no motion that could end: the start values led to no pose, and it is not proved that none exists.
    NotFound,
}

impl Ending {
    /// Whether the motion may nevertheless continue.
    pub const fn is_undecided(&self) -> bool {
        matches!(
            self,
            Self::GivenUp { .. }
                | Self::Jump { .. }
                | Self::AngleTooLarge
                | Self::PlaceTooFar
                | Self::NotFound
                | Self::InputUndefined { proved: false, .. }
                | Self::Fold {
                    proved: false,
                    asked: true
                }
                | Self::NoValue {
                    proved: false,
                    asked: true,
                    ..
                }
        )
    }

    /// The word used in reports.
    pub const fn word(&self) -> &'static str {
        match self {
            Self::Fold { .. } => "fold",
            Self::NoValue { .. } => "no-value",
            Self::InputUndefined { .. } => "input-undefined",
            Self::GivenUp { .. } => "given-up",
            Self::Jump { .. } => "jump",
            Self::AngleTooLarge => "angle-too-large",
            Self::PlaceTooFar => "place-too-far",
            Self::NotFound => "not-found",
        }
    }
}

/// One place on the drive.
#[derive(Clone, Debug, PartialEq)]
pub struct Instant {
    /// Seconds.
    pub time: f64,
    /// Inputs: radians, or the scene's length unit.
    pub inputs: Vec<f64>,
}

/// The closure error that remains where a mechanism cannot be closed.
#[derive(Clone, Debug, PartialEq)]
pub struct RemainingGap {
    /// The sample.
    pub at: Instant,
    /// Loop or equation with the largest remaining closure error.
    pub name: String,
    /// Remaining rotation, radians; nonzero only if the rotations alone cannot be closed.
    pub angle: f64,
    /// Remaining distance in the scene's unit, or value of the equation.
    pub distance: f64,
    /// Whether it is proved that no assembly has a pose there; otherwise none was found, or no proof was requested.
    pub proved: bool,
}

/// An interval of the drive in which no pose was found.
#[derive(Clone, Debug, PartialEq)]
pub struct MotionGap {
    /// The last place with a pose; `None` if the drive begins inside.
    pub from: Option<Instant>,
    /// The first place with a pose again; `None` if the drive ends inside.
    pub until: Option<Instant>,
    /// Why the motion before it ends.
    pub ending: Option<Ending>,
    /// Why the motion after it ends, followed backwards.
    pub beginning: Option<Ending>,
    /// The sample inside with the largest closure error.
    pub widest: Option<RemainingGap>,
}

impl MotionGap {
    /// Whether it is unknown that the motion ends: it may continue inside.
    pub fn is_undecided(&self) -> bool {
        let is_proved = self.widest.as_ref().is_some_and(|lack| lack.proved);
        let mut ends = [&self.ending, &self.beginning].into_iter().flatten();
        !is_proved && ends.next().is_none_or(Ending::is_undecided)
    }
}

/// The motion over the drive.
#[derive(Clone, Debug, PartialEq, Default)]
pub struct Trajectory {
    /// Samples in the order of time.
    pub samples: Vec<Sample>,
    /// Events in the order of time.
    pub events: Vec<Event>,
    /// Intervals in which no pose was found, in the order of time.
    pub gaps: Vec<MotionGap>,
    /// Proofs of the motion after each sample, up to the next one or to the end of a cyclic drive; empty unless
    /// requested.
    pub intervals: Vec<IntervalCertificate>,
    /// Number of samples added where the motion ends and resumes.
    pub added: usize,
    /// Steps it took.
    pub steps: usize,
    /// Whether it was given up because they are limited.
    pub is_spent: bool,
    /// Poses between the samples; none without proofs.
    pub passed: Arc<PassedPoses>,
}

impl Trajectory {
    /// Number of samples that were requested.
    pub fn asked(&self) -> usize {
        self.samples.len() - self.added
    }

    /// Number of samples without a pose.
    pub fn missing(&self) -> usize {
        self.samples.iter().filter(|s| s.pose.is_none()).count()
    }

    /// Whether there is a pose at every sample and, as far as is known, between them.
    pub fn is_whole(&self) -> bool {
        self.missing() == 0 && self.gaps.is_empty()
    }

    /// Whether poses are missing without a known end of the motion or a proof that an instant has none.
    pub fn is_undecided(&self) -> bool {
        let is_proved = |event: &Event| {
            matches!(
                event.kind,
                EventKind::StartNotClosed { proved: true, .. }
                    | EventKind::InputUndefined { proved: true, .. }
            )
        };
        !self.is_whole()
            && self.gaps.iter().all(MotionGap::is_undecided)
            && !self.events.iter().any(is_proved)
    }

    /// Whether it is one assembly from its start values on, as far as is known.
    pub fn is_one_assembly(&self) -> bool {
        let leaves = |kind: &EventKind| {
            matches!(
                kind,
                EventKind::OtherStart
                    | EventKind::SingularPosePassed
                    | EventKind::MotionResumes { .. }
            )
        };
        !self.events.iter().any(|event| leaves(&event.kind))
    }

    /// The worst closure error of all poses.
    pub fn closure_error(&self) -> f64 {
        self.poses().map(|p| p.closure_error).fold(0.0, f64::max)
    }

    /// The samples of one motion: after its first end there are no poses, even where the drive is feasible again.
    pub fn of_one_motion(mut self) -> Vec<Sample> {
        let mut ends = self.events.iter();
        if let Some(end) = ends.find(|e| matches!(e.kind, EventKind::MotionEnds(_))) {
            let behind = self.samples.iter_mut().filter(|s| s.time > end.time);
            behind.for_each(|s| s.pose = None);
        }
        self.samples
    }

    /// When the motion first comes to a singular pose from which it goes on without proof: mechanisms with nearly the same
    /// dimensions may go on in another assembly.
    pub fn first_singular(&self) -> Option<f64> {
        let mut events = self.events.iter();
        let met = |kind: &EventKind| {
            matches!(
                kind,
                EventKind::SingularPosePassed | EventKind::SingularPoseMet
            )
        };
        events.find(|e| met(&e.kind)).map(|e| e.time)
    }

    /// All poses there are.
    pub fn poses(&self) -> impl Iterator<Item = &ClosedPose> {
        self.samples.iter().filter_map(|s| s.pose.as_ref())
    }
}
