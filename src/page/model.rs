//! The bodies and their motion as the page's viewer reads them: meshes in 16 bits a coordinate, placements in 32.

use crate::export::model::{ExportModel, ModelPart, ModelTrace};
use crate::geometry::Mesh;
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::{Pose, narrow_rotation, narrow_vector, rotation_quaternions};
use crate::model::mechanism::Mechanism;
use crate::render::{Camera, Projection};
use crate::scene::Scene;
use crate::staging::model::{Facets, body_parts, model_traces, of_motion, up_vector};
use base64::prelude::{BASE64_STANDARD, Engine};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};
use std::collections::HashMap;

/// Most triangles of a file that can still be mailed: 6 to 12 bytes each, and half as much for their corners.
const MOST_TRIANGLES: usize = 60_000;

/// Levels of a coordinate within its mesh's box, and of a normal's entry.
const LEVELS: f64 = 65535.0;
const NORMAL_LEVELS: f64 = 127.0;

/// The model for the viewer, or why there is none.
pub fn viewer_model(
    scene: &Scene,
    (whole, shown): (&Trajectory, &Trajectory),
    camera: Option<(&Camera, f64)>,
) -> Result<Value, String> {
    let samples = 0..shown.samples.len();
    let model = of_motion(scene, shown, samples, None, Facets::Picture);
    let parts = || model.bodies.iter().flat_map(|body| &body.parts);
    let triangles: usize = parts().map(|part| part.mesh.triangles.len()).sum();
    if triangles == 0 {
        return Err(
            "The scene has no bodies with shapes: there is nothing to turn around.".to_owned(),
        );
    }
    if triangles > MOST_TRIANGLES {
        return Err(format!(
            "The picture does not move: {triangles} triangles are too many for a page ({MOST_TRIANGLES} at most); \
             mechanim render writes them as .glb."
        ));
    }
    let bodies = model.bodies.iter().map(|body| &body.parts[..]);
    let mut value = shapes_value(bodies.enumerate());
    let poses = model
        .bodies
        .iter()
        .map(|body| (&body.name[..], &body.poses[..]));
    value["bodies"] = poses.map(|(name, poses)| body_value(name, poses)).collect();
    value["traces"] = traces_value(&scene.mechanism, whole);
    value["camera"] = match camera {
        Some((camera, aspect)) => camera_value(scene, &model, camera, aspect),
        None => Value::Null,
    };
    Ok(value)
}

/// The shapes of some bodies in place of those that a viewer has; their meshes suit a picture of this extent.
pub(super) fn changed_shapes(scene: &Scene, bodies: &[usize], extent: f64) -> Value {
    let parts = |body: &usize| (*body, body_parts(scene, *body, Facets::Picture, extent));
    let parts: Vec<(usize, Vec<ModelPart>)> = bodies.iter().map(parts).collect();
    let mut value = shapes_value(parts.iter().map(|(body, parts)| (*body, &parts[..])));
    value["replaced"] = json!(bodies);
    value
}

/// Placements of all bodies at the frames shown, and the paths traced over the whole motion: everything that changes when a
/// mechanism only moves.
pub(super) fn motion_value(
    mechanism: &Mechanism,
    (whole, shown): (&Trajectory, &Trajectory),
) -> Value {
    let bodies = mechanism.bodies.iter().enumerate();
    let poses = |index: usize| -> Vec<Pose> {
        let poses = shown.poses();
        poses.map(|pose| pose.bodies[index]).collect()
    };
    let bodies = bodies.map(|(index, body)| body_value(&body.name, &poses(index)));
    json!({ "bodies": bodies.collect::<Vec<_>>(), "traces": traces_value(mechanism, whole) })
}

fn traces_value(mechanism: &Mechanism, whole: &Trajectory) -> Value {
    let traces = model_traces(mechanism, whole);
    traces.iter().map(trace_value).collect()
}

/// The meshes and what is made of them.
fn shapes_value<'m>(bodies: impl Iterator<Item = (usize, &'m [ModelPart])>) -> Value {
    let mut meshes = ModelMeshes::default();
    let mut list = Vec::new();
    for (body, parts) in bodies {
        let parts = parts.iter();
        for part in parts.filter(|part| !part.mesh.triangles.is_empty()) {
            list.push(json!({
                "mesh": meshes.index(&part.mesh),
                "body": body,
                "colour": part.colour,
                "opacity": part.opacity,
            }));
        }
    }
    json!({ "meshes": meshes.list, "parts": list })
}

/// The meshes by their bytes: equal ones are written once.
#[derive(Default)]
struct ModelMeshes {
    list: Vec<Value>,
    known: HashMap<String, usize>,
}

impl ModelMeshes {
    fn index(&mut self, mesh: &Mesh) -> usize {
        let value = mesh_value(mesh);
        let next = self.list.len();
        let index = *self.known.entry(value.to_string()).or_insert(next);
        if index == next {
            self.list.push(value);
        }
        index
    }
}

fn mesh_value(mesh: &Mesh) -> Value {
    let [low, high] = mesh.bounds().unwrap_or([DVec3::ZERO; 2]);
    let size = high - low;
    // A flat mesh has no extent across.
    let level = |v: f64, size: f64| {
        if size > 0.0 {
            (v / size * LEVELS).round() as u16
        } else {
            0
        }
    };
    let positions: Vec<u8> = mesh
        .positions
        .iter()
        .flat_map(|p| {
            let p = *p - low;
            let levels = [level(p.x, size.x), level(p.y, size.y), level(p.z, size.z)];
            levels.into_iter().flat_map(u16::to_le_bytes)
        })
        .collect();
    let normals: Vec<u8> = mesh
        .normals
        .iter()
        .flat_map(|n| folded_normal(*n))
        .collect();
    let is_wide = mesh.positions.len() > 1 << 16;
    let corners = mesh.triangles.as_flattened().iter();
    let triangles: Vec<u8> = match is_wide {
        true => corners.flat_map(|k| k.to_le_bytes()).collect(),
        false => corners.flat_map(|k| (*k as u16).to_le_bytes()).collect(),
    };
    json!({
        "positions": BASE64_STANDARD.encode(&positions),
        "normals": BASE64_STANDARD.encode(&normals),
        "triangles": BASE64_STANDARD.encode(&triangles),
        "wide": is_wide,
        "low": narrow_vector(low),
        "size": narrow_vector(size),
    })
}

/// A direction as a point of an octahedron that is folded open into a square, in two bytes.
fn folded_normal(normal: DVec3) -> [u8; 2] {
    let n = normal / (normal.x.abs() + normal.y.abs() + normal.z.abs()).max(f64::MIN_POSITIVE);
    let side = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
    let [x, y] = match n.z < 0.0 {
        true => [(1.0 - n.y.abs()) * side(n.x), (1.0 - n.x.abs()) * side(n.y)],
        false => [n.x, n.y],
    };
    [x, y].map(|v| ((v * NORMAL_LEVELS).round() as i8).to_le_bytes()[0])
}

/// A body's quaternion and position for every frame; one frame for a body that does not move.
fn body_value(name: &str, poses: &[Pose]) -> Value {
    let first = poses.first();
    let stands = poses.iter().all(|pose| Some(pose) == first);
    let poses = match stands {
        true => &poses[..poses.len().min(1)],
        false => poses,
    };
    let turns: Vec<DMat3> = poses.iter().map(|pose| pose.rotation).collect();
    let bytes: Vec<u8> = rotation_quaternions(&turns)
        .into_iter()
        .zip(poses)
        .flat_map(|(turn, pose)| {
            let turn = narrow_rotation(turn).into_iter();
            let numbers = turn.chain(narrow_vector(pose.translation));
            numbers.flat_map(f32::to_le_bytes)
        })
        .collect();
    json!({ "name": name, "poses": BASE64_STANDARD.encode(&bytes) })
}

fn trace_value(trace: &ModelTrace) -> Value {
    let points = trace.runs.iter().flatten();
    let bytes: Vec<u8> = points
        .flat_map(|p| narrow_vector(*p).into_iter().flat_map(f32::to_le_bytes))
        .collect();
    json!({
        "colour": trace.colour,
        "points": BASE64_STANDARD.encode(&bytes),
        "runs": trace.runs.iter().map(Vec::len).collect::<Vec<_>>(),
    })
}

/// The picture's camera with its centre of rotation: the point of its axis nearest to the middle of everything shown.
fn camera_value(scene: &Scene, model: &ExportModel, camera: &Camera, aspect: f64) -> Value {
    let [low, high] = extent_of(model);
    let (middle, extent) = (0.5 * (low + high), (high - low).length());
    let eye = camera.world_from_camera.translation;
    let back = camera.world_from_camera.rotation.z_axis;
    let distance = (eye - middle).dot(back).max(1e-6 * extent);
    let (fov, height) = match camera.projection {
        Projection::Perspective { fov_y } => (Some(fov_y), 0.0),
        Projection::Orthographic { height } => (None, height),
    };
    json!({
        "target": narrow_vector(eye - back * distance),
        "back": narrow_vector(back),
        "up": narrow_vector(up_vector(scene.view.up)),
        "distance": distance,
        "extent": extent,
        "fov": fov,
        "height": height,
        "aspect": aspect,
    })
}

/// The box around all bodies at all frames.
fn extent_of(model: &ExportModel) -> [DVec3; 2] {
    let mut ends = [DVec3::INFINITY, DVec3::NEG_INFINITY];
    for body in &model.bodies {
        let boxes = body.parts.iter().filter_map(|part| part.mesh.bounds());
        let boxes: Vec<[DVec3; 2]> = boxes.collect();
        for pose in &body.poses {
            for [low, high] in &boxes {
                for corner in 0..8 {
                    let pick = |bit: usize, low: f64, high: f64| {
                        if corner >> bit & 1 == 0 { low } else { high }
                    };
                    let point = DVec3::new(
                        pick(0, low.x, high.x),
                        pick(1, low.y, high.y),
                        pick(2, low.z, high.z),
                    );
                    let point = pose.transform_point(point);
                    ends = [ends[0].min(point), ends[1].max(point)];
                }
            }
        }
    }
    ends
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As the viewer's shader unfolds it.
    fn unfolded(bytes: [u8; 2]) -> DVec3 {
        let [x, y] = bytes.map(|b| f64::from(i8::from_le_bytes([b])) / NORMAL_LEVELS);
        let mut n = DVec3::new(x, y, 1.0 - x.abs() - y.abs());
        if n.z < 0.0 {
            let side = |v: f64| if v < 0.0 { -1.0 } else { 1.0 };
            (n.x, n.y) = ((1.0 - y.abs()) * side(x), (1.0 - x.abs()) * side(y));
        }
        n.normalize()
    }

    #[test]
    fn normals_survive_folding() {
        for k in 0..4000 {
            let k = f64::from(k);
            let n =
                DVec3::new((k * 0.7).sin(), (k * 1.3 + 1.0).sin(), (k * 0.37).cos()).normalize();
            let angle = unfolded(folded_normal(n)).dot(n).clamp(-1.0, 1.0).acos();
            assert!(angle < 0.02, "{n} is off by {angle}");
        }
    }
}
