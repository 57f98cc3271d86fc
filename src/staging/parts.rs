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
    triangles_per_step: u32,
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
            triangles: 0..index as u32 * self.triangles_per_step,
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
        let points: Vec<Option<DVec3>> = trajectory
            .samples
            .iter()
            .map(|s| s.pose.as_ref().map(|p| p.traces[index]))
            .collect();
        let path = trace_mesh(&points, radius, TRACE_SIDES);
        meshes.push(path.mesh);
        parts.push(TracePart {
            mesh: meshes.len() - 1,
            triangles_per_step: path.triangles_per_step,
            colour: trace.colour,
        });
    }
    parts
}
