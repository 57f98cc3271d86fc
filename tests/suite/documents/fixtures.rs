//! What the commands of the documents need and the reader has: a scene, two versions of one, pictures, tables.

use crate::program::Workspace;

/// What stands for SCENE and `scene.toml`: a mechanism with everything that the commands ask for, in few frames.
pub const SCENE: &str = r##"title = "Stand-in"
units = { length = "mm", angle = "deg" }
duration = 2
[parameters]
r = 40
L4 = 880
[inputs]
u = "30*t"
v = "40*t - 40"
[chains]
T14 = "Rz(u) Tx(r)"
arm = "Ty(2000) Rz(v)"
[loops]
A = "T14 Rz(a) Tx(L4) Rz(b) Tx(-h)"
[guess]
h = 900
[measures]
stroke = { of = "h", take = "range" }
[study]
minimise = "stroke"
variables = { r = { range = [30, 50] } }
[[bodies]]
name = "crank"
frame = "Rz(u)"
shapes = [{ capsule = { from = [0, 0, 0], to = [40, 0, 0], radius = 5 } }]
[[bodies]]
name = "arm"
frame = "arm"
shapes = [{ capsule = { from = [0, 0, 0], to = [500, 0, 0], radius = 5 } }]
[[traces]]
name = "M"
body = "arm"
point = [500, 0, 0]
[clearance]
minimum = 1
[view]
fps = 2
[[plots]]
x = "u"
y = ["h"]
"##;

/// Points of the curve of the four-bar's coupler point, from its table.
const PATH: &str = "time,K.x,K.y
0,26.18473544604218,66.68801324708764
0.8,32.813278184563885,96.85664006290261
1.6,-4.083010591150519,83.32423171353982
2.4,-24.12677190711207,46.56508957501732
";

/// Writes all of it.
pub fn write_files(workspace: &Workspace) {
    for folder in ["designs", "scenes", "frames", "golden", "pages"] {
        std::fs::create_dir(workspace.path(folder)).unwrap();
    }
    let linkage = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/dyads-bars.toml");
    std::fs::copy(linkage, workspace.path("dyads-bars.toml")).unwrap();
    for name in [
        "scene.toml",
        "old.toml",
        "designs/one.toml",
        "designs/two.toml",
        "scenes/own.toml",
    ] {
        workspace.write(name, SCENE);
    }
    workspace.write("new.toml", SCENE.replace("r = 40", "r = 41"));
    workspace.write("table.csv", "time,u,v\n0,0,-40\n1,30,0\n2,60,40\n");
    workspace.write("path.csv", PATH);
    write_encoder(workspace);
    let picture = ["render", "scene.toml", "--size", "64x48", "-q", "--out"];
    for (name, at) in [
        ("frames/f1.png", "0"),
        ("frames/f2.png", "1"),
        ("A.png", "0"),
        ("B.png", "0"),
    ] {
        let arguments = [&picture[..], &[name, "--at", at]].concat();
        workspace.run(&arguments).exits(0);
    }
    workspace.write(
        "golden/snapshots.toml",
        "[[picture]]\nfile = \"a.png\"\nscene = \"slider-crank\"\nsize = [64, 48]\n",
    );
    let golden = workspace.run(&["snapshot", "golden", "--update=new", "-q"]);
    golden.exits(0);
}

/// A program called `ffmpeg` in the folder `bin` that keeps what it reads; real ones are asked in `pictures/videos.rs`.
#[cfg(unix)]
fn write_encoder(workspace: &Workspace) {
    use std::os::unix::fs::PermissionsExt;
    std::fs::create_dir(workspace.path("bin")).unwrap();
    let script = "#!/bin/sh\nfor last; do :; done\ncat > \"${last#file:}\"\n";
    let program = workspace.write("bin/ffmpeg", script);
    std::fs::set_permissions(program, PermissionsExt::from_mode(0o755)).unwrap();
}

#[cfg(not(unix))]
fn write_encoder(_: &Workspace) {}

/// A command with what the reader puts in place of the words in capitals; `number` tells folders apart. `None` if the words
/// stand for anything.
pub fn filled(command: &str, number: usize) -> Option<String> {
    let folder = match command {
        _ if command.contains("snapshot DIR") => "golden".to_owned(),
        _ if command.contains("manual DIR") => "pages".to_owned(),
        _ => format!("folder-{number}"),
    };
    let text = command
        .replace("SCENES", "SCENE")
        .replace("SCENE", "scene.toml")
        .replace("DIR", &folder)
        .replace("FILE.stl", "file.stl")
        .replace("--body NAME", "--body crank")
        .replace("OTHER", "arm");
    let is_placeholder =
        |word: &str| word.len() > 2 && word.chars().all(|c| c.is_ascii_uppercase());
    let text = text.replace(['[', ']'], "");
    let is_whole = !super::text::words(&text).iter().any(|w| is_placeholder(w));
    is_whole.then_some(text)
}
