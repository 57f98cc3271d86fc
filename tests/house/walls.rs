//! Which room may speak to which library, how large files get, that each says what it holds.

use crate::source::{is_test, sources};

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
        for word in wall.words.iter().filter(|word| code.contains(**word)) {
            if !may && !is_test(name) {
                faults.push(format!("{name}: `{word}` belongs to {:?}", wall.rooms));
            }
        }
    }
    if !text.starts_with("//!") {
        faults.push(format!("{name}: does not open with what it holds"));
    }
    let lines = before_tests(text).lines().count();
    if lines > MOST_LINES && !is_test(name) {
        faults.push(format!("{name}: {lines} lines"));
    }
    faults
}

#[test]
fn every_file_keeps_to_its_room() {
    let files = sources();
    let all: Vec<String> = files
        .iter()
        .flat_map(|s| faults(&s.name, &s.text))
        .collect();
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
