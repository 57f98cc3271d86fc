//! `encode`, `diff`, `snapshot` and the formats of `render`, as their users meet them.

use crate::program;
use crate::program::{Workspace, finish, moving};
use image::{Rgba, RgbaImage};
use serde_json::Value;

/// Twelve frames of a moving block over a gradient, numbered without padding.
fn frame(k: u32) -> RgbaImage {
    RgbaImage::from_fn(24, 16, |x, y| {
        let block = (k..k + 5).contains(&x) && (4..9).contains(&y);
        if block {
            Rgba([200, 60, 40, 255])
        } else {
            Rgba([240, 240 - 3 * y as u8, 250, 255])
        }
    })
}

fn workspace() -> Workspace {
    let w = Workspace::new();
    w.write("moving.toml", moving());
    for k in 0..12 {
        frame(k).save(w.path(&format!("f{k}.png"))).unwrap();
    }
    w
}

fn names(range: std::ops::Range<u32>) -> Vec<String> {
    let mut names: Vec<String> = range.map(|k| format!("f{k}.png")).collect();
    // As a shell sorts them: f0, f1, f10, f11, f2.
    names.sort();
    names
}

fn run(w: &Workspace, verb: &str, files: &[String], rest: &[&str]) -> program::Run {
    let mut arguments = vec![verb];
    arguments.extend(files.iter().map(String::as_str));
    arguments.extend(rest);
    w.run(&arguments)
}

#[test]
fn frames_are_assembled_in_the_order_people_count() {
    let w = workspace();
    run(
        &w,
        "encode",
        &names(0..12),
        &["--out", "a.gif", "--fps", "10"],
    )
    .exits(0)
    .says(&["a.gif: 12 frames of 24x16, 1.20 s"]);
    run(&w, "encode", &names(0..12), &["--out", "a.apng"]).exits(0);
    std::fs::create_dir(w.path("in")).unwrap();
    for name in names(0..12) {
        std::fs::copy(w.path(&name), w.path(&format!("in/{name}"))).unwrap();
    }
    w.run(&[
        "encode",
        "in",
        "--out",
        "b.gif",
        "--fps",
        "10",
        "--threads",
        "3",
    ])
    .exits(0);
    assert_eq!(w.read("a.gif"), w.read("b.gif"));
    w.run(&["diff", "a.gif", "b.gif"]).exits(0);
    w.run(&["encode", "in", "--out", "out/"]).exits(0);
    // The folder has other names; the pictures are the same.
    for k in 0..12 {
        w.run(&[
            "diff",
            &format!("f{k}.png"),
            &format!("out/frame-{k:04}.png"),
        ])
        .exits(0);
    }
    run(
        &w,
        "encode",
        &names(0..12),
        &["--out", "c.gif", "--no-sort"],
    )
    .exits(0);
    w.run(&["diff", "a.gif", "c.gif"]).exits(1);
    let raw = run(
        &w,
        "encode",
        &names(0..3),
        &["--out", "-", "--format", "rgba"],
    )
    .exits(0)
    .says_nothing();
    let expected: Vec<u8> = (0..3).flat_map(|k| frame(k).into_raw()).collect();
    assert_eq!(raw.stdout, expected);
}

#[test]
fn frames_that_do_not_fit_are_named() {
    let w = workspace();
    RgbaImage::new(24, 15).save(w.path("f5.png")).unwrap();
    let mut glass = frame(7);
    glass.get_pixel_mut(3, 3).0[3] = 128;
    glass.save(w.path("g.png")).unwrap();
    w.write("h.png", b"\x89PNG\r\n\x1a\nrest");
    w.write("i.png", "text");
    let before = w.files();
    for (files, out, says) in [
        (
            &["f0.png", "f5.png"][..],
            "x.gif",
            &["f5.png: 24x15 pixels, but the first frame has 24x16"][..],
        ),
        (
            &["f0.png", "g.png"],
            "x.gif",
            &[
                "g.png has transparent pixels, which a GIF cannot hold",
                "--background",
            ],
        ),
        (&["f0.png", "h.png"], "x.apng", &["h.png"]),
        (&["f0.png", "i.png"], "x.gif", &["i.png"]),
        (&["f0.png", "none.png"], "x.gif", &["cannot read none.png"]),
        (
            &["f0.png", "f1.png"],
            "x.png",
            &["x.png contains one picture", ".gif, .apng"],
        ),
        (
            &["f0.png", "f1.png"],
            "f1.png",
            &["f1.png is an input of this command"],
        ),
        (
            &["f0.png"],
            "x.glb",
            &["a GLB contains shapes, which pictures do not have"],
        ),
        (&["f0.png"], "x.avi", &["unknown extension .avi"]),
    ] {
        let mut arguments = [&["encode"], files, &["--out", out]].concat();
        w.run(&arguments).exits(2).prints_nothing().says(says);
        arguments.extend(["--fps", "0"]);
        w.run(&arguments).exits(2).says(&["between 0.01 and 1000"]);
    }
    assert_eq!(w.files(), before);
    w.run(&["encode", "g.png", "f0.png", "--out", "x.apng"])
        .exits(0);
    let kept = image::open(w.path("x.apng")).unwrap().to_rgba8();
    assert_eq!(kept.dimensions(), (24, 16));
    w.run(&[
        "encode",
        "g.png",
        "--out",
        "x.gif",
        "--background",
        "#000000",
    ])
    .exits(0);
    w.run(&["encode", "g.png", "--out", "x.png"]).exits(0);
    w.run(&["diff", "g.png", "x.png"]).exits(0);
}

#[test]
fn one_frame_and_one_pixel_make_every_format() {
    let w = workspace();
    for out in ["a.gif", "a.apng", "a.y4m", "a.rgba", "a.png", "dots/"] {
        let draw = [
            "render",
            "moving.toml",
            "--size",
            "1x1",
            "--frames",
            "1",
            "--out",
            out,
        ];
        w.run(&draw).exits(0);
    }
    for file in ["a.gif", "a.apng", "a.png", "dots/frame-0000.png"] {
        let picture = image::ImageReader::open(w.path(file))
            .unwrap()
            .with_guessed_format()
            .unwrap();
        let picture = picture.decode().unwrap();
        assert_eq!((picture.width(), picture.height()), (1, 1), "{file}");
    }
    assert_eq!(w.read("a.rgba").len(), 4);
    let [y, cb, cr] = w.read("a.y4m")[w.read("a.y4m").len() - 3..] else {
        panic!()
    };
    // The background is a light grey.
    assert!(
        y > 200 && cb.abs_diff(128) < 4 && cr.abs_diff(128) < 4,
        "{y} {cb} {cr}"
    );
    assert!(String::from_utf8_lossy(&w.read("a.y4m")).starts_with("YUV4MPEG2 W1 H1 F2:1 "));
}

#[test]
fn a_file_that_cannot_hold_what_is_asked_is_refused() {
    let w = workspace();
    for (out, more, says) in [
        (
            "x.stl",
            &["--frames", "5"][..],
            &[
                "x.stl: an STL contains one pose, not a motion",
                "write a .glb",
            ][..],
        ),
        (
            "x.obj",
            &["--frames", "5"],
            &["an OBJ contains one pose", "--at SECONDS"],
        ),
        ("x.png", &["--frames", "5"], &["x.png contains one picture"]),
        (
            "x.stl",
            &["--at", "9"],
            &["lasts from 0 to 0.5 s, 9 is outside"],
        ),
        (
            "x.png",
            &["--quality", "50"],
            &["--quality has no effect on a PNG", "it applies to GIFs"],
        ),
        (
            "x.gif",
            &["--compression", "small"],
            &["--compression has no effect on a GIF"],
        ),
        (
            "x.y4m",
            &["--loop", "once"],
            &["--loop has no effect on a y4m video"],
        ),
        (
            "x.gif",
            &["--chroma", "420"],
            &[
                "--chroma has no effect on a GIF",
                "it applies to y4m videos",
            ],
        ),
        (
            "x.gif",
            &["--trail-length", "1"],
            &["--trail-length is for trails that fade", "--trails fading"],
        ),
        (
            "x.gif",
            &["--arrow-scale", "1"],
            &["--arrow-scale has no effect without arrows", "--arrows"],
        ),
        (
            "x.gif",
            &["--orbit", "1e9"],
            &["--orbit", "between -36000 and 36000"],
        ),
        (
            "x%d.gif",
            &[],
            &["a GIF is one file, its name takes no frame number"],
        ),
        (
            "x.gif",
            &["--format", "bmp"],
            &["possible values: gif, apng, png"],
        ),
        (
            "x.gif",
            &["--compression", "great"],
            &["possible values: fast, balanced, small"],
        ),
    ] {
        let arguments = [
            &["render", "moving.toml", "--size", "20x20", "--out", out],
            more,
        ]
        .concat();
        w.run(&arguments).exits(2).prints_nothing().says(says);
        assert!(!w.path(out).exists());
    }
    w.write(
        "gap.toml",
        moving()
            .replace("2*t", "4*t")
            .replace("Tx(40) Rz(alpha) Tx(80)", "Tx(80) Rz(alpha) Tx(60)")
            .replace("[40, 0, 0]", "[80, 0, 0]"),
    );
    let gone = w.run(&["render", "gap.toml", "--at", "0.5", "--out", "x.stl"]);
    gone.exits(4).says(&["the motion has no pose at t = 0.5 s"]);
    assert!(!w.path("x.stl").exists());
    w.run(&["render", "gap.toml", "--at", "0", "--out", "x.stl"])
        .exits(0);
    w.run(&["render", "gap.toml", "--out", "x.glb"]).exits(4);
    assert!(gltf::Gltf::from_slice(&w.read("x.glb")).is_ok());
}

#[test]
fn models_come_from_the_command_line() {
    let w = workspace();
    w.run(&["render", "moving.toml", "--out", "a.glb"])
        .exits(0)
        .says(&["a.glb: 1 bodies, ", "13 keys over 0.50 s"]);
    let gltf = gltf::Gltf::from_slice(&w.read("a.glb")).unwrap();
    // A drive that ends where it began has its end as a key: viewers repeat without a jump.
    w.run(&["render", "slider-crank", "--out", "b.glb"])
        .exits(0)
        .says(&["81 keys over 4.00 s"]);
    assert_eq!(gltf.animations().count(), 1);
    let still = w
        .run(&[
            "render",
            "moving.toml",
            "--at",
            "0.25",
            "--out",
            "-",
            "--format",
            "glb",
        ])
        .exits(0)
        .says_nothing();
    assert_eq!(
        gltf::Gltf::from_slice(&still.stdout)
            .unwrap()
            .animations()
            .count(),
        0
    );
    w.run(&["render", "moving.toml", "--at", "0.25", "--out", "a.stl"])
        .exits(0)
        .says(&["a.stl: 1 bodies"]);
    let mut file = std::fs::File::open(w.path("a.stl")).unwrap();
    let mesh = stl_io::read_stl(&mut file).unwrap();
    // The crank stands at 2 · 0.25 rad and is 40 + 5 long.
    let reach = mesh
        .vertices
        .iter()
        .map(|v| f64::from(v.0[0]).hypot(v.0[1].into()))
        .fold(0.0, f64::max);
    assert!((reach - 45.0).abs() < 0.02, "{reach}");
    let far = mesh
        .vertices
        .iter()
        .max_by(|a, b| a.0[0].total_cmp(&b.0[0]))
        .unwrap();
    assert!(f64::from(far.0[1]) > 15.0, "{far:?}");
}

#[test]
fn diff_answers_by_its_exit_code() {
    let w = workspace();
    w.run(&["diff", "f0.png", "f0.png"]).exits(0).says_nothing();
    let run = w
        .run(&["diff", "f0.png", "f1.png", "--out", "t.png"])
        .exits(1)
        .says_nothing();
    assert!(
        run.text().contains("10 of 384 pixels off by more than 0"),
        "{}",
        run.text()
    );
    assert!(run.text().contains("result           different"));
    let triptych = image::open(w.path("t.png")).unwrap();
    assert_eq!((triptych.width(), triptych.height()), (3 * 24 + 8, 16));
    w.run(&["diff", "f0.png", "f1.png", "--max-pixels", "10"])
        .exits(0);
    w.run(&["diff", "f0.png", "f1.png", "--max-pixels", "9"])
        .exits(1);
    w.run(&["diff", "f0.png", "f1.png", "--levels", "255"])
        .exits(0);
    RgbaImage::new(24, 15).save(w.path("small.png")).unwrap();
    let run = w
        .run(&["diff", "f0.png", "small.png", "--levels", "255"])
        .exits(1);
    assert!(run.text().contains("24x16 expected, 24x15 found"));
    for (a, b, says) in [
        ("f0.png", "none.png", "cannot read none.png"),
        (
            "f0.png",
            "moving.toml",
            "moving.toml: neither a PNG nor a GIF",
        ),
        ("f0.png", ".", "f0.png is a PNG and . is a folder"),
    ] {
        w.run(&["diff", a, b])
            .exits(2)
            .prints_nothing()
            .says(&[says]);
    }
    w.run(&["diff", "f0.png", "f1.png", "--out", "f1.png"])
        .exits(2)
        .says(&["is an input"]);
    w.run(&["diff", "f0.png", "f1.png", "--levels", "256"])
        .exits(2);
    std::fs::create_dir(w.path("empty")).unwrap();
    w.run(&["diff", "empty", "empty"])
        .exits(2)
        .says(&["the folder has no PNG files"]);
}

#[test]
fn animations_are_compared_frame_by_frame_with_their_times() {
    let w = workspace();
    for kind in ["gif", "apng"] {
        let file = |name: &str| format!("{name}.{kind}");
        let make = |name: &str, range, more: &[&str]| {
            let out = file(name);
            let rest = [&["--out", out.as_str()], more].concat();
            run(&w, "encode", &names(range), &rest).exits(0);
        };
        make("a", 0..8, &[]);
        make("slow", 0..8, &["--fps", "20"]);
        make("once", 0..8, &["--loop", "once"]);
        make("short", 0..7, &[]);
        std::fs::copy(w.path("f3.png"), w.path("keep.png")).unwrap();
        let mut spoilt = frame(3);
        spoilt.get_pixel_mut(20, 12).0[0] ^= 32;
        spoilt.save(w.path("f3.png")).unwrap();
        make("spoilt", 0..8, &[]);
        std::fs::copy(w.path("keep.png"), w.path("f3.png")).unwrap();
        let against =
            |name: &str, code| w.run(&["diff", &file("a"), &file(name)]).exits(code).text();
        assert!(against("a", 0).contains("same (0 of 8 pictures differ)"));
        assert!(against("slow", 1).contains(
            "frame 0: 0 of 384 pixels off by more than 0; shown for 0.040 s in A and 0.050 s in B"
        ));
        assert!(against("once", 1).contains("A plays without end, B once"));
        assert!(against("short", 1).contains("frame 7: only in A"));
        let text = against("spoilt", 1);
        assert!(
            text.contains("frame 3: 1 of 384 pixels off by more than 0, worst 32 at (20, 12)"),
            "{text}"
        );
        assert!(text.contains("(1 of 8 pictures differ)"), "{text}");
    }
    let run = w
        .run(&["diff", "a.gif", "spoilt.gif", "--json", "-"])
        .exits(1);
    let json: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!(
        (&json["schema"], &json["kind"]),
        (&"mechanim-diff/1".into(), &"GIF".into())
    );
    assert_eq!(
        (&json["worst"], &json["result"]),
        (&3.into(), &"different".into())
    );
    assert_eq!(
        json["frames"][3]["difference"]["worst_at"],
        serde_json::json!([20, 12])
    );
}

/// Every prefix and many flipped bytes: an error or some frames, and no more memory than the size allows.
#[test]
fn damaged_pictures_are_refused_in_order() {
    use mechanim::import::{FilmFrame, FilmReader, ImportError};
    let w = workspace();
    for out in ["a.gif", "a.apng", "f0.png"] {
        if out != "f0.png" {
            run(&w, "encode", &names(0..4), &["--out", out]).exits(0);
        }
        let whole = w.read(out);
        let frames = |bytes: &[u8]| {
            let path = w.write("damaged", bytes);
            let Ok(film) = FilmReader::open(&path) else {
                return None;
            };
            let read = |frame: FilmFrame| {
                let mut rows = frame.picture.rows()?;
                while rows.next_row()?.is_some() {}
                Ok::<_, ImportError>(())
            };
            film.take(20)
                .try_for_each(|frame| frame.and_then(read))
                .ok()
        };
        assert!(frames(&whole).is_some());
        let step = (whole.len() / 150).max(1);
        let mut refused = 0;
        for at in (0..whole.len()).step_by(step) {
            let mut flipped = whole.clone();
            flipped[at] ^= 1 << (at % 8);
            for damaged in [&whole[..at], &flipped] {
                refused += usize::from(frames(damaged).is_none());
            }
        }
        assert!(refused > 20, "{out}: only {refused} refused");
    }
    w.write("damaged", &w.read("f0.png")[..60]);
    let run = w.run(&["diff", "f0.png", "damaged"]).exits(2);
    run.prints_nothing().says(&["damaged"]);
}

/// A few bytes can ask for terabytes.
#[test]
#[cfg(target_os = "linux")]
fn a_huge_picture_is_refused_without_memory() {
    let w = workspace();
    let mut gif = b"GIF89a\xff\xff\xff\xff\x80\0\0\0\0\0\xff\xff\xff".to_vec();
    gif.extend(b"\x2c\0\0\0\0\x01\0\x01\0\0\x02\x02\x44\x01\0\x3b");
    w.write("huge.gif", gif);
    let line = "ulimit -v 3000000; exec \"$0\" diff huge.gif huge.gif";
    let program = w.command::<&str>(&[]).get_program().to_owned();
    let mut command = std::process::Command::new("sh");
    command
        .args(["-c", line])
        .arg(program)
        .current_dir(w.path(""));
    command.stderr(std::process::Stdio::piped());
    finish(command.spawn().unwrap())
        .exits(2)
        .says(&["huge.gif"]);
}

#[test]
fn folders_are_compared_file_by_file() {
    let w = workspace();
    for folder in ["a", "b"] {
        std::fs::create_dir(w.path(folder)).unwrap();
        for name in names(0..5) {
            std::fs::copy(w.path(&name), w.path(&format!("{folder}/{name}"))).unwrap();
        }
    }
    w.run(&["diff", "a", "b"]).exits(0);
    std::fs::remove_file(w.path("b/f2.png")).unwrap();
    frame(9).save(w.path("b/f4.png")).unwrap();
    let text = w.run(&["diff", "a", "b", "--out", "t.png"]).exits(1).text();
    assert!(
        text.contains("f2.png: only in A") && text.contains("f4.png: 50 of 384"),
        "{text}"
    );
    let triptych = image::open(w.path("t.png")).unwrap().to_rgba8();
    assert_eq!(triptych.get_pixel(4, 4), frame(4).get_pixel(4, 4));
}

const LIST: &str = r##"[[picture]]
file = "start.png"
scene = "moving.toml"
size = [40, 30]

[[picture]]
file = "later.png"
scene = "moving.toml"
size = [40, 30]
time = 0.3
inputs = { phi = "3*t" }
view = { azimuth = 10, projection = "orthographic", captions = false, ground = false, background = "#102030" }
"##;

#[test]
fn snapshots_are_written_once_and_kept_to() {
    let w = workspace();
    std::fs::create_dir(w.path("shots")).unwrap();
    w.write("shots/snapshots.toml", LIST);
    w.write("shots/moving.toml", moving());
    let snapshot = |more: &[&str]| w.run(&[&["snapshot", "shots"], more].concat());
    let text = snapshot(&[]).exits(1).text();
    assert!(
        text.contains("failed   start.png: the golden picture is missing"),
        "{text}"
    );
    assert!(w.path("shots/start.new.png").exists() && !w.path("shots/start.png").exists());
    assert!(
        snapshot(&["--update=new"])
            .exits(0)
            .text()
            .contains("written  later.png")
    );
    let text = snapshot(&[]).exits(0).text();
    assert!(
        text.contains("passed   start.png") && text.contains("0 of 2 pictures failed"),
        "{text}"
    );
    assert!(!w.path("shots/start.new.png").exists());
    let later = image::open(w.path("shots/later.png")).unwrap().to_rgb8();
    assert_eq!(later.get_pixel(0, 0).0, [0x10, 0x20, 0x30]);

    // A longer crank is another picture.
    w.write(
        "shots/moving.toml",
        moving().replace("[40, 0, 0]", "[44, 0, 0]"),
    );
    let run = snapshot(&["--json", "-"]).exits(1);
    let json: Value = serde_json::from_str(&run.text()).unwrap();
    assert_eq!(
        (&json["schema"], &json["result"]),
        (&"mechanim-snapshot/1".into(), &"failed".into())
    );
    assert_eq!(json["pictures"][0]["verdict"], "failed");
    assert!(w.path("shots/start.diff.png").exists());
    snapshot(&["--update=new"]).exits(1);
    snapshot(&["--update", "--only", "start"]).exits(0);
    let text = snapshot(&[]).exits(1).text();
    assert!(
        text.contains("passed   start.png") && text.contains("failed   later.png"),
        "{text}"
    );
    snapshot(&["--update=all"]).exits(0);
    snapshot(&[]).exits(0);
    snapshot(&["--only", "nothing"])
        .exits(2)
        .says(&["no picture is called nothing", "start.png, later.png"]);
    std::fs::copy(w.path("f0.png"), w.path("shots/stray.png")).unwrap();
    snapshot(&[])
        .exits(0)
        .says(&["stray.png is not in snapshots.toml"]);
}

/// A list cuts and explodes as the options of `render` do.
#[test]
fn snapshots_show_sections_and_exploded_views() {
    let w = Workspace::new();
    let picture = |file: &str, view: &str| {
        format!(
            "[[picture]]\nfile = \"{file}\"\nscene = \"hooke-joint\"\nsize = [80, 60]\n{view}\n"
        )
    };
    let cut = "view = { section = { point = [0, 0, 5], normal = [0, 1, 1] } }";
    let list = [
        picture("cut.png", cut),
        picture("apart.png", "view = { explode = 0.7 }"),
        picture("whole.png", ""),
    ];
    w.write("snapshots.toml", list.concat());
    w.run(&["snapshot", ".", "--update=new"]).exits(0);
    let still = ["render", "hooke-joint", "--frame", "0", "--size", "80x60"];
    for (file, options) in [
        ("cut.png", &["--section", "0,0,5/0,1,1"][..]),
        ("apart.png", &["--explode", "0.7"]),
        ("whole.png", &[]),
    ] {
        let more = [
            "--supersample",
            "4",
            "--renderer",
            "cpu",
            "--out",
            "still.png",
        ];
        w.run(&[&still[..], options, &more].concat()).exits(0);
        let pixels = |name: &str| image::open(w.path(name)).unwrap().to_rgb8();
        assert_eq!(pixels(file), pixels("still.png"), "{file}");
        assert_eq!(file == "whole.png", pixels(file) == pixels("whole.png"));
    }
}

#[test]
fn snapshots_are_not_written_in_ci_nor_without_a_list() {
    let w = workspace();
    w.run(&["snapshot", "."])
        .exits(2)
        .says(&["cannot read ./snapshots.toml", "[[picture]]"]);
    w.write("snapshots.toml", LIST);
    let mut command = w.command(&["snapshot", "--update", "."]);
    let run = finish(command.env("CI", "true").spawn().unwrap());
    run.exits(2).says(&["--update is refused if CI is set"]);
    assert!(!w.path("start.png").exists());
    for (from, to, says) in [
        (
            "time = 0.3",
            "time = 3",
            "later.png: the motion lasts from 0 to 0.5 s, 3 is outside",
        ),
        (
            "time = 0.3",
            "frame = 9",
            "later.png: the motion has frames 0 to 4, 9 is outside",
        ),
        (
            "scene = \"moving.toml\"",
            "scene = \"gone.toml\"",
            "the scene `gone.toml` is neither a built-in one nor a file beside the list",
        ),
        ("time = 0.3", "tme = 0.3", "did you mean `time`?"),
        ("phi = \"3*t\"", "psi = \"3*t\"", "no input `psi`"),
    ] {
        w.write("snapshots.toml", LIST.replace(from, to));
        w.run(&["snapshot", "."])
            .exits(2)
            .prints_nothing()
            .says(&[says]);
    }
}

/// Coordinates of a text file are as exact as its bodies need, wherever they stand; binary files say what they cannot hold.
#[test]
fn solids_far_from_the_origin_keep_their_shape() {
    let w = Workspace::new();
    for (place, is_told) in [(0.0, false), (1e3, false), (1e7, true), (1e9, true)] {
        let ball = place + 20.0;
        let text = format!(
            "duration = 1\n[inputs]\nx = \"t\"\n[[bodies]]\nname = \"box\"\nframe = \"Ty(x)\"\n\
             shapes = [{{ box = {{ center = [{place:?}, 0, 0], size = [10, 2, 2] }} }}]\n[[bodies]]\nname = \"ball\"\n\
             shapes = [{{ sphere = {{ center = [{ball:?}, 0, 0], radius = 2 }} }}]\n"
        );
        w.write("far.toml", text);
        w.run(&["render", "far.toml", "--at", "0", "--out", "far.obj"])
            .exits(0);
        let obj = String::from_utf8(w.read("far.obj")).unwrap();
        let corners: Vec<Vec<f64>> = obj
            .lines()
            .filter_map(|line| line.strip_prefix("v "))
            .map(|line| {
                line.split(' ')
                    .map(|number| number.parse().unwrap())
                    .collect()
            })
            .collect();
        // Corners of the ball are on it, those of the box at its edges.
        let off = corners.iter().map(|c| {
            let [x, y, z] = [c[0] - ball, c[1], c[2]];
            match x.abs() < 5.0 {
                true => ((x * x + y * y + z * z).sqrt() - 2.0).abs(),
                false => ((c[0] - place).abs() - 5.0)
                    .abs()
                    .max((y.abs() - 1.0).abs()),
            }
        });
        let off = off.fold(0.0, f64::max);
        assert!(off < 1e-6, "{place}: {off}");
        for out in ["far.stl", "far.glb"] {
            let run = w
                .run(&["render", "far.toml", "--at", "0", "--out", out])
                .exits(0);
            let told = run.stderr.contains("single precision");
            assert_eq!(told, is_told, "{out} at {place}");
        }
    }
}

/// A mechanism looks the same wherever it stands: its bodies, its path, the signs of its joints, and its drawing.
#[test]
fn pictures_far_from_the_origin_are_those_at_the_origin() {
    let w = Workspace::new();
    for place in ["0, 0, 0", "500000, 5500000, 0", "3e7, 0, 0"] {
        let text = format!(
            "duration = 4\nunits = {{ length = \"m\", angle = \"deg\" }}\n[inputs]\nu = \"90*t\"\n\
             [chains]\nC = \"T({place}) Rz(u)\"\n[[bodies]]\nname = \"jib\"\nframe = \"C\"\n\
             shapes = [{{ box = {{ center = [5, 0, 8], size = [12, 1, 1] }} }}]\n\
             [[traces]]\nname = \"hook\"\nbody = \"jib\"\npoint = [10, 0, 8]\n[view]\nground = \"none\"\n"
        );
        w.write("crane.toml", text);
        let name = |what: &str| format!("{what}-{}.png", place.len());
        // The name of an angle in a drawing may stand at another place that is as good; a line has more pixels.
        for (verb, most, options) in [
            (
                "render",
                40,
                &["--at", "1", "--size", "300x200", "--joints"][..],
            ),
            ("draw", 120, &["--width", "500", "--at", "0.7"]),
        ] {
            let out = name(verb);
            let mut line = vec![verb, "crane.toml", "--out", &out];
            line.extend(options);
            w.run(&line).exits(0);
            let [own, near] = [out, format!("{verb}-7.png")].map(|file| {
                let bytes = w.read(&file);
                image::load_from_memory(&bytes).unwrap().into_rgb8()
            });
            assert_eq!(own.dimensions(), near.dimensions(), "{verb} {place}");
            let pairs = own.pixels().zip(near.pixels());
            let differs = pairs.filter(|(a, b)| (0..3).any(|k| a[k].abs_diff(b[k]) > 40));
            let count = differs.count();
            assert!(count < most, "{verb} at {place}: {count} pixels differ");
        }
    }
}
