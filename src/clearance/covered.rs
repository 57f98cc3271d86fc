//! A motion that is covered with tubes when first needed, and only once; likewise the motions along tracks of measures.

use super::motion::ProvedMotion;
use crate::kinematics::measures::driven_along;
use crate::kinematics::motion::continuation::solve_motion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::measure::MeasuredTrack;
use std::collections::HashMap;

/// The motion between the samples: clearances, measures and swept envelopes share its proofs.
pub struct CoveredMotion<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    trajectory: &'m Trajectory,
    motion: Option<ProvedMotion<'m>>,
    /// Along the tracks, by their names, with the drives that lead along them.
    tracks: HashMap<String, (ProvedMotion<'m>, Actuation)>,
}

impl<'m> CoveredMotion<'m> {
    /// Of a motion of certified poses, and what is already proved of it.
    pub fn new(
        system: &'m System,
        actuation: &'m Actuation,
        trajectory: &'m Trajectory,
        motion: Option<ProvedMotion<'m>>,
    ) -> Self {
        Self {
            system,
            actuation,
            trajectory,
            motion,
            tracks: HashMap::new(),
        }
    }

    /// The motion, proved as far as possible.
    pub fn proved(&mut self) -> &mut ProvedMotion<'m> {
        self.motion
            .get_or_insert_with(|| ProvedMotion::new(self.system, self.actuation, self.trajectory))
    }

    /// The motion along a track, proved as far as it can be, and the drives that lead along it: the inputs at the times of that
    /// motion.
    pub fn along_track(&mut self, track: &MeasuredTrack) -> (&mut ProvedMotion<'m>, &Actuation) {
        let (system, actuation) = (self.system, self.actuation);
        let known = self.tracks.entry(track.name.clone());
        let (motion, drives) = known.or_insert_with(|| {
            let (drives, times) = driven_along(actuation, track);
            let mut along = solve_motion(system, &drives, &times);
            // The path to the first pose is not part of the track.
            along.samples.remove(0);
            (ProvedMotion::new(system, &drives, &along), drives)
        });
        (motion, drives)
    }
}
