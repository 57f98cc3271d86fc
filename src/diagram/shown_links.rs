//! Which links a diagram shows, and their numbers.

use crate::model::bar_ends::BarEnds;
use crate::model::joints::Joints;
use crate::model::mechanism::Mechanism;
use crate::sorting::sort_by_key;

/// Whether a body is carried by joints only.
pub(super) fn rides_on_joints(joints: &Joints, ends: &BarEnds, body: usize) -> bool {
    let mut passages = joints.along_bodies[body].iter();
    passages.all(|passage| {
        let joint = &joints.list[passage.joint];
        !joint.is_placed && !ends.place_joint(joint)
    })
}

/// Links that loops pass, and those of bodies that ride on joints; not those that only place ends of bars.
pub(super) fn shown_links(mechanism: &Mechanism, ends: &BarEnds) -> Vec<bool> {
    let joints = &mechanism.joints;
    let mut shown = vec![false; joints.links.len()];
    let riding = (0..mechanism.bodies.len()).filter(|body| rides_on_joints(joints, ends, *body));
    let own: Vec<usize> = riding.collect();
    let passed = own.iter().flat_map(|body| &joints.along_bodies[*body]);
    let passed = passed.chain(joints.along_loops.iter().flatten());
    let sides = passed.flat_map(|passage| {
        let joint = &joints.list[passage.joint];
        [joint.before.link, joint.after.link]
    });
    let starts = joints.loop_starts.iter().map(|start| start.link);
    let bodies = own.iter().map(|body| joints.of_body[*body]);
    let all = sides.chain(starts).chain(bodies).chain([0]);
    let own = all.filter(|link| *link == 0 || !ends.place_link(*link));
    own.for_each(|link| shown[link] = true);
    shown
}

/// Numbers of links in textbook order: the frame is 1, then the bodies in order, then the rest, then `bars` bars; hidden
/// ones come last.
pub(super) fn link_numbers(joints: &Joints, shown: &[bool], bars: usize) -> Vec<usize> {
    let mut order: Vec<usize> = (0..joints.links.len()).collect();
    let first = |link: usize| {
        joints.links[link]
            .bodies
            .iter()
            .min()
            .copied()
            .unwrap_or(usize::MAX)
    };
    sort_by_key(&mut order, |link| {
        (*link != 0, !shown[*link], first(*link), *link)
    });
    let mut numbers = vec![0; order.len()];
    order
        .iter()
        .enumerate()
        .for_each(|(k, link)| numbers[*link] = k + 1 + if shown[*link] { 0 } else { bars });
    numbers
}
