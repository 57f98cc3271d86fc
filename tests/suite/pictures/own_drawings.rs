//! Scenes without bodies draw themselves: links and bars as rods, a flat mechanism squarely.

use image::RgbaImage;
use std::path::Path;
use std::process::Command;

const JOINTS: &str = r#"
duration = 4
units = { length = "mm", angle = "deg" }
[inputs]
phi = "360*t/4"
[loops]
A = "Rz(phi) Tx(35) Rz(alpha) Tx(95) Rz(mu) inv(Tx(105) Rz(psi) Tx(80))"
[guess]
alpha = 60
psi = 90
mu = 70
"#;

const BARS: &str = r#"
duration = 4
units = { length = "mm", angle = "deg" }
[inputs]
phi = "360*t/4"
[chains]
B = "Rz(phi) Tx(35)"
D = "Tx(105)"
C = "Tx(xc) Ty(yc)"
[guess]
xc = 80
yc = 70
[bars]
coupler = { from = "B", to = "C", length = 95 }
rocker = { from = "D", to = "C", length = 80 }
"#;

/// A ram between a fixed point and one that slides along a line.
const RAM: &str = r#"
duration = 1
[inputs]
l = "1 + 0.8*t"
[chains]
C = "Tx(x) Ty(0.5)"
[guess]
x = 0.8
[bars]
ram = { from = [0, 0], to = "C", length = "l" }
"#;

fn picture(folder: &Path, scene: &str, options: &[&str]) -> RgbaImage {
    let [text, out] = ["own.toml", "own.png"].map(|name| folder.join(name));
    std::fs::write(&text, scene).unwrap();
    let mut command = Command::new(env!("CARGO_BIN_EXE_mechanim"));
    command.args(["render", "--renderer", "cpu", "--size", "320x240"]);
    command.arg(&text).arg("--out").arg(&out).args(options);
    let output = command.output().unwrap();
    let message = String::from_utf8_lossy(&output.stderr).into_owned();
    assert!(output.status.success(), "{options:?}: {message}");
    image::open(out).unwrap().to_rgba8()
}

/// Whether a pixel has a colour: the ground, its shadows and the symbols of joints are nearly grey.
fn is_coloured(pixel: [u8; 4]) -> bool {
    let [r, g, b, _] = pixel;
    r.max(g).max(b) - r.min(g).min(b) > 60
}

fn coloured(picture: &RgbaImage) -> usize {
    picture.pixels().filter(|p| is_coloured(p.0)).count()
}

#[test]
fn a_linkage_of_bars_looks_like_one_of_joints() {
    let folder = tempfile::tempdir().unwrap();
    for at in ["0.5", "1.7", "3"] {
        let options = ["--at", at, "--edges", "none"];
        let [joints, bars] = [JOINTS, BARS].map(|scene| picture(folder.path(), scene, &options));
        let pairs = || joints.pixels().zip(bars.pixels());
        let all = pairs().filter(|(a, b)| is_coloured(a.0) || is_coloured(b.0));
        let alike = all.clone().filter(|(a, b)| {
            let apart = a.0.iter().zip(&b.0).map(|(a, b)| a.abs_diff(*b));
            apart.max().is_some_and(|apart| apart < 40)
        });
        let (all, alike) = (all.count(), alike.count());
        assert!(all > 500 && alike * 10 > all * 9, "{at}: {alike} of {all}");
    }
}

#[test]
fn a_flat_mechanism_is_looked_at_squarely_unless_told_otherwise() {
    let folder = tempfile::tempdir().unwrap();
    let own = picture(folder.path(), BARS, &["--at", "1"]);
    let top = picture(folder.path(), BARS, &["--at", "1", "--view", "top"]);
    assert!(own == top);
    for options in [
        &["--view", "iso"][..],
        &["--azimuth", "-60", "--elevation", "20"],
        &["--elevation", "30"],
    ] {
        let other = picture(folder.path(), BARS, &[&["--at", "1"], options].concat());
        assert!(own != other, "{options:?}");
    }
    let aimed = format!("{BARS}\n[view]\nazimuth = -60\nelevation = 25\n");
    assert!(own != picture(folder.path(), &aimed, &["--at", "1"]));
    // With y up, the plane of x and y is the one that the side view shows.
    let upright = format!("{BARS}\n[view]\nup = \"y\"\n");
    let side = picture(folder.path(), &upright, &["--at", "1", "--view", "side"]);
    assert!(side == picture(folder.path(), &upright, &["--at", "1"]));
}

#[test]
fn a_bar_that_changes_its_length_is_drawn_as_long_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let lengths = ["0", "0.5", "1"].map(|at| {
        let options = ["--at", at, "--edges", "none", "--no-captions"];
        coloured(&picture(folder.path(), RAM, &options)) as f64
    });
    // A barrel and a rod as long as each other, both drawn in full unless one is in the other.
    assert!(
        lengths[0] < lengths[1] && lengths[1] < lengths[2],
        "{lengths:?}"
    );
}
