//! 3-D files read back by other people's readers: the motion is the trajectory's, the shapes are where they stand.

use crate::driven::{frame_times, solve};
use crate::program::LEAVES;
use glam::{DMat4, DVec3, Mat4, Quat, Vec3};
use mechanim::export::glb::{Corners, write_glb};
use mechanim::export::model::ExportModel;
use mechanim::export::solid::{write_obj, write_stl};
use mechanim::export::{ExportError, ExportSummary, Output, PendingFile};
use mechanim::geometry::Mesh;
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::math::Pose;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::staging::model::{Facets, of_mesh, of_motion};
use mechanim::staging::{PictureOptions, Staging};
use std::collections::BTreeMap;

const NAMES: [&str; 3] = ["gearshift", "slider-crank", "seven-r"];

fn solved(name: &str) -> (Scene, Trajectory) {
    let scene = load_scene(&builtin::find_builtin(name).unwrap(), &Overrides::default()).unwrap();
    let times = frame_times(&scene, scene.view.fps);
    let trajectory = solve(&scene, &times).unwrap();
    (scene, trajectory)
}

fn model(scene: &Scene, trajectory: &Trajectory) -> ExportModel {
    let options = PictureOptions {
        size: [640, 480],
        samples: 4,
    };
    let camera = Staging::new(scene, trajectory, options).stage.camera;
    let samples = 0..trajectory.samples.len();
    of_motion(
        scene,
        trajectory,
        samples,
        Some((camera, 4.0 / 3.0)),
        Facets::Tool,
    )
}

fn written(
    model: &ExportModel,
    write: impl Fn(&ExportModel, Box<dyn Output>) -> Result<ExportSummary, ExportError>,
) -> Vec<u8> {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("file");
    let summary = write(model, Box::new(PendingFile::create(&path).unwrap())).unwrap();
    let bytes = std::fs::read(&path).unwrap();
    assert_eq!(summary.bytes, bytes.len() as u64);
    bytes
}

fn full_glb(model: &ExportModel, output: Box<dyn Output>) -> Result<ExportSummary, ExportError> {
    write_glb(model, Corners::Full, output)
}

/// Largest distance between two rigid motions over a ball of radius `reach`.
fn distance(a: Mat4, b: &Pose, reach: f64) -> f64 {
    let exact = DMat4::from_mat3_translation(b.rotation, b.translation);
    let points = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::Z].map(|p| p * reach);
    points
        .iter()
        .map(|p| (a.as_dmat4().transform_point3(*p) - exact.transform_point3(*p)).length())
        .fold(0.0, f64::max)
}

/// Keys of a node: times, and translation or rotation, as the file has them.
#[derive(Default)]
struct Track {
    times: Vec<f32>,
    translations: Vec<Vec3>,
    rotations: Vec<Quat>,
}

fn tracks(document: &gltf::Document, blob: &[u8]) -> BTreeMap<String, Track> {
    let mut tracks: BTreeMap<String, Track> = BTreeMap::new();
    for channel in document.animations().flat_map(|a| a.channels()) {
        let track = tracks
            .entry(channel.target().node().name().unwrap().to_owned())
            .or_default();
        let reader = channel.reader(|_| Some(blob));
        track.times = reader.read_inputs().unwrap().collect();
        match reader.read_outputs().unwrap() {
            gltf::animation::util::ReadOutputs::Translations(t) => {
                track.translations = t.map(Vec3::from).collect();
            }
            gltf::animation::util::ReadOutputs::Rotations(r) => {
                track.rotations = r.into_f32().map(Quat::from_array).collect();
            }
            _ => panic!("neither moved nor turned"),
        }
    }
    tracks
}

#[test]
fn every_key_of_a_glb_is_the_pose_of_the_trajectory() {
    for name in NAMES {
        let (scene, trajectory) = solved(name);
        let bytes = written(&model(&scene, &trajectory), full_glb);
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = blob.unwrap();
        let tracks = tracks(&document, &blob);
        let size = scene.mechanism.size;
        for (index, body) in scene.mechanism.bodies.iter().enumerate() {
            let node = document
                .nodes()
                .find(|n| n.name() == Some(&body.name))
                .unwrap();
            let (rest_place, rest_turn, scale) = node.transform().decomposed();
            assert_eq!(scale, [1.0; 3]);
            let track = tracks.get(&body.name);
            for (k, sample) in trajectory.samples.iter().enumerate() {
                let pick = |keys: Option<&Vec<Vec3>>| keys.and_then(|t| t.get(k)).copied();
                let place = pick(track.map(|t| &t.translations)).unwrap_or(rest_place.into());
                let turn = track.and_then(|t| t.rotations.get(k)).copied();
                let turn = turn.unwrap_or(Quat::from_array(rest_turn));
                if let Some(track) = track {
                    assert!((f64::from(track.times[k]) - sample.time).abs() <= 1e-6);
                    assert_eq!(track.times.len(), trajectory.samples.len());
                }
                assert!((turn.length() - 1.0).abs() < 1e-6);
                let exact = &sample.pose.as_ref().unwrap().bodies[index];
                let off = distance(Mat4::from_rotation_translation(turn, place), exact, size);
                // A few units in the last place of 32 bits at the mechanism's extent.
                assert!(off < 2e-6 * size, "{name} {} key {k}: {off}", body.name);
            }
            for pair in track.map_or(&[][..], |t| &t.rotations).windows(2) {
                assert!(
                    pair[0].dot(pair[1]) > 0.0,
                    "{name} {}: the long way round",
                    body.name
                );
            }
        }
    }
}

#[test]
fn bounds_alignment_and_units_of_a_glb_are_as_the_format_asks() {
    let (scene, trajectory) = solved("gearshift");
    let model = model(&scene, &trajectory);
    let bytes = written(&model, full_glb);
    assert_eq!((&bytes[..4], bytes.len() % 4), (&b"glTF"[..], 0));
    assert_eq!(
        u32::from_le_bytes(bytes[8..12].try_into().unwrap()) as usize,
        bytes.len()
    );
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    for accessor in document.accessors() {
        let view = accessor.view().unwrap();
        assert_eq!((view.offset() % 4, accessor.offset() % 4), (0, 0));
        assert!(accessor.count() > 0);
    }
    let mut triangles = 0;
    for primitive in document.meshes().flat_map(|m| m.primitives()) {
        let reader = primitive.reader(|_| Some(blob.as_slice()));
        let points: Vec<Vec3> = reader.read_positions().unwrap().map(Vec3::from).collect();
        let bounds = primitive.bounding_box();
        let fold = |pick: fn(Vec3, Vec3) -> Vec3| points.iter().copied().reduce(pick).unwrap();
        assert_eq!(Vec3::from(bounds.min), fold(Vec3::min));
        assert_eq!(Vec3::from(bounds.max), fold(Vec3::max));
        match primitive.mode() {
            gltf::mesh::Mode::Triangles => {
                let normals: Vec<Vec3> = reader.read_normals().unwrap().map(Vec3::from).collect();
                assert_eq!(normals.len(), points.len());
                assert!(normals.iter().all(|n| (n.length() - 1.0).abs() < 1e-5));
                let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
                assert!(corners.iter().all(|c| (*c as usize) < points.len()));
                triangles += corners.len() / 3;
            }
            mode => assert_eq!(mode, gltf::mesh::Mode::LineStrip),
        }
    }
    let ours = model
        .bodies
        .iter()
        .flat_map(|b| &b.parts)
        .map(|p| p.mesh.triangles.len());
    assert_eq!(triangles, ours.sum::<usize>());
    // Millimetres, z up, become metres, y up.
    let world = document
        .nodes()
        .find(|n| n.name() == Some("world"))
        .unwrap();
    let world = Mat4::from_cols_array_2d(&world.transform().matrix());
    let up = world.transform_point3(Vec3::new(0.0, 0.0, 1000.0));
    assert!((up - Vec3::Y).length() < 1e-6, "{up}");
    let camera = document.nodes().find(|n| n.camera().is_some()).unwrap();
    let (_, _, scale) = camera.transform().decomposed();
    assert_eq!(scale, [1.0; 3]);
}

/// Short corners and normals of every body, read from the bytes that the accessors name, are those of the model to their rounding.
#[test]
fn a_quantised_glb_has_every_corner_and_normal() {
    for name in ["gearshift", "torus-torus"] {
        let (scene, trajectory) = solved(name);
        let model = model(&scene, &trajectory);
        let full = written(&model, full_glb);
        let short = |model: &ExportModel, output| write_glb(model, Corners::Quantised, output);
        let bytes = written(&model, short);
        assert!(bytes.len() < 3 * full.len() / 4, "{name}");
        // The reader does not know the extension.
        let gltf = gltf::Gltf::from_slice_without_validation(&bytes).unwrap();
        let required: Vec<&str> = gltf.document.extensions_required().collect();
        assert_eq!(required, ["KHR_mesh_quantization"]);
        let blob = gltf.blob.unwrap();
        for body in &model.bodies {
            let parts: Vec<_> = body
                .parts
                .iter()
                .filter(|p| !p.mesh.triangles.is_empty())
                .collect();
            let node = gltf
                .document
                .nodes()
                .find(|n| n.name() == Some(&body.name))
                .unwrap();
            let Some(shape) = node.children().next() else {
                assert!(parts.is_empty(), "{}", body.name);
                continue;
            };
            let (low, turn, scale) = shape.transform().decomposed();
            assert_eq!(turn, [0.0, 0.0, 0.0, 1.0]);
            assert!(scale[0] == scale[1] && scale[1] == scale[2]);
            let low = DVec3::from(low.map(f64::from));
            let edge = f64::from(scale[0]);
            for (primitive, part) in shape.mesh().unwrap().primitives().zip(parts) {
                let row = |semantic, k: usize| {
                    let accessor = primitive.get(&semantic).unwrap();
                    assert!(accessor.normalized());
                    let view = accessor.view().unwrap();
                    let stride = view.stride().unwrap();
                    assert_eq!(
                        (accessor.count(), stride % 4),
                        (part.mesh.positions.len(), 0)
                    );
                    &blob[view.offset() + k * stride..][..stride]
                };
                for (k, (place, normal)) in part
                    .mesh
                    .positions
                    .iter()
                    .zip(&part.mesh.normals)
                    .enumerate()
                {
                    let bytes = row(gltf::Semantic::Positions, k);
                    let share =
                        |i: usize| f64::from(u16::from_le_bytes([bytes[2 * i], bytes[2 * i + 1]]));
                    let read = low + DVec3::new(share(0), share(1), share(2)) / 65535.0 * edge;
                    let off = (read - *place).abs().max_element();
                    assert!(
                        off <= edge * (0.5 / 65535.0 + 3e-7) + low.length() * 1e-7,
                        "{name}: {off}"
                    );
                    let bytes = row(gltf::Semantic::Normals, k);
                    let read = [0, 1, 2].map(|i| f64::from(bytes[i] as i8) / 127.0);
                    assert!(
                        (DVec3::from(read) - *normal).abs().max_element() <= 0.5 / 127.0 + 1e-9
                    );
                }
            }
        }
    }
}

/// Corners take two bytes where all of them fit, and no corner is the number that restarts a primitive.
#[test]
fn corners_of_small_and_large_meshes_are_read_back() {
    let (scene, _) = solved("four-bar");
    let mut sizes = Vec::new();
    for count in [3_u32, 65_534, 65_535, 65_536, 70_000] {
        let at = |k: u32| DVec3::new(f64::from(k % 300), f64::from(k / 300), 0.0);
        let mesh = Mesh {
            positions: (0..count).map(at).collect(),
            normals: vec![DVec3::Z; count as usize],
            triangles: (0..count - 2)
                .step_by(997)
                .map(|k| [k, k + 1, count - 1])
                .collect(),
        };
        let corners = mesh.triangles.as_flattened().to_vec();
        let bytes = written(&of_mesh(&scene, "net", mesh), full_glb);
        let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
        let blob = blob.unwrap();
        let primitive = document.meshes().next().unwrap().primitives().next();
        let primitive = primitive.unwrap();
        let reader = primitive.reader(|_| Some(blob.as_slice()));
        let read: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
        assert_eq!(read, corners, "{count}");
        sizes.push(primitive.indices().unwrap().data_type().size());
    }
    assert_eq!(sizes, [2, 2, 2, 4, 4]);
}

#[test]
fn colours_and_paths_are_in_a_glb() {
    let (scene, trajectory) = solved("gearshift");
    let bytes = written(&model(&scene, &trajectory), full_glb);
    let gltf::Gltf { document, blob } = gltf::Gltf::from_slice(&bytes).unwrap();
    let blob = blob.unwrap();
    let srgb = |linear: f32| {
        let x = f64::from(linear);
        let code = if x <= 0.0031308 {
            12.92 * x
        } else {
            1.055 * x.powf(1.0 / 2.4) - 0.055
        };
        (255.0 * code).round() as u8
    };
    for body in &scene.mechanism.bodies {
        let mesh = document
            .meshes()
            .find(|m| m.name() == Some(&body.name))
            .unwrap();
        for (primitive, shape) in mesh.primitives().zip(&body.shapes) {
            let [r, g, b, a] = primitive
                .material()
                .pbr_metallic_roughness()
                .base_color_factor();
            assert_eq!([r, g, b].map(srgb), shape.colour, "{}", body.name);
            assert!((f64::from(a) - shape.opacity).abs() < 1e-6);
        }
    }
    let trace = &scene.mechanism.traces[0];
    let mesh = document
        .meshes()
        .find(|m| m.name() == Some(&trace.name))
        .unwrap();
    let [path] = mesh
        .primitives()
        .collect::<Vec<_>>()
        .try_into()
        .ok()
        .unwrap();
    assert!(path.material().unlit());
    let points: Vec<[f32; 3]> = path
        .reader(|_| Some(blob.as_slice()))
        .read_positions()
        .unwrap()
        .collect();
    let first = trajectory.samples[0].pose.as_ref().unwrap().traces[0].as_vec3();
    assert!((Vec3::from(points[0]) - first).length() < 1e-3);
    assert!(points.len() > 50);
}

/// The drive goes there, where there is no pose, and back; with a point to be traced.
fn gap() -> String {
    let drive = "{ keys = [[0, 0], [1, 1.2], [2, 0]], ease = \"linear\" }";
    LEAVES
        .replace("duration = 1\n", "")
        .replace("\"1.2*t\"", drive)
        + "[[traces]]\nname = \"tip\"\nbody = \"crank\"\npoint = [80, 0, 0]\n"
}

#[test]
fn nothing_is_invented_where_there_is_no_pose() {
    let source = mechanim::diag::Source {
        name: "gap".into(),
        text: gap(),
    };
    let scene = load_scene(&source, &Overrides::default()).unwrap();
    let trajectory = solve(&scene, &frame_times(&scene, 20.0)).unwrap();
    let closed: Vec<bool> = trajectory
        .samples
        .iter()
        .map(|s| s.pose.is_some())
        .collect();
    assert!(
        closed[0] && !closed[20] && *closed.last().unwrap(),
        "{closed:?}"
    );
    let model = model(&scene, &trajectory);
    assert_eq!(model.traces[0].runs.len(), 2);
    assert!(model.times.windows(2).all(|w| (w[0] as f32) < w[1] as f32));
    // Between any two keys the pose is one of the trajectory, or the last before the gap.
    let held = closed.iter().position(|c| !c).unwrap() - 1;
    let back = closed.iter().rposition(|c| !c).unwrap() + 1;
    let angle = |k: usize| model.bodies[0].poses[k].rotation.x_axis.y.asin();
    for (k, time) in model.times.iter().enumerate() {
        let sample = trajectory.samples.iter().position(|s| s.time == *time);
        let shown = match sample {
            Some(sample) if closed[sample] => sample,
            // In the gap, and just before its end.
            _ => held,
        };
        let exact = trajectory.samples[shown].inputs[0];
        assert!((angle(k) - exact).abs() < 1e-12, "key {k} at {time}");
    }
    let resumed = model
        .times
        .iter()
        .position(|t| *t == trajectory.samples[back].time)
        .unwrap();
    assert!(model.times[resumed] - model.times[resumed - 1] < 1e-6);
    assert!(gltf::Gltf::from_slice(&written(&model, full_glb)).is_ok());
}

fn pose(name: &str, sample: usize) -> (Scene, ExportModel) {
    let (scene, trajectory) = solved(name);
    let model = of_motion(&scene, &trajectory, sample..sample + 1, None, Facets::Tool);
    (scene, model)
}

/// Six times the volume that the triangles enclose, and their bounds.
fn measured(triangles: impl Iterator<Item = [DVec3; 3]>) -> (f64, [DVec3; 2]) {
    let start = (0.0, [DVec3::INFINITY, DVec3::NEG_INFINITY]);
    triangles.fold(start, |(volume, [low, high]), [a, b, c]| {
        let volume = volume + a.dot(b.cross(c));
        (
            volume,
            [low.min(a).min(b).min(c), high.max(a).max(b).max(c)],
        )
    })
}

fn exact(model: &ExportModel) -> (f64, [DVec3; 2]) {
    measured(model.placed_parts().flat_map(|(_, part, pose)| {
        let mesh = part.mesh.clone();
        mesh.triangles
            .into_iter()
            .map(move |t| t.map(|i| pose.transform_point(mesh.positions[i as usize])))
    }))
}

fn agree(name: &str, found: (f64, [DVec3; 2]), exact: (f64, [DVec3; 2])) {
    let extent = (exact.1[1] - exact.1[0]).length();
    assert!(
        (found.0 - exact.0).abs() < 1e-4 * exact.0,
        "{name}: {} {}",
        found.0,
        exact.0
    );
    for (a, b) in found.1.iter().zip(exact.1) {
        assert!((*a - b).length() < 1e-6 * extent, "{name}: {a} {b}");
    }
}

#[test]
fn an_stl_holds_the_bodies_where_they_stand() {
    for name in NAMES {
        let (_, model) = pose(name, 40);
        let bytes = written(&model, write_stl);
        let stl = stl_io::read_stl(&mut std::io::Cursor::new(&bytes)).unwrap();
        let vertices = &stl.vertices;
        let point = |i: usize| DVec3::from_array(vertices[i].0.map(f64::from));
        let triangles = stl.faces.iter().map(|face| face.vertices.map(point));
        agree(name, measured(triangles), exact(&model));
        for face in &stl.faces {
            let [a, b, c] = face.vertices.map(point);
            let normal = DVec3::from_array(face.normal.0.map(f64::from));
            let area = (b - a).cross(c - a);
            assert!(
                area.length() < 1e-3 || normal.dot(area.normalize()) > 0.999,
                "{name}"
            );
        }
    }
}

#[test]
fn an_obj_holds_every_body_by_name_and_colour() {
    for name in NAMES {
        let (scene, model) = pose(name, 40);
        let bytes = written(&model, |model, output| write_obj(model, output, None));
        let load = |_: &std::path::Path| -> tobj::MTLLoadResult { panic!("no materials") };
        let (objects, _) =
            tobj::load_obj_buf(&mut bytes.as_slice(), &tobj::LoadOptions::default(), load).unwrap();
        let names: Vec<String> = scene
            .mechanism
            .bodies
            .iter()
            .map(|b| b.name.replace(' ', "_"))
            .collect();
        let found: Vec<&String> = objects.iter().map(|o| &o.name).collect();
        assert_eq!(found, names.iter().collect::<Vec<_>>());
        let triangles = objects.iter().flat_map(|object| {
            let mesh = &object.mesh;
            let point = |i: u32| {
                let at = 3 * i as usize;
                DVec3::new(
                    mesh.positions[at].into(),
                    mesh.positions[at + 1].into(),
                    mesh.positions[at + 2].into(),
                )
            };
            mesh.indices
                .chunks_exact(3)
                .map(move |t| [point(t[0]), point(t[1]), point(t[2])])
        });
        agree(name, measured(triangles), exact(&model));
        for (object, body) in objects.iter().zip(&scene.mechanism.bodies) {
            let colour = object.mesh.vertex_color[..3]
                .iter()
                .map(|c| (255.0 * c).round() as u8);
            assert_eq!(
                colour.collect::<Vec<_>>(),
                body.shapes[0].colour,
                "{}",
                body.name
            );
        }
    }
}

/// With a library every triangle has the material of its solid.
#[test]
fn an_objs_materials_are_its_colours() {
    for name in NAMES {
        let (_, model) = pose(name, 40);
        let folder = tempfile::tempdir().unwrap();
        let at = |name: &str| folder.path().join(name);
        let target = |name: &str| Box::new(PendingFile::create(&at(name)).unwrap());
        let library: (String, Box<dyn Output>) = ("a.mtl".to_owned(), target("a.mtl"));
        let summary = write_obj(&model, target("a.obj"), Some(library)).unwrap();
        let size = |name: &str| at(name).metadata().unwrap().len();
        assert_eq!(summary.bytes, size("a.obj") + size("a.mtl"));
        let (objects, materials) =
            tobj::load_obj(at("a.obj"), &tobj::LoadOptions::default()).unwrap();
        let materials = materials.unwrap();
        let parts: usize = model.bodies.iter().map(|body| body.parts.len()).sum();
        assert!(materials.len() > 2 && materials.len() <= parts);
        let mut found = BTreeMap::new();
        for object in &objects {
            let material = &materials[object.mesh.material_id.unwrap()];
            let code = |c: f32| (255.0 * c).round() as u8;
            let key = (
                material.diffuse.unwrap().map(code),
                code(material.dissolve.unwrap()),
            );
            *found.entry(key).or_insert(0) += object.mesh.indices.len() / 3;
        }
        let mut expected = BTreeMap::new();
        for part in model.bodies.iter().flat_map(|body| &body.parts) {
            let key = (part.colour, (255.0 * part.opacity).round() as u8);
            *expected.entry(key).or_insert(0) += part.mesh.triangles.len();
        }
        assert_eq!(found, expected, "{name}");
    }
}

#[test]
fn a_model_without_solids_is_no_stl() {
    let (_, mut model) = pose("slider-crank", 0);
    model.bodies.iter_mut().for_each(|b| b.parts.clear());
    let folder = tempfile::tempdir().unwrap();
    type Writer = fn(&ExportModel, Box<dyn Output>) -> Result<ExportSummary, ExportError>;
    let writers: [Writer; 2] = [write_stl, |model, output| write_obj(model, output, None)];
    for write in writers {
        let target = PendingFile::create(&folder.path().join("a.stl")).unwrap();
        let error = write(&model, Box::new(target)).unwrap_err().to_string();
        assert!(error.contains("nothing to write"), "{error}");
    }
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 0);
    // Paths alone make a GLB.
    assert!(gltf::Gltf::from_slice(&written(&model, full_glb)).is_ok());
}
