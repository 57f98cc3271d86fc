//! Which room may speak to which library, how large files get, that each says what it holds.

use std::path::Path;

use super::source::{bare, before_tests, is_test, sources, with_strings};

/// Words that only some files under `src/` may hold.
struct Wall {
    words: &'static [&'static str],
    rooms: &'static [&'static str],
}

const WALLS: [Wall; 26] = [
    Wall {
        words: &["nix::"],
        rooms: &["cli/program.rs"],
    },
    Wall {
        words: &["wgpu::", "pollster::", "bytemuck::"],
        rooms: &["render/gpu/", "render/adapter.rs"],
    },
    Wall {
        words: &["ab_glyph::"],
        rooms: &["render/text/"],
    },
    Wall {
        words: &["wide::"],
        rooms: &[
            "render/cpu/",
            "render/mutual_shade/",
            "linalg/",
            "numbers/",
            "kinematics/",
        ],
    },
    Wall {
        words: &["pulp::"],
        rooms: &["numbers/lists.rs"],
    },
    Wall {
        words: &["parry3d_f64::"],
        rooms: &["geometry/"],
    },
    Wall {
        words: &["nalgebra::"],
        rooms: &["linalg/", "analysis/optimise/"],
    },
    Wall {
        words: &["Encoder::new", "PngEncoder", "GifEncoder", "stl_io::"],
        rooms: &["export/"],
    },
    Wall {
        words: &["tempfile::"],
        rooms: &["export/"],
    },
    Wall {
        words: &["use gif::"],
        rooms: &["export/"],
    },
    Wall {
        words: &["use png::"],
        rooms: &["export/", "import/"],
    },
    Wall {
        words: &["image::codecs"],
        rooms: &["export/", "import/"],
    },
    Wall {
        words: &["ab_glyph_rasterizer::"],
        rooms: &["plot/"],
    },
    Wall {
        words: &["toml::"],
        rooms: &["scene/", "snapshot/"],
    },
    Wall {
        words: &["strsim::"],
        rooms: &["diag/"],
    },
    Wall {
        words: &["serde_json::"],
        rooms: &["report/", "export/", "page/", "parts/", "sweep/", "cli/"],
    },
    Wall {
        words: &["sha2::"],
        rooms: &["parts/", "page/"],
    },
    Wall {
        words: &["base64::", "lzma_rust2::"],
        rooms: &["page/"],
    },
    Wall {
        words: &["clap::", "clap_complete::", "clap_mangen::"],
        rooms: &["cli/"],
    },
    Wall {
        words: &["codespan_reporting::"],
        rooms: &["cli/term/"],
    },
    Wall {
        words: &["ctrlc::"],
        rooms: &["cli/program.rs"],
    },
    // Functions of the platform differ in the last digit from machine to machine; those of `libm` do not.
    Wall {
        words: &[
            ".powf(", ".log10(", ".log2(", ".cbrt(", ".exp2(", ".sinh(", ".cosh(", ".tanh(",
        ],
        rooms: &[],
    },
    // Number types have some of their names.
    Wall {
        words: &[
            ".hypot(",
            ".sin()",
            ".cos()",
            ".tan()",
            ".asin()",
            ".acos()",
            ".atan()",
            ".atan2(",
            ".sin_cos()",
            ".exp()",
            ".ln()",
        ],
        rooms: &[
            "numbers/",
            "model/function.rs",
            "model/chain.rs",
            "model/expression/pieces.rs",
            "intervals/",
            "kinematics/abreast/block_values.rs",
            "kinematics/certificate/tube/",
            "analysis/enclosure/",
        ],
    },
    // One copy of the machine code sorts them all.
    Wall {
        words: &[".sort_by(|", ".sort_by_key(|"],
        rooms: &["sorting.rs"],
    },
    // The library does not print.
    Wall {
        words: &["println!", "print!", "dbg!", "io::stdout", "io::stderr"],
        rooms: &["cli/", "main.rs"],
    },
    Wall {
        words: &["process::exit", "process::abort"],
        rooms: &["main.rs", "cli/program.rs"],
    },
];

/// Rooms that prove: the constants of rounding that they use stand in one file, derived there.
const PROVING: [&str; 7] = [
    "intervals/",
    "clearance/",
    "kinematics/certificate/",
    "kinematics/enclosure/",
    "kinematics/motion/continuation/fold_proof.rs",
    "kinematics/motion/continuation/domain_proof.rs",
    "analysis/enclosure/",
];

/// A constant of its own, in units of rounding.
fn is_own_rounding(line: &str) -> bool {
    let is_constant =
        line.contains("const ") && (line.contains("* U;") || line.contains("ROUNDING: f64"));
    is_constant || line.contains("EPSILON")
}

/// The one file that knows scenes by name: they are data.
const SCENE_LIST: &str = "scene/builtin.rs";

/// Most lines of a file, its tests not counted.
const MOST_LINES: usize = 450;

/// What is wrong with the file `name` (relative to `src/`, with `/`), where `scenes` are built in.
fn faults(name: &str, text: &str, scenes: &[String]) -> Vec<String> {
    let mut faults = Vec::new();
    if !text.starts_with("//!") {
        faults.push(format!("{name}: does not open with what it holds"));
    }
    if is_test(name) {
        return faults;
    }
    let code = bare(text);
    for wall in &WALLS {
        let may = wall.rooms.iter().any(|room| name.starts_with(room));
        for word in wall.words.iter().filter(|word| holds(&code, word) && !may) {
            faults.push(format!("{name}: `{word}` belongs to {:?}", wall.rooms));
        }
    }
    if PROVING.iter().any(|room| name.starts_with(room)) {
        let own = code.lines().filter(|line| is_own_rounding(line));
        faults.extend(own.map(|line| format!("{name}: belongs to numbers/rounding.rs: {line}")));
    }
    let code = with_strings(text);
    for scene in scenes.iter().filter(|_| name != SCENE_LIST) {
        if code.contains(&format!("\"{scene}")) {
            faults.push(format!("{name}: knows the scene `{scene}`"));
        }
    }
    let lines = before_tests(text).lines().count();
    if lines > MOST_LINES {
        faults.push(format!("{name}: {lines} lines"));
    }
    faults
}

/// Whether `word` stands in `code`, and not as the end of a longer name.
fn holds(code: &str, word: &str) -> bool {
    let is_part = |c: char| c.is_alphanumeric() || c == '_';
    code.match_indices(word).any(|(at, _)| {
        let before = code[..at].chars().next_back();
        // `println!` is also the end of `eprintln!`, an encoder's name may have a beginning, a method is called on a name.
        let may_follow = word.ends_with('!') || word.contains("Encoder") || word.starts_with('.');
        may_follow || !before.is_some_and(is_part)
    })
}

/// Names of the built-in scenes, from their files.
fn scene_names() -> Vec<String> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenes");
    let files = std::fs::read_dir(folder).unwrap();
    let paths = files.map(|entry| entry.unwrap().path());
    let scenes = paths.filter(|path| path.extension().is_some_and(|e| e == "toml"));
    scenes
        .map(|path| path.file_stem().unwrap().to_str().unwrap().to_owned())
        .collect()
}

#[test]
fn every_file_keeps_to_its_room() {
    let scenes = scene_names();
    assert!(scenes.len() > 20, "only {} scenes found", scenes.len());
    let files = sources();
    let all = files.iter().flat_map(|s| faults(&s.name, &s.text, &scenes));
    let all: Vec<String> = all.collect();
    assert!(all.is_empty(), "{}", all.join("\n"));
}

#[test]
fn a_planted_fault_is_found() {
    let scenes = scene_names();
    let count = |name: &str, line: &str| {
        let text = format!("//! Holds.\n{line}\n");
        faults(name, &text, &scenes).len()
    };
    assert_eq!(count("model/a.rs", "let x = 1;"), 0);
    for (line, room) in [
        ("use wgpu::Device;", "render/gpu/a.rs"),
        ("use ab_glyph::Font;", "render/text/a.rs"),
        ("use wide::f32x4;", "render/cpu/a.rs"),
        ("let d = parry3d_f64::query::distance();", "geometry/a.rs"),
        ("use nalgebra::DMatrix;", "linalg/a.rs"),
        ("let e = PngEncoder::new(w);", "export/a.rs"),
        (
            "let r = ab_glyph_rasterizer::Rasterizer::new(1, 1);",
            "plot/a.rs",
        ),
        ("use image::codecs::png::PngDecoder;", "import/a.rs"),
        ("fn f(t: &toml::de::DeTable) {}", "scene/a.rs"),
        ("use serde_json::json;", "cli/a.rs"),
        ("list.sort_by(|a, b| a.0.cmp(&b.0));", "sorting.rs"),
        ("use clap::Parser;", "cli/a.rs"),
        ("use codespan_reporting::term;", "cli/term/a.rs"),
        ("    println!(\"x\");", "cli/a.rs"),
        ("    eprintln!(\"x\");", "cli/a.rs"),
        ("std::process::exit(1)", "main.rs"),
        ("let s = angle.sin();", "numbers/a.rs"),
        ("if name == \"seven-r\" {}", SCENE_LIST),
        ("if name == \"lifting-arm\" {}", SCENE_LIST),
    ] {
        assert!(count("model/a.rs", line) > 0, "{line}");
        assert_eq!(count(room, line), 0, "{line}");
        assert_eq!(count("model/a.rs", &format!("// {line}")), 0, "{line}");
        let tests = format!("#[cfg(test)]\nmod tests {{\n{line}\n}}");
        assert_eq!(count("model/a.rs", &tests), 0, "{line}");
    }
    assert_eq!(count("numbers/a.rs", "let s = size.powf(0.5);"), 1);
    assert_eq!(count("numbers/a.rs", "let s = libm::pow(size, 0.5);"), 0);
    for line in [
        "const STEP_ROUNDING: f64 = 1e-15;",
        "const STEP: f64 = 3.0 * U;",
        "a * f64::EPSILON",
    ] {
        assert_eq!(count("clearance/a.rs", line), 1, "{line}");
        assert_eq!(count("numbers/rounding.rs", line), 0, "{line}");
    }
    assert_eq!(faults("a.rs", "fn a() {}\n", &scenes).len(), 1);
    let long = "//! Long.\n".to_owned() + &"\n".repeat(MOST_LINES);
    assert_eq!(faults("a.rs", &long, &scenes).len(), 1);
}
