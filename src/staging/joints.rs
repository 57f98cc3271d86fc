//! The joints of the mechanism's table and their placements at a pose, for pictures. Their symbols are made in
//! `joint_symbols`.

use super::axis_places::axis_shifts;
use super::floating::floating_joints;
use crate::kinematics::results::trajectory::{ClosedPose, Sample, Trajectory};
use crate::math::Pose;
use crate::model::bar_ends::BarEnds;
use crate::model::chain::{ArgumentValue, Chain, ChainJoint, ChainStep, ElementaryMotion};
use crate::model::joints::{Joint, JointKind, LinkFrame};
use crate::model::mechanism::Mechanism;
use crate::model::walk::walk_chain;
use glam::DVec3;

/// Samples looked at for the room and the strokes of the joints.
const MAX_SAMPLES: usize = 64;

/// Parts that move relative to each other by less than this fraction of the mechanism's size move together.
pub(super) const AT_REST: f64 = 1e-6;

/// Number of poses at which that is examined.
const POSES: usize = 7;

/// A few poses, evenly spread over all.
pub(super) fn few_of(all: &[PlacedLinks]) -> impl Iterator<Item = &PlacedLinks> {
    all.iter().step_by(all.len().div_ceil(POSES).max(1))
}

/// A joint with its placement in the world.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedJoint {
    /// What it is.
    pub kind: JointKind,
    /// The frame before the joint.
    pub before: CarriedFrame,
    /// The frame behind it.
    pub after: CarriedFrame,
    /// Its first axis (0 x, 1 y, 2 z) in the frame before.
    pub axis: usize,
    /// Axis of its last rotation in the frame before that; its first axis if it does not turn.
    pub last_axis: usize,
    /// It belongs to the frame of the mechanism.
    pub grounded: bool,
}

/// A frame carried by a link, some steps from it. Storing the chains of all links in full would take far more memory
/// than the joints.
#[derive(Clone, Debug, PartialEq)]
pub struct CarriedFrame {
    link: usize,
    steps: Vec<ChainStep>,
}

impl CarriedFrame {
    fn new(frame: &LinkFrame) -> Self {
        let is_own = frame.link_from_here == Pose::IDENTITY;
        let fixed = (!is_own).then(|| ChainStep::Fixed(frame.link_from_here.into()));
        Self {
            link: frame.link,
            steps: fixed.into_iter().collect(),
        }
    }

    /// The frame behind one more step.
    pub fn then(mut self, steps: &[ChainStep]) -> Self {
        self.steps.extend(steps);
        self
    }

    /// That of a link itself.
    pub fn of_link(link: usize) -> Self {
        Self {
            link,
            steps: Vec::new(),
        }
    }

    /// The place of a frame that only constant steps lead to, from its link.
    #[cfg(test)]
    pub fn fixed_place(&self) -> glam::DVec3 {
        let steps = self.steps.clone();
        Chain { steps }.pose(&[]).translation
    }

    /// World from the frame.
    pub fn pose(&self, at: &PlacedLinks) -> Pose {
        let mut here = at.links[self.link];
        walk_chain(&self.steps, &mut here, &at.arguments, |_, _| {});
        here
    }
}

/// All placements at a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct PlacedLinks {
    /// Values of all arguments.
    pub arguments: Vec<ArgumentValue>,
    /// World from every link.
    links: Vec<Pose>,
}

impl PlacedLinks {
    /// At a sample.
    pub fn new(mechanism: &Mechanism, sample: &Sample, pose: &ClosedPose) -> Self {
        let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
        let arguments = mechanism.argument_values(&coordinates);
        Self {
            links: mechanism.joints.link_poses(&arguments),
            arguments,
        }
    }

    /// At some samples of the motion that have a pose.
    pub fn over_motion(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Self> {
        let samples = trajectory.samples.iter();
        let closed = samples.filter_map(|sample| Some((sample, sample.pose.as_ref()?)));
        let closed: Vec<_> = closed.collect();
        let stride = closed.len().div_ceil(MAX_SAMPLES).max(1);
        let kept = closed.into_iter().step_by(stride);
        kept.map(|(sample, pose)| Self::new(mechanism, sample, pose))
            .collect()
    }

    /// World from a link.
    pub fn link(&self, link: usize) -> Pose {
        self.links[link]
    }
}

impl PlacedJoint {
    /// The displacement of a translation; 0 for a rotation.
    pub fn stroke(&self, at: &PlacedLinks) -> f64 {
        let [before, after] = [&self.before, &self.after].map(|frame| frame.pose(at));
        (after.translation - before.translation).dot(before.rotation.col(self.axis))
    }
}

/// All joints except those that connect nothing, or only place ends of bars.
pub fn placed_joints(mechanism: &Mechanism) -> Vec<PlacedJoint> {
    let ends = BarEnds::new(mechanism);
    let jointed = mechanism.joints.list.iter().zip(axis_shifts(mechanism));
    let jointed = jointed
        .zip(floating_joints(mechanism))
        .filter(|(_, floats)| !floats);
    let jointed = jointed.filter(|((j, _), _)| !j.is_placed && !ends.place_joint(j));
    let jointed = jointed.flat_map(|((joint, shift), _)| match parts_of(joint) {
        Some(parts) => parts,
        None => place_joint(joint, shift).into_iter().collect(),
    });
    jointed.chain(guided_ends(&ends)).collect()
}

/// What stands between two motions of one joint and moves with the first of them, such as the column under a shoulder: its frame, and
/// where it leads to from there.
pub fn inner_links(mechanism: &Mechanism) -> Vec<(CarriedFrame, DVec3)> {
    let ends = BarEnds::new(mechanism);
    let joints = mechanism.joints.list.iter().zip(floating_joints(mechanism));
    let joints =
        joints.filter(|(joint, floats)| !floats && !joint.is_placed && !ends.place_joint(joint));
    let inner = joints.flat_map(|(joint, _)| {
        let steps = &joint.steps;
        let moves = |step: &ChainStep| step.joint().is_some();
        let first = steps.iter().position(moves).unwrap_or(steps.len());
        let last = steps.iter().rposition(moves).unwrap_or(0);
        (first + 1..=last).filter_map(move |k| {
            let ChainStep::Fixed(pose) = &steps[k] else {
                return None;
            };
            let frame = CarriedFrame::new(&joint.before).then(&steps[..k]);
            (pose.translation != DVec3::ZERO).then_some((frame, pose.translation))
        })
    });
    inner.collect()
}

/// The guides of ends that slide along lines of the frame, where no joint of the table has their coordinate.
fn guided_ends(ends: &BarEnds) -> Vec<PlacedJoint> {
    let mut guides = Vec::new();
    for (end, before, joint) in ends.guides() {
        // What stands behind the step is carried along: the line of the end is as far beside it.
        let behind = Chain {
            steps: end.carrier.steps[before.len() + 1..].to_vec(),
        };
        let beside = ChainStep::Fixed(Pose::from_translation(behind.pose(&[]).translation).into());
        let carried = CarriedFrame::of_link(0).then(before).then(&[beside]);
        guides.push(PlacedJoint {
            kind: JointKind::Prismatic,
            axis: joint.axis,
            last_axis: joint.axis,
            grounded: true,
            after: carried.clone().then(&[end.carrier.steps[before.len()]]),
            before: carried,
        });
    }
    guides
}

/// A joint whose motions have places of their own, part by part: a column on its bearing with the shoulder on top. `None` if all of them
/// have one place, or are not told apart.
fn parts_of(joint: &Joint) -> Option<Vec<PlacedJoint>> {
    use JointKind::{Cylindrical, Spherical, Universal};
    let is_apart = |step: &ChainStep| match step {
        ChainStep::Fixed(pose) => pose.translation != DVec3::ZERO,
        ChainStep::Joint { .. } => false,
    };
    let steps = &joint.steps;
    let moving: Vec<usize> = (0..steps.len())
        .filter(|k| steps[*k].joint().is_some())
        .collect();
    let (first, last) = (*moving.first()?, *moving.last()?);
    if !(matches!(joint.kind, Cylindrical | Spherical | Universal)
        && steps[first..last].iter().any(is_apart))
    {
        return None;
    }
    // Motions without an offset between them are one part.
    let mut parts: Vec<Vec<usize>> = Vec::new();
    for k in moving {
        let known = parts.last_mut();
        let beside = known.filter(|part| {
            let before = part.last().copied().unwrap_or(k);
            !steps[before..k].iter().any(is_apart)
        });
        match beside {
            Some(part) => part.push(k),
            None => parts.push(vec![k]),
        }
    }
    let start = CarriedFrame::new(&joint.before);
    let count = parts.len();
    let placed = parts.iter().enumerate().map(|(index, part)| {
        let [from, until] = [part[0], part[part.len() - 1]];
        let own = part.iter().filter_map(|k| steps[*k].joint());
        let own: Vec<ChainJoint> = own.collect();
        let turning = own
            .iter()
            .filter(|step| step.motion == ElementaryMotion::Rotation);
        let turning: Vec<usize> = turning.map(|step| step.axis).collect();
        let kind = match (own.len(), turning.len()) {
            (1, 0) => JointKind::Prismatic,
            (1, 1) => JointKind::Revolute,
            (2, 2) => Universal,
            (3, 3) => Spherical,
            _ => return None,
        };
        let is_of_frame =
            (index == 0 && joint.before.link == 0) || (index + 1 == count && joint.after.link == 0);
        Some(PlacedJoint {
            kind,
            axis: own[0].axis,
            last_axis: turning.last().copied().unwrap_or(own[0].axis),
            grounded: is_of_frame,
            before: start.clone().then(&steps[..from]),
            after: start.clone().then(&steps[..=until]),
        })
    });
    placed.collect()
}

fn place_joint(joint: &Joint, shift: f64) -> Option<PlacedJoint> {
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
    let along = ChainStep::Fixed(Pose::from_translation(DVec3::AXES[first] * shift).into());
    let before = CarriedFrame::new(&joint.before);
    let before = match shift == 0.0 {
        true => before,
        false => before.then(&[along]),
    };
    // What slides is seen from the frame of the mechanism, which has the guide: its axis is the same from both sides.
    let slides = matches!(
        joint.kind,
        JointKind::Prismatic | JointKind::Cylindrical | JointKind::Helical
    );
    if slides && joint.after.link == 0 && joint.before.link != 0 {
        return Some(PlacedJoint {
            kind: joint.kind,
            axis: first,
            last_axis: first,
            grounded: true,
            before: CarriedFrame::new(&joint.after),
            after: before,
        });
    }
    Some(PlacedJoint {
        kind: joint.kind,
        axis: first,
        last_axis: joint.steps.iter().rev().find_map(turn).unwrap_or(first),
        grounded: [joint.before.link, joint.after.link].contains(&0),
        after: before.clone().then(&joint.steps),
        before,
    })
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diag::Source;
    use crate::kinematics::motion::continuation::solve_motion;
    use crate::kinematics::structure::system::System;
    use crate::scene::{Overrides, builtin, load_scene};
    use std::sync::Arc;

    /// The guide of a slider stands still, and what slides on it is where the rod ends.
    #[test]
    fn guides_belong_to_the_frame() {
        let source = builtin::find_builtin("slider-crank").unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let mechanism = &scene.mechanism;
        let system = System::new(Arc::clone(mechanism), &scene.actuation).unwrap();
        let motion = solve_motion(&system, &scene.actuation, &[0.0, 0.4, 1.1]);
        let all = placed_joints(mechanism);
        let slider = all.iter().find(|joint| joint.kind == JointKind::Prismatic);
        let slider = slider.unwrap();
        assert!(slider.grounded);
        let stroke = mechanism
            .unknowns
            .iter()
            .position(|u| u.name == "h")
            .unwrap();
        for sample in &motion.samples {
            let pose = sample.pose.as_ref().unwrap();
            let at = PlacedLinks::new(mechanism, sample, pose);
            assert!(slider.before.pose(&at).translation.length() < 1e-12);
            let moved = slider.after.pose(&at).translation.length();
            assert!((moved - pose.unknowns[stroke]).abs() < 1e-9, "{moved}");
        }
    }

    /// Motions of one joint that have places of their own have symbols of their own, and links in between.
    #[test]
    fn parts_of_a_joint_are_told_apart() {
        use JointKind::{Prismatic, Revolute, Spherical};
        let rows: [(&str, &[JointKind], usize); 4] = [
            ("Rz(a) Tz(1) Ry(b) Tx(1)", &[Revolute, Revolute], 1),
            (
                "Rz(a) Tx(1) Rz(b) Tx(1) Tz(c) Tx(0.1)",
                &[Revolute, Revolute, Prismatic],
                1,
            ),
            ("Rz(a) Ry(b) Rx(c) Tx(1)", &[Spherical], 0),
            ("Rz(a) Tx(1) Ty(1) Rz(b) Tx(1)", &[Revolute, Revolute], 0),
        ];
        for (chain, kinds, inner) in rows {
            let text = format!(
                "duration = 1\n[inputs]\na = \"t\"\nb = \"2*t\"\nc = \"0.3*t\"\n[[bodies]]\nname = \"arm\"\nframe = \"{chain}\"\n"
            );
            let name = "arm".to_owned();
            let scene = load_scene(&Source { name, text }, &Overrides::default()).unwrap();
            let placed = placed_joints(&scene.mechanism);
            let found: Vec<JointKind> = placed.iter().map(|joint| joint.kind).collect();
            assert_eq!(found, kinds, "{chain}");
            assert_eq!(inner_links(&scene.mechanism).len(), inner, "{chain}");
        }
    }

    /// The centre of a platform's rotation is one of its points.
    #[test]
    fn a_bar_at_the_centre_of_a_platform_holds_it() {
        let text = "duration = 1\n[inputs]\nl = \"1 + 0.2*t\"\n[chains]\nP = \"T(x, y, 0) Rz(g)\"\n[bars]\n\
                    a = { from = [0, 0], to = \"P\", length = \"l\" }\nb = { from = [2, 0], to = \"P Tx(1)\", length = 1 }\n\
                    c = { from = [1, 2], to = \"P Ty(0.5)\", length = 1.5 }\n[guess]\nx = 0.5\ny = 1\n";
        let source = Source {
            name: "platform".to_owned(),
            text: text.to_owned(),
        };
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let ends = BarEnds::new(&scene.mechanism);
        let carried = ends.carried();
        assert_eq!(carried.len(), 3);
        assert!(carried.iter().all(|(link, _)| *link == carried[0].0));
    }
}
