//! The position of a joint's symbol along its axis: a chain determines only the axis, the bodies show where the joint
//! is.

use super::joints::{AT_REST, CarriedFrame, PlacedJoint, PlacedLinks, few_of};
use crate::geometry::coarse_mesh_of;
use crate::math::Pose;
use crate::model::joints::JointKind;
use crate::model::mechanism::Mechanism;
use crate::model::view::View;
use glam::DVec3;

/// Facet error of the meshes that are looked at over a solid's radius.
const COARSE: f64 = 0.02;

/// Solids around an axis (sockets, hubs) count up to this many reaches from it.
const SOCKET: f64 = 8.0;

/// How much farther from its line than from a pin's axis a slider's guide may be.
const GUIDE: f64 = 3.0;

/// The bodies as joints meet them.
pub struct BodyOutlines<'p> {
    /// Points of the solids of every body, a list a solid, in the body's frame.
    bodies: Vec<Vec<Vec<DVec3>>>,
    /// Some poses of the motion, each with those of all bodies.
    poses: Vec<(&'p PlacedLinks, Vec<Pose>)>,
    size: f64,
}

/// The position of a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointPlace {
    /// Shift along the joint's first axis from its frames.
    pub shift: f64,
    /// Whether a body on the base side reaches the joint, so that it needs no ground symbol.
    pub held: bool,
}

/// Extents of a solid along the axis of a joint.
type AxisExtent = [f64; 2];

impl<'p> BodyOutlines<'p> {
    /// Outlines of all bodies, examined at some of the poses of the motion.
    pub fn new((mechanism, view): (&Mechanism, &View), all: &'p [PlacedLinks]) -> Self {
        let bodies = (0..mechanism.bodies.len()).map(|body| {
            let solids = view.shown_shapes(mechanism, body).map(|shape| {
                let mesh = coarse_mesh_of(&shape.solid, COARSE);
                let points = mesh.positions.iter();
                points
                    .map(|p| shape.body_from_shape.transform_point(*p))
                    .collect()
            });
            solids.collect()
        });
        let poses = few_of(all).map(|at| {
            let chains = mechanism.bodies.iter().map(|body| &body.world_from_body);
            (at, chains.map(|chain| chain.pose(&at.arguments)).collect())
        });
        Self {
            bodies: bodies.collect(),
            poses: poses.collect(),
            size: mechanism.size,
        }
    }

    /// The position of a joint; `reach` is the distance from the axis within which a body holds it.
    pub fn place(&self, joint: &PlacedJoint, reach: f64) -> JointPlace {
        // The guide of a slider is next to its line.
        let reach = match joint.kind {
            JointKind::Prismatic | JointKind::Planar => GUIDE * reach,
            _ => reach,
        };
        let meets = matches!(joint.kind, JointKind::Spherical | JointKind::Universal);
        let [before, after] = [&joint.before, &joint.after].map(|frame| {
            let mut stretches = self.stretches(frame, joint.axis, reach);
            if meets {
                stretches.retain(|s| s[0] <= reach && s[1] >= -reach);
            }
            stretches
        });
        let shift = if meets {
            0.0
        } else {
            stretch_shift(&before, &after)
        };
        JointPlace {
            shift,
            held: !before.is_empty(),
        }
    }

    /// Extents along the axis of the bodies that are fixed to a frame.
    fn stretches(&self, frame: &CarriedFrame, axis: usize, reach: f64) -> Vec<AxisExtent> {
        let frames: Vec<Pose> = self
            .poses
            .iter()
            .map(|(at, _)| frame.pose(at).inverse())
            .collect();
        let resting = self.bodies.iter().enumerate().filter_map(|(body, solids)| {
            let poses = self.poses.iter().zip(&frames);
            let mut seen = poses.map(|((_, bodies), frame)| *frame * bodies[body]);
            let first = seen.next()?;
            let still =
                seen.all(|pose| pose_difference(&pose, &first, self.size) < AT_REST * self.size);
            still.then_some((first, solids))
        });
        resting
            .flat_map(|(pose, solids)| {
                let solids = solids.iter();
                solids.filter_map(move |points| axis_stretch(points, &pose, axis, reach))
            })
            .collect()
    }
}

/// Largest displacement of a point of a mechanism of this size between two poses.
fn pose_difference(pose: &Pose, other: &Pose, size: f64) -> f64 {
    let turned = (0..3).map(|k| (pose.rotation.col(k) - other.rotation.col(k)).length());
    (pose.translation - other.translation).length() + size * turned.fold(0.0, f64::max)
}

/// Extent along the axis of a solid that touches it or surrounds it closely.
fn axis_stretch(points: &[DVec3], pose: &Pose, axis: usize, reach: f64) -> Option<AxisExtent> {
    let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
    let local: Vec<DVec3> = points.iter().map(|p| pose.transform_point(*p)).collect();
    let first = *local.first()?;
    let fold = |pick: fn(DVec3, DVec3) -> DVec3| local.iter().fold(first, |a, b| pick(a, *b));
    let (low, high) = (fold(DVec3::min), fold(DVec3::max));
    let nearest = local.iter().map(|p| libm::hypot(p[u], p[v]));
    let touches = nearest.fold(f64::INFINITY, f64::min) <= reach;
    let around = [u, v].into_iter().all(|k| {
        low[k] <= reach && high[k] >= -reach && low[k].abs().max(high[k].abs()) <= SOCKET * reach
    });
    (touches || around).then_some([low[axis], high[axis]])
}

/// The position where solids on both sides of a joint meet on its axis: in the middle of the gap or overlap of the
/// nearest two; the origin if both cover it.
fn stretch_shift(before: &[AxisExtent], after: &[AxisExtent]) -> f64 {
    let alone = |stretches: &[AxisExtent]| {
        let nearest = stretches.iter().map(|s| 0f64.clamp(s[0], s[1]));
        nearest.min_by(|a, b| a.abs().total_cmp(&b.abs()))
    };
    let meeting = |a: &AxisExtent, b: &AxisExtent| {
        let (start, end) = (a[0].max(b[0]), a[1].min(b[1]));
        let place = if start <= 0.0 && end >= 0.0 {
            0.0
        } else {
            0.5 * (start + end)
        };
        ((start - end).max(0.0), place)
    };
    let pairs = before
        .iter()
        .flat_map(|a| after.iter().map(move |b| meeting(a, b)));
    let nearest = pairs.min_by(|p, q| {
        let order = p.0.total_cmp(&q.0);
        order.then(p.1.abs().total_cmp(&q.1.abs()))
    });
    let one_sided = || alone(before).or_else(|| alone(after));
    nearest.map(|pair| pair.1).or_else(one_sided).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::kinematics::motion::continuation::solve_motion;
    use crate::kinematics::motion::sampling::even_times;
    use crate::kinematics::structure::system::System;
    use crate::scene::{Overrides, builtin, load_scene};
    use crate::staging::joints;
    use std::sync::Arc;

    #[test]
    fn a_sign_stands_where_two_solids_meet() {
        let cases: [(&[AxisExtent], &[AxisExtent], f64); 6] = [
            (&[[1.0, 3.0]], &[[2.0, 5.0]], 2.5),
            (&[[1.0, 3.0]], &[[4.0, 5.0]], 3.5),
            (&[[-1.0, 3.0]], &[[-4.0, 5.0]], 0.0),
            (&[[8.0, 9.0], [1.0, 2.0]], &[[2.5, 3.0]], 2.25),
            (&[], &[[-7.0, -6.0]], -6.0),
            (&[], &[], 0.0),
        ];
        for (before, after, place) in cases {
            assert_eq!(stretch_shift(before, after), place, "{before:?} {after:?}");
        }
    }

    /// The driver's bearing is high above the origin of its chain; all joints of the frame are held by it.
    #[test]
    fn signs_stand_on_the_bodies_that_the_joint_connects() {
        let source = builtin::find_builtin("rsrrr").unwrap();
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let (mechanism, actuation) = (scene.mechanism, &scene.actuation);
        let system = System::new(Arc::clone(&mechanism), actuation).unwrap();
        let times = even_times(&mechanism, actuation, 9);
        let trajectory = solve_motion(&system, actuation, &times);
        let samples = trajectory.samples.iter();
        let closed = samples.filter_map(|s| Some((s, s.pose.as_ref()?)));
        let poses: Vec<PlacedLinks> = closed
            .map(|(sample, pose)| PlacedLinks::new(&mechanism, sample, pose))
            .collect();
        let outlines = BodyOutlines::new((&mechanism, &scene.view), &poses);
        let places = joints::placed_joints(&mechanism)
            .into_iter()
            .filter(|joint| joint.grounded)
            .map(|joint| {
                let place = outlines.place(&joint, 0.8);
                let at = joint.before.pose(&poses[0]);
                assert!(place.held);
                (at.translation + at.rotation.col(joint.axis) * place.shift).z
            });
        let places: Vec<f64> = places.collect();
        assert_eq!(places.len(), 2, "{places:?}");
        // The frame's upper bearing reaches from 11.2 to 14.2.
        assert!(
            places.iter().any(|z| (11.2..=14.2).contains(z)),
            "{places:?}"
        );
        assert!(places.iter().any(|z| *z < 0.0), "{places:?}");
    }
}
