//! A short motion with all its proofs, for proofs of endings.

use super::recorder::Recorder;
use crate::kinematics::certificate::tube::certify_motion;
use crate::kinematics::results::certificate::Certificate;
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::joints::Joints;
use crate::model::mechanism::{Kind, Mechanism};
use crate::model::printed::InputReading;

/// The mechanism without the parts that such a motion does not need.
pub(super) fn bare_mechanism(mechanism: &Mechanism) -> Mechanism {
    Mechanism {
        bodies: Vec::new(),
        traces: Vec::new(),
        outputs: Vec::new(),
        // The scene's table of joints may not apply to these arguments.
        joints: Joints::default(),
        ..mechanism.clone()
    }
}

/// The samples of a motion without events whose tubes are proved; otherwise `None`.
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

/// An unknown of a proved pose, and its error bound.
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
