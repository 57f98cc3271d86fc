//! What `[view]` and the options of `render` show: named views, transparency, decorations, characters without glyph.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

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
    let options: [&[&str]; 15] = [
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
    let text = mechanim::scene::builtin::find("bennett").unwrap().text;
    let text = text.replacen("title = \"", "title = \"漢 ", 1);
    let scene = folder.path().join("scene.toml");
    std::fs::write(&scene, text).unwrap();
    let output = render(folder.path(), scene.to_str().unwrap(), "a.png", &[]);
    assert!(output.status.success());
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(message.contains("`漢` (U+6F22)"), "{message}");
}
