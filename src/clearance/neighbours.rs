//! Neighbours: two bodies that one joint connects. The parts of their shapes that touch at the joint itself are left out of
//! the check, everything else of them is judged.
//!
//! A body on a link between two others separates them, however close their axes are: these two must keep their clearance.

use super::joint_locus::JointLocus;
use super::joint_region::{JointRegion, TOUCH};
use super::motion::ProvedMotion;
use crate::distance::bodies::BodyElements;
use crate::distance::mesh;
use crate::distance::pair::{Proximity, signed_distance};
use crate::distance::point::on_segment;
use crate::distance::primitive::Element;
use crate::math::Pose;
use crate::model::chain::{ArgumentValue, ElementaryMotion as StepMotion};
use crate::model::joints::{Joint, JointKind, Joints};
use crate::model::walk::walk_chain;
use glam::DVec3;

/// A contact belongs to the joint if it is no farther from it than this many radii of the smaller shape.
const AROUND: f64 = 2.0;

/// Two bodies with nothing but a joint between, or not even that.
#[derive(Clone, Debug)]
pub enum Neighbours {
    /// One link: nothing moves between them.
    Rigid,
    /// On the two sides of a joint.
    Joined {
        /// What kind of joint.
        words: &'static str,
        /// The parts of both bodies that touch there at the first pose.
        region: Box<JointRegion>,
    },
}

impl Neighbours {
    /// As in reports.
    pub const fn words(&self) -> &'static str {
        match self {
            Self::Rigid => "one rigid part",
            Self::Joined { words, .. } => words,
        }
    }
}

/// Why two bodies are neighbours, or `None` if they are not. Shapes nearer than `minimum` count as touching, but for those of
/// bodies that slide along each other.
pub fn joint_neighbours(
    motion: &ProvedMotion,
    joints: &Joints,
    [a, b]: [usize; 2],
    hulls: [&BodyElements; 2],
    minimum: f64,
) -> Option<Neighbours> {
    if joints.are_rigid(a, b) {
        return Some(Neighbours::Rigid);
    }
    let joint = joints.between(a, b)?;
    // Sliders have no place of their own: only what touches is of them.
    let slides = matches!(joint.kind, JointKind::Prismatic | JointKind::Planar);
    let near = if slides { 0.0 } else { minimum };
    let first = motion.assembled()?;
    let place = place_of(joints, joint, &motion.instants[first].arguments);
    let [world_from_a, world_from_b] = [a, b].map(|body| motion.body_pose(first, body));
    let a_from_b = world_from_a.inverse() * world_from_b;
    // At the first pose: elements that touch at the joint itself.
    let mut touching = Vec::new();
    for (i, first) in hulls[0].elements.iter().enumerate() {
        for (j, mine) in hulls[1].elements.iter().enumerate() {
            let second = mine.moved(&a_from_b);
            let contact = contact_of(first, &second, near);
            let is_there = contact.is_some_and(|(point, radius)| {
                place.is_near(world_from_a.transform_point(point), AROUND * radius)
            });
            touching.extend(is_there.then_some([i, j]));
        }
    }
    let words = joint.kind.words();
    let places = [world_from_a, world_from_b].map(|pose| place.seen_from(&pose));
    let region = JointRegion::new(hulls, &touching, &places, &a_from_b, minimum);
    let only_turns = matches!(joint.kind, JointKind::Revolute | JointKind::Spherical);
    let region = Box::new(region.turning(only_turns));
    Some(Neighbours::Joined { words, region })
}

/// The point where two elements touch, or are within `near`, and the radius of the smaller one.
fn contact_of(first: &Element, second: &Element, near: f64) -> Option<(DVec3, f64)> {
    let [(_, r), (_, s)] = [first.bounds(), second.bounds()];
    let radius = r.min(s);
    let found = signed_distance(first, second);
    let is_near = found.distance <= near + TOUCH * radius;
    let is_inside = || mesh::is_any([first, second]) && mesh::one_inside(&first.core, &second.core);
    (is_near || is_inside()).then(|| (contact_place(first, second, &found), radius))
}

/// The middle between the surfaces, but not beyond the nearest points of the cores: where two elements are deep in each other
/// the way out leads in any direction, and far away from where they meet.
fn contact_place(first: &Element, second: &Element, found: &Proximity) -> DVec3 {
    let [p, q] = found.points;
    let n = found.normal;
    let cores = [p - n * first.radius, q + n * second.radius];
    on_segment(&cores, 0.5 * (p + q))
}

/// Where a joint is at a pose, in the world.
fn place_of(joints: &Joints, joint: &Joint, arguments: &[ArgumentValue]) -> JointLocus {
    if matches!(joint.kind, JointKind::Prismatic | JointKind::Planar) {
        return JointLocus::Anywhere;
    }
    let mut here: Pose = joints.world_from(&joint.before).pose(arguments);
    let mut lines = Vec::new();
    walk_chain(&joint.steps, &mut here, arguments, |here, step| {
        if step.motion == StepMotion::Rotation {
            lines.push([here.translation, here.rotation.col(step.axis)]);
        }
    });
    match (joint.kind, lines.first()) {
        (JointKind::Spherical, Some([centre, _])) => JointLocus::Point(*centre),
        (_, Some(_)) => JointLocus::Lines(lines),
        (_, None) => JointLocus::Anywhere,
    }
}
