//! Whole frames: their look, cameras, what is left out, ranges, the ground.

use super::*;

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
        ALL_OPEN,
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
            centre: DVec3::ZERO,
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
            centre: DVec3::new(0.0, 1.0, 0.0),
            size: DVec3::new(2.5, 0.3, 0.5),
        },
    ];
    let ground = Ground {
        centre: DVec3::Z * -0.2,
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
        meshes: solids.iter().map(|s| mesh_of(s, 0.002).into()).collect(),
        size: [161, 99],
        samples,
        camera: crate::render::camera::fit_camera(corners.into_iter(), &view, projection, 1.6, 0.1),
        background: [245, 246, 248],
        rim: Rim::DARK,
        edges: None,
        mutual_shade: None,
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

/// Pictures of a motion, one after the other with one renderer, are those of a new renderer for each: bodies that move or
/// stand still, turn translucent, are drawn in part or change their colour, before and behind each other.
#[test]
fn what_is_kept_of_the_frame_before_is_what_would_be_drawn() {
    for samples in [1, 2, 4, 8, 16] {
        let (mut stage, mut frame) = workshop(samples);
        for (edges, shade) in [(false, false), (true, false), (true, true)] {
            stage.edges = edges.then_some(EdgeStyle {
                creases: true,
                ink: BLACK,
            });
            let room = [DVec3::splat(-9.0), DVec3::splat(9.0)];
            stage.mutual_shade = shade.then_some(room);
            let mut renderer = CpuRenderer::new(Arc::new(stage.clone())).unwrap();
            let mut image = RgbaImage::new(stage.size[0], stage.size[1]);
            for step in 0..9 {
                let turn = Pose::from_axis_rotation(step % 3, 0.1 * step as f64);
                match step {
                    2 => frame.instances[1].opacity = 1.0,
                    3 => frame.instances[1].opacity = 0.4,
                    4 => frame.instances[0].colour = [9, 200, 90],
                    7 => frame.instances[2].world_from_mesh.translation.z -= 3.0,
                    _ => frame.instances[step % 2].world_from_mesh = turn,
                }
                let drawn = 3 * step as u32;
                frame.instances[2].triangles = 0..if step == 8 { 4 } else { drawn };
                renderer.draw(&frame, &mut image).unwrap();
                let expected = draw(stage.clone(), frame.instances.clone());
                assert!(image == expected, "{samples} {edges} {shade} {step}");
            }
        }
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
    let more = [broken.into(), StageMesh::default()];
    stage.meshes = stage.meshes.iter().cloned().chain(more).collect();
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

/// Of surfaces that lie in one plane the one listed first is seen, whole, however they are cut into triangles.
#[test]
fn surfaces_at_one_depth_do_not_break_through_each_other() {
    let red = [220, 30, 30];
    let turned = |mesh: &Mesh, angle: f64| {
        let turn = Pose::from_axis_rotation(2, angle);
        let mut mesh = mesh.clone();
        for position in &mut mesh.positions {
            *position = turn.transform_point(*position);
        }
        mesh
    };
    let square = rectangle([-30.0; 2], [30.0; 2], 0.0);
    let mut seed = 7;
    for case in 0..24 {
        let other = turned(&square, noise(&mut seed) * 3.0);
        let [a, b] = [noise(&mut seed), noise(&mut seed)];
        let about = |axis: usize, share: f64| Pose::from_axis_rotation(axis, 2.0 * share - 1.0);
        let tilt = about(0, a) * about(1, b);
        let at = |mesh: usize, colour: [u8; 3]| Instance {
            world_from_mesh: tilt,
            ..instance(mesh, colour)
        };
        let stage = || {
            let mut stage = flat_stage([100, 80], 4, vec![square.clone(), other.clone()]);
            if case % 2 == 0 {
                stage.camera.projection = Projection::Perspective { fov_y: 0.8 };
            }
            stage
        };
        let alone = draw(stage(), vec![at(0, red)]);
        let both = draw(stage(), vec![at(0, red), at(1, [30, 30, 220])]);
        let whole = alone.pixels().zip(both.pixels());
        let whole = whole.filter(|(alone, _)| alone.0[..3] == red);
        let broken = whole.clone().filter(|(alone, both)| alone != both).count();
        assert!(whole.count() > 500, "{case}: the square is seen");
        assert_eq!(broken, 0, "{case}");
    }
}

#[test]
fn meshes_of_a_frame_are_drawn_like_those_of_the_stage() {
    let meshes = [
        rectangle([-9.0, -9.0], [3.0, 9.0], 0.0),
        rectangle([-2.0, -5.0], [9.0, 5.0], 1.0),
    ];
    let instances = || [[200, 20, 20], [20, 20, 200]].into_iter().enumerate();
    let instances = || {
        instances()
            .map(|(mesh, colour)| instance(mesh, colour))
            .collect()
    };
    let expected = draw(flat_stage([30, 30], 4, meshes.to_vec()), instances());
    for own in 0..=2 {
        let (of_stage, of_frame) = meshes.split_at(2 - own);
        let frame = Frame {
            meshes: of_frame.iter().map(|mesh| mesh.clone().into()).collect(),
            // One more that no mesh exists for.
            instances: [instances(), vec![instance(2, [0; 3])]].concat(),
            ..Frame::default()
        };
        let stage = flat_stage([30, 30], 4, of_stage.to_vec());
        let mut image = RgbaImage::new(30, 30);
        let mut renderer = CpuRenderer::new(Arc::new(stage)).unwrap();
        renderer.draw(&frame, &mut image).unwrap();
        assert!(image == expected, "{own} meshes of the frame");
    }
}
