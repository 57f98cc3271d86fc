//! The GPU renderer against the built-in one: the same stage, the same picture within stated bounds.
//!
//! All but the first test need a graphics adapter, a software one will do (Debian, Ubuntu: `mesa-vulkan-drivers`),
//! and are ignored by default, so that a machine without one does not report them as
//! passed: `cargo test --release --test gpu_parity -- --include-ignored`. They fail where there is no adapter.
#![cfg(feature = "gpu")]
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use glam::DVec3;
use image::RgbaImage;
use mechanim::geometry::mesh_of;
use mechanim::math::Pose;
use mechanim::model::shape::Solid;
use mechanim::render::adapter::{AdapterChoice, AdapterInfo};
use mechanim::render::camera::{ViewDirection, fit_camera};
use mechanim::render::cpu::CpuRenderer;
use mechanim::render::edges::EdgeStyle;
use mechanim::render::gpu::GpuRenderer;
use mechanim::render::look::Rim;
use mechanim::render::open::list_adapters;
use mechanim::render::{Frame, Ground, Instance, Projection, RenderError, Renderer, Stage};
use std::sync::Arc;

/// Least likeness of the two renderers' pictures. Mesa's software adapter reaches 53 to 60 dB.
const LEAST_PSNR: f64 = 50.0;
/// A channel this many levels apart is seen.
const SEEN: u8 = 24;
/// Largest share of pixels with a seen difference: edges, where the two may sort a sample's two surfaces differently.
const MOST_SEEN: f64 = 0.001;

/// A channel this many levels apart is more than rounding: another formula on one side.
const ROUNDING: u8 = 3;
/// Largest share of pixels beyond rounding; edges of the bodies' facets, where light is taken at slightly other places.
const MOST_BEYOND_ROUNDING: f64 = 0.01;

const PERSPECTIVE: Projection = Projection::Perspective { fov_y: 0.5 };
const PARALLEL: Projection = Projection::Orthographic { height: 1.0 };

fn solids() -> Vec<Solid> {
    vec![
        Solid::Sphere {
            centre: DVec3::ZERO,
            radius: 0.35,
        },
        Solid::Capsule {
            from: DVec3::new(-1.2, 0.0, 0.0),
            to: DVec3::new(1.2, 0.3, 0.9),
            radius: 0.12,
        },
        Solid::Torus {
            centre: DVec3::ZERO,
            axis: DVec3::Z,
            ring: 0.8,
            tube: 0.18,
        },
        Solid::Box {
            centre: DVec3::ZERO,
            size: DVec3::new(0.5, 0.7, 0.3),
        },
    ]
}

fn stage(projection: Projection, size: [u32; 2], samples: u32) -> Arc<Stage> {
    let view = ViewDirection {
        azimuth: -0.9,
        elevation: 0.42,
        up: DVec3::Z,
    };
    let (low, high) = (DVec3::new(-1.6, -1.8, 0.0), DVec3::new(1.8, 1.9, 1.7));
    let corner = |k: usize| {
        let pick = |axis: usize| {
            if k >> axis & 1 == 0 {
                low[axis]
            } else {
                high[axis]
            }
        };
        DVec3::new(pick(0), pick(1), pick(2))
    };
    let aspect = f64::from(size[0]) / f64::from(size[1]);
    Arc::new(Stage {
        meshes: solids()
            .iter()
            .map(|solid| mesh_of(solid, 0.004).into())
            .collect(),
        size,
        samples,
        camera: fit_camera((0..8).map(corner), &view, projection, aspect, 0.06),
        background: [0xf4, 0xf5, 0xf7],
        rim: Rim::DARK,
        edges: Some(EdgeStyle {
            creases: true,
            ink: [0x1b, 0x1f, 0x26],
        }),
        mutual_shade: Some([low, high]),
        ground: Some(Ground {
            centre: DVec3::ZERO,
            normal: DVec3::Z,
            radius: 5.0,
            grid: 0.5,
            shade: Ground::DARKER,
        }),
    })
}

/// Opaque and translucent bodies, one cut by the ground, one flat, one partial; two with a mesh of the frame's own.
fn frame(stage: &Stage) -> Frame {
    let body =
        |mesh: usize, place: [f64; 3], (axis, angle): (usize, f64), colour, opacity| Instance {
            mesh,
            world_from_mesh: Pose::from_translation(place.into())
                * Pose::from_axis_rotation(axis, angle),
            colour,
            opacity,
            triangles: 0..stage.meshes[mesh].triangles.len() as u32,
            casts_shadow: true,
            outline: Some(mesh as u32),
            flat: 0.0,
        };
    let mut instances = vec![
        body(0, [-1.2, 0.0, 0.4], (0, 0.0), [0xc2, 0x45, 0x2d], 1.0),
        body(0, [1.3, 0.4, 1.3], (0, 0.0), [0x2f, 0x6f, 0xb5], 1.0),
        body(1, [0.0, 0.0, 0.4], (0, 0.0), [0xb8, 0xbc, 0xc4], 1.0),
        body(2, [0.2, 1.2, 0.5], (0, 0.9), [0xe0, 0xa0, 0x30], 1.0),
        body(2, [0.0, -0.6, 0.8], (1, 0.6), [0x3c, 0x9a, 0x6e], 0.4),
        body(3, [1.4, -1.0, 0.15], (2, 0.5), [0x77, 0x55, 0x9c], 1.0),
        body(0, [0.0, -1.5, 0.1], (0, 0.0), [0xd8, 0xd8, 0xda], 1.0),
        body(3, [-1.0, 1.4, 0.5], (0, 0.3), [0x20, 0x90, 0xa0], 1.0),
    ];
    instances[5].triangles.end /= 2;
    instances[7].flat = 1.0;
    let own = stage.meshes.len();
    instances[7].mesh = own;
    instances[4].mesh = own + 1;
    Frame {
        meshes: vec![stage.meshes[3].clone(), stage.meshes[2].clone()],
        instances,
        ..Frame::default()
    }
}

fn adapters() -> Vec<AdapterInfo> {
    let found = list_adapters();
    assert!(
        !found.is_empty(),
        "this test needs a graphics adapter and found none"
    );
    found
}

fn exactly(adapter: &AdapterInfo) -> AdapterChoice {
    AdapterChoice::Name(adapter.to_string())
}

fn draw(renderer: &mut dyn Renderer, stage: &Stage, frame: &Frame) -> RgbaImage {
    let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
    renderer.draw(frame, &mut image).unwrap();
    image
}

/// Peak signal-to-noise ratio in dB of `b`, moved by (dx, dy), against `a`, where both have pixels.
fn psnr(a: &RgbaImage, b: &RgbaImage, dx: i32, dy: i32) -> f64 {
    let (mut sum, mut count) = (0.0, 0.0);
    for (x, y, pixel) in a.enumerate_pixels() {
        let (u, v) = (x.wrapping_add_signed(dx), y.wrapping_add_signed(dy));
        let Some(other) = b.get_pixel_checked(u, v) else {
            continue;
        };
        for c in 0..3 {
            let difference = f64::from(pixel.0[c]) - f64::from(other.0[c]);
            sum += difference * difference;
            count += 1.0;
        }
    }
    if sum == 0.0 {
        return f64::INFINITY;
    }
    10.0 * (255.0 * 255.0 * count / sum).log10()
}

/// Share of pixels of which a channel is more than `levels` apart.
fn share_beyond(a: &RgbaImage, b: &RgbaImage, levels: u8) -> f64 {
    let beyond = a
        .pixels()
        .zip(b.pixels())
        .filter(|(p, q)| p.0.iter().zip(q.0).any(|(m, n)| m.abs_diff(n) > levels));
    beyond.count() as f64 / (f64::from(a.width()) * f64::from(a.height()))
}

fn assert_same(gpu: &RgbaImage, cpu: &RgbaImage, what: &str) {
    let likeness = psnr(gpu, cpu, 0, 0);
    let seen = share_beyond(gpu, cpu, SEEN);
    let beyond = share_beyond(gpu, cpu, ROUNDING);
    println!(
        "{what}: {likeness:.2} dB, {:.3} % beyond rounding, {:.3} % seen to differ",
        beyond * 100.0,
        seen * 100.0
    );
    assert!(
        beyond <= MOST_BEYOND_ROUNDING,
        "{what}: {:.3} % differ by more than {ROUNDING}",
        beyond * 100.0
    );
    assert!(likeness >= LEAST_PSNR, "{what}: {likeness:.2} dB");
    assert!(
        seen <= MOST_SEEN,
        "{what}: {:.3} % differ by more than {SEEN}",
        seen * 100.0
    );
    for (dx, dy) in [(1, 0), (-1, 0), (0, 1), (0, -1), (1, 1), (-1, -1)] {
        let shifted = psnr(gpu, cpu, dx, dy);
        assert!(
            shifted < likeness,
            "{what}: better when moved by ({dx}, {dy})"
        );
    }
}

fn compare(projection: Projection, size: [u32; 2], samples: u32) {
    compare_stage(stage(projection, size, samples));
}

fn compare_stage(stage: Arc<Stage>) {
    let (projection, samples) = (stage.camera.projection, stage.samples);
    let frame = frame(&stage);
    let mut cpu = CpuRenderer::new(Arc::clone(&stage)).unwrap();
    let expected = draw(&mut cpu, &stage, &frame);
    for adapter in adapters() {
        let mut gpu = GpuRenderer::open(Arc::clone(&stage), exactly(&adapter)).unwrap();
        assert_eq!(gpu.name(), adapter.to_string());
        let found = draw(&mut gpu, &stage, &frame);
        assert!(found.pixels().all(|p| p.0[3] == 255));
        assert_same(
            &found,
            &expected,
            &format!("{adapter}, {projection:?}, {samples} samples"),
        );
        let again = draw(&mut gpu, &stage, &frame);
        assert_eq!(found, again, "{adapter}: a second drawing differs");
    }
}

#[test]
fn an_adapter_that_is_not_there_is_an_error_that_helps() {
    let stage = stage(PERSPECTIVE, [8, 8], 1);
    let choice = AdapterChoice::Name("no adapter has this name".to_owned());
    let Err(RenderError::NoAdapter(text)) = GpuRenderer::open(stage, choice) else {
        panic!("an adapter was found");
    };
    for part in [
        "no adapter has this name",
        "mesa-vulkan-drivers",
        "--renderer cpu",
    ] {
        assert!(text.contains(part), "{text}");
    }
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn perspective_pictures_are_the_same() {
    compare(PERSPECTIVE, [400, 300], 4);
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn parallel_pictures_are_the_same() {
    compare(PARALLEL, [400, 300], 4);
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn pictures_with_one_sample_are_the_same() {
    compare(PERSPECTIVE, [400, 300], 1);
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn rows_that_need_padding_are_read_whole() {
    compare(PERSPECTIVE, [257, 131], 4);
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn bodies_without_ground_are_lit_alike() {
    let mut bare = Stage::clone(&stage(PERSPECTIVE, [320, 240], 4));
    bare.ground = None;
    compare_stage(Arc::new(bare));
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn an_eye_among_the_bodies_sees_the_same() {
    for projection in [PERSPECTIVE, Projection::Orthographic { height: 3.0 }] {
        let mut close = Stage::clone(&stage(PERSPECTIVE, [320, 240], 4));
        let camera = &mut close.camera;
        camera.projection = projection;
        let ahead = camera.world_from_camera.rotation * DVec3::NEG_Z;
        let middle = DVec3::new(0.0, 0.0, 0.6);
        camera.world_from_camera.translation = middle - 0.9 * ahead;
        (camera.near, camera.far) = (0.05, 8.0);
        compare_stage(Arc::new(close));
    }
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn a_picture_without_pose_is_marked_alike() {
    let stage = stage(PERSPECTIVE, [200, 150], 4);
    let mut frame = frame(&stage);
    frame.no_pose = true;
    let mut cpu = CpuRenderer::new(Arc::clone(&stage)).unwrap();
    let mut gpu = GpuRenderer::open(Arc::clone(&stage), AdapterChoice::Any).unwrap();
    let pictures = [
        draw(&mut gpu, &stage, &frame),
        draw(&mut cpu, &stage, &frame),
    ];
    assert_same(&pictures[0], &pictures[1], "no pose");
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn later_frames_do_not_remember_earlier_ones() {
    let stage = stage(PERSPECTIVE, [160, 120], 4);
    let full = frame(&stage);
    let few = Frame {
        instances: full.instances[..2].to_vec(),
        ..Frame::default()
    };
    let mut gpu = GpuRenderer::open(Arc::clone(&stage), AdapterChoice::Any).unwrap();
    let fresh = draw(&mut gpu, &stage, &few);
    let many = Frame {
        instances: full.instances.iter().cycle().take(500).cloned().collect(),
        ..Frame::default()
    };
    assert_ne!(draw(&mut gpu, &stage, &many), fresh);
    assert_eq!(draw(&mut gpu, &stage, &few), fresh);
    assert_ne!(draw(&mut gpu, &stage, &Frame::default()), fresh);
}

/// Three renderers on one device, each on its own thread and with frames of its own, draw what one does.
#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn frames_in_flight_do_not_disturb_each_other() {
    let stage = stage(PERSPECTIVE, [160, 120], 4);
    let frames: Vec<Frame> = (1..=8)
        .map(|count| Frame {
            instances: frame(&stage).instances[..count].to_vec(),
            ..Frame::default()
        })
        .collect();
    let mut first = GpuRenderer::open(Arc::clone(&stage), AdapterChoice::Any).unwrap();
    let alone: Vec<RgbaImage> = frames.iter().map(|f| draw(&mut first, &stage, f)).collect();
    let siblings = [first.sibling().unwrap(), first.sibling().unwrap(), first];
    std::thread::scope(|scope| {
        for (k, mut renderer) in siblings.into_iter().enumerate() {
            let (stage, frames, alone) = (&stage, &frames, &alone);
            scope.spawn(move || {
                for round in 0..40 {
                    let at = (round * (k + 1) + k) % frames.len();
                    let found = draw(&mut renderer, stage, &frames[at]);
                    assert_eq!(found, alone[at], "renderer {k}, frame {at}");
                }
            });
        }
    });
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn a_moving_camera_sees_the_same() {
    let stage = stage(PERSPECTIVE, [240, 180], 4);
    let mut frame = frame(&stage);
    let mut cpu = CpuRenderer::new(Arc::clone(&stage)).unwrap();
    let mut gpu = GpuRenderer::open(Arc::clone(&stage), AdapterChoice::Any).unwrap();
    for turn in [0.0, 0.4, 1.9] {
        let turned = Pose::from_axis_rotation(2, turn) * stage.camera.world_from_camera;
        frame.camera = Some(mechanim::render::Camera {
            world_from_camera: turned,
            ..stage.camera
        });
        let [found, expected] = [
            draw(&mut gpu, &stage, &frame),
            draw(&mut cpu, &stage, &frame),
        ];
        assert_same(&found, &expected, &format!("turned by {turn}"));
    }
}

#[test]
#[ignore = "needs a graphics adapter: run with --include-ignored"]
fn sizes_the_device_cannot_hold_are_refused() {
    for size in [[1 << 30, 1], [0, 10], [10, 0], [u32::MAX, u32::MAX]] {
        let mut big = Stage::clone(&stage(PERSPECTIVE, [64, 48], 4));
        big.size = size;
        let opened = GpuRenderer::open(Arc::new(big), AdapterChoice::Any);
        assert!(matches!(opened, Err(RenderError::Size(_))), "{size:?}");
    }
    let small = stage(PERSPECTIVE, [1, 1], 4);
    let mut gpu = GpuRenderer::open(Arc::clone(&small), AdapterChoice::Any).unwrap();
    draw(&mut gpu, &small, &frame(&small));
    let mut wrong = RgbaImage::new(2, 1);
    assert!(matches!(
        gpu.draw(&Frame::default(), &mut wrong),
        Err(RenderError::Size(_))
    ));
}
