//! A mechanism moved by hand: one pose whose inputs are set by sliders instead of the drive.

use super::following::{FollowEnd, follow, stop_of};
use super::session::{LiveError, LiveScene};
use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::actuation::Actuation;

impl LiveScene {
    /// Moves the inputs from their present values, or from a time of the motion, to values in the file's units; others
    /// stay. If the motion ends before, the pose stays, and the place is returned as a fraction of the way.
    ///
    /// Errors: no such input; no pose to start from.
    pub fn drive(
        &mut self,
        time: f64,
        wanted: &[(String, f64)],
    ) -> Result<Option<FollowEnd>, LiveError> {
        let (start, pose) = self.standing_pose(time)?;
        let mut inputs = start.inputs.clone();
        for (name, value) in wanted {
            let known = self.mechanism().inputs.iter();
            let index = known.clone().position(|input| input.name == *name);
            let index = index.ok_or_else(|| LiveError::Request(format!("no input `{name}`")))?;
            let kind = self.mechanism().inputs[index].kind;
            inputs[index] = self.mechanism().inner_value(kind, *value);
        }
        Ok(self.follow_by_hand(&start, &pose, &inputs))
    }

    /// Follows the mechanism from a pose to other inputs, and holds it there. If the motion ends before, the pose stays, and
    /// the place is returned as a fraction of the way.
    pub(super) fn follow_by_hand(
        &mut self,
        start: &Sample,
        pose: &ClosedPose,
        inputs: &[f64],
    ) -> Option<FollowEnd> {
        let way = Actuation::straight(&start.inputs, inputs, pose.unknowns.clone());
        let mut motion = follow(&self.now.system, &way);
        if let Some((at, why)) = stop_of(&motion) {
            let why = why.to_owned();
            return Some(FollowEnd::Stopped { at, why });
        }
        self.hand = motion.samples.pop();
        None
    }

    /// The present pose: the one set by hand, or that of the sample nearest to a time.
    pub(super) fn standing_pose(&self, time: f64) -> Result<(Sample, ClosedPose), LiveError> {
        let held = self.hand.as_ref();
        let off = |s: &&Sample| (s.time - time).abs();
        let posed = self.now.motion.samples.iter().filter(|s| s.pose.is_some());
        let nearest = posed.min_by(|a, b| off(a).total_cmp(&off(b)));
        let sample = held.or(nearest);
        sample
            .and_then(|sample| Some((sample.clone(), sample.pose.clone()?)))
            .ok_or_else(|| LiveError::Request("no pose to begin at".to_owned()))
    }
}
