//! Other poses that stay in the picture as translucent bodies.

use super::body_meshes::StagedPart;
use crate::kinematics::results::trajectory::{ClosedPose, Trajectory};
use crate::math::Pose;
use crate::model::view::Ghosts;
use crate::render::{Instance, StageMesh};

/// Opacity of a ghost relative to its body.
const OPACITY: f64 = 0.16;

/// A body that is nearer to its ghost than this, relative to its size of 1, has no ghost.
const STILL: f64 = 1e-9;

/// Samples of the ghosts, ascending.
pub fn ghost_samples(ghosts: &Ghosts, trajectory: &Trajectory, duration: f64) -> Vec<usize> {
    let times = match ghosts {
        Ghosts::Count(count) => (0..*count)
            .map(|k| duration * k as f64 / *count as f64)
            .collect(),
        Ghosts::Times(times) => times.clone(),
    };
    let with_pose = || {
        let samples = trajectory.samples.iter().enumerate();
        samples.filter(|(_, sample)| sample.pose.is_some())
    };
    let nearest = |time: f64| {
        let away = |sample: &f64| (sample - time).abs();
        with_pose()
            .min_by(|a, b| away(&a.1.time).total_cmp(&away(&b.1.time)))
            .map(|(index, _)| index)
    };
    let mut samples: Vec<usize> = times.into_iter().filter_map(nearest).collect();
    samples.sort_unstable();
    samples.dedup();
    samples
}

/// The ghosts before sample `index`, whose own pose is `now`.
pub fn ghost_instances(
    parts: &[StagedPart],
    samples: &[usize],
    trajectory: &Trajectory,
    (index, now): (usize, &ClosedPose),
    meshes: &[StageMesh],
) -> Vec<Instance> {
    let earlier = samples.iter().take_while(|sample| **sample < index);
    let poses = earlier.filter_map(|sample| trajectory.samples[*sample].pose.as_ref());
    poses
        .flat_map(|pose| {
            let moved = parts.iter().filter(|part| {
                let body = part.body();
                !same_pose(&pose.bodies[body], &now.bodies[body])
            });
            moved.map(|part| {
                let mut instance = part.instance(pose, meshes);
                instance.opacity *= OPACITY;
                instance.casts_shadow = false;
                instance
            })
        })
        .collect()
}

fn same_pose(a: &Pose, b: &Pose) -> bool {
    let turned = (a.rotation - b.rotation).to_cols_array();
    let size = 1.0 + b.translation.length();
    turned.iter().all(|entry| entry.abs() < STILL)
        && a.translation.distance(b.translation) < STILL * size
}
