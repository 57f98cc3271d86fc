//! Pictures of the built-in scenes: golden images of the built-in renderer, and the same frames on any number of
//! threads.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod snapshot;

use image::RgbaImage;
use mechanim::kinematics::continuation::solve;
use mechanim::kinematics::sampling::frame_times;
use mechanim::kinematics::trajectory::Trajectory;
use mechanim::render::Renderer;
use mechanim::render::cpu::CpuRenderer;
use mechanim::render::overlay::Overlay;
use mechanim::scene::{Overrides, Scene, builtin, load};
use mechanim::staging::{PictureOptions, Staging};
use snapshot::{EXACT, assert_snapshot};
use std::sync::Arc;

const SMALL: PictureOptions = PictureOptions {
    size: [192, 144],
    samples: 4,
};

fn solved(name: &str) -> (Scene, Trajectory) {
    let source = builtin::find(name).unwrap();
    let scene =
        load(&source, &Overrides::default()).unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let trajectory = solve(
        &scene.mechanism,
        &frame_times(&scene.mechanism, scene.view.fps),
    )
    .unwrap();
    (scene, trajectory)
}

fn draw(staging: &Staging, renderer: &mut CpuRenderer, index: usize) -> RgbaImage {
    let [width, height] = staging.stage.size;
    let mut image = RgbaImage::new(width, height);
    let frame = staging.frame(index);
    renderer.draw(&frame, &mut image).unwrap();
    Overlay::new(staging.stage.background).draw(&frame, &staging.stage.camera, &mut image);
    image
}

#[test]
fn scenes_look_as_they_should() {
    for (name, frame) in [
        ("gearshift", 100),
        ("gearshift-optimised", 100),
        ("slider-crank", 30),
        ("seven-r", 80),
    ] {
        let (scene, trajectory) = solved(name);
        let staging = Staging::new(&scene, &trajectory, SMALL);
        let mut renderer = CpuRenderer::new(Arc::clone(&staging.stage)).unwrap();
        assert_snapshot(
            &format!("{name}-{frame}"),
            &draw(&staging, &mut renderer, frame),
            EXACT,
        );
    }
}

#[test]
fn a_frame_does_not_depend_on_the_frames_before_it() {
    let (scene, trajectory) = solved("gearshift");
    let staging = Staging::new(&scene, &trajectory, SMALL);
    let open = || CpuRenderer::new(Arc::clone(&staging.stage)).unwrap();
    let (mut fresh, mut used) = (open(), open());
    for index in (0..60).step_by(7) {
        draw(&staging, &mut used, index);
    }
    assert_eq!(
        draw(&staging, &mut fresh, 60),
        draw(&staging, &mut used, 60)
    );
}

#[test]
fn every_body_is_seen_and_the_camera_holds_the_whole_motion() {
    for name in ["gearshift", "slider-crank", "seven-r"] {
        let (scene, trajectory) = solved(name);
        let staging = Staging::new(&scene, &trajectory, SMALL);
        for index in (0..staging.frame_count()).step_by(11) {
            for instance in staging.frame(index).instances {
                let mesh = &staging.stage.meshes[instance.mesh];
                for point in &mesh.positions {
                    let world = instance.world_from_mesh.transform_point(*point);
                    let [x, y, _] = staging.stage.camera.project(world, SMALL.size).unwrap();
                    let inside = (0.0..=192.0).contains(&x) && (0.0..=144.0).contains(&y);
                    assert!(
                        inside,
                        "{name} frame {index}: a point is drawn at {x:.1}, {y:.1}"
                    );
                }
            }
        }
    }
}

#[test]
fn trace_grows_frame_by_frame_and_is_whole_at_the_end() {
    let (scene, trajectory) = solved("gearshift");
    let staging = Staging::new(&scene, &trajectory, SMALL);
    let drawn = |index: usize| staging.frame(index).instances.last().unwrap().triangles.end;
    assert_eq!(drawn(0), 0);
    let steps: Vec<u32> = (1..staging.frame_count())
        .map(|k| drawn(k) - drawn(k - 1))
        .collect();
    assert!(steps.iter().all(|s| *s == steps[0] && *s > 0));
    let trace = staging.frame(0).instances.last().unwrap().mesh;
    assert_eq!(
        drawn(staging.frame_count() - 1) as usize,
        staging.stage.meshes[trace].triangles.len()
    );
}
