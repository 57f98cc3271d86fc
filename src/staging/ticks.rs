//! Marks on a traced path at equal times: where they are far apart, the point is fast.

use super::solids::merged_mesh;
use super::trails::{LEAST_RADIUS_PIXELS, TRACE_RADIUS, TrailLook, trace_piece};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::shape::Solid;
use crate::model::view::{Decor, Trails};
use crate::render::{Instance, StageMesh};
use crate::scene::Scene;
use glam::DVec3;

/// Radius of a mark over that of its path.
const RADIUS: f64 = 2.0;

/// Marks of a path; later ones are left out.
const MOST: usize = 1000;

/// The marks of one path.
pub struct TickMarks {
    mesh: usize,
    /// Triangles up to each sample; of the whole path where it is shown whole.
    triangles: Vec<u32>,
    colour: [u8; 3],
}

impl TickMarks {
    /// The marks at sample `index`.
    pub fn instance(&self, index: usize) -> Instance {
        trace_piece(self.mesh, 0..self.triangles[index], self.colour)
    }
}

/// The marks of all traces that are shown.
pub fn of_traces(
    scene: &Scene,
    trajectory: &Trajectory,
    decor: &Decor,
    look: TrailLook,
    meshes: &mut Vec<StageMesh>,
) -> Vec<TickMarks> {
    // Marks stand on shown paths only.
    let Some(step) = decor.ticks.filter(|_| decor.trails != Trails::None) else {
        return Vec::new();
    };
    let mut all = Vec::new();
    for (index, trace) in scene.mechanism.traces.iter().enumerate() {
        let usual = (TRACE_RADIUS / 480.0 * look.height).max(LEAST_RADIUS_PIXELS);
        let radius = RADIUS * trace.radius.unwrap_or(usual * look.pixel);
        if radius <= 0.0 {
            continue;
        }
        let (mut marks, mut times) = (Vec::new(), Vec::new());
        // One mark each at equal times, as far as the point has a place there.
        for mark in 0..MOST {
            let time = mark as f64 * step;
            if time > scene.actuation.duration {
                break;
            }
            if let Some(centre) = path_point(trajectory, index, time) {
                marks.push(Solid::Sphere { centre, radius });
                times.push(time);
            }
        }
        if marks.is_empty() {
            continue;
        }
        // All marks have equally many triangles, in the order of time: a range shows those passed.
        let mesh = merged_mesh(&marks, 0.2 * look.pixel);
        let each = mesh.triangles.len() / marks.len();
        let passed = |now: f64| times.iter().filter(|time| **time <= now).count();
        let samples = trajectory.samples.iter();
        let shown = samples.map(|sample| match decor.trails {
            Trails::Whole => marks.len(),
            _ => passed(sample.time),
        });
        all.push(TickMarks {
            triangles: shown.map(|count| (count * each) as u32).collect(),
            mesh: meshes.len(),
            colour: trace.colour,
        });
        meshes.push(mesh.into());
    }
    all
}

/// The traced point at a time, on the straight piece between two samples, as the path is drawn.
pub fn path_point(trajectory: &Trajectory, trace: usize, time: f64) -> Option<DVec3> {
    let samples = &trajectory.samples;
    let after = samples.partition_point(|sample| sample.time < time);
    let at = |k: usize| {
        Some((
            samples.get(k)?.time,
            samples.get(k)?.pose.as_ref()?.traces[trace],
        ))
    };
    let (end, last) = at(after)?;
    let Some((start, first)) = after.checked_sub(1).and_then(at) else {
        return (end - time).abs().le(&f64::EPSILON).then_some(last);
    };
    let share = (time - start) / (end - start);
    Some(first + (last - first) * share)
}
