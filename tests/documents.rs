//! The documents say what the program does: every scene key, every exit code, every verb.
#![allow(clippy::unwrap_used, clippy::expect_used, clippy::panic)]

mod driven;

use driven::solve;
use std::collections::BTreeSet;

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Keys that a reader asks for: the first text argument of its reading functions.
fn keys_of_the_reader(files: &[&str]) -> BTreeSet<String> {
    let source: String = files.iter().map(|file| read(file)).collect();
    let readers = [
        "string",
        "strings",
        "formula",
        "formulas",
        "boolean",
        "colour",
        "vector",
        "rows",
        "rows::<3>",
        "rows::<2>",
        "rows::<4>",
        "vector::<2>",
        "table",
        "tables",
        "named",
        "named_formulas",
    ];
    let mut keys = BTreeSet::new();
    for reader in readers {
        for part in source.split(&format!(".{reader}(")).skip(1) {
            if let Some(rest) = part.trim_start().strip_prefix('"') {
                keys.insert(rest.split('"').next().unwrap().to_owned());
            }
        }
    }
    for part in source.split("required(").skip(1) {
        if let Some(key) = part.split('"').nth(1).filter(|_| !part.starts_with('\n')) {
            keys.insert(key.to_owned());
        }
    }
    keys
}

#[test]
fn every_scene_key_is_documented() {
    let document = read("docs/scene-format.md");
    let keys = keys_of_the_reader(&[
        "src/scene/file.rs",
        "src/scene/views.rs",
        "src/scene/plots.rs",
        "src/scene/studies.rs",
        "src/scene/measures.rs",
    ]);
    assert!(keys.len() > 40, "the search found too few keys: {keys:?}");
    let missing: Vec<_> = keys
        .iter()
        .filter(|key| {
            !["`{}`", "`[{}]`", "`[[{}]]`", "{} ="]
                .iter()
                .any(|form| document.contains(&form.replace("{}", key)))
        })
        .collect();
    assert!(
        missing.is_empty(),
        "not in docs/scene-format.md: {missing:?}"
    );
}

#[test]
fn every_key_of_a_list_of_snapshots_is_documented() {
    let document = read("docs/formats.md");
    let mut keys = keys_of_the_reader(&["src/snapshot/manifest.rs"]);
    // These are asked for through functions of the reader's own.
    let more = [
        "samples",
        "frame",
        "tolerance",
        "pixels",
        "parameters",
        "inputs",
        "guess",
    ];
    let source = read("src/snapshot/manifest.rs");
    for key in more.into_iter().chain(["azimuth", "elevation", "fov"]) {
        assert!(source.contains(&format!("\"{key}\"")), "{key}");
        keys.insert(key.to_owned());
    }
    assert!(keys.len() > 15, "the search found too few keys: {keys:?}");
    let missing: Vec<_> = keys
        .iter()
        .filter(|key| !document.contains(&format!("`{key}`")))
        .collect();
    assert!(missing.is_empty(), "not in docs/formats.md: {missing:?}");
}

/// Verbs and long options, found in the argument tables as they are written there.
#[test]
fn every_verb_and_option_of_pictures_is_documented() {
    let documents = read("README.md") + &read("docs/formats.md");
    for verb in ["render", "encode", "diff", "snapshot"] {
        assert!(documents.contains(&format!("mechanim {verb}")), "{verb}");
    }
    let source = read("src/cli/args/files.rs");
    let mut options = 0;
    for part in source.split("#[arg(").skip(1) {
        let (attributes, rest) = part.split_once(")]\n").unwrap();
        if !attributes.contains("long") {
            continue;
        }
        let named = attributes
            .split("long = \"")
            .nth(1)
            .and_then(|t| t.split('"').next());
        let field = rest
            .split("pub ")
            .nth(1)
            .unwrap()
            .split(':')
            .next()
            .unwrap();
        let option = named.map_or(field.replace('_', "-"), str::to_owned);
        assert!(
            documents.contains(&format!("--{option}")),
            "--{option} is not documented"
        );
        options += 1;
    }
    assert!(options > 15, "the search found only {options} options");
}

#[test]
fn every_exit_code_is_in_the_readme() {
    let readme = read("README.md");
    for code in ["0", "1", "2", "3", "4", "70", "130"] {
        assert!(readme.contains(&format!("| {code} |")), "exit code {code}");
    }
}

#[test]
fn the_scene_of_the_readme_works() {
    let readme = read("README.md");
    let text = readme
        .split("```toml\n")
        .nth(1)
        .unwrap()
        .split("```")
        .next()
        .unwrap();
    let source = mechanim::diag::Source {
        name: "README".into(),
        text: text.into(),
    };
    let scene = mechanim::scene::load(&source, &Default::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let trajectory = solve(&scene, &[0.0, 1.0]).unwrap();
    assert_eq!(trajectory.missing(), 0);
}

#[test]
fn pictures_in_the_documents_exist() {
    for document in [
        "README.md",
        "docs/performance.md",
        "docs/accuracy.md",
        "docs/formats.md",
        "docs/certificates.md",
        "ARCHITECTURE.md",
    ] {
        for link in read(document).split("](").skip(1) {
            let target = link.split(')').next().unwrap();
            if target.starts_with("http") {
                continue;
            }
            let base = if document.starts_with("docs/") {
                "docs/"
            } else {
                ""
            };
            let path = format!("{}/{base}{target}", env!("CARGO_MANIFEST_DIR"));
            assert!(
                std::path::Path::new(&path).exists(),
                "{document} links to {target}"
            );
        }
    }
}

#[test]
fn the_gallery_shows_every_scene() {
    let gallery = read("docs/gallery.md");
    for scene in mechanim::scene::builtin::ALL {
        let name = scene.name;
        assert!(
            gallery.contains(&format!("](gallery/{name}.png)")),
            "{name}"
        );
        assert!(
            gallery.contains(&format!("{name}:")),
            "{name} is not in the command"
        );
        let path = format!("{}/docs/gallery/{name}.png", env!("CARGO_MANIFEST_DIR"));
        let picture = image::open(&path).unwrap_or_else(|e| panic!("{path}: {e}"));
        assert_eq!((picture.width(), picture.height()), (320, 240), "{name}");
    }
}

#[test]
fn every_reason_of_a_refusal_is_documented() {
    use mechanim::kinematics::results::certificate::{Obstacle, Reason};
    let document = read("docs/certificates.md");
    let tests = [
        Reason::Formula,
        Reason::Singular,
        Reason::HalfTurn,
        Reason::GimbalLock,
        Reason::Open,
        Reason::NotAsked,
    ];
    let obstacles = [Obstacle::NoPose, Obstacle::Drive, Obstacle::NotJoined];
    let words = tests.map(Obstacle::Test).into_iter().chain(obstacles);
    for word in words.map(Obstacle::word) {
        assert!(document.contains(&format!("| `{word}` |")), "{word}");
    }
}
