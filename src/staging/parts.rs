//! Meshes of bodies and traces at the fineness the picture needs, and their instances.

use crate::geometry::trace::trace_mesh;
use crate::geometry::{Mesh, mesh_of};
use crate::kinematics::trajectory::{ClosedPose, Trajectory};
use crate::math::Pose;
use crate::model::mechanism::Mechanism;
use crate::render::{Camera, Instance};
use glam::DVec3;

/// Largest distance between a round surface and its facets, in pixels: below what four samples can show.
const FACET_ERROR_PIXELS: f64 = 0.2;

/// Radius of a trace in pixels where the scene gives none.
const TRACE_RADIUS_PIXELS: f64 = 1.7;

/// Points of a trace nearer together than this, in pixels, are one: long runs of samples draw no hair's breadths.
const TRACE_STEP_PIXELS: f64 = 0.5;

/// Sides of a trace's tube: it is a few pixels wide.
const TRACE_SIDES: u32 = 6;

/// A solid of a body, ready to be placed.
pub struct Part {
    mesh: usize,
    body: usize,
    body_from_shape: Pose,
    colour: [u8; 3],
    opacity: f64,
}

impl Part {
    /// Index of the body it belongs to.
    pub fn body(&self) -> usize {
        self.body
    }

    /// Where and how it is drawn at a pose.
    pub fn instance(&self, pose: &ClosedPose, meshes: &[Mesh]) -> Instance {
        Instance {
            mesh: self.mesh,
            world_from_mesh: pose.bodies[self.body] * self.body_from_shape,
            colour: self.colour,
            opacity: self.opacity,
            triangles: 0..meshes[self.mesh].triangles.len() as u32,
            casts_shadow: self.opacity >= 1.0,
            flat: 0.0,
        }
    }
}

/// A path that grows from frame to frame.
pub struct TracePart {
    mesh: usize,
    /// Triangles drawn at each sample.
    triangles: Vec<u32>,
    colour: [u8; 3],
}

impl TracePart {
    /// The path up to sample `index`.
    pub fn instance(&self, index: usize) -> Instance {
        Instance {
            mesh: self.mesh,
            world_from_mesh: Pose::IDENTITY,
            colour: self.colour,
            opacity: 1.0,
            triangles: 0..self.triangles[index],
            casts_shadow: false,
            flat: 1.0,
        }
    }
}

/// Length of a pixel where the motion is nearest to the camera, in the scene's unit.
pub fn pixel_size(camera: &Camera, size: [u32; 2], points: &[DVec3]) -> f64 {
    let scale = camera.pixels_per_unit(size);
    if !camera.is_perspective() {
        return 1.0 / scale;
    }
    let camera_from_world = camera.world_from_camera.inverse();
    let nearest = points
        .iter()
        .map(|p| -camera_from_world.transform_point(*p).z)
        .fold(f64::INFINITY, f64::min);
    nearest.clamp(camera.near, camera.far) / scale
}

/// One part per shape of every body.
pub fn of_bodies(mechanism: &Mechanism, pixel: f64, meshes: &mut Vec<Mesh>) -> Vec<Part> {
    let mut parts = Vec::new();
    for (body, b) in mechanism.bodies.iter().enumerate() {
        for shape in &b.shapes {
            meshes.push(mesh_of(&shape.solid, FACET_ERROR_PIXELS * pixel));
            parts.push(Part {
                mesh: meshes.len() - 1,
                body,
                body_from_shape: shape.body_from_shape,
                colour: shape.colour,
                opacity: shape.opacity,
            });
        }
    }
    parts
}

/// One part per trace that is to be seen.
pub fn of_traces(
    mechanism: &Mechanism,
    trajectory: &Trajectory,
    pixel: f64,
    meshes: &mut Vec<Mesh>,
) -> Vec<TracePart> {
    let mut parts = Vec::new();
    for (index, trace) in mechanism.traces.iter().enumerate() {
        let radius = trace.radius.unwrap_or(TRACE_RADIUS_PIXELS * pixel);
        if radius <= 0.0 {
            continue;
        }
        let points = trajectory
            .samples
            .iter()
            .map(|s| s.pose.as_ref().map(|p| p.traces[index]));
        let (kept, steps) = thinned(points, TRACE_STEP_PIXELS * pixel);
        let path = trace_mesh(&kept, radius, TRACE_SIDES);
        meshes.push(path.mesh);
        parts.push(TracePart {
            mesh: meshes.len() - 1,
            triangles: steps
                .iter()
                .map(|step| step * path.triangles_per_step)
                .collect(),
            colour: trace.colour,
        });
    }
    parts
}

/// The points that are at least `apart` from the one kept before (gaps and the last point are always kept), and for
/// every point the number of steps between kept points up to it.
fn thinned(
    points: impl Iterator<Item = Option<DVec3>> + Clone,
    apart: f64,
) -> (Vec<Option<DVec3>>, Vec<u32>) {
    let last = points.clone().count().saturating_sub(1);
    let mut kept: Vec<Option<DVec3>> = Vec::new();
    let steps = points.enumerate().map(|(index, point)| {
        let near =
            matches!((kept.last(), point), (Some(Some(a)), Some(b)) if a.distance(b) < apart);
        if !near || index == last {
            kept.push(point);
        }
        kept.len() as u32 - 1
    });
    let steps = steps.collect();
    (kept, steps)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn close_points_are_thinned_and_gaps_and_ends_are_kept() {
        let x = |v: f64| Some(DVec3::new(v, 0.0, 0.0));
        let points = [x(0.0), x(0.1), x(0.6), x(0.7), None, x(0.7), x(0.8)];
        let (kept, steps) = thinned(points.into_iter(), 0.5);
        assert_eq!(kept, [x(0.0), x(0.6), None, x(0.7), x(0.8)]);
        assert_eq!(steps, [0, 0, 1, 1, 2, 3, 4]);
    }
}
