//! Where on their axes the hinges of scenes without bodies are: beside the ends of bars that their links carry. A chain
//! determines only the axis.

use crate::model::bar_ends::BarEnds;
use crate::model::joints::{Joint, JointKind, LinkFrame};
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// The shift of every joint of the table along its axis; none but for hinges of scenes with bars and without bodies.
pub fn axis_shifts(mechanism: &Mechanism) -> Vec<f64> {
    let joints = &mechanism.joints.list;
    let mut shifts = vec![None; joints.len()];
    if mechanism.bars.is_empty() || !mechanism.has_no_shapes() {
        return vec![0.0; joints.len()];
    }
    // Next to the ends of bars first, then next to the hinges that are known.
    let mut places = BarEnds::new(mechanism).carried();
    loop {
        let mut found = Vec::new();
        for (joint, shift) in joints.iter().zip(&mut shifts) {
            if shift.is_none() {
                *shift = nearest_height(joint, &places);
                found.extend(shift.iter().flat_map(|shift| joint_points(joint, *shift)));
            }
        }
        if found.is_empty() {
            return shifts
                .into_iter()
                .map(|shift| shift.unwrap_or(0.0))
                .collect();
        }
        places.extend(found);
    }
}

/// The place of a joint on its links, shifted along its axis.
pub fn joint_points(joint: &Joint, shift: f64) -> [(usize, DVec3); 2] {
    let along = hinge_axis(joint).map_or(DVec3::ZERO, |axis| DVec3::AXES[axis] * shift);
    let place = |frame: &LinkFrame| (frame.link, frame.link_from_here.transform_point(along));
    [place(&joint.before), place(&joint.after)]
}

/// The height above a hinge's frames of the points that its links carry: the least.
fn nearest_height(joint: &Joint, places: &[(usize, DVec3)]) -> Option<f64> {
    let axis = hinge_axis(joint)?;
    let frames = [&joint.before, &joint.after];
    let heights = frames
        .into_iter()
        .filter(|frame| frame.link != 0)
        .flat_map(|frame| {
            let own = places.iter().filter(|(link, _)| *link == frame.link);
            own.map(|(_, place)| frame.link_from_here.inverse().transform_point(*place)[axis])
        });
    heights.min_by(|a, b| a.abs().total_cmp(&b.abs()))
}

/// The axis of a hinge in both of its frames.
fn hinge_axis(joint: &Joint) -> Option<usize> {
    let mut steps = joint.steps.iter().filter_map(|step| step.joint());
    let axis = steps.next().map(|step| step.axis);
    axis.filter(|_| joint.kind == JointKind::Revolute && steps.next().is_none())
}
