//! Time of a frame on the CPU renderer and its distance from a supersampled picture.
//!
//! The scene is the one that other renderers were measured with: two chains of six capsules swinging
//! through two tori, eight balls around them, about 60 000 triangles, 640 x 480 pixels, 120 frames.
//! `cargo bench --bench frame [-- [--quick] FOLDER]` prints a table, and with a folder leaves pictures there.
//! `--quick` measures the time of four samples only, for a profiler.

// A benchmark may stop at the first surprise.
#![allow(clippy::expect_used)]

use glam::{DMat3, DVec3};
use image::RgbaImage;
use mechanim::geometry::Mesh;
use mechanim::math::Pose;
use mechanim::render::cpu::CpuRenderer;
use mechanim::render::look::Rim;
use mechanim::render::{Camera, Frame, Ground, Instance, Projection, Renderer, Stage};
use std::f64::consts::{FRAC_PI_2, PI, TAU};
use std::sync::Arc;
use std::time::Instant;

const SIZE: [u32; 2] = [640, 480];
const FRAMES: u32 = 120;
/// The frame whose picture is compared.
const COMPARED: u32 = 30;
/// Levels between neighbours that make an edge.
const EDGE: f64 = 16.0;

/// Triangles of a grid of `around` by `along` vertices, closed around and maybe along.
fn grid(around: u32, along: u32, closed: bool) -> Vec<[u32; 3]> {
    let rows = if closed { along } else { along - 1 };
    let cell = |i: u32, j: u32| {
        let at = |i: u32, j: u32| (i % around) * along + j % along;
        let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
        [[a, b, c], [a, c, d]]
    };
    (0..around)
        .flat_map(|i| (0..rows).flat_map(move |j| cell(i, j)))
        .collect()
}

fn torus(ring: f64, tube: f64) -> Mesh {
    let mut mesh = Mesh::default();
    for i in 0..128 {
        for j in 0..64 {
            let (a, b) = (TAU * f64::from(i) / 128.0, TAU * f64::from(j) / 64.0);
            let out = DVec3::new(a.cos(), a.sin(), 0.0);
            let normal = out * b.cos() + DVec3::Z * b.sin();
            mesh.push_vertex(out * ring + normal * tube, normal);
        }
    }
    mesh.triangles = grid(128, 64, true);
    mesh
}

/// Along x from 0 to `length`; the triangles at the poles have a side without length.
fn capsule(radius: f64, length: f64, around: u32, rings: u32) -> Mesh {
    let mut mesh = Mesh::default();
    let mut profile = Vec::new();
    for k in 0..rings {
        let t = FRAC_PI_2 * f64::from(k) / f64::from(rings - 1);
        profile.push((0.0, -t.cos(), t.sin()));
    }
    for k in 0..rings {
        let t = FRAC_PI_2 * f64::from(k) / f64::from(rings - 1);
        profile.push((length, t.sin(), if k + 1 == rings { 0.0 } else { t.cos() }));
    }
    for i in 0..around {
        let a = TAU * f64::from(i) / f64::from(around);
        for (x, up, out) in &profile {
            let normal = DVec3::new(*up, out * a.cos(), out * a.sin()).normalize();
            let at = DVec3::new(
                x + radius * up,
                radius * out * a.cos(),
                radius * out * a.sin(),
            );
            mesh.push_vertex(at, normal);
        }
    }
    mesh.triangles = grid(around, 2 * rings, false);
    mesh
}

fn colour(c: [f64; 3]) -> [u8; 3] {
    c.map(|v| (v * 255.0).round() as u8)
}

/// Meshes and colours of the 22 bodies.
fn bodies() -> Vec<(Mesh, [u8; 3])> {
    let hues = [
        [0.80, 0.25, 0.20],
        [0.20, 0.45, 0.75],
        [0.95, 0.65, 0.15],
        [0.25, 0.60, 0.35],
        [0.50, 0.35, 0.65],
        [0.55, 0.55, 0.58],
    ];
    let mut all = Vec::new();
    for i in 0..12 {
        let radius = 0.11 + 0.015 * f64::from(i % 3);
        all.push((capsule(radius, 0.9, 40, 10), colour(hues[i as usize % 6])));
    }
    all.push((torus(1.1, 0.28), colour([0.85, 0.45, 0.15])));
    all.push((torus(1.1, 0.28), colour([0.15, 0.55, 0.60])));
    for _ in 0..8 {
        all.push((capsule(0.2, 0.0, 32, 9), colour([0.75, 0.75, 0.78])));
    }
    all
}

fn poses(frame: u32) -> Vec<Pose> {
    let t = TAU * f64::from(frame) / f64::from(FRAMES);
    let shift = |x, y, z| Pose::from_translation(DVec3::new(x, y, z));
    let turn = Pose::from_axis_rotation;
    let mut all = Vec::new();
    for chain in 0..2 {
        let c = f64::from(chain);
        let mut pose =
            shift(-2.3 + 0.5 * c, -1.2 + 2.4 * c, 0.4) * turn(2, 0.35 - 0.7 * c + 0.25 * t.sin());
        for i in 0..6 {
            let axis = if i % 3 == 1 { 2 } else { 1 };
            pose = pose * turn(axis, 0.35 * (t + f64::from(i) + c).sin());
            all.push(pose);
            pose = pose * shift(0.9, 0.0, 0.0);
        }
    }
    all.push(shift(-0.3, 0.0, 0.2) * turn(0, 0.5) * turn(2, t));
    all.push(shift(0.9, 0.0, 0.2) * turn(0, FRAC_PI_2 + 0.4 * t.sin()) * turn(1, 0.3));
    for i in 0..8 {
        let a = t + f64::from(i) * PI / 4.0;
        all.push(shift(
            2.6 * a.cos(),
            2.2 * a.sin(),
            -0.9 + 0.3 * (2.0 * a).sin(),
        ));
    }
    all
}

fn camera() -> Camera {
    let eye = DVec3::new(5.2, -6.4, 4.0);
    let back = (eye - DVec3::new(0.0, 0.0, 0.2)).normalize();
    let right = DVec3::Z.cross(back).normalize();
    Camera {
        world_from_camera: Pose {
            rotation: DMat3::from_cols(right, back.cross(right), back),
            translation: eye,
        },
        projection: Projection::Perspective {
            fov_y: 35f64.to_radians(),
        },
        near: 0.5,
        far: 50.0,
    }
}

/// What is drawn beside the bodies.
#[derive(Clone, Copy, PartialEq)]
enum Around {
    Nothing,
    Ground,
    /// And shadows on bodies.
    Shadows,
}

/// The room of the bodies' motion.
const ROOM: [DVec3; 2] = [DVec3::splat(-2.6), DVec3::splat(2.6)];

fn stage(scale: u32, samples: u32, around: Around) -> Stage {
    Stage {
        meshes: bodies().into_iter().map(|(mesh, _)| mesh.into()).collect(),
        size: SIZE.map(|n| n * scale),
        samples,
        camera: camera(),
        background: [245, 246, 248],
        rim: Rim::DARK,
        edges: None,
        mutual_shade: (around == Around::Shadows).then_some(ROOM),
        ground: (around != Around::Nothing).then_some(Ground {
            centre: DVec3::new(0.0, 0.0, -1.45),
            normal: DVec3::Z,
            radius: 6.5,
            // Lines have a width in pixels, which the larger reference picture does not share.
            grid: 0.0,
            shade: Ground::DARKER,
        }),
    }
}

fn frame(number: u32, colours: &[[u8; 3]]) -> Frame {
    let instances = colours.iter().copied().zip(poses(number)).enumerate().map(
        |(mesh, (colour, world_from_mesh))| Instance {
            mesh,
            world_from_mesh,
            colour,
            opacity: 1.0,
            triangles: 0..u32::MAX,
            casts_shadow: true,
            outline: None,
            flat: 0.0,
        },
    );
    Frame {
        instances: instances.collect(),
        ..Frame::default()
    }
}

fn bodies_colours() -> Vec<[u8; 3]> {
    bodies().into_iter().map(|(_, colour)| colour).collect()
}

/// CPU seconds of this process so far, of all threads; wall time where the system does not say.
fn cpu_seconds(start: Instant) -> f64 {
    let ticks = std::fs::read_to_string("/proc/self/schedstat")
        .ok()
        .and_then(|text| text.split(' ').next()?.parse::<f64>().ok());
    ticks.map_or_else(
        || start.elapsed().as_secs_f64(),
        |nanoseconds| nanoseconds * 1e-9,
    )
}

fn draw(stage: Stage, frame: &Frame) -> RgbaImage {
    let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
    let mut renderer = CpuRenderer::new(Arc::new(stage)).expect("a stage");
    renderer.draw(frame, &mut image).expect("a picture");
    image
}

/// The same picture by 8 x 8 pixels of 16 samples for each, in sRGB codes averaged in linear light.
fn reference(number: u32, around: Around) -> Vec<[f64; 3]> {
    const SCALE: u32 = 8;
    let large = draw(stage(SCALE, 16, around), &frame(number, &bodies_colours()));
    let curve = mechanim::render::colour::ToneCurve::shared();
    let mut sums = vec![[0.0; 3]; (SIZE[0] * SIZE[1]) as usize];
    for (x, y, pixel) in large.enumerate_pixels() {
        let sum = &mut sums[((y / SCALE) * SIZE[0] + x / SCALE) as usize];
        for (sum, code) in sum.iter_mut().zip(pixel.0) {
            *sum += f64::from(curve.decode(code)) / f64::from(SCALE * SCALE);
        }
    }
    let encode = |v: f64| {
        if v <= 0.003_130_8 {
            12.92 * v
        } else {
            1.055 * v.powf(1.0 / 2.4) - 0.055
        }
    };
    sums.into_iter()
        .map(|c| c.map(|v| 255.0 * encode(v)))
        .collect()
}

fn rmse(image: &RgbaImage, reference: &[[f64; 3]]) -> f64 {
    let sum: f64 = image
        .pixels()
        .zip(reference)
        .flat_map(|(pixel, truth)| (0..3).map(|k| (f64::from(pixel.0[k]) - truth[k]).powi(2)))
        .sum();
    (sum / (3.0 * reference.len() as f64)).sqrt()
}

/// RMSE over the pixels at edges: those that differ from the pixel to the left or above by more than [`EDGE`].
fn edge_error(image: &RgbaImage, reference: &[[f64; 3]]) -> f64 {
    let width = SIZE[0] as usize;
    let differ =
        |a: usize, b: usize| (0..3).any(|k| (reference[a][k] - reference[b][k]).abs() > EDGE);
    let (mut sum, mut count) = (0.0, 0.0);
    for (at, pixel) in image.pixels().enumerate() {
        let beside = at % width > 0 && differ(at, at - 1);
        if beside || (at >= width && differ(at, at - width)) {
            sum += (0..3)
                .map(|k| (f64::from(pixel.0[k]) - reference[at][k]).powi(2))
                .sum::<f64>();
            count += 3.0;
        }
    }
    (sum / f64::max(count, 1.0)).sqrt()
}

/// Time of all frames with one number of samples, and the distance from the truth if it is known.
fn measure(stage: Stage, frames: &[Frame], truth: Option<&[[f64; 3]]>) -> RgbaImage {
    let samples = stage.samples;
    let mut renderer = CpuRenderer::new(Arc::new(stage)).expect("a stage");
    let mut image = RgbaImage::new(SIZE[0], SIZE[1]);
    renderer.draw(&frames[0], &mut image).expect("a picture");
    let start = Instant::now();
    let before = cpu_seconds(start);
    let mut best = f64::INFINITY;
    for frame in frames {
        let start = Instant::now();
        renderer.draw(frame, &mut image).expect("a picture");
        best = best.min(start.elapsed().as_secs_f64());
    }
    let cpu = (cpu_seconds(start) - before) * 1e3 / frames.len() as f64;
    renderer
        .draw(&frames[COMPARED as usize], &mut image)
        .expect("a picture");
    let error = truth.map_or(String::new(), |truth| {
        let edges = edge_error(&image, truth);
        format!(", RMSE {:.3}, at edges {edges:.3}", rmse(&image, truth))
    });
    println!(
        "  {samples:2} samples: {cpu:6.2} CPU ms a frame (best {:6.2} wall){error}",
        best * 1e3
    );
    image
}

fn main() {
    let folder = std::env::args().skip(1).find(|a| !a.starts_with("--"));
    let quick = std::env::args().any(|a| a == "--quick");
    let colours = bodies_colours();
    let frames: Vec<Frame> = (0..FRAMES).map(|k| frame(k, &colours)).collect();
    let triangles: usize = bodies().iter().map(|(mesh, _)| mesh.triangles.len()).sum();
    println!(
        "{triangles} triangles, {} x {} pixels, {FRAMES} frames",
        SIZE[0], SIZE[1]
    );
    let all = [
        (Around::Nothing, "bodies only"),
        (Around::Ground, "with ground and contact shadow"),
        (Around::Shadows, "with shadows on bodies as well"),
    ];
    for (number, (around, words)) in all.into_iter().enumerate() {
        println!("{words}");
        // The cells of occlusion are smaller in a larger picture: it is another picture.
        let compared = !quick && around != Around::Shadows;
        let truth = compared.then(|| reference(COMPARED, around));
        let counts: &[u32] = if quick { &[4] } else { &[1, 2, 4, 8, 16] };
        for samples in counts.iter().copied() {
            let image = measure(stage(1, samples, around), &frames, truth.as_deref());
            if let Some(folder) = &folder {
                let name = format!("{folder}/frame-{samples}-{number}.png");
                image.save(&name).expect("a file");
            }
        }
    }
}
