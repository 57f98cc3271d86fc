//! Poses a design: the mechanism with its parameters as inputs is continued from the file's own values to those of the
//! design, so that a row belongs to the same assembly or states that it does not.

use super::row::RowStatus;
use crate::analysis::study::{FamilyError, ParametricMechanism};
use crate::kinematics::motion::continuation::{solve_motion, solve_whole};
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::printed::printed_certificate;
use crate::kinematics::results::trajectory::ClosedPose;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;

/// The first pose of the motion with the file's own values: the start of the path to every design.
#[derive(Clone, Debug)]
pub(super) struct FirstPose {
    /// Inputs, the parameters last.
    pub inputs: Vec<f64>,
    unknowns: Vec<f64>,
    branch: String,
}

/// Where the motion of a design begins.
pub(super) struct DesignStart {
    /// Unknowns of the first pose.
    pub unknowns: Vec<f64>,
    /// Whether it belongs to the file's assembly: `Ok`, `OtherBranch` or `NotReached`.
    pub status: RowStatus,
}

impl FirstPose {
    /// The first pose with the file's own values.
    ///
    /// # Errors
    ///
    /// No pose exists.
    pub fn new(family: &ParametricMechanism) -> Result<Self, FamilyError> {
        let motion = solve_motion(family.system(), &family.actuation, &[0.0]);
        let pose = motion.poses().next().ok_or_else(|| {
            let message = "no pose was found at the start of the drive with the file's own values, from which every design is reached";
            FamilyError::Lacks(message.to_owned())
        })?;
        Ok(Self {
            inputs: family.actuation.inputs_at(0.0),
            unknowns: pose.unknowns.clone(),
            branch: pose.branch.clone(),
        })
    }

    /// Unknowns, then inputs.
    pub fn coordinates(&self) -> impl Iterator<Item = f64> + '_ {
        self.unknowns.iter().chain(&self.inputs).copied()
    }

    /// The first pose at other inputs (including the parameters).
    ///
    /// # Errors
    ///
    /// No pose exists, proved (`NotClosed`) or merely not found (`Undecided`).
    pub fn start_at(
        &self,
        family: &ParametricMechanism,
        inputs: &[f64],
    ) -> Result<DesignStart, RowStatus> {
        if let Some(unknowns) = self.followed(family, inputs) {
            return Ok(DesignStart {
                unknowns,
                status: RowStatus::Ok,
            });
        }
        // Beyond a region without poses there may be poses again; only the signs identify their assembly.
        let assembled = Actuation::straight(inputs, inputs, self.unknowns.clone());
        let motion = solve_motion(family.system(), &assembled, &[0.0]);
        let Some(pose) = motion.poses().next() else {
            return Err(match motion.is_undecided() {
                true => RowStatus::Undecided,
                false => RowStatus::NotClosed,
            });
        };
        let status = match pose.branch == self.branch {
            true => RowStatus::NotReached,
            false => RowStatus::OtherBranch,
        };
        Ok(DesignStart {
            unknowns: pose.unknowns.clone(),
            status,
        })
    }

    /// The straight path from the file's values, if it reaches the design without a singular pose.
    fn followed(&self, family: &ParametricMechanism, inputs: &[f64]) -> Option<Vec<f64>> {
        if self.inputs == inputs {
            return Some(self.unknowns.clone());
        }
        let way = Actuation::straight(&self.inputs, inputs, self.unknowns.clone());
        let motion = solve_whole(family.system(), &way, &[0.0, 1.0])?;
        let end = motion.poses().last()?;
        let is_same = motion.is_one_assembly() && end.branch == self.branch;
        is_same.then(|| end.unknowns.clone())
    }
}

/// The largest closure error and certified error of a set of poses, and the number without a certificate.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Proved {
    pub closure_error: f64,
    pub error_bound: f64,
    pub unproved: f64,
}

impl Proved {
    pub fn add<'p>(&mut self, mechanism: &Mechanism, poses: impl Iterator<Item = &'p ClosedPose>) {
        for pose in poses {
            self.closure_error = self.closure_error.max(pose.closure_error);
            match printed_certificate(mechanism, pose) {
                Certificate::Certified { error_bound, .. }
                | Certificate::Consistent { error_bound, .. } => {
                    self.error_bound = self.error_bound.max(error_bound)
                }
                Certificate::Locked { .. } | Certificate::Refused { .. } => self.unproved += 1.0,
            }
        }
    }
}
