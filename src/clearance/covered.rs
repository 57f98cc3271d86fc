//! A motion that is covered with tubes once it is asked for, and once only.

use super::motion::ProvedMotion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;

/// The motion between the samples: clearances, measures and swept envelopes share what is proved of it.
pub struct CoveredMotion<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    trajectory: &'m Trajectory,
    motion: Option<ProvedMotion<'m>>,
}

impl<'m> CoveredMotion<'m> {
    /// Of a motion of certified poses; proves nothing yet.
    pub fn new(system: &'m System, actuation: &'m Actuation, trajectory: &'m Trajectory) -> Self {
        let motion = None;
        Self {
            system,
            actuation,
            trajectory,
            motion,
        }
    }

    /// The motion, proved as far as it can be.
    pub fn proved(&mut self) -> &mut ProvedMotion<'m> {
        self.motion
            .get_or_insert_with(|| ProvedMotion::new(self.system, self.actuation, self.trajectory))
    }
}
