//! What a picture must be, in closed form: areas, exact colours, order, no cracks, no memory.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod coverage;
mod frames;
mod lines;
mod shades;

use super::*;
use crate::geometry::{Mesh, mesh_of};
use crate::math::Pose;
use crate::model::shape::Solid as Shape;
use crate::render::colour::ToneCurve;
use crate::render::edges::EdgeStyle;
use crate::render::look::{ALL_OPEN, Rim, Surroundings};
use crate::render::{Camera, Ground, Instance, Projection, StageMesh, look};
use glam::DVec3;
use image::Rgba;

const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];

/// One unit is one pixel; x to the right and y up from the picture's middle, seen from z = 100.
fn flat_stage(size: [u32; 2], samples: u32, meshes: Vec<Mesh>) -> Stage {
    Stage {
        meshes: meshes.into_iter().map(StageMesh::from).collect(),
        size,
        samples,
        camera: Camera {
            world_from_camera: Pose::from_translation(DVec3::Z * 100.0),
            projection: Projection::Orthographic {
                height: f64::from(size[1]),
            },
            near: 1.0,
            far: 1000.0,
        },
        rim: Rim::DARK,
        background: WHITE,
        ground: None,
        edges: None,
        mutual_shade: None,
    }
}

fn instance(mesh: usize, colour: [u8; 3]) -> Instance {
    Instance {
        mesh,
        world_from_mesh: Pose::IDENTITY,
        colour,
        opacity: 1.0,
        triangles: 0..u32::MAX,
        casts_shadow: true,
        outline: None,
        flat: 1.0,
    }
}

fn draw(stage: Stage, instances: Vec<Instance>) -> RgbaImage {
    let frame = Frame {
        instances,
        ..Frame::default()
    };
    let mut image = RgbaImage::from_pixel(stage.size[0], stage.size[1], Rgba([1, 2, 3, 4]));
    let mut renderer = CpuRenderer::new(Arc::new(stage)).unwrap();
    renderer.draw(&frame, &mut image).unwrap();
    assert!(
        image.pixels().all(|p| p.0[3] == 255),
        "a pixel was left out"
    );
    image
}

/// A rectangle at height z that faces the viewer.
fn rectangle(low: [f64; 2], high: [f64; 2], z: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for [x, y] in [low, [high[0], low[1]], high, [low[0], high[1]]] {
        mesh.push_vertex(DVec3::new(x, y, z), DVec3::Z);
    }
    mesh.triangles = vec![[0, 1, 2], [0, 2, 3]];
    mesh
}

/// Numbers in 0..1 that look random and are the same in every run.
fn noise(seed: &mut u64) -> f64 {
    *seed = seed
        .wrapping_mul(6_364_136_223_846_793_005)
        .wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 40) as f64 / f64::from(1 << 24)
}

/// A sheet of `cells`² cells with corners at ±reach, shaken so little that no triangle folds over.
fn sheet(cells: u32, reach: f64, seed: u64) -> Mesh {
    let mut seed = seed;
    let mut mesh = Mesh::default();
    let step = 2.0 * reach / f64::from(cells);
    for i in 0..=cells {
        for j in 0..=cells {
            let inner = i > 0 && j > 0 && i < cells && j < cells;
            let mut shake = || {
                if inner {
                    0.24 * (noise(&mut seed) - 0.5)
                } else {
                    0.0
                }
            };
            let x = (f64::from(j) + shake()) * step - reach;
            let y = (f64::from(i) + shake()) * step - reach;
            mesh.push_vertex(DVec3::new(x, y, 0.0), DVec3::Z);
        }
    }
    for i in 0..cells {
        for j in 0..cells {
            let a = i * (cells + 1) + j;
            let [b, c, d] = [a + 1, a + cells + 2, a + cells + 1];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}
