//! What `[view]` and the options of `render` show: named views, transparency, decorations, characters without glyph.

use image::RgbaImage;
use std::path::Path;
use std::process::{Command, Output};

fn render(folder: &Path, scene: &str, out: &str, options: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_mechanim"));
    command.args(["render", scene, "--renderer", "cpu", "--size", "320x240"]);
    command.arg("--out").arg(folder.join(out)).args(options);
    command.output().unwrap()
}

fn picture(folder: &Path, options: &[&str]) -> RgbaImage {
    let output = render(folder, "gearshift", "a.png", options);
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{options:?}: {message}");
    image::open(folder.join("a.png")).unwrap().to_rgba8()
}

#[test]
fn every_option_changes_the_picture() {
    let folder = tempfile::tempdir().unwrap();
    let plain = picture(folder.path(), &["--at", "3"]);
    let options: [&[&str]; 19] = [
        &["--orbit", "120"],
        &["--view", "iso"],
        &["--view", "front"],
        &["--view", "top"],
        &["--view", "side"],
        &["--view", "four"],
        &["--elevation", "90"],
        &["--projection", "orthographic"],
        &["--theme", "dark"],
        &["--background", "#ffffff"],
        &["--ghosts", "3"],
        &["--trails", "fading"],
        &["--arrows"],
        &["--axes", "all"],
        &["--axes", "corner"],
        &["--scale"],
        &["--ticks", "0.5"],
        &["--gauge"],
        &["--joints"],
    ];
    let mut seen = vec![plain];
    for option in options {
        let changed = picture(folder.path(), &[&["--at", "3"], option].concat());
        assert!(seen.iter().all(|other| *other != changed), "{option:?}");
        seen.push(changed);
    }
}

#[test]
fn a_picture_without_background_gives_the_same_before_white() {
    let folder = tempfile::tempdir().unwrap();
    let clear = picture(folder.path(), &["--transparent", "--no-captions"]);
    let white = picture(folder.path(), &["--background", "#ffffff", "--no-captions"]);
    assert_eq!(clear.get_pixel(0, 0).0[3], 0);
    assert!(clear.pixels().any(|p| p.0[3] == 255));
    // On edges the channels let through different shares, and one alpha has to serve all three.
    let far = clear.pixels().zip(white.pixels()).filter(|(layer, whole)| {
        let alpha = f64::from(layer.0[3]) / 255.0;
        (0..3).any(|c| {
            let over = f64::from(layer.0[c]) * alpha + 255.0 * (1.0 - alpha);
            (over - f64::from(whole.0[c])).abs() > 12.0
        })
    });
    let far = far.count();
    assert!(far * 20 < clear.pixels().len(), "{far} pixels");
    for out in ["a.gif", "a.y4m"] {
        let output = render(folder.path(), "gearshift", out, &["--transparent"]);
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8_lossy(&output.stderr).contains("no transparency"));
        assert!(!folder.path().join(out).exists());
    }
}

#[test]
fn characters_without_glyph_are_named() {
    let folder = tempfile::tempdir().unwrap();
    let text = mechanim::scene::builtin::find_builtin("bennett")
        .unwrap()
        .text;
    let text = text.replacen("title = \"", "title = \"漢 ", 1);
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let output = render(folder.path(), scene.to_str().unwrap(), "a.png", &[]);
    assert!(output.status.success());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("`漢` (U+6F22)"), "{message}");
}

/// A camera inside a body, one that looks along the up axis, one that passes over the zenith: pictures, no panics.
#[test]
fn cameras_in_odd_places_make_pictures() {
    let folder = tempfile::tempdir().unwrap();
    let text = mechanim::scene::builtin::find_builtin("gearshift")
        .unwrap()
        .text;
    let paths = [
        "[{ target = [455, 235, 150], distance = 1e-3 }]",
        "[{ target = [455, 235, 150], distance = 40 }]",
        "[{ elevation = 90 }]",
        "[{ elevation = -90, zoom = 100 }]",
        "[{ t = 0, elevation = -90, azimuth = 0 }, { t = 3, elevation = 90, azimuth = 720 }]",
    ];
    for path in paths {
        let view = format!("[view]\ncamera_path = {path}\n");
        let scene = folder.path().join("scene.toml");
        std::fs::write(&scene, text.replacen("[view]\n", &view, 1)).unwrap();
        for options in [
            &["--at", "2"][..],
            &["--at", "2", "--projection", "orthographic"],
        ] {
            let output = render(folder.path(), scene.to_str().unwrap(), "a.png", options);
            let message = String::from_utf8_lossy(&output.stderr).into_owned();
            assert_eq!(output.status.code(), Some(0), "{path}: {message}");
            assert!(image::open(folder.path().join("a.png")).is_ok());
        }
    }
}

/// After a whole turn and a whole cycle everything is where it was; on the way it is not.
#[test]
fn an_orbit_of_a_whole_turn_ends_where_it_begins() {
    let folder = tempfile::tempdir().unwrap();
    let seen = |at: &'static str| {
        let options = [
            "--orbit",
            "360",
            "--no-captions",
            "--trails",
            "none",
            "--at",
            at,
        ];
        picture(folder.path(), &options)
    };
    let [start, quarter, end] = ["0", "1.5", "6"].map(seen);
    let apart = |a: &RgbaImage, b: &RgbaImage| {
        let pairs = a.pixels().zip(b.pixels());
        let differ = pairs.filter(|(p, q)| p.0.iter().zip(q.0).any(|(m, n)| m.abs_diff(n) > 2));
        differ.count()
    };
    // Sines of a whole turn are rounded otherwise: some edges may.
    assert!(apart(&start, &end) <= 20, "{}", apart(&start, &end));
    assert!(
        apart(&start, &quarter) > 2000,
        "{}",
        apart(&start, &quarter)
    );
}

/// A post with a label, and a door that passes before it.
const DOOR: &str = r#"
duration = 2
[inputs]
x = "4*t - 4"
[loops]
A = "Tx(x) Tx(-y)"
[[bodies]]
name = "post"
shapes = [{ box = { center = [0, 2, 0], size = [0.2, 0.2, 0.2] } }]
[[bodies]]
name = "door"
frame = "Tx(x)"
shapes = [{ box = { center = [0, 0, 0], size = [2, 0.2, 2] } }]
[view]
from = "front"
captions = false
"#;

#[test]
fn a_label_hides_while_a_body_stands_before_it() {
    let folder = tempfile::tempdir().unwrap();
    let seen = |rule: &str, at: &str| {
        let scene = folder.path().join("door.toml");
        std::fs::write(&scene, format!("{DOOR}{rule}")).unwrap();
        let output = render(
            folder.path(),
            scene.to_str().unwrap(),
            "a.png",
            &["--at", at],
        );
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{message}");
        image::open(folder.path().join("a.png")).unwrap().to_rgba8()
    };
    let label = "[[labels]]\ntext = \"P\"\nbody = \"post\"\npoint = [0, 2, 0]\n";
    let hides = format!("{label}hides = true\n");
    // The door is far at the start, and before the post in the middle.
    for (at, hidden) in [("0", false), ("1", true)] {
        let [none, always, sometimes] = ["", label, &hides].map(|rule| seen(rule, at));
        assert!(none != always);
        assert!(sometimes == if hidden { none } else { always }, "{at}");
    }
}
