//! Velocity arrows on traced points. Speeds are differences between neighbouring samples.

use super::solids::{arrow_solids, merged_mesh, sign_instance};
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::Pose;
use crate::model::mechanism::Trace;
use crate::model::view::Decor;
use crate::render::{Instance, StageMesh};
use glam::DVec3;

/// Length of the fastest arrow as a fraction of the motion's extent, if the scene gives no scale.
const LONGEST: f64 = 0.16;

/// Number of arrow lengths: they differ by about a pixel.
const LEVELS: usize = 96;

/// Radius of the shaft and length of the head, in pixels.
const SHAFT_PIXELS: f64 = 1.5;
const HEAD_PIXELS: f64 = 11.0;

/// Arrows slower than this fraction of the fastest are omitted: their direction is not meaningful.
const STILL: f64 = 0.01;

/// Ready-made arrows.
pub struct Arrows {
    /// Velocity of every trace at every sample, the scene's unit per second.
    velocities: Vec<Vec<DVec3>>,
    /// Mesh of the shortest arrow; those of longer ones follow.
    first: usize,
    fastest: f64,
    colours: Vec<[u8; 3]>,
}

impl Arrows {
    /// Adds the meshes; `None` if arrows are not requested or nothing moves.
    pub fn new(
        traces: &[Trace],
        trajectory: &Trajectory,
        decor: &Decor,
        [extent, pixel]: [f64; 2],
        meshes: &mut Vec<StageMesh>,
    ) -> Option<Self> {
        if !decor.arrows {
            return None;
        }
        let count = trajectory.samples.len();
        // Velocities of all traced points, of which the fastest sets the scale.
        let velocities: Vec<Vec<DVec3>> = (0..count)
            .map(|index| {
                let along = |trace| trace_velocity(trajectory, index, trace);
                (0..traces.len()).map(along).collect()
            })
            .collect();
        let speeds = velocities.iter().flatten().map(|v| v.length());
        let fastest = speeds.fold(0.0, f64::max);
        if fastest <= 0.0 {
            return None;
        }
        // Length is speed times a number of seconds: the scene's own, or one that suits the extent of the motion.
        let longest = decor
            .arrow_scale
            .map_or(LONGEST * extent, |seconds| seconds * fastest);
        // Arrows of all lengths that occur, ready-made: frames choose among them.
        let first = meshes.len();
        for level in 1..=LEVELS {
            let length = longest * level as f64 / LEVELS as f64;
            let head = (HEAD_PIXELS * pixel).min(0.6 * length);
            let solids = arrow_solids(DVec3::Z, length, SHAFT_PIXELS * pixel, head);
            meshes.push(merged_mesh(&solids, 0.2 * pixel).into());
        }
        Some(Self {
            velocities,
            first,
            fastest,
            colours: traces.iter().map(|trace| trace.colour).collect(),
        })
    }

    /// The arrows at sample `index`, whose traced points are `points`.
    pub fn instances(&self, index: usize, points: &[DVec3], meshes: &[StageMesh]) -> Vec<Instance> {
        let moving = self.velocities[index].iter().zip(points).zip(&self.colours);
        moving
            .filter(|((velocity, _), _)| velocity.length() > STILL * self.fastest)
            .map(|((velocity, point), colour)| {
                let level = (velocity.length() / self.fastest * LEVELS as f64).round();
                let mesh = self.first + (level as usize).clamp(1, LEVELS) - 1;
                let at = Pose {
                    translation: *point,
                    ..Pose::from_z_axis(velocity.normalize())
                };
                sign_instance(mesh, meshes, at, *colour, 0.5)
            })
            .collect()
    }
}

/// From the samples on both sides if they have poses, otherwise from the one that has.
fn trace_velocity(trajectory: &Trajectory, index: usize, trace: usize) -> DVec3 {
    let at = |k: usize| {
        let sample = trajectory.samples.get(k)?;
        Some((sample.time, sample.pose.as_ref()?.traces[trace]))
    };
    let Some(here) = at(index) else {
        return DVec3::ZERO;
    };
    let before = index.checked_sub(1).and_then(at).unwrap_or(here);
    let after = at(index + 1).unwrap_or(here);
    let velocity = (after.1 - before.1) / (after.0 - before.0);
    if velocity.is_finite() {
        velocity
    } else {
        DVec3::ZERO
    }
}
