//! Bodies cut by the plane of the view: what is left of them in a frame, and their cut faces.
//!
//! Cut faces are meshes of the frame: flat paint, lighter than the body, with hatching as stripes between which the face is
//! divided. Both renderers draw the same triangles.

use super::body_meshes::StagedPart;
use crate::geometry::Mesh;
use crate::geometry::section::{
    CutMesh, CutPlane, PlaneFrame, Strips, Trapezoid, cut_mesh, divide_region,
};
use crate::math::Pose;
use crate::model::section::Section;
use crate::model::view::{UpAxis, View};
use crate::render::edges::FIRST_CUT;
use crate::render::{Instance, StageMesh};
use crate::sorting::sort_by_number;
use glam::{DMat3, DVec2, DVec3};
use std::collections::HashMap;

/// Distance of the lines of the plainest hatching and their width, in 480ths of the picture's height.
const PITCH: f64 = 11.0;
const WIDTH: f64 = 1.9;

/// Pixels that stand for a 480th of the height at least: thinner lines would break up in small pictures.
const LEAST_UNIT: f64 = 0.7;

/// Angle in degrees and relative distance of the lines, body by body, so that neighbours can be told apart.
const PATTERNS: [(f64, f64); 6] = [
    (45.0, 1.0),
    (135.0, 1.0),
    (45.0, 1.5),
    (135.0, 1.5),
    (45.0, 0.75),
    (135.0, 0.75),
];

/// How far a cut face is from its body's colour to white.
const LIGHTENED: f64 = 0.6;

/// Factor on a body's colour for the lines of its hatching.
const DARKENED: f64 = 0.6;

/// Trapezoids of a cut face reach this far, in pixels, over their horizontal sides: corners on the screen are rounded, and
/// no sample may fall between two neighbours.
const OVERLAP: f64 = 0.02;

/// The plane of a view and the meshes that it cuts.
pub struct SectionCut {
    section: Section,
    up: UpAxis,
    /// Size of a pixel, and the unit of hatching.
    pixel: f64,
    unit: f64,
    /// Of every body: how far it is drawn from its place.
    offsets: Vec<DVec3>,
    /// Meshes of cut bodies by their numbers, and whether they are closed.
    meshes: HashMap<usize, (Mesh, bool)>,
    /// Volumes of the cut bodies: where two overlap, the smaller is shown, as a pin is in its hole.
    volumes: Vec<f64>,
    /// Number of meshes of the stage.
    first_mesh: usize,
}

/// Cut solids of one body that look alike: they have one face.
struct CutFace {
    body: usize,
    colour: [u8; 3],
    opacity: f64,
    frame: PlaneFrame,
    border: Vec<[DVec2; 2]>,
}

impl SectionCut {
    /// The section of a view, for a picture `height` pixels high; `offsets` are those of an exploded view.
    pub fn new(
        view: &View,
        (parts, offsets): (&[StagedPart], &[DVec3]),
        meshes: &[StageMesh],
        (pixel, height): (f64, f64),
    ) -> Option<Self> {
        let section = view.section.clone()?;
        let mut volumes = vec![0.0; offsets.len()];
        let mut cut: HashMap<usize, (Mesh, bool)> = HashMap::new();
        for part in parts.iter().filter(|part| section.cuts(part.body())) {
            let mesh = &meshes[part.mesh()];
            let own = || (widened(mesh), mesh.closed);
            let (mesh, is_closed) = cut.entry(part.mesh()).or_insert_with(own);
            if *is_closed {
                volumes[part.body()] += mesh.volume();
            }
        }
        Some(Self {
            up: view.up,
            pixel,
            unit: pixel * (height / 480.0).max(LEAST_UNIT),
            offsets: offsets.to_vec(),
            meshes: cut,
            volumes,
            first_mesh: meshes.len(),
            section,
        })
    }

    /// The plane for a body, where it is drawn.
    fn plane(&self, body: usize) -> CutPlane {
        let plane = self.section.plane;
        CutPlane {
            point: plane.point + self.offsets[body],
            normal: plane.normal,
        }
    }

    /// Whether a point of a body, where it is drawn, is cut off.
    pub fn removes(&self, body: usize, point: DVec3) -> bool {
        self.section.cuts(body) && self.plane(body).height(point) > 0.0
    }

    /// Colours of the cut faces of parts.
    pub fn flat_colours(&self, parts: &[StagedPart]) -> Vec<[u8; 3]> {
        let cut = parts.iter().filter(|p| self.section.cuts(p.body()));
        cut.flat_map(|part| face_colours(part.colour())).collect()
    }

    /// Cuts instances of bodies; the first `solids` of them get cut faces, which come before all others. `poses` are those
    /// of the bodies. New meshes are added to those of the frame.
    pub fn apply(
        &self,
        instances: Vec<Instance>,
        (solids, poses): (usize, &[Pose]),
        meshes: &mut Vec<StageMesh>,
    ) -> Vec<Instance> {
        let mut faces: Vec<CutFace> = Vec::new();
        let mut kept = Vec::new();
        for (index, instance) in instances.into_iter().enumerate() {
            let body = instance.outline.map(|body| body as usize);
            let body = body.filter(|body| *body < poses.len() && self.section.cuts(*body));
            let cut = body.zip(self.meshes.get(&instance.mesh));
            let Some((body, (mesh, is_closed))) = cut else {
                kept.push(instance);
                continue;
            };
            let plane = self.plane(body);
            let world_from_mesh = instance.world_from_mesh;
            let part = match cut_mesh(mesh, &plane_in_mesh(&plane, &world_from_mesh)) {
                CutMesh::Whole => {
                    kept.push(instance);
                    continue;
                }
                CutMesh::Nothing => continue,
                CutMesh::Part(part) => part,
            };
            // An open mesh has no inside, and so no cut face.
            if *is_closed && index < solids {
                let face = face_of(&mut faces, &instance, body, || {
                    self.frame(&plane, body, poses[body].translation)
                });
                let flat = |point| face.frame.flat(world_from_mesh.transform_point(point));
                let border = part.border.iter().map(|ends| ends.map(flat));
                face.border.extend(border);
            }
            let mesh = self.push(part.shell, meshes);
            kept.push(Instance {
                triangles: 0..meshes[mesh - self.first_mesh].triangles.len() as u32,
                mesh,
                ..instance
            });
        }
        // What comes first is in front where faces overlap.
        sort_by_number(&mut faces, |a| self.volumes[a.body]);
        let faces = faces.iter().flat_map(|face| self.draw_face(face, meshes));
        let mut all: Vec<Instance> = faces.collect();
        all.extend(kept);
        all
    }

    /// Adds a mesh to a frame; returns its number.
    fn push(&self, mesh: Mesh, meshes: &mut Vec<StageMesh>) -> usize {
        meshes.push(mesh.into());
        self.first_mesh + meshes.len() - 1
    }

    /// Coordinates in the plane of a body: the first axis along its hatching, the origin moving with the body.
    fn frame(&self, plane: &CutPlane, body: usize, origin: DVec3) -> PlaneFrame {
        let up = self.up.axis();
        // Without a horizontal direction, that of the first horizontal axis.
        let level = up.cross(plane.normal).try_normalize();
        let level = level.unwrap_or_else(|| {
            let other = [DVec3::X, DVec3::Y]
                .into_iter()
                .find(|axis| axis.dot(up) == 0.0);
            crate::math::square_to(plane.normal, other.unwrap_or(DVec3::X))
        });
        let level = PlaneFrame {
            origin: origin - plane.normal * plane.height(origin),
            axes: [level, plane.normal.cross(level)],
        };
        level.turned(PATTERNS[body % PATTERNS.len()].0.to_radians())
    }

    /// The plain parts of a face and its stripes.
    fn draw_face(&self, face: &CutFace, meshes: &mut Vec<StageMesh>) -> Vec<Instance> {
        let pitch = PITCH * self.unit * PATTERNS[face.body % PATTERNS.len()].1;
        let strips = Strips {
            pitch,
            width: WIDTH * self.unit,
        };
        let parts = divide_region(&face.border, Some(strips));
        let [first, second] = face.frame.axes;
        let world_from_mesh = Pose {
            rotation: DMat3::from_cols(first, second, first.cross(second)),
            translation: face.frame.origin,
        };
        let colours = face_colours(face.colour).into_iter().zip([false, true]);
        let drawn = colours.map(|(colour, is_striped)| {
            let own = parts.iter().filter(|part| part.is_striped == is_striped);
            let mesh = self.push(face_mesh(own, OVERLAP * self.pixel), meshes);
            Instance {
                mesh,
                world_from_mesh,
                colour,
                opacity: face.opacity,
                triangles: 0..meshes[mesh - self.first_mesh].triangles.len() as u32,
                casts_shadow: false,
                outline: Some(FIRST_CUT + face.body as u32),
                flat: 1.0,
            }
        });
        drawn.collect()
    }
}

/// The face of a body that looks like an instance, a new one if there is none.
fn face_of<'f>(
    faces: &'f mut Vec<CutFace>,
    instance: &Instance,
    body: usize,
    frame: impl FnOnce() -> PlaneFrame,
) -> &'f mut CutFace {
    let look = (body, instance.colour, instance.opacity);
    let known = faces
        .iter()
        .position(|face| (face.body, face.colour, face.opacity) == look);
    let index = known.unwrap_or_else(|| {
        faces.push(CutFace {
            body,
            colour: instance.colour,
            opacity: instance.opacity,
            frame: frame(),
            border: Vec::new(),
        });
        faces.len() - 1
    });
    &mut faces[index]
}

/// Colours of a cut face and of the lines on it.
fn face_colours(colour: [u8; 3]) -> [[u8; 3]; 2] {
    let face = colour.map(|c| {
        let c = f64::from(c);
        (c + (255.0 - c) * LIGHTENED).round() as u8
    });
    [
        face,
        colour.map(|c| (f64::from(c) * DARKENED).round() as u8),
    ]
}

/// The plane in the frame of a mesh.
fn plane_in_mesh(plane: &CutPlane, world_from_mesh: &Pose) -> CutPlane {
    let mesh_from_world = world_from_mesh.inverse();
    CutPlane {
        point: mesh_from_world.transform_point(plane.point),
        normal: mesh_from_world.transform_vector(plane.normal),
    }
}

/// Trapezoids as triangles, in the plane of the first two coordinates.
fn face_mesh<'t>(parts: impl Iterator<Item = &'t Trapezoid>, overlap: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for part in parts {
        let [low, high] = part.heights;
        let rows = [low - overlap, high + overlap];
        let mut corner =
            |x: f64, row: usize| mesh.push_vertex(DVec3::new(x, rows[row], 0.0), DVec3::Z);
        let [a, b] = [corner(part.left[0], 0), corner(part.right[0], 0)];
        let [d, c] = [corner(part.left[1], 1), corner(part.right[1], 1)];
        mesh.triangles.extend([[a, b, c], [a, c, d]]);
    }
    mesh
}

/// A mesh of a stage in double precision: what is cut is what would be drawn.
fn widened(mesh: &StageMesh) -> Mesh {
    let wide = |list: &[[f32; 3]], from: DVec3| {
        let list = list.iter().map(|v| from + DVec3::from(v.map(f64::from)));
        list.collect()
    };
    Mesh {
        positions: wide(&mesh.positions, mesh.origin),
        normals: wide(&mesh.normals, DVec3::ZERO),
        triangles: mesh.triangles.clone(),
    }
}
