//! The joints of the mechanism's table as pictures need them, and where they are at a pose. Their signs are made in
//! `joint_symbols`.

use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::chain::{Argument, ArgumentValue, Chain, ChainStep, ElementaryMotion};
use crate::model::joints::{Joint, JointKind};
use crate::model::mechanism::Mechanism;

/// A joint with its place in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedJoint {
    /// What it is.
    pub kind: JointKind,
    /// Chain from the world to the frame before the joint.
    pub before: Chain,
    /// Chain from the world to the frame behind it.
    pub after: Chain,
    /// Its first axis (0 x, 1 y, 2 z) in the frame before.
    pub axis: usize,
    /// Axis of its last rotation in the frame before that; its first axis if it does not turn.
    pub last_axis: usize,
    /// It stands on the frame of the mechanism.
    pub grounded: bool,
}

impl PlacedJoint {
    /// How far it is drawn out, for a translation; 0 for a rotation.
    pub fn stroke(&self, arguments: &[ArgumentValue]) -> f64 {
        let [before, after] = [&self.before, &self.after].map(|c| c.pose(arguments));
        (after.translation - before.translation).dot(before.rotation.col(self.axis))
    }
}

/// All joints but those of pieces that follow a formula (of a rope on its drum): these are placed, not jointed.
pub fn placed_joints(mechanism: &Mechanism) -> Vec<PlacedJoint> {
    let joints = &mechanism.joints;
    let in_loops: Vec<usize> = joints
        .along_loops
        .iter()
        .flatten()
        .map(|p| p.joint)
        .collect();
    let list = joints.list.iter().enumerate();
    let jointed = list.filter(|(index, joint)| {
        let mut arguments = joint.arguments().map(|a| &mechanism.arguments[a]);
        in_loops.contains(index) || !arguments.any(|a| matches!(a, Argument::Formula(_)))
    });
    jointed
        .filter_map(|(_, joint)| place_joint(mechanism, joint))
        .collect()
}

fn place_joint(mechanism: &Mechanism, joint: &Joint) -> Option<PlacedJoint> {
    let axis = |step: &ChainStep| match step {
        ChainStep::Joint { axis, .. } => Some(*axis),
        ChainStep::Fixed(_) => None,
    };
    let turn = |step: &ChainStep| match step {
        ChainStep::Joint {
            motion: ElementaryMotion::Rotation,
            axis,
            ..
        } => Some(*axis),
        _ => None,
    };
    let first = joint.steps.iter().find_map(axis)?;
    let before = mechanism.joints.world_from(&joint.before);
    let mut after = before.clone();
    after.steps.extend(&joint.steps);
    Some(PlacedJoint {
        kind: joint.kind,
        axis: first,
        last_axis: joint.steps.iter().rev().find_map(turn).unwrap_or(first),
        grounded: [joint.before.link, joint.after.link].contains(&0),
        before,
        after,
    })
}

/// Values of all arguments at a sample.
pub fn argument_values(
    mechanism: &Mechanism,
    sample: &Sample,
    pose: &ClosedPose,
) -> Vec<ArgumentValue> {
    let mut coordinates = pose.unknowns.clone();
    coordinates.extend(&sample.inputs);
    mechanism.argument_values(&coordinates)
}
