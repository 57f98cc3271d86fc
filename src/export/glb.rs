//! Animated GLB: a node with a mesh for every body, its poses as an animation, paths as line strips.
//!
//! Source: glTF 2.0 specification, Khronos 2021; unlit lines by its extension `KHR_materials_unlit`, short numbers by
//! `KHR_mesh_quantization`.

use super::ExportSummary;
use super::error::ExportError;
use super::glb_buffer::Buffer;
use super::model::{ExportModel, ModelBody, ModelCamera, ModelPart, ModelTrace};
use super::target::Output;
use crate::geometry::Mesh;
use crate::math::{Pose, narrow_rotation, narrow_vector, rotation_quaternions};
use glam::{DMat3, DVec3};
use serde_json::{Value, json};

/// Marks in the file's header and before its two chunks.
const MAGIC: &[u8; 4] = b"glTF";
const VERSION: u32 = 2;
const JSON_CHUNK: &[u8; 4] = b"JSON";
const BINARY_CHUNK: &[u8; 4] = b"BIN\0";

/// How matt bodies look: neither metal nor mirror.
const ROUGHNESS: f64 = 0.55;

/// The extension that allows short numbers in meshes.
const QUANTIZATION: &str = "KHR_mesh_quantization";

/// Modes of a primitive.
const LINE_STRIP: u32 = 3;
const TRIANGLES: u32 = 4;

/// Numbers of the corners and normals of meshes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Corners {
    /// In f32, for every reader.
    #[default]
    Full,
    /// Corners to 1/65535 of a body's extent, normals to half a degree: half the bytes, for readers of
    /// `KHR_mesh_quantization`. Bodies with very thin parts stay full.
    Quantised,
}

/// Writes `model` and returns what was written; `frames` counts the keys.
///
/// Errors: more than 4 GiB, a failed write.
pub fn write_glb(
    model: &ExportModel,
    corners: Corners,
    mut output: Box<dyn Output>,
) -> Result<ExportSummary, ExportError> {
    let mut file = Document {
        corners,
        ..Document::default()
    };
    file.add(model);
    let bytes = file.into_bytes(output.name())?;
    output.emit(&bytes)?;
    output.commit()?;
    Ok(ExportSummary {
        frames: model.times.len(),
        bytes: bytes.len() as u64,
        seconds: model.times.last().copied().unwrap_or(0.0),
    })
}

/// The lists of a glTF document under construction; entries refer to each other by index.
#[derive(Default)]
struct Document {
    corners: Corners,
    /// Whether any mesh has short numbers.
    has_short: bool,
    buffer: Buffer,
    nodes: Vec<Value>,
    roots: Vec<usize>,
    meshes: Vec<Value>,
    materials: Vec<Value>,
    cameras: Vec<Value>,
    channels: Vec<Value>,
    samplers: Vec<Value>,
    title: String,
}

impl Document {
    fn add(&mut self, model: &ExportModel) {
        self.title.clone_from(&model.title);
        let times = (model.times.len() > 1).then(|| self.buffer.scalars(&model.times));
        let mut children = Vec::new();
        for body in &model.bodies {
            children.push(self.push_body(body, times));
        }
        for trace in model.traces.iter().filter(|trace| !trace.runs.is_empty()) {
            children.push(self.push_trace(trace));
        }
        let [rotation] = rotation_quaternions(&[model.upright])[..] else {
            return;
        };
        let world = json!({
            "name": "world",
            "rotation": narrow_rotation(rotation),
            "scale": ([model.metres; 3]),
            "children": children,
        });
        self.push_root(world);
        if let Some(camera) = &model.camera {
            self.push_camera(camera, model);
        }
    }

    fn push(list: &mut Vec<Value>, entry: Value) -> usize {
        list.push(entry);
        list.len() - 1
    }

    fn push_root(&mut self, node: Value) {
        let index = Self::push(&mut self.nodes, node);
        self.roots.push(index);
    }

    /// The node of a body, with its animation if it moves.
    fn push_body(&mut self, body: &ModelBody, times: Option<usize>) -> usize {
        let parts = body.parts.iter();
        let parts = parts.filter(|part| !part.mesh.triangles.is_empty());
        let parts: Vec<&ModelPart> = parts.collect();
        let cube = match self.corners {
            Corners::Full => None,
            Corners::Quantised => Cube::around(&parts),
        };
        self.has_short |= cube.is_some();
        // A primitive for each part, as parts have colours of their own.
        let primitives: Vec<Value> = (parts.into_iter())
            .map(|part| self.part(part, cube.as_ref()))
            .collect();
        // Quaternions have the sign nearest to the one before, so that interpolation takes the shorter way.
        let turns: Vec<DMat3> = body.poses.iter().map(|pose| pose.rotation).collect();
        let turns: Vec<[f32; 4]> = rotation_quaternions(&turns)
            .into_iter()
            .map(narrow_rotation)
            .collect();
        let places: Vec<[f32; 3]> = body
            .poses
            .iter()
            .map(|p| narrow_vector(p.translation))
            .collect();
        // Without an animation the node keeps its first pose.
        let mut node = json!({ "name": body.name });
        if let (Some(turn), Some(place)) = (turns.first(), places.first()) {
            node["rotation"] = json!(turn);
            node["translation"] = json!(place);
        }
        if !primitives.is_empty() {
            let mesh = json!({ "name": body.name, "primitives": primitives });
            let mesh = Self::push(&mut self.meshes, mesh);
            match cube {
                None => node["mesh"] = mesh.into(),
                Some(cube) => {
                    let shape = json!({
                        "mesh": mesh,
                        "translation": narrow_vector(cube.low),
                        "scale": narrow_vector(DVec3::splat(cube.edge)),
                    });
                    node["children"] = json!([Self::push(&mut self.nodes, shape)]);
                }
            }
        }
        let index = Self::push(&mut self.nodes, node);
        // Channels only for what changes.
        if let Some(times) = times {
            if turns.windows(2).any(|w| w[0] != w[1]) {
                let values = self.buffer.push_rotations(&turns);
                self.push_channel(index, "rotation", times, values);
            }
            if places.windows(2).any(|w| w[0] != w[1]) {
                let values = self.buffer.keys(&places);
                self.push_channel(index, "translation", times, values);
            }
        }
        index
    }

    fn push_channel(&mut self, node: usize, path: &str, times: usize, values: usize) {
        let sampler = json!({ "input": times, "output": values, "interpolation": "LINEAR" });
        let sampler = Self::push(&mut self.samplers, sampler);
        let target = json!({ "node": node, "path": path });
        self.channels
            .push(json!({ "sampler": sampler, "target": target }));
    }

    fn part(&mut self, part: &ModelPart, cube: Option<&Cube>) -> Value {
        let narrowed = |list: &[DVec3]| list.iter().map(|v| narrow_vector(*v)).collect::<Vec<_>>();
        let Mesh {
            positions, normals, ..
        } = &part.mesh;
        let [positions, normals] = match cube {
            None => [
                self.buffer.vertices(&narrowed(positions), true),
                self.buffer.vertices(&narrowed(normals), false),
            ],
            Some(cube) => {
                let shares: Vec<_> = positions.iter().map(|p| cube.share(*p)).collect();
                let normals: Vec<_> = normals.iter().map(|n| short_normal(*n)).collect();
                self.buffer.quantised(&shares, &normals)
            }
        };
        let indices = self.buffer.indices(part.mesh.triangles.as_flattened());
        let mut material = json!({
            "pbrMetallicRoughness": {
                "baseColorFactor": linear_colour(part.colour, part.opacity),
                "metallicFactor": 0.0,
                "roughnessFactor": ROUGHNESS,
            },
        });
        if part.opacity < 1.0 {
            material["alphaMode"] = "BLEND".into();
        }
        json!({
            "attributes": { "POSITION": positions, "NORMAL": normals },
            "indices": indices,
            "material": self.material_index(material),
            "mode": TRIANGLES,
        })
    }

    /// The index of a material; equal ones are shared.
    fn material_index(&mut self, material: Value) -> usize {
        let known = self.materials.iter().position(|m| *m == material);
        known.unwrap_or_else(|| Self::push(&mut self.materials, material))
    }

    fn push_trace(&mut self, trace: &ModelTrace) -> usize {
        let material = self.material_index(json!({
            "pbrMetallicRoughness": { "baseColorFactor": linear_colour(trace.colour, 1.0) },
            "extensions": { "KHR_materials_unlit": {} },
        }));
        let primitives = trace.runs.iter().map(|run| {
            let points: Vec<[f32; 3]> = run.iter().map(|p| narrow_vector(*p)).collect();
            let positions = self.buffer.vertices(&points, true);
            json!({ "attributes": { "POSITION": positions }, "material": material, "mode": LINE_STRIP })
        });
        let primitives: Vec<Value> = primitives.collect();
        let mesh = json!({ "name": trace.name, "primitives": primitives });
        let mesh = Self::push(&mut self.meshes, mesh);
        let node = json!({ "name": format!("path of {}", trace.name), "mesh": mesh });
        Self::push(&mut self.nodes, node)
    }

    /// The camera is outside the scaled world: its distances are in metres.
    fn push_camera(&mut self, camera: &ModelCamera, model: &ExportModel) {
        let [near, far] = camera.range.map(|distance| distance * model.metres);
        let (kind, lens) = match camera.fov_y {
            Some(fov) => (
                "perspective",
                json!({ "yfov": fov, "aspectRatio": camera.aspect, "znear": near, "zfar": far }),
            ),
            None => {
                let half = 0.5 * camera.height * model.metres;
                let lens = json!({ "xmag": half * camera.aspect, "ymag": half, "znear": near, "zfar": far });
                ("orthographic", lens)
            }
        };
        let lens = json!({ "type": kind, kind: lens });
        let lens = Self::push(&mut self.cameras, lens);
        let Pose {
            rotation,
            translation,
        } = camera.world_from_camera;
        let place = model.upright * translation * model.metres;
        for turn in rotation_quaternions(&[model.upright * rotation]) {
            self.push_root(json!({
                "name": "camera",
                "camera": lens,
                "rotation": narrow_rotation(turn),
                "translation": narrow_vector(place),
            }));
        }
    }

    fn into_bytes(self, name: &str) -> Result<Vec<u8>, ExportError> {
        let uses_unlit = self.materials.iter().any(|m| !m["extensions"].is_null());
        let (views, accessors, binary) = self.buffer.into_parts();
        let mut json = json!({
            "asset": { "version": "2.0", "generator": concat!("mechanim ", env!("CARGO_PKG_VERSION")) },
            "scene": 0,
            "scenes": [{ "name": self.title, "nodes": self.roots }],
        });
        let lists = [
            ("nodes", self.nodes),
            ("meshes", self.meshes),
            ("materials", self.materials),
            ("cameras", self.cameras),
            ("bufferViews", views),
            ("accessors", accessors),
        ];
        // Empty lists are not allowed.
        for (key, list) in lists.into_iter().filter(|(_, list)| !list.is_empty()) {
            json[key] = list.into();
        }
        if !self.channels.is_empty() {
            let motion =
                json!({ "name": "motion", "channels": self.channels, "samplers": self.samplers });
            json["animations"] = json!([motion]);
        }
        if !binary.is_empty() {
            json["buffers"] = json!([{ "byteLength": binary.len() }]);
        }
        let mut used = Vec::new();
        if uses_unlit {
            used.push("KHR_materials_unlit");
        }
        if self.has_short {
            used.push(QUANTIZATION);
            json["extensionsRequired"] = json!([QUANTIZATION]);
        }
        if !used.is_empty() {
            json["extensionsUsed"] = json!(used);
        }
        glb_container(json.to_string().into_bytes(), binary, name)
    }
}

/// Short corners are off by 1/131070 of a body's extent: of parts that are thinner than this share of it, they would be a
/// visible part.
const THINNEST: f64 = 1e-3;

/// The cube in which the corners of a body lie, in its frame.
struct Cube {
    low: DVec3,
    edge: f64,
}

impl Cube {
    /// `None` for a body without extent, or with a part too thin for short numbers.
    fn around(parts: &[&ModelPart]) -> Option<Self> {
        let boxes: Vec<[DVec3; 2]> = parts
            .iter()
            .map(|part| box_of(part.mesh.positions.iter().map(|p| [*p; 2])))
            .collect();
        let [low, high] = box_of(boxes.iter().copied());
        let edge = (high - low).max_element();
        let thinnest = THINNEST * edge;
        let is_fine = |[low, high]: &[DVec3; 2]| (*high - *low).min_element() >= thinnest;
        (edge > 0.0 && boxes.iter().all(is_fine)).then_some(Self { low, edge })
    }

    /// A corner as shares of the edge.
    fn share(&self, corner: DVec3) -> [u16; 3] {
        let share = (corner - self.low) / self.edge * f64::from(u16::MAX);
        share.to_array().map(|v| v.round() as u16)
    }
}

/// The box around boxes.
fn box_of(boxes: impl Iterator<Item = [DVec3; 2]>) -> [DVec3; 2] {
    boxes.fold([DVec3::INFINITY, DVec3::NEG_INFINITY], |all, one| {
        [all[0].min(one[0]), all[1].max(one[1])]
    })
}

/// A unit vector with 1 as the largest byte.
fn short_normal(normal: DVec3) -> [i8; 3] {
    let bytes = normal * f64::from(i8::MAX);
    bytes.to_array().map(|v| v.round() as i8)
}

/// Header and chunks, each padded to four bytes: JSON with spaces, binary with zeros.
fn glb_container(
    mut json: Vec<u8>,
    mut binary: Vec<u8>,
    name: &str,
) -> Result<Vec<u8>, ExportError> {
    json.resize(json.len().next_multiple_of(4), b' ');
    binary.resize(binary.len().next_multiple_of(4), 0);
    let mut chunks = vec![(JSON_CHUNK, json)];
    if !binary.is_empty() {
        chunks.push((BINARY_CHUNK, binary));
    }
    let total: usize = 12
        + chunks
            .iter()
            .map(|(_, bytes)| 8 + bytes.len())
            .sum::<usize>();
    let total = u32::try_from(total).map_err(|_| ExportError::Encode {
        name: name.to_owned(),
        message: "a GLB holds at most 4 GiB".to_owned(),
    })?;
    let mut file = MAGIC.to_vec();
    file.extend(VERSION.to_le_bytes());
    file.extend(total.to_le_bytes());
    for (mark, bytes) in chunks {
        file.extend((bytes.len() as u32).to_le_bytes());
        file.extend(mark);
        file.extend(bytes);
    }
    Ok(file)
}

/// An sRGB colour as the linear factors that glTF wants (IEC 61966-2-1), with its opacity.
fn linear_colour(colour: [u8; 3], opacity: f64) -> [f64; 4] {
    let [r, g, b] = colour.map(|code| {
        let code = f64::from(code) / 255.0;
        if code <= 0.040_45 {
            code / 12.92
        } else {
            libm::pow((code + 0.055) / 1.055, 2.4)
        }
    });
    [r, g, b, opacity]
}
