//! The room a motion takes: points that the camera must hold.

use crate::geometry::mesh_of;
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::mechanism::Mechanism;
use glam::DVec3;

/// Samples looked at: more do not widen the bounds visibly.
const MAX_SAMPLES: usize = 64;

/// Facet error of the bounding meshes over the mechanism's size: a coarse hull is enough, the margin covers it.
const COARSE: f64 = 0.02;

/// Points of coarse meshes of all bodies over the motion, and all traced points.
pub fn moving_points(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<DVec3> {
    let hulls: Vec<(usize, Vec<DVec3>)> = mechanism
        .bodies
        .iter()
        .enumerate()
        .flat_map(|(body, b)| b.shapes.iter().map(move |shape| (body, shape)))
        .map(|(body, shape)| {
            let mesh = mesh_of(&shape.solid, COARSE * mechanism.size);
            (
                body,
                mesh.positions
                    .iter()
                    .map(|p| shape.body_from_shape.transform_point(*p))
                    .collect(),
            )
        })
        .collect();
    let poses: Vec<_> = trajectory.poses().collect();
    let stride = poses.len().div_ceil(MAX_SAMPLES).max(1);
    let mut points = Vec::new();
    for pose in poses.iter().step_by(stride) {
        for (body, hull) in &hulls {
            points.extend(hull.iter().map(|p| pose.bodies[*body].transform_point(*p)));
        }
    }
    points.extend(poses.iter().flat_map(|pose| pose.traces.iter().copied()));
    points.retain(|p| p.is_finite());
    points
}

/// Of all points those that are outermost in one of `directions` evenly spread directions (Fibonacci's lattice on the
/// sphere): enough to frame them.
pub fn outline(points: &[DVec3], directions: usize) -> Vec<DVec3> {
    if points.len() <= directions {
        return points.to_vec();
    }
    let golden = std::f64::consts::PI * (3.0 - 5f64.sqrt());
    let outermost = (0..directions).filter_map(|k| {
        let z = 1.0 - (2.0 * k as f64 + 1.0) / directions as f64;
        let out = (1.0 - z * z).sqrt();
        let (sin, cos) = crate::math::sin_cos(golden * k as f64);
        let direction = DVec3::new(out * cos, out * sin, z);
        let far = |p: &&DVec3, q: &&DVec3| p.dot(direction).total_cmp(&q.dot(direction));
        points.iter().max_by(far).copied()
    });
    outermost.collect()
}

/// Smallest axis-parallel box around the points.
pub fn box_of(points: &[DVec3]) -> Option<[DVec3; 2]> {
    let first = *points.first()?;
    Some(
        points
            .iter()
            .fold([first, first], |[low, high], p| [low.min(*p), high.max(*p)]),
    )
}
