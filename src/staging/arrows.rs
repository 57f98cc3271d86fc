//! Velocity arrows on traced points, from the rates of the pose. At a singular pose, which has none, they are differences between
//! neighbouring samples.

use super::solids::{arrow_solids, merged_mesh, sign_instance};
use crate::kinematics::loops::forward::{body_poses, trace_points};
use crate::kinematics::results::trajectory::{Sample, Trajectory};
use crate::math::Pose;
use crate::render::{Instance, StageMesh};
use crate::scene::Scene;
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
        scene: &Scene,
        trajectory: &Trajectory,
        [extent, pixel]: [f64; 2],
        meshes: &mut Vec<StageMesh>,
    ) -> Option<Self> {
        let (traces, decor) = (&scene.mechanism.traces, &scene.view.decor);
        if !decor.arrows {
            return None;
        }
        // Velocities of all traced points, of which the fastest sets the scale.
        let samples = trajectory.samples.iter().enumerate();
        let velocities: Vec<Vec<DVec3>> = samples
            .map(|(index, sample)| {
                let differences = |trace| trace_difference(trajectory, index, trace);
                trace_velocities(scene, sample)
                    .unwrap_or_else(|| (0..traces.len()).map(differences).collect())
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

/// The part of the mechanism that a step for a velocity moves: a point leaves its tangent by the square of that.
const STEP: f64 = 1e-5;

/// Velocities of the traced points at a pose: central differences of their places along the rates of the coordinates. `None` without
/// a pose, or where a rate is undefined.
fn trace_velocities(scene: &Scene, sample: &Sample) -> Option<Vec<DVec3>> {
    let (mechanism, pose) = (&scene.mechanism, sample.pose.as_ref()?);
    let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
    let of_inputs = scene.actuation.rates_at(sample.time);
    let rates = [pose.rates.as_slice(), &of_inputs].concat();
    if rates.len() != coordinates.len() || !rates.iter().all(|rate| rate.is_finite()) {
        return None;
    }
    let scaled = rates.iter().enumerate();
    let scaled = scaled.map(|(k, rate)| rate.abs() / mechanism.scale_of(k));
    let fastest = scaled.fold(0.0, f64::max);
    if fastest == 0.0 {
        return Some(vec![DVec3::ZERO; mechanism.traces.len()]);
    }
    let step = STEP / fastest;
    let moved = |by: f64| {
        let pairs = coordinates.iter().zip(&rates);
        let moved: Vec<f64> = pairs.map(|(at, rate)| at + by * rate).collect();
        trace_points(mechanism, &body_poses(mechanism, &moved))
    };
    let pairs = moved(-step).into_iter().zip(moved(step));
    Some(pairs.map(|(a, b)| (b - a) / (2.0 * step)).collect())
}

/// From the samples on both sides if they have poses, otherwise from the one that has.
fn trace_difference(trajectory: &Trajectory, index: usize, trace: usize) -> DVec3 {
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

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;
    use crate::diag::Source;
    use crate::kinematics::motion::continuation::solve_motion;
    use crate::kinematics::structure::system::System;
    use crate::scene::{Overrides, load_scene};
    use std::sync::Arc;

    /// Those of a circle, at however few samples; a jump of a drive is no velocity.
    #[test]
    fn velocities_are_those_of_the_poses() {
        let text = "duration = 2\n[inputs]\na = \"pi*t\"\ns = { keys = [[0, 0], [1, 50], [2, 20]], ease = \"step\" }\n\
                    [[bodies]]\nname = \"b\"\nframe = \"Tx(s) Rz(a) Tx(50)\"\n[[traces]]\nname = \"P\"\nbody = \"b\"\n";
        let source = Source {
            name: "circle".to_owned(),
            text: text.to_owned(),
        };
        let scene = load_scene(&source, &Overrides::default()).unwrap();
        let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation).unwrap();
        let motion = solve_motion(&system, &scene.actuation, &[0.0, 0.99, 1.0, 1.5]);
        for sample in &motion.samples {
            let angle = std::f64::consts::PI * sample.time;
            let speed = 50.0 * std::f64::consts::PI;
            let exact = DVec3::new(-angle.sin(), angle.cos(), 0.0) * speed;
            let [found] = trace_velocities(&scene, sample).unwrap()[..] else {
                unreachable!("one trace");
            };
            assert!(found.distance(exact) < 1e-7 * speed, "{found} {exact}");
        }
    }
}
