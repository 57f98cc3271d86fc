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
    let options: [&[&str]; 23] = [
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
        &["--section", "y=0"],
        &["--section", "-y=0"],
        &["--section", "0,0,0/1,1,1"],
        &["--explode", "0.5"],
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

/// Title, values and names of the views are opaque where the background is not.
#[test]
fn captions_of_several_views_show_without_a_background() {
    let folder = tempfile::tempdir().unwrap();
    let four = ["--view", "four", "--transparent"];
    let named = picture(folder.path(), &four);
    let bare = picture(folder.path(), &[&four[..], &["--no-captions"]].concat());
    // The title's corner.
    let opaque = |image: &RgbaImage| {
        let corner = image::imageops::crop_imm(image, 0, 0, 100, 16).to_image();
        corner.pixels().filter(|p| p.0[3] > 200).count()
    };
    assert_eq!(opaque(&bare), 0);
    assert!(opaque(&named) > 10);
}

/// A box and a ring beside it, before a camera that looks at the cut.
const BOXES: &str = r##"
[inputs]
phi = 0
[[bodies]]
name = "left"
frame = "Rz(phi)"
colour = "#c02020"
shapes = [{ box = { center = [-1.5, 0, 0], size = [2, 2, 2] } }]
[[bodies]]
name = "right"
frame = "Rz(phi)"
colour = "#2020c0"
shapes = [{ torus = { center = [1.5, 0, 0], axis = [0, 1, 0], ring = 0.8, tube = 0.4 } }]
[view]
from = "front"
ground = "none"
edges = "none"
captions = false
"##;

fn count(picture: &RgbaImage, [red, green, blue]: [u8; 3]) -> usize {
    let is_it = |p: &&image::Rgba<u8>| p.0[..3] == [red, green, blue];
    picture.pixels().filter(is_it).count()
}

/// Colours of the cut face and of its hatching: three fifths of the way to white, and three fifths of the light.
fn cut_colours(colour: [u8; 3]) -> [[u8; 3]; 2] {
    let mixed = |to: f64, share: f64| {
        colour.map(|c| (f64::from(c) + (to - f64::from(c)) * share).round() as u8)
    };
    [mixed(255.0, 0.6), mixed(0.0, 0.4)]
}

#[test]
fn cut_faces_are_flat_and_hatched() {
    let folder = tempfile::tempdir().unwrap();
    let draw = |section: &str, options: &[&str]| {
        let scene = folder.path().join("boxes.toml");
        std::fs::write(&scene, format!("{BOXES}{section}")).unwrap();
        let at = [&["--frame", "0"], options].concat();
        let output = render(folder.path(), scene.to_str().unwrap(), "a.png", &at);
        let message = String::from_utf8_lossy(&output.stderr).into_owned();
        assert!(output.status.success(), "{section}: {message}");
        image::open(folder.path().join("a.png")).unwrap().to_rgba8()
    };
    let [left, right] = [[0xc0, 0x20, 0x20], [0x20, 0x20, 0xc0]].map(cut_colours);
    let whole = draw("", &[]);
    assert_eq!(count(&whole, left[0]) + count(&whole, right[0]), 0);
    // The viewer of `front` looks along y: the near halves are taken away.
    let key = "section = { point = [0, 0, 0], normal = [0, -1, 0] }";
    let cut = draw(key, &[]);
    for [face, lines] in [left, right] {
        let [face, lines] = [count(&cut, face), count(&cut, lines)];
        assert!(face > 1000 && 40 * lines > face, "{face} {lines}");
    }
    // The hole of the ring shows what is behind it.
    let [width, height] = [cut.width(), cut.height()];
    let mut columns = (width / 2..width).filter(|x| {
        let pixel = cut.get_pixel(*x, height / 2);
        right.iter().any(|colour| pixel.0[..3] == *colour)
    });
    let (first, last) = (columns.next().unwrap(), columns.next_back().unwrap());
    assert!(columns.count() + 20 < (last - first) as usize);
    assert_eq!(draw(key, &[]), cut);
    assert_eq!(draw("", &["--section=-y=0"]), cut);
    // Only one of them; then none of them; then nothing is left.
    let one = draw(&key.replace(" }", ", bodies = [\"left\"] }"), &[]);
    assert!(count(&one, left[0]) > 1000 && count(&one, right[0]) == 0);
    assert_eq!(draw("", &["--section", "y=9"]), whole);
    let gone = draw("", &["--section", "y=-9"]);
    assert!(gone.pixels().all(|p| p == gone.get_pixel(0, 0)));
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
