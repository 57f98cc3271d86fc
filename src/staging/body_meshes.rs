//! Meshes of bodies and traces, as fine as the picture needs, and their instances.

use super::bounds;
use crate::geometry::mesh_of;
use crate::kinematics::results::trajectory::ClosedPose;
use crate::math::Pose;
use crate::model::shape::{Solid, TriangleSoup};
use crate::render::{Camera, Instance, StageMesh};
use crate::scene::Scene;
use glam::DVec3;
use std::collections::HashMap;
use std::sync::Arc;

/// Largest distance between a round surface and its facets, in pixels: below what four samples can show.
const FACET_ERROR_PIXELS: f64 = 0.2;

/// A solid of a body, ready to be placed.
pub struct StagedPart {
    mesh: usize,
    body: usize,
    body_from_shape: Pose,
    colour: [u8; 3],
    opacity: f64,
    /// How far it is drawn from its place.
    offset: DVec3,
}

impl StagedPart {
    /// Index of the body it belongs to.
    pub fn body(&self) -> usize {
        self.body
    }

    /// Index of its mesh.
    pub fn mesh(&self) -> usize {
        self.mesh
    }

    /// Its sRGB colour.
    pub fn colour(&self) -> [u8; 3] {
        self.colour
    }

    /// Draws it this far from its place.
    pub fn move_by(&mut self, offset: DVec3) {
        self.offset = offset;
    }

    /// Where and how it is drawn at a pose.
    pub fn instance(&self, pose: &ClosedPose, meshes: &[StageMesh]) -> Instance {
        let mut world_from_mesh = pose.bodies[self.body] * self.body_from_shape;
        world_from_mesh.translation += self.offset;
        Instance {
            mesh: self.mesh,
            world_from_mesh,
            colour: self.colour,
            opacity: self.opacity,
            triangles: 0..meshes[self.mesh].triangles.len() as u32,
            casts_shadow: true,
            outline: Some(self.body as u32),
            flat: 0.0,
        }
    }
}

/// Number of cameras along a path at which the size of a pixel is evaluated.
const CAMERAS: usize = 32;

/// Meshes get no finer than for a picture whose height is this fraction of the motion's extent: with the eye inside a
/// body there would be no limit.
const CLOSEST: f64 = 16.0;

/// Size of a pixel where the motion is nearest to any of the cameras, in the scene's unit.
pub fn pixel_size(cameras: &[Camera], size: [u32; 2], points: &[DVec3]) -> f64 {
    let stride = cameras.len().div_ceil(CAMERAS).max(1);
    let some = cameras.iter().step_by(stride);
    let nearest = some.map(|camera| nearest_pixel(camera, size, points));
    let extent = bounds::box_of(points).map_or(0.0, |[low, high]| (high - low).length());
    let finest = extent / (CLOSEST * f64::from(size[1]));
    nearest.fold(f64::INFINITY, f64::min).max(finest)
}

fn nearest_pixel(camera: &Camera, size: [u32; 2], points: &[DVec3]) -> f64 {
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

/// One part per shape of every body. Shapes that share the triangles of a file share their mesh.
pub fn of_bodies(scene: &Scene, pixel: f64, meshes: &mut Vec<StageMesh>) -> Vec<StagedPart> {
    let mut parts = Vec::new();
    let mut of_files: HashMap<*const TriangleSoup, usize> = HashMap::new();
    for body in 0..scene.mechanism.bodies.len() {
        for shape in scene.view.shown_shapes(&scene.mechanism, body) {
            let mut new_mesh = || {
                meshes.push(mesh_of(&shape.solid, FACET_ERROR_PIXELS * pixel).into());
                meshes.len() - 1
            };
            let mesh = match &shape.solid {
                Solid::Triangles(soup) => {
                    *of_files.entry(Arc::as_ptr(soup)).or_insert_with(new_mesh)
                }
                _ => new_mesh(),
            };
            parts.push(StagedPart {
                mesh,
                body,
                body_from_shape: shape.body_from_shape,
                colour: shape.colour,
                opacity: shape.opacity,
                offset: DVec3::ZERO,
            });
        }
    }
    parts
}
