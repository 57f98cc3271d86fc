//! What could be proved about a pose, and about the motion between two of them, as values.

use crate::numbers::rounding::GROW;

/// What could be proved about a pose.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Certificate {
    /// An exact closed pose exists.
    Certified {
        /// Bound on the difference of every unknown: lengths and plain numbers as they are; angles as radians times the
        /// mechanism's size.
        error_bound: f64,
        /// It is the only one within this distance, measured in the same way.
        unique_radius: f64,
    },
    /// An exact pose of as many independent equations as there are unknowns exists. The redundant equations hold there
    /// as far as rounding and the digits of the dimensions allow to judge; this is not a theorem.
    Consistent {
        /// As above.
        error_bound: f64,
        /// As above.
        unique_radius: f64,
        /// Proved bound on the closure errors of the redundant equations, measured in the same way.
        closes_to: f64,
    },
    /// An exact closed pose exists, but angles of a ball joint are locked, so that only its rotation is proved.
    Locked {
        /// As above, with the three angles of every ball joint replaced by the rotation vector that leads to the exact
        /// pose, in the frame after the joint.
        error_bound: f64,
        /// It is the only one within this distance, measured in the same way.
        unique_radius: f64,
        /// As above, if there are redundant equations.
        closes_to: Option<f64>,
    },
    /// Nothing was proved.
    Refused {
        /// Why.
        reason: Reason,
    },
}

impl Certificate {
    /// Error bound and radius of uniqueness, unless nothing was proved.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("seven-r")?.solve(Samples::Even(10))?;
    /// let bounds = motion.poses().filter_map(|pose| pose.certificate().bounds());
    /// assert!(bounds.into_iter().all(|[error, unique]| error < unique));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub const fn bounds(&self) -> Option<[f64; 2]> {
        match *self {
            Self::Certified {
                error_bound,
                unique_radius,
            }
            | Self::Consistent {
                error_bound,
                unique_radius,
                ..
            }
            | Self::Locked {
                error_bound,
                unique_radius,
                ..
            } => Some([error_bound, unique_radius]),
            Self::Refused { .. } => None,
        }
    }

    /// The certificate of a pose whose unknowns are at most this far from those proved.
    pub(crate) fn moved(mut self, by: f64) -> Self {
        match &mut self {
            Self::Certified {
                error_bound,
                unique_radius,
            }
            | Self::Consistent {
                error_bound,
                unique_radius,
                ..
            }
            | Self::Locked {
                error_bound,
                unique_radius,
                ..
            } => {
                *error_bound = (*error_bound + by) * GROW;
                *unique_radius = (*unique_radius - by).max(0.0);
            }
            Self::Refused { .. } => {}
        }
        self
    }

    /// Bound on the closure errors of redundant equations, if they are bounded and not proved.
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let motion = Scene::builtin("bennett")?.solve(Samples::Even(10))?;
    /// let gaps = motion.poses().filter_map(|pose| pose.certificate().closes_to());
    /// assert!(gaps.into_iter().all(|gap| gap < 1e-9));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub const fn closes_to(&self) -> Option<f64> {
        match *self {
            Self::Consistent { closes_to, .. } => Some(closes_to),
            Self::Locked { closes_to, .. } => closes_to,
            Self::Certified { .. } | Self::Refused { .. } => None,
        }
    }
}

/// Why a pose has no certificate.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reason {
    /// A formula has no bounded derivatives here: a kink, a pole, the end of its range.
    Formula,
    /// Too near a singular pose (or too far from a closed one) for the test to succeed.
    Singular,
    /// The angles of a ball joint are locked, and its rotation has no proof either.
    GimbalLock,
    /// A loop is rotated by more than a right angle: the skew part cannot distinguish closed from rotated by π.
    HalfTurn,
    /// An angle so large that its last digit is a noticeable part of a turn.
    Precision,
    /// A redundant equation does not hold: its closure error is more than rounding and the digits of the dimensions
    /// explain.
    Open,
    /// Nobody wanted one.
    NotAsked,
}

impl Reason {
    /// The word used in reports.
    ///
    /// ```
    /// assert_eq!(mechanim::Reason::Singular.word(), "near-singular");
    /// ```
    pub const fn word(self) -> &'static str {
        match self {
            Self::Formula => "formula",
            Self::Singular => "near-singular",
            Self::GimbalLock => "gimbal-lock",
            Self::HalfTurn => "half-turn",
            Self::Precision => "precision",
            Self::Open => "open",
            Self::NotAsked => "not-asked",
        }
    }
}

/// What could be proved about the motion between two samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IntervalCertificate {
    /// Number of time intervals that were proved, from the start on.
    pub tubes: usize,
    /// The motion stays within this distance of the proved path (measured like the error bound of a pose).
    pub radius: f64,
    /// It is the only one within this distance of the path, measured in the same way.
    pub unique_radius: f64,
    /// Bound on the closure errors of the redundant equations; `None` if there are none, or nothing was proved.
    pub closes_to: Option<f64>,
    /// Where and why the proof ended early.
    pub refused: Option<ProofRefusal>,
}

impl IntervalCertificate {
    /// The word used in reports.
    pub const fn word(&self) -> &'static str {
        match (self.refused, self.closes_to) {
            (Some(refusal), _) => refusal.obstacle.word(),
            (None, Some(_)) => CONSISTENT,
            (None, None) => "certified",
        }
    }
}

/// The word for a proof in which the redundant equations are only bounded.
pub const CONSISTENT: &str = "consistent";

/// The end of a proof.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ProofRefusal {
    /// Seconds: the motion immediately after it is not proved.
    pub time: f64,
    /// Why.
    pub obstacle: ProofObstacle,
}

/// Why a time interval is not proved.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProofObstacle {
    /// A sample has no pose: the motion ends, or resumes, somewhere in between.
    NoPose,
    /// The drive jumps, or its formula has a kink or is undefined.
    Drive,
    /// There is a motion, but not one that joins the two samples.
    NotJoined,
    /// The test fails, at a sample or between.
    Test(Reason),
}

impl ProofObstacle {
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
