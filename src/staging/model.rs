//! From a solved scene to solids in space with their motion, for 3-D files.

use super::bounds;
use crate::export::model::{ExportModel, ModelBody, ModelCamera, ModelPart, ModelTrace};
use crate::geometry::{Mesh, largest_radius, mesh_of};
use crate::kinematics::results::trajectory::Trajectory;
use crate::math::Pose;
use crate::model::mechanism::Mechanism;
use crate::model::shape::{Shape, Solid};
use crate::model::view::UpAxis;
use crate::render::{Camera, Projection};
use crate::scene::Scene;
use glam::{DMat3, DVec3};
use std::ops::Range;

/// Largest distance between a round surface and its facets, relative to the extent of the model: a tenth of a
/// millimetre for a machine of a metre, invisible in a printer or viewer.
const FACET_ERROR: f64 = 1e-4;

/// The same relative to a solid's own radius, smallest and largest: no part becomes an octagon next to a large one (36
/// segments around), and none is finer than a tool mark (142).
const FACET_ERROR_OF_RADIUS: [f64; 2] = [5e-4, 8e-3];

/// The same for models that are only viewed, relative to the extent and to the radius: half a pixel of a picture 700
/// pixels wide; at least 13 segments around, since shading does not hide corners, and at most 41.
const FACET_ERROR_OF_PICTURE: f64 = 7e-4;
const PICTURE_ERROR_OF_RADIUS: [f64; 2] = [3e-3, 3e-2];

/// How fine round surfaces are divided into facets.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Facets {
    /// For tools: what neither a printer nor a viewer shows.
    Tool,
    /// For pictures: invisible on a screen except in a close-up.
    Picture,
    /// No facet is farther from its surface than this length.
    Within(f64),
}

impl Facets {
    /// The greatest distance between a solid's surface and its facets, in a scene of this extent.
    fn facet_error(self, solid: &Solid, extent: f64) -> f64 {
        let (share, of_radius) = match self {
            Self::Within(length) => return length,
            Self::Tool => (FACET_ERROR, FACET_ERROR_OF_RADIUS),
            Self::Picture => (FACET_ERROR_OF_PICTURE, PICTURE_ERROR_OF_RADIUS),
        };
        let radius = largest_radius(solid).unwrap_or(extent);
        let [fine, coarse] = of_radius.map(|share| share * radius);
        (share * extent).clamp(fine, coarse)
    }
}

/// sRGB colour of a mesh that is no body's.
const SURFACE: [u8; 3] = [150, 170, 190];

/// Metres in the units of length that have a name of their own.
const METRES: [(&str, f64); 8] = [
    ("um", 1e-6),
    ("µm", 1e-6),
    ("mm", 1e-3),
    ("cm", 1e-2),
    ("m", 1.0),
    ("km", 1e3),
    ("in", 0.0254),
    ("ft", 0.3048),
];

/// The solids of a scene at the given samples of its motion; `camera` and `aspect` are those of the pictures.
///
/// At a sample without a pose the previous pose is held until the next: nothing is interpolated over a gap.
pub fn of_motion(
    scene: &Scene,
    trajectory: &Trajectory,
    samples: Range<usize>,
    camera: Option<(Camera, f64)>,
    facets: Facets,
) -> ExportModel {
    let mechanism = &scene.mechanism;
    // The extent of the motion bounds the error of facets.
    let extent = extent_of_motion(scene, trajectory);
    // Keys in time; over a gap the pose before it is held.
    let keys = pose_keys(trajectory, samples);
    // A part for every shape shown, and a pose for every key.
    let bodies = mechanism.bodies.iter().enumerate().map(|(index, body)| {
        let poses = keys.iter().filter_map(|key| {
            let pose = trajectory.samples[key.sample].pose.as_ref()?;
            Some(pose.bodies[index])
        });
        ModelBody {
            name: body.name.clone(),
            parts: body_parts(scene, index, facets, extent),
            poses: poses.collect(),
        }
    });
    ExportModel {
        title: mechanism.title.clone(),
        upright: upright_frame(scene.view.up),
        metres: metres_per_unit(mechanism),
        times: keys.iter().map(|key| key.time).collect(),
        bodies: bodies.collect(),
        traces: model_traces(mechanism, trajectory),
        camera: camera.map(|(camera, aspect)| of_camera(&camera, aspect)),
    }
}

/// The diagonal of the box that all bodies pass through.
pub fn extent_of_motion(scene: &Scene, trajectory: &Trajectory) -> f64 {
    let points = bounds::moving_points(scene, trajectory);
    bounds::box_of(&points).map_or(scene.mechanism.size, |[low, high]| (high - low).length())
}

/// The visible shapes of a body in its own frame, for a motion of this extent.
pub fn body_parts(scene: &Scene, body: usize, facets: Facets, extent: f64) -> Vec<ModelPart> {
    let shapes = scene.view.shown_shapes(&scene.mechanism, body);
    shapes
        .map(|s| model_part(s, facets.facet_error(&s.solid, extent)))
        .collect()
}

/// One mesh in the world of a scene.
pub fn of_mesh(scene: &Scene, name: &str, mesh: Mesh) -> ExportModel {
    let part = ModelPart {
        mesh,
        colour: SURFACE,
        opacity: 1.0,
    };
    let body = ModelBody {
        name: name.to_owned(),
        parts: vec![part],
        poses: vec![Pose::IDENTITY],
    };
    ExportModel {
        title: scene.mechanism.title.clone(),
        upright: upright_frame(scene.view.up),
        metres: metres_per_unit(&scene.mechanism),
        times: vec![0.0],
        bodies: vec![body],
        traces: Vec::new(),
        camera: None,
    }
}

/// Metres in a mechanism's unit of length; 1 if unknown.
fn metres_per_unit(mechanism: &Mechanism) -> f64 {
    let mut units = METRES.iter();
    let unit = units.find(|(name, _)| *name == mechanism.length_unit);
    unit.map_or(1.0, |(_, metres)| *metres)
}

/// A time, and the sample whose pose is shown at it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct PoseKey {
    time: f64,
    sample: usize,
}

/// Keys at all samples; before the first one after a gap there is another key, which holds the pose from before the
/// gap.
fn pose_keys(trajectory: &Trajectory, samples: Range<usize>) -> Vec<PoseKey> {
    let shown = super::shown_samples(trajectory);
    let mut keys: Vec<PoseKey> = Vec::new();
    for index in samples {
        let Some(sample) = shown[index] else { continue };
        let time = trajectory.samples[index].time;
        let gap_before = index > 0 && trajectory.samples[index - 1].pose.is_none();
        if let Some(held) = keys.last().map(|key| key.sample).filter(|_| gap_before) {
            push_key(
                &mut keys,
                PoseKey {
                    time: f64::from((time as f32).next_down()),
                    sample: held,
                },
            );
        }
        push_key(&mut keys, PoseKey { time, sample });
    }
    keys
}

/// Adds a key unless its time equals that of the last one in the 32 bits of the file.
fn push_key(keys: &mut Vec<PoseKey>, key: PoseKey) {
    if keys
        .last()
        .is_none_or(|last| key.time as f32 > last.time as f32)
    {
        keys.push(key);
    }
}

fn model_part(shape: &Shape, tolerance: f64) -> ModelPart {
    let mesh = mesh_of(&shape.solid, tolerance);
    ModelPart {
        mesh: placed_mesh(mesh, &shape.body_from_shape),
        colour: shape.colour,
        opacity: shape.opacity,
    }
}

fn placed_mesh(mut mesh: Mesh, body_from_shape: &Pose) -> Mesh {
    for position in &mut mesh.positions {
        *position = body_from_shape.transform_point(*position);
    }
    for normal in &mut mesh.normals {
        *normal = body_from_shape.transform_vector(*normal);
    }
    mesh
}

/// The visible paths over the whole motion, cut where there is no pose.
pub fn model_traces(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<ModelTrace> {
    let visible = mechanism.traces.iter().enumerate();
    let visible = visible.filter(|(_, trace)| trace.radius.is_none_or(|r| r > 0.0));
    let path = |index: usize| -> Vec<Vec<DVec3>> {
        let points: Vec<Option<DVec3>> = trajectory
            .samples
            .iter()
            .map(|s| s.pose.as_ref().map(|p| p.traces[index]))
            .collect();
        let runs = points.split(Option::is_none);
        runs.map(|run| {
            let mut run: Vec<DVec3> = run.iter().flatten().copied().collect();
            run.dedup();
            run
        })
        .filter(|run| run.len() > 1)
        .collect()
    };
    visible
        .map(|(index, trace)| ModelTrace {
            name: trace.name.clone(),
            colour: trace.colour,
            runs: path(index),
        })
        .collect()
}

/// The up direction of a scene.
pub fn up_vector(up: UpAxis) -> DVec3 {
    up.axis()
}

/// The rotation that takes the up axis to y.
fn upright_frame(up: UpAxis) -> DMat3 {
    match up {
        UpAxis::Y => DMat3::IDENTITY,
        UpAxis::Z => DMat3::from_cols(DVec3::X, DVec3::NEG_Z, DVec3::Y),
        UpAxis::X => DMat3::from_cols(DVec3::Y, DVec3::NEG_X, DVec3::Z),
    }
}

fn of_camera(camera: &Camera, aspect: f64) -> ModelCamera {
    let (fov_y, height) = match camera.projection {
        Projection::Perspective { fov_y } => (Some(fov_y), 0.0),
        Projection::Orthographic { height } => (None, height),
    };
    ModelCamera {
        world_from_camera: camera.world_from_camera,
        fov_y,
        height,
        aspect,
        range: [camera.near, camera.far],
    }
}
