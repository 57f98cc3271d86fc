//! What a picture must be, in closed form: areas, exact colours, order, no cracks, no memory.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use super::*;
use crate::geometry::{Mesh, mesh_of};
use crate::math::Pose;
use crate::model::shape::Solid as Shape;
use crate::render::colour::ToneCurve;
use crate::render::edges::Edges;
use crate::render::look::{Rim, Surroundings};
use crate::render::{Camera, Ground, Instance, Projection, look};
use glam::DVec3;
use image::Rgba;

const WHITE: [u8; 3] = [255; 3];
const BLACK: [u8; 3] = [0; 3];

/// One unit is one pixel; x to the right and y up from the picture's middle, seen from z = 100.
fn flat_stage(size: [u32; 2], samples: u32, meshes: Vec<Mesh>) -> Stage {
    Stage {
        meshes,
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

#[test]
fn a_ball_covers_its_disc() {
    let radius = 20.0;
    let ball = mesh_of(
        &Shape::Sphere {
            center: DVec3::ZERO,
            radius,
        },
        1e-6,
    );
    // The outline is the regular polygon of the equator.
    let exact = 128.0 * radius * radius * (std::f64::consts::TAU / 256.0).sin();
    let mut seed = 7;
    for (samples, within) in [(16, 1.2), (8, 3.0), (4, 6.0), (2, 9.0), (1, 14.0)] {
        let mut worst = 0.0f64;
        for _ in 0..5 {
            let mut ball_there = instance(0, BLACK);
            let offset = DVec3::new(noise(&mut seed), noise(&mut seed), 0.0);
            ball_there.world_from_mesh = Pose::from_translation(offset);
            let image = draw(
                flat_stage([64, 64], samples, vec![ball.clone()]),
                vec![ball_there],
            );
            let curve = ToneCurve::shared();
            let area: f64 = image
                .pixels()
                .map(|p| 1.0 - f64::from(curve.decode(p.0[0])))
                .sum();
            worst = worst.max((area - exact).abs());
        }
        assert!(worst < within, "{samples} samples: {worst} pixels off");
    }
}

#[test]
fn a_half_covered_pixel_is_half_the_light() {
    // Edges through pixel middles: half of the samples of every pattern but the single one.
    for samples in [2, 4, 8, 16] {
        let left = rectangle([-100.0, -100.0], [0.5, 100.0], 0.0);
        let image = draw(
            flat_stage([8, 8], samples, vec![left]),
            vec![instance(0, BLACK)],
        );
        let row: Vec<u8> = (0..8).map(|x| image.get_pixel(x, 3).0[0]).collect();
        assert_eq!(row, [0, 0, 0, 0, 188, 255, 255, 255], "{samples}");
    }
}

#[test]
fn the_nearer_surface_is_seen_in_any_order() {
    let stage = || {
        let far = rectangle([-9.0, -9.0], [9.0, 9.0], -3.0);
        let near = rectangle([-9.0, -9.0], [9.0, 9.0], 2.0);
        flat_stage([4, 4], 4, vec![far, near])
    };
    let (red, green) = ([200, 0, 0], [0, 180, 0]);
    for order in [[0, 1], [1, 0]] {
        let instances = order.map(|k| instance(k, if k == 0 { red } else { green }));
        let image = draw(stage(), instances.to_vec());
        assert!(image.pixels().all(|p| p.0[..3] == green));
    }
}

#[test]
fn translucent_layers_blend_in_linear_light() {
    let curve = ToneCurve::shared();
    let far = rectangle([-9.0, -9.0], [9.0, 9.0], -3.0);
    let near = rectangle([-9.0, -9.0], [9.0, 9.0], 2.0);
    let (first, second) = ([200, 40, 90], [20, 180, 250]);
    let layer = |mesh, colour, opacity| Instance {
        opacity,
        ..instance(mesh, colour)
    };
    let expected = [0, 1, 2].map(|k| {
        let below = 0.7 * 1.0 + 0.3 * curve.decode(first[k]);
        curve.encode(0.4 * below + 0.6 * curve.decode(second[k]))
    });
    for samples in [1, 2, 4, 8, 16] {
        let layers = [layer(0, first, 0.3), layer(1, second, 0.6)];
        for instances in [layers.to_vec(), layers.iter().rev().cloned().collect()] {
            let stage = flat_stage([5, 5], samples, vec![far.clone(), near.clone()]);
            let image = draw(stage, instances);
            for pixel in image.pixels() {
                for k in 0..3 {
                    assert!(
                        pixel.0[k].abs_diff(expected[k]) <= 1,
                        "{pixel:?} {expected:?}"
                    );
                }
            }
        }
    }
    // What is behind an opaque surface does not show, whatever its opacity.
    let hidden = vec![layer(0, first, 0.5), instance(1, second)];
    let image = draw(flat_stage([5, 5], 4, vec![far, near]), hidden);
    assert!(image.pixels().all(|p| p.0[..3] == second));
}

/// Two veils that cross: on either side of where they meet another one is in front, whatever their order.
#[test]
fn translucent_bodies_may_cross() {
    let curve = ToneCurve::shared();
    let (red, blue) = ([230, 20, 20], [20, 20, 230]);
    let mut slanted = rectangle([-9.0, -9.0], [9.0, 9.0], 0.0);
    for place in &mut slanted.positions {
        place.z = place.x;
    }
    let level = rectangle([-9.0, -9.0], [9.0, 9.0], 0.0);
    let veil = |mesh, colour| Instance {
        opacity: 0.5,
        ..instance(mesh, colour)
    };
    let over = |near: [u8; 3], far: [u8; 3]| {
        [0, 1, 2].map(|k| {
            let below = 0.5 + 0.5 * curve.decode(far[k]);
            curve.encode(0.5 * below + 0.5 * curve.decode(near[k]))
        })
    };
    for samples in [1, 4, 16] {
        for order in [[(0, red), (1, blue)], [(1, blue), (0, red)]] {
            let stage = flat_stage([12, 8], samples, vec![slanted.clone(), level.clone()]);
            let image = draw(stage, order.map(|(mesh, c)| veil(mesh, c)).to_vec());
            for (x, _, pixel) in image.enumerate_pixels() {
                let expected = if x >= 6 {
                    over(red, blue)
                } else {
                    over(blue, red)
                };
                for (found, expected) in pixel.0.iter().zip(expected) {
                    // Two layers, each rounded to the 8 bits of a sample.
                    assert!(found.abs_diff(expected) <= 2, "{x} {pixel:?}");
                }
            }
        }
    }
}

fn lined(mut stage: Stage, creases: bool) -> Stage {
    stage.edges = Some(Edges {
        creases,
        ink: BLACK,
    });
    stage
}

/// A line runs along the border of a body, to both sides, and nowhere else; it does not depend on the tiles.
#[test]
fn lines_follow_the_borders_of_bodies() {
    let square = rectangle([-30.0, -20.0], [30.0, 20.0], 0.0);
    for samples in [1, 2, 4, 8, 16] {
        let stage = lined(flat_stage([100, 80], samples, vec![square.clone()]), true);
        let body = Instance {
            outline: Some(0),
            ..instance(0, [240, 200, 40])
        };
        let image = draw(stage, vec![body]);
        for (x, y, pixel) in image.enumerate_pixels() {
            let (dx, dy) = (
                (f64::from(x) - 49.5).abs() - 30.0,
                (f64::from(y) - 39.5).abs() - 20.0,
            );
            // Beside a corner the border is as far as the corner.
            let off = match dx > 0.0 && dy > 0.0 {
                true => dx.hypot(dy),
                false => dx.max(dy).abs(),
            };
            let own = if dx.max(dy) < 0.0 {
                [240, 200, 40]
            } else {
                WHITE
            };
            if off > 1.6 {
                assert_eq!(pixel.0[..3], own, "{samples}: {x} {y}");
            } else if off < 0.6 && dx.min(dy) < -1.0 {
                // At a corner the line thins out.
                assert!(pixel.0[0] < own[0] - 20, "{samples}: {x} {y} {pixel:?}");
            }
        }
    }
}

/// A veil that is all but clear and draws no line takes none away: neither under it nor where its own border parts the
/// samples of a pixel.
#[test]
fn a_clear_veil_leaves_lines_as_they_are() {
    let square = rectangle([-30.0, -20.0], [30.0, 20.0], 0.0);
    let veil = rectangle([-40.0, 10.3], [-29.6, 30.0], 1.0);
    for samples in [1, 2, 4, 8, 16] {
        let stage = || {
            let stage = flat_stage([100, 80], samples, vec![square.clone(), veil.clone()]);
            lined(stage, true)
        };
        let body = Instance {
            outline: Some(0),
            ..instance(0, [240, 200, 40])
        };
        let clear = Instance {
            opacity: 1e-3,
            ..instance(1, WHITE)
        };
        let bare = draw(stage(), vec![body.clone()]);
        let veiled = draw(stage(), vec![body, clear]);
        for ((x, y, bare), veiled) in bare.enumerate_pixels().zip(veiled.pixels()) {
            let off = bare.0.iter().zip(veiled.0).map(|(a, b)| a.abs_diff(b));
            assert!(
                off.max() <= Some(2),
                "{samples}: {x} {y} {bare:?} {veiled:?}"
            );
        }
    }
}

#[test]
fn what_has_no_outline_takes_no_line_and_bodies_of_one_group_have_none_between_them() {
    let left = rectangle([-30.0, -20.0], [0.0, 20.0], 0.0);
    let right = rectangle([0.0, -20.0], [30.0, 20.0], 0.0);
    let colour = [240, 200, 40];
    let part = |mesh, outline| Instance {
        outline,
        ..instance(mesh, colour)
    };
    let middle = |creases, outlines: [Option<u32>; 2]| {
        let stage = flat_stage([100, 80], 4, vec![left.clone(), right.clone()]);
        let parts = vec![part(0, outlines[0]), part(1, outlines[1])];
        *draw(lined(stage, creases), parts).get_pixel(50, 40)
    };
    assert_eq!(middle(true, [None, None]).0[..3], colour);
    assert_eq!(middle(false, [Some(3), Some(3)]).0[..3], colour);
    for dark in [
        middle(false, [Some(3), Some(4)]),
        middle(true, [Some(3), Some(3)]),
    ] {
        // As much darker as on any border.
        assert!(dark.0[0] < colour[0] - 30, "{dark:?}");
    }
}

#[test]
fn shared_edges_have_no_cracks_and_no_overlap() {
    let half = ToneCurve::shared().encode(0.5);
    let cases = [
        (sheet(60, 60.0, 1), [90, 70]),
        (sheet(7, 60.0, 2), [90, 70]),
        (sheet(3, 500.0, 3), [90, 70]),
        (sheet(2, 2_000.0, 4), [300, 70]),
        (sheet(2, 30_000.0, 5), [90, 70]),
        (sheet(2, 1e6, 6), [64, 64]),
        (sheet(1, 1e9, 7), [33, 65]),
    ];
    for (mesh, size) in cases {
        for samples in [1, 2, 4, 8, 16] {
            let veil = Instance {
                opacity: 0.5,
                ..instance(0, BLACK)
            };
            let image = draw(flat_stage(size, samples, vec![mesh.clone()]), vec![veil]);
            let wrong = image.pixels().filter(|p| p.0[0] != half).count();
            assert_eq!(wrong, 0, "{} triangles, {samples}", mesh.triangles.len());
        }
    }
}

#[test]
fn a_plane_through_the_eye_is_cut_without_cracks() {
    // The sheet passes under the eye, from far behind it to far in front: all below the horizon is it.
    let mut stage = flat_stage([64, 48], 4, vec![sheet(5, 3000.0, 8)]);
    stage.camera = Camera {
        world_from_camera: Pose::from_translation(DVec3::new(3.0, -4.0, 2.0))
            * Pose::from_axis_rotation(0, std::f64::consts::FRAC_PI_2),
        projection: Projection::Perspective { fov_y: 0.9 },
        near: 0.01,
        far: 1e4,
    };
    let veil = Instance {
        opacity: 0.5,
        ..instance(0, BLACK)
    };
    let image = draw(stage, vec![veil]);
    let half = ToneCurve::shared().encode(0.5);
    for (_, y, pixel) in image.enumerate_pixels() {
        match y {
            0..=22 => assert_eq!(pixel.0[0], 255),
            25.. => assert_eq!(pixel.0[0], half),
            _ => {}
        }
    }
}

#[test]
fn a_facing_surface_has_the_colour_of_the_look() {
    let curve = ToneCurve::shared();
    let square = rectangle([-9.0, -9.0], [9.0, 9.0], 0.0);
    let colour = [194, 69, 45];
    let lit = Instance {
        flat: 0.0,
        ..instance(0, colour)
    };
    let image = draw(
        flat_stage([3, 3], 4, vec![square.clone()]),
        vec![lit.clone()],
    );
    let facing = [0.0, 0.0, 1.0];
    let light = look::shade_surface(
        facing,
        facing,
        &Surroundings {
            up: [0.0, 1.0, 0.0],
            rim: Rim::DARK,
        },
        curve.decode_rgb(colour),
        0.0,
    );
    let expected = light.map(|c| curve.encode(c));
    assert!(image.pixels().all(|p| p.0[..3] == expected));
    // The back of an open sheet is lit like its front.
    let turned = Instance {
        world_from_mesh: Pose::from_axis_rotation(1, std::f64::consts::PI),
        ..lit
    };
    let back = draw(flat_stage([3, 3], 4, vec![square]), vec![turned]);
    assert!(back.pixels().zip(image.pixels()).all(|(a, b)| a == b));
}

fn workshop(samples: u32) -> (Stage, Frame) {
    let solids = [
        Shape::Torus {
            center: DVec3::ZERO,
            axis: DVec3::Z,
            ring: 1.0,
            tube: 0.3,
        },
        Shape::Capsule {
            from: DVec3::ZERO,
            to: DVec3::new(0.4, 0.2, 1.8),
            radius: 0.2,
        },
        Shape::Box {
            center: DVec3::new(0.0, 1.0, 0.0),
            size: DVec3::new(2.5, 0.3, 0.5),
        },
    ];
    let ground = Ground {
        center: DVec3::Z * -0.2,
        normal: DVec3::Z,
        radius: 4.0,
        grid: 0.5,
        shade: Ground::DARKER,
    };
    let view = crate::render::camera::ViewDirection {
        azimuth: -0.9,
        elevation: 0.4,
        up: DVec3::Z,
    };
    let corners = [DVec3::splat(-1.5), DVec3::splat(1.5)];
    let projection = Projection::Perspective { fov_y: 0.6 };
    let stage = Stage {
        meshes: solids.iter().map(|s| mesh_of(s, 0.002)).collect(),
        size: [161, 99],
        samples,
        camera: crate::render::camera::fit_camera(corners.into_iter(), &view, projection, 1.6, 0.1),
        background: [245, 246, 248],
        rim: Rim::DARK,
        edges: None,
        ground: Some(ground),
    };
    let mut frame = Frame::default();
    for (mesh, colour) in [[194, 69, 45], [50, 110, 180], [90, 90, 95]]
        .into_iter()
        .enumerate()
    {
        frame.instances.push(Instance {
            flat: 0.0,
            ..instance(mesh, colour)
        });
    }
    frame.instances[1].opacity = 0.6;
    (stage, frame)
}

#[test]
fn a_picture_depends_on_nothing_but_its_frame() {
    for samples in [1, 2, 4, 8, 16] {
        let (stage, frame) = workshop(samples);
        let stage = Arc::new(stage);
        let mut moved = frame.clone();
        moved.instances[0].world_from_mesh = Pose::from_axis_rotation(0, 1.0);
        moved.instances[1].opacity = 1.0;
        moved.no_pose = true;
        let size = stage.size;
        let picture = move |renderer: &mut CpuRenderer, frame: &Frame| {
            let mut image = RgbaImage::new(size[0], size[1]);
            renderer.draw(frame, &mut image).unwrap();
            image
        };
        let mut first = CpuRenderer::new(stage.clone()).unwrap();
        let mut second = CpuRenderer::new(stage.clone()).unwrap();
        let direct = picture(&mut first, &frame);
        let other = picture(&mut second, &moved);
        assert!(direct != other);
        assert!(picture(&mut second, &frame) == direct);
        let threaded = std::thread::spawn(move || picture(&mut first, &moved))
            .join()
            .unwrap();
        assert!(threaded == other);
    }
}

/// A frame's own camera gives the picture of a stage that is seen through it, also after others and from below.
#[test]
fn a_frame_is_seen_through_its_own_camera() {
    let (stage, mut frame) = workshop(4);
    let mut moving = CpuRenderer::new(Arc::new(stage.clone())).unwrap();
    let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
    for (axis, turn) in [(2, 0.4), (0, 2.5), (2, -1.0)] {
        let turned = Pose::from_axis_rotation(axis, turn) * stage.camera.world_from_camera;
        let camera = Camera {
            world_from_camera: turned,
            ..stage.camera
        };
        let there = Stage {
            camera,
            ..stage.clone()
        };
        frame.camera = None;
        let expected = draw(there, frame.instances.clone());
        frame.camera = Some(camera);
        moving.draw(&frame, &mut image).unwrap();
        assert!(image == expected, "{axis} {turn}");
    }
}

#[test]
fn what_cannot_be_drawn_is_left_out() {
    let (mut stage, mut frame) = workshop(4);
    let mut broken = sheet(4, 1.0, 9);
    broken.triangles.push([0, 1, 4_000_000_000]);
    broken.positions[3] = DVec3::NAN;
    broken.positions[4] = DVec3::splat(1e300);
    broken.normals[5] = DVec3::NAN;
    broken.normals[6] = DVec3::ZERO;
    stage.meshes.extend([broken, Mesh::default()]);
    let bad_pose = |v: f64| Pose::from_translation(DVec3::new(0.0, v, v));
    for (mesh, value) in [
        (3, 0.0),
        (4, 0.0),
        (99, 0.0),
        (0, f64::NAN),
        (0, 1e300),
        (2, 1e30),
        (1, f64::INFINITY),
    ] {
        for opacity in [1.0, 0.5, f64::NAN, -3.0] {
            let world_from_mesh = bad_pose(value);
            frame.instances.push(Instance {
                opacity,
                world_from_mesh,
                flat: f64::NAN,
                ..instance(mesh, WHITE)
            });
        }
    }
    #[allow(clippy::reversed_empty_ranges)]
    frame.instances.push(Instance {
        triangles: 9..3,
        ..instance(0, WHITE)
    });
    frame.instances.push(Instance {
        triangles: u32::MAX - 1..u32::MAX,
        ..instance(0, WHITE)
    });
    draw(stage, frame.instances);
}

#[test]
fn a_range_of_triangles_is_drawn_alone() {
    let square = rectangle([-2.0, -2.0], [2.0, 2.0], 0.0);
    let part = Instance {
        triangles: 0..1,
        ..instance(0, BLACK)
    };
    let image = draw(flat_stage([4, 4], 1, vec![square]), vec![part]);
    let dark = image.pixels().filter(|p| p.0[0] == 0).count();
    // Half of 16 pixels, the diagonal's pixel middles falling to one side together.
    assert!(dark == 6 || dark == 10, "{dark}");
    assert_eq!(image.get_pixel(3, 3).0[0], 0);
    assert_eq!(image.get_pixel(0, 0).0[0], 255);
}

#[test]
fn stages_that_cannot_be_drawn_are_refused() {
    for (size, samples) in [
        ([0, 5], 4),
        ([5, 0], 4),
        ([MAX_SIDE + 1, 1], 4),
        ([5, 5], 3),
        ([5, 5], 0),
    ] {
        let stage = flat_stage(size, samples, vec![]);
        assert!(matches!(
            CpuRenderer::new(Arc::new(stage)),
            Err(RenderError::Size(_))
        ));
    }
    let mut renderer = CpuRenderer::new(Arc::new(flat_stage([1, 1], 4, vec![]))).unwrap();
    let mut other = RgbaImage::new(2, 1);
    assert!(renderer.draw(&Frame::default(), &mut other).is_err());
    let single = draw(flat_stage([1, 1], 16, vec![]), vec![]);
    assert_eq!(single.get_pixel(0, 0).0, [255; 4]);
}

#[test]
fn the_ground_hides_what_is_below_it() {
    let (stage, mut frame) = workshop(4);
    let bare = draw(stage.clone(), vec![]);
    frame.instances.truncate(1);
    frame.instances[0].casts_shadow = false;
    frame.instances[0].world_from_mesh = Pose::from_translation(DVec3::Z * -0.6);
    let buried = draw(stage, frame.instances);
    assert!(bare == buried);
}
