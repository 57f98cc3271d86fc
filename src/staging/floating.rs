//! Joints that are only coordinates of a free body which bars hold, such as `T(x, y, z) Rx(a) Ry(b) Rz(c)` of a platform: nothing
//! is made there.

use crate::model::bar_ends::BarEnds;
use crate::model::chain::ElementaryMotion;
use crate::model::joints::Joint;
use crate::model::mechanism::Mechanism;

/// Unknown translations from the frame to a link that carries ends of bars: with so many it floats.
const FREE: usize = 2;

/// Whether every joint of the table is one of them.
pub fn floating_joints(mechanism: &Mechanism) -> Vec<bool> {
    let joints = &mechanism.joints.list;
    let mut floating = vec![false; joints.len()];
    if mechanism.bars.is_empty() {
        return floating;
    }
    let carriers: Vec<usize> = BarEnds::new(mechanism)
        .carried()
        .iter()
        .map(|(link, _)| *link)
        .collect();
    let at = |link: usize| (0..joints.len()).filter(move |k| sides(&joints[*k]).contains(&link));
    let beyond = |k: usize, link: usize| {
        let [a, b] = sides(&joints[k]);
        if a == link { b } else { a }
    };
    for first in at(0) {
        let (mut path, mut link) = (vec![first], beyond(first, 0));
        // Along links between two joints, to the first that carries something.
        while link != 0 && !carriers.contains(&link) && path.len() <= joints.len() {
            let others: Vec<usize> = at(link).filter(|k| !path.contains(k)).collect();
            let [next] = others[..] else { break };
            path.push(next);
            link = beyond(next, link);
        }
        let own = path.iter().map(|k| &joints[*k]);
        let is_unknown = |joint: &Joint| {
            joint
                .coordinates
                .iter()
                .all(|slot| *slot < mechanism.unknowns.len())
        };
        let shifts: usize = own.clone().map(translations).sum();
        if carriers.contains(&link) && shifts >= FREE && own.clone().all(is_unknown) {
            path.iter().for_each(|k| floating[*k] = true);
        }
    }
    floating
}

fn sides(joint: &Joint) -> [usize; 2] {
    [joint.before.link, joint.after.link]
}

fn translations(joint: &Joint) -> usize {
    let steps = joint.steps.iter().filter_map(|step| step.joint());
    steps
        .filter(|step| step.motion == ElementaryMotion::Translation)
        .count()
}
