//! Pictures of the built-in scenes: golden images of the built-in renderer, and the same frames on any number of
//! threads.

use crate::driven::{frame_times, solve};
use crate::snapshot;
use glam::DVec3;
use image::RgbaImage;
use mechanim::diag::Source;

#[cfg(feature = "gpu")]
use crate::snapshot::assert_snapshot;
use mechanim::kinematics::results::trajectory::Trajectory;
use mechanim::render::Renderer;
use mechanim::render::cpu::CpuRenderer;
use mechanim::render::overlay::Overlay;
use mechanim::scene::{Overrides, Scene, builtin, load_scene};
use mechanim::snapshot::manifest::GoldenPicture;
use mechanim::snapshot::{GoldenVerdict, MANIFEST, Manifest, judge_picture};
use mechanim::staging::{PictureOptions, Staging};
use std::sync::Arc;

const SMALL: PictureOptions = PictureOptions {
    size: [192, 144],
    samples: 4,
};

fn solved(name: &str) -> (Scene, Trajectory) {
    let source = builtin::find_builtin(name).unwrap();
    let scene = load_scene(&source, &Overrides::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let trajectory = solve(&scene, &frame_times(&scene, scene.view.fps)).unwrap();
    (scene, trajectory)
}

fn draw(staging: &Staging, renderer: &mut dyn Renderer, index: usize) -> RgbaImage {
    let [width, height] = staging.stage.size;
    let mut image = RgbaImage::new(width, height);
    let frame = staging.frame(index);
    renderer.draw(&frame, &mut image).unwrap();
    Overlay::new(staging.stage.background).draw(&frame, &frame.camera(&staging.stage), &mut image);
    image
}

/// The list of golden pictures: a frame of every built-in scene.
fn pictures() -> Vec<GoldenPicture> {
    let path = snapshot::folder().join(MANIFEST);
    let source = Source {
        name: MANIFEST.into(),
        text: std::fs::read_to_string(path).unwrap(),
    };
    Manifest::read(&source).unwrap().pictures
}

#[test]
fn scenes_look_as_they_should() {
    let pictures = pictures();
    for scene in builtin::ALL {
        assert!(
            pictures.iter().any(|p| p.scene == scene.name),
            "no picture of {}",
            scene.name
        );
    }
    // All of them first, so that one run shows every picture that fails.
    let update = snapshot::wish_of_environment().unwrap();
    let failures = pictures.iter().filter_map(|picture| {
        let drawn = mechanim::snapshot::draw_picture(picture, &snapshot::folder()).unwrap();
        let golden = snapshot::folder().join(&picture.file);
        match judge_picture(&golden, &drawn, picture.allowed, update).unwrap() {
            GoldenVerdict::Failed { reason, .. } => Some(format!("{}: {reason}", golden.display())),
            _ => None,
        }
    });
    let failures: Vec<String> = failures.collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The adapter's picture against the same goldens: what is seen (24 levels) may differ in one pixel of a thousand,
/// at edges where the two sort a sample's surfaces differently.
#[cfg(feature = "gpu")]
#[test]
#[ignore = "needs a graphics adapter, a software one will do: run with --include-ignored"]
fn scenes_look_the_same_on_a_graphics_adapter() {
    use mechanim::compare::{Comparison, compare_pictures};
    use mechanim::render::adapter::AdapterChoice;
    use mechanim::render::gpu::GpuRenderer;
    use mechanim::snapshot::{AllowedDifference, draw_picture, draw_with};
    for picture in pictures() {
        let (file, folder) = (&picture.file, snapshot::folder());
        let drawn = draw_with(&picture, &folder, &|stage| {
            Ok(Box::new(GpuRenderer::open(stage, AdapterChoice::Any)?))
        })
        .unwrap();
        let compared = compare_pictures(&draw_picture(&picture, &folder).unwrap(), &drawn, 24);
        let Comparison::SameSize(likeness) = compared else {
            panic!("{file}: {compared:?}")
        };
        println!("{file}: {:.1} dB", likeness.psnr);
        assert!(likeness.psnr >= 49.0, "{file}: {:.1} dB", likeness.psnr);
        assert_snapshot(
            file.trim_end_matches(".png"),
            &drawn,
            AllowedDifference {
                tolerance: 24,
                pixels: (drawn.width() * drawn.height() / 1000).into(),
            },
        );
    }
}

#[test]
fn gif_bytes_do_not_depend_on_the_number_of_threads() {
    let folder = tempfile::tempdir().unwrap();
    let file = |threads: &str| {
        let out = folder.path().join(format!("{threads}.gif"));
        let status = std::process::Command::new(env!("CARGO_BIN_EXE_mechanim"))
            .args([
                "render",
                "gearshift",
                "--renderer",
                "cpu",
                "--size",
                "160x120",
                "--frames",
                "30",
                "--quiet",
            ])
            .args(["--threads", threads, "--out"])
            .arg(&out)
            .status()
            .unwrap();
        assert!(status.success());
        std::fs::read(out).unwrap()
    };
    let one = file("1");
    assert!(one.starts_with(b"GIF89a"));
    assert_eq!(one, file("2"));
    assert_eq!(one, file("3"));
    assert_eq!(one, file("1"), "run to run");
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
    for name in ["gearshift", "slider-crank", "seven-r", "dyads"] {
        let (scene, trajectory) = solved(name);
        let staging = Staging::new(&scene, &trajectory, SMALL);
        for index in (0..staging.frame_count()).step_by(11) {
            for instance in staging.frame(index).instances {
                let mesh = &staging.stage.meshes[instance.mesh];
                for point in &mesh.positions {
                    let point = DVec3::from(point.map(f64::from));
                    let world = instance.world_from_mesh.transform_point(point);
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
    assert!((1..staging.frame_count()).all(|k| drawn(k) >= drawn(k - 1)));
    assert!(
        drawn(30) > 0 && drawn(60) > drawn(30),
        "it grows while the lever moves"
    );
    let trace = staging.frame(0).instances.last().unwrap().mesh;
    // All but the step from the end of the cycle to its start.
    let left = staging.stage.meshes[trace].triangles.len() as u32;
    let left = left - drawn(staging.frame_count() - 1);
    assert_eq!(left, 6 * 6);
}

/// Oklab (Ottosson, 2020) of an sRGB colour.
fn oklab(rgb: [u8; 3]) -> [f64; 3] {
    let linear = mechanim::render::colour::ToneCurve::shared().decode_rgb(rgb);
    let [r, g, b] = linear.map(f64::from);
    let cones = [
        0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b,
        0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b,
        0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b,
    ];
    let [l, m, s] = cones.map(f64::cbrt);
    [
        0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
        1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
        0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s,
    ]
}

/// 255 colours for a whole motion move no pixel as far as bodies' colours are apart (0.06, see `model/palette.rs`), and
/// nearly all by less than can be seen.
#[test]
fn bodies_stay_apart_in_a_palette() {
    use mechanim::export::palette::Palette;
    for name in ["gearshift", "dyads", "twin-steer"] {
        let (scene, trajectory) = solved(name);
        let staging = Staging::new(&scene, &trajectory, SMALL);
        let mut renderer = CpuRenderer::new(Arc::clone(&staging.stage)).unwrap();
        let count = staging.frame_count();
        let sampled = (0..count).step_by(count / 10);
        let frames = sampled.map(|k| draw(&staging, &mut renderer, k));
        let frames: Vec<RgbaImage> = frames.collect();
        let palette = Palette::from_samples(&frames, &staging.needed_colours(), 255);
        let between = draw(&staging, &mut renderer, count / 7);
        let mut moved: Vec<f64> = between
            .pixels()
            .map(|pixel| {
                let [r, g, b, _] = pixel.0;
                let mapped = palette.colours()[usize::from(palette.map([r, g, b]))];
                let (a, b) = (oklab([r, g, b]), oklab(mapped));
                (0..3).map(|k| (a[k] - b[k]).powi(2)).sum::<f64>().sqrt()
            })
            .collect();
        moved.sort_by(f64::total_cmp);
        let worst = moved[moved.len() - 1];
        let usual = moved[moved.len() * 99 / 100];
        println!("{name}: worst {worst:.4}, 99 % within {usual:.4}");
        assert!(worst < 0.06 && usual < 0.02, "{name}: {worst} {usual}");
    }
}
