//! The walls of the house: which room may speak to which library, how large files get, that each says what it holds.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

use std::path::{Path, PathBuf};

/// A text that only some files under `src/` may hold.
struct Wall {
    words: &'static [&'static str],
    rooms: &'static [&'static str],
}

const WALLS: [Wall; 8] = [
    Wall {
        words: &["wgpu::"],
        rooms: &["render/"],
    },
    Wall {
        words: &["parry3d_f64"],
        rooms: &["geometry/", "clearance/"],
    },
    Wall {
        words: &["Encoder::new", "PngEncoder", "GifEncoder", "stl_io::write"],
        rooms: &["export/"],
    },
    Wall {
        words: &["tiny_skia::"],
        rooms: &["plot/"],
    },
    Wall {
        words: &["image::codecs"],
        rooms: &["export/", "import/"],
    },
    Wall {
        words: &["clap::", "clap_complete::"],
        rooms: &["cli/"],
    },
    Wall {
        words: &[
            "println!",
            "print!",
            "io::stdout",
            "io::stderr",
            "process::exit",
        ],
        rooms: &["cli/", "main.rs"],
    },
    // Nothing in the program knows a scene: they are data.
    Wall {
        words: &[
            "\"gearshift",
            "\"seven-r\"",
            "\"slider-crank\"",
            "\"dyads\"",
        ],
        rooms: &["scene/builtin.rs"],
    },
];

/// Most lines of a file, its tests not counted.
const MOST_LINES: usize = 450;

/// The code of a file: without comments and tests.
fn code(text: &str) -> String {
    let lines = before_tests(text).lines();
    let lines = lines.filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// The text without its test module, which ends every file.
fn before_tests(text: &str) -> &str {
    let end = text.find("#[cfg(test)]\nmod tests {");
    &text[..end.unwrap_or(text.len())]
}

/// What is wrong with the file `name` (relative to `src/`, with `/`).
fn faults(name: &str, text: &str) -> Vec<String> {
    let mut faults = Vec::new();
    let code = code(text);
    for wall in &WALLS {
        let may = wall.rooms.iter().any(|room| name.starts_with(room));
        let is_test = name.ends_with("tests.rs");
        for word in wall.words.iter().filter(|word| code.contains(**word)) {
            if !may && !is_test {
                faults.push(format!("{name}: `{word}` belongs to {:?}", wall.rooms));
            }
        }
    }
    if !text.starts_with("//!") {
        faults.push(format!("{name}: does not open with what it holds"));
    }
    let lines = before_tests(text).lines().count();
    if lines > MOST_LINES && !name.ends_with("tests.rs") {
        faults.push(format!("{name}: {lines} lines"));
    }
    faults
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

#[test]
fn every_file_keeps_to_its_room() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    assert!(files.len() > 50, "only {} files found", files.len());
    let mut all = Vec::new();
    for path in files {
        let name = path.strip_prefix(&root).unwrap().to_str().unwrap();
        let name = name.replace('\\', "/");
        all.extend(faults(&name, &std::fs::read_to_string(&path).unwrap()));
    }
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn a_planted_fault_is_found() {
    let count = |name: &str, line: &str| faults(name, &format!("//! Holds.\n{line}\n")).len();
    assert_eq!(count("model/a.rs", "let x = 1;"), 0);
    for (line, room) in [
        ("use wgpu::Device;", "render/gpu/a.rs"),
        ("let d = parry3d_f64::query::distance();", "clearance/a.rs"),
        ("let e = PngEncoder::new(w);", "export/a.rs"),
        ("let p = tiny_skia::Paint::default();", "plot/a.rs"),
        ("use image::codecs::png::PngDecoder;", "import/a.rs"),
        ("use clap::Parser;", "cli/a.rs"),
        ("    println!(\"x\");", "cli/a.rs"),
        ("std::process::exit(1)", "main.rs"),
        ("if name == \"seven-r\" {}", "scene/builtin.rs"),
    ] {
        assert!(count("model/a.rs", line) > 0, "{line}");
        assert_eq!(count(room, line), 0, "{line}");
        assert_eq!(count("model/a.rs", &format!("// {line}")), 0, "{line}");
        let tests = format!("#[cfg(test)]\nmod tests {{\n{line}\n}}");
        assert_eq!(count("model/a.rs", &tests), 0, "{line}");
    }
    assert_eq!(faults("a.rs", "fn a() {}\n").len(), 1);
    let long = "//! Long.\n".to_owned() + &"\n".repeat(MOST_LINES);
    assert_eq!(faults("a.rs", &long).len(), 1);
}

/// Which version of glam each of `packages` speaks: the entries of its dependency list in a lock file.
fn glam_of(lock: &str, packages: &[&str]) -> Vec<String> {
    let entries = lock.split("[[package]]");
    let wanted = entries.filter(|entry| {
        let name = entry.lines().find_map(|l| l.strip_prefix("name = "));
        name.is_some_and(|name| packages.contains(&name.trim_matches('"')))
    });
    let lines = wanted
        .flat_map(str::lines)
        .map(|l| l.trim().trim_matches(['"', ',']));
    let mut list: Vec<String> = lines
        .filter(|l| *l == "glam" || l.starts_with("glam "))
        .map(str::to_owned)
        .collect();
    list.sort();
    list
}

#[test]
fn one_glam_is_spoken() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.lock");
    let lock = std::fs::read_to_string(path).unwrap();
    let mut spoken = glam_of(&lock, &["mechanim", "parry3d-f64", "glamx"]);
    assert!(
        spoken.len() > 1,
        "the lock file is not understood: {spoken:?}"
    );
    spoken.dedup();
    assert_eq!(spoken.len(), 1, "{spoken:?}");
    let two =
        "[[package]]\nname = \"a\"\n \"glam 0.1\",\n[[package]]\nname = \"b\"\n \"glam 0.2\",\n";
    assert_eq!(glam_of(two, &["a", "b"]), ["glam 0.1", "glam 0.2"]);
}
