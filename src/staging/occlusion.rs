//! Decides whether a body hides a point from the eye.

use super::body_meshes::StagedPart;
use super::section::SectionCut;
use crate::kinematics::results::trajectory::ClosedPose;
use crate::render::{Camera, Instance, StageMesh};
use glam::DVec3;

/// A body hides a point only if it is nearer to the eye by this fraction of the distance.
const NEARER: f64 = 1e-3;

/// Whether a part of a body other than `own` hides `point` from the camera.
pub fn is_hidden(
    point: DVec3,
    own: Option<usize>,
    camera: &Camera,
    (parts, section): (&[StagedPart], Option<&SectionCut>),
    pose: &ClosedPose,
    meshes: &[StageMesh],
) -> bool {
    let to_eye = if camera.is_perspective() {
        camera.world_from_camera.translation - point
    } else {
        camera.world_from_camera.rotation.z_axis * (camera.far - camera.near)
    };
    let others = parts.iter().filter(|part| Some(part.body()) != own);
    others
        .map(|part| (part.body(), part.instance(pose, meshes)))
        .any(|(body, instance)| {
            // What is cut off hides nothing.
            let is_there = |at: f64| {
                let hit = point + to_eye * at;
                !section.is_some_and(|section| section.removes(body, hit))
            };
            let mesh = &meshes[instance.mesh];
            crosses_instance(&instance, mesh, (point, to_eye), is_there)
        })
}

/// Whether the ray from `point` along `way` hits a triangle of the mesh at a share of the way where it `is_there`.
fn crosses_instance(
    instance: &Instance,
    mesh: &StageMesh,
    (point, way): (DVec3, DVec3),
    is_there: impl Fn(f64) -> bool,
) -> bool {
    let mesh_from_world = instance.world_from_mesh.inverse();
    let from = mesh_from_world.transform_point(point);
    let way = mesh_from_world.transform_vector(way);
    if !passes_box(mesh, from, way) {
        return false;
    }
    mesh.triangles.iter().any(|corners| {
        let corner = |k: u32| mesh.origin + DVec3::from(mesh.positions[k as usize].map(f64::from));
        let [a, b, c] = corners.map(corner);
        meets_triangle(from, way, [a, b - a, c - a]).is_some_and(&is_there)
    })
}

fn passes_box(mesh: &StageMesh, from: DVec3, way: DVec3) -> bool {
    let [low, high] = mesh.bounds;
    let (mut enter, mut leave) = (0.0f64, 1.0f64);
    for k in 0..3 {
        let times = [(low[k] - from[k]) / way[k], (high[k] - from[k]) / way[k]];
        enter = enter.max(times[0].min(times[1]));
        leave = leave.min(times[0].max(times[1]));
    }
    enter <= leave
}

/// Möller and Trumbore's test of a ray against a triangle given by a corner and two edges: the share of the way to it.
fn meets_triangle(from: DVec3, way: DVec3, [corner, first, second]: [DVec3; 3]) -> Option<f64> {
    let normal = way.cross(second);
    let inverse = 1.0 / first.dot(normal);
    let off = from - corner;
    let u = off.dot(normal) * inverse;
    let across = off.cross(first);
    let v = way.dot(across) * inverse;
    let at = second.dot(across) * inverse;
    let is_met = u >= 0.0 && v >= 0.0 && u + v <= 1.0 && at > NEARER && at < 1.0;
    is_met.then_some(at)
}
