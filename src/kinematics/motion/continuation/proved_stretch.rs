//! A short motion with all of its proofs: what proofs of endings are made of.

use super::recorder::Recorder;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::joints::Joints;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::InputReading;

/// The mechanism without what nobody asks such a motion for.
pub(super) fn bare_mechanism(mechanism: &Mechanism) -> Mechanism {
    Mechanism {
        bodies: Vec::new(),
        traces: Vec::new(),
        outputs: Vec::new(),
        // The scene's table of joints may say nothing of these arguments.
        joints: Joints::default(),
        ..mechanism.clone()
    }
}

/// The samples of a motion on which nothing happens and whose tubes are proved; else `None`.
pub(super) fn proved_samples(
    system: &System,
    actuation: &Actuation,
    times: &[f64],
) -> Option<Vec<Sample>> {
    let recorder = Recorder::new(system, actuation, &|| false);
    let motion = recorder
        .proving(InputReading::Numbers)
        .up_to_gaps()
        .run(times);
    if motion.missing() > 0 || !motion.events.is_empty() {
        return None;
    }
    let tubes = certify_motion(system, actuation, &motion);
    let is_proved = tubes.iter().all(|tube| tube.refused.is_none());
    is_proved.then_some(motion.samples)
}

/// An unknown of a proved pose, and the error that its proof leaves.
pub(super) fn proved_value(
    mechanism: &Mechanism,
    sample: &Sample,
    unknown: usize,
) -> Option<[f64; 2]> {
    let pose = sample.pose.as_ref()?;
    let Certificate::Certified { error_bound, .. } = pose.certificate else {
        return None;
    };
    // The bound is in lengths: an angle's part of it is over the size.
    let error = match mechanism.unknowns[unknown].kind {
        Kind::Angle => error_bound / mechanism.size,
        Kind::Length | Kind::Number => error_bound,
    };
    Some([pose.unknowns[unknown], error])
}
