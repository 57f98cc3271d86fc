//! Joints found in the chains of the bodies, and where they are at a pose. Their signs are made in `joint_signs`.

use crate::kinematics::results::trajectory::{ClosedPose, Sample};
use crate::model::chain::{Argument, ArgumentValue, Chain, Motion, Step};
use crate::model::mechanism::{Closes, Loop, Mechanism};
use glam::DVec3;

/// Joints nearer than this over the mechanism's size, with the same arguments, are one joint found twice.
const SAME_PLACE: f64 = 1e-6;

/// What a joint lets move.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum JointKind {
    /// One rotation.
    Pin,
    /// Two rotations about axes that meet.
    Cross,
    /// Three rotations about axes that meet.
    Ball,
    /// One translation.
    Slider,
    /// Rotation about and translation along one axis.
    Cylindrical,
    /// The same, coupled.
    Screw,
}

/// A joint of the mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// What it is.
    pub kind: JointKind,
    /// Chain from the world to the frame before the joint.
    pub before: Chain,
    /// Chain from the world to the frame behind it.
    pub after: Chain,
    /// Its first axis (0 x, 1 y, 2 z) in the frame before.
    pub axis: usize,
    /// Its last axis in the frame before the last motion.
    pub last_axis: usize,
    /// Nothing moves before it: it stands on the frame.
    pub grounded: bool,
    /// A formula moves it that is more than a coordinate, scaled and shifted.
    placed: bool,
    /// Unknowns and inputs that move it, ascending.
    coordinates: Vec<usize>,
}

impl Joint {
    /// How far it is drawn out, for a translation; 0 for a rotation.
    pub fn stroke(&self, arguments: &[ArgumentValue]) -> f64 {
        let [before, after] = [&self.before, &self.after].map(|c| c.pose(arguments));
        (after.translation - before.translation).dot(before.rotation.col(self.axis))
    }
}

/// All joints on the chains of bodies, and on loops that pass a joint of the frame and so have a place in the world.
pub fn find(mechanism: &Mechanism, first: &[ArgumentValue]) -> Vec<Joint> {
    let bodies = mechanism.bodies.iter().map(|body| &body.world_from_body);
    let bodies: Vec<&Chain> = bodies.collect();
    let loops = mechanism.loops.iter();
    let loops: Vec<(Chain, bool)> = loops
        .filter_map(|l| Some((from_world(l, &bodies)?, l.closes == Closes::Frame)))
        .collect();
    let chains = bodies.iter().map(|chain| (*chain, false));
    let chains = chains.chain(loops.iter().map(|(chain, closed)| (chain, *closed)));
    let mut found: Vec<(Joint, [DVec3; 2])> = Vec::new();
    for (chain, closed) in chains {
        let in_loop = loops.iter().any(|(other, _)| std::ptr::eq(other, chain));
        for joint in along(chain, closed, &bodies, mechanism) {
            // A piece that follows a formula (of a rope on its drum) is placed, not jointed.
            if !in_loop && joint.placed {
                continue;
            }
            let ends = [&joint.before, &joint.after].map(|c| c.pose(first).translation);
            // Another chain may come to a joint from behind, or to a pin elsewhere on its axis.
            let axis = joint.before.pose(first).rotation.col(joint.axis);
            let near = |place: &DVec3| {
                let apart = *place - ends[0];
                let along = match joint.kind {
                    JointKind::Pin => axis * apart.dot(axis),
                    _ => DVec3::ZERO,
                };
                (apart - along).length() < SAME_PLACE * mechanism.size
            };
            let known = found.iter().any(|(other, places)| {
                other.coordinates == joint.coordinates && places.iter().any(near)
            });
            if !known {
                found.push((joint, ends));
            }
        }
    }
    found.into_iter().map(|(joint, _)| joint).collect()
}

/// Values of all arguments at a sample.
pub fn arguments(mechanism: &Mechanism, sample: &Sample, pose: &ClosedPose) -> Vec<ArgumentValue> {
    let mut coordinates = pose.unknowns.clone();
    coordinates.extend(&sample.inputs);
    mechanism.argument_values(&coordinates)
}

/// The steps up to the first joint.
fn opening(chain: &Chain) -> &[Step] {
    let joint = chain.steps.iter().position(is_joint);
    joint.map_or(&[], |end| &chain.steps[..=end])
}

/// The loop turned so that it begins in the world: a body's chain begins with one of its joints.
///
/// A loop that closes in a point only ends there: what comes before its start has no place.
fn from_world(l: &Loop, bodies: &[&Chain]) -> Option<Chain> {
    let steps = &l.chain.steps;
    let mut openings = bodies.iter().map(|body| opening(body));
    let (opening, at) = openings.find_map(|opening| {
        let at = steps.iter().position(|step| Some(step) == opening.last())?;
        Some((opening, at))
    })?;
    let mut turned = opening[..opening.len() - 1].to_vec();
    turned.extend(&steps[at..]);
    if l.closes == Closes::Frame {
        turned.extend(&steps[..at]);
    }
    Some(Chain { steps: turned })
}

fn is_joint(step: &Step) -> bool {
    matches!(step, Step::Joint { .. })
}

/// Motion, axis and argument of a step that is a joint.
fn motion(step: Option<&Step>) -> Option<(Motion, usize, usize)> {
    match step {
        Some(Step::Joint {
            motion,
            axis,
            argument,
            ..
        }) => Some((*motion, *axis, *argument)),
        _ => None,
    }
}

/// The joints of one chain, in its order; a `closed` one comes back to the frame.
fn along(chain: &Chain, closed: bool, bodies: &[&Chain], mechanism: &Mechanism) -> Vec<Joint> {
    let steps = &chain.steps;
    let mut joints = Vec::new();
    let mut at = 0;
    while at < steps.len() {
        let Some((first, axis, argument)) = motion(steps.get(at)) else {
            at += 1;
            continue;
        };
        let second = motion(steps.get(at + 1)).filter(|(second, _, _)| *second != first);
        let (kind, end) = match second {
            Some((_, other, coupled)) if other == axis => {
                let own = |a: usize| mechanism.arguments[a].coordinates();
                let kind = if own(argument) == own(coupled) {
                    JointKind::Screw
                } else {
                    JointKind::Cylindrical
                };
                (kind, at + 2)
            }
            _ if first == Motion::Translation => (JointKind::Slider, at + 1),
            _ => rotations(steps, at, bodies),
        };
        let prefix = |count: usize| Chain {
            steps: steps[..count].to_vec(),
        };
        joints.push(Joint {
            kind,
            before: prefix(at),
            after: prefix(end),
            axis,
            last_axis: motion(steps.get(end - 1)).map_or(axis, |(_, last, _)| last),
            grounded: !steps[..at].iter().any(is_joint)
                || (closed && !steps[end..].iter().any(is_joint)),
            placed: (at..end)
                .filter_map(|k| motion(steps.get(k)))
                .any(|(_, _, a)| matches!(mechanism.arguments[a], Argument::Formula(_))),
            // `Tx(s)` and `Tx(-s)` are two arguments and one joint.
            coordinates: (at..end)
                .filter_map(|k| motion(steps.get(k)))
                .flat_map(|(_, _, a)| mechanism.arguments[a].coordinates())
                .collect::<std::collections::BTreeSet<_>>()
                .into_iter()
                .collect(),
        });
        at = end;
    }
    joints
}

/// Kind and end of the rotations that follow each other from `at` on; a body between two of them parts them.
fn rotations(steps: &[Step], at: usize, bodies: &[&Chain]) -> (JointKind, usize) {
    let mut end = at + 1;
    while end < at + 3
        && matches!(motion(steps.get(end)), Some((Motion::Rotation, _, _)))
        && !bodies.iter().any(|body| body.steps == steps[..end])
    {
        end += 1;
    }
    let kind = match end - at {
        1 => JointKind::Pin,
        2 => JointKind::Cross,
        _ => JointKind::Ball,
    };
    (kind, end)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]
    use super::*;
    use crate::kinematics::motion::continuation::solve;
    use crate::kinematics::structure::system::System;
    use crate::scene::{Overrides, builtin, load};
    use std::sync::Arc;

    fn kinds(scene: &str) -> Vec<JointKind> {
        let source = builtin::find(scene).unwrap();
        let scene = load(&source, &Overrides::default()).unwrap();
        let mechanism = &scene.mechanism;
        // Two ways to a joint meet only where the loops are closed.
        let system = System::new(Arc::clone(mechanism), &scene.actuation).unwrap();
        let trajectory = solve(&system, &scene.actuation, &[0.0]);
        let sample = &trajectory.samples[0];
        let pose = sample.pose.as_ref().unwrap();
        let found = find(mechanism, &arguments(mechanism, sample, pose));
        found.into_iter().map(|joint| joint.kind).collect()
    }

    #[test]
    fn joints_are_told_apart_by_their_motions() {
        use JointKind::*;
        assert_eq!(kinds("bennett").iter().filter(|k| **k == Pin).count(), 4);
        let gearshift = kinds("gearshift");
        let count = |kind| gearshift.iter().filter(|k| **k == kind).count();
        assert_eq!(
            kinds("slider-crank")
                .iter()
                .filter(|k| **k == Slider)
                .count(),
            1
        );
        assert_eq!([count(Cylindrical), count(Ball)], [1, 4], "{gearshift:?}");
    }
}
