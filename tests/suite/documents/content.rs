//! The documents say what the program does: every scene key, every exit code, every verb.

use crate::driven::solve;

fn read(path: &str) -> String {
    std::fs::read_to_string(format!("{}/{path}", env!("CARGO_MANIFEST_DIR"))).unwrap()
}

/// Verbs and long options, found in the argument tables as they are written there.
#[test]
fn every_verb_and_option_of_pictures_is_documented() {
    let documents = read("docs/commands.md") + &read("docs/formats.md");
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
fn every_exit_code_is_in_one_table() {
    let [commands, readme] = ["docs/commands.md", "README.md"].map(read);
    for code in ["0", "1", "2", "3", "4", "70", "130"] {
        let row = format!("\n| {code} | ");
        assert_eq!(commands.matches(&row).count(), 1, "exit code {code}");
    }
    assert!(readme.contains("(docs/commands.md#exit-codes)"));
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
    let scene = mechanim::scene::load_scene(&source, &Default::default())
        .unwrap_or_else(|e| panic!("{:#?}", e.diagnostics));
    let trajectory = solve(&scene, &[0.0, 1.0]).unwrap();
    assert_eq!(trajectory.missing(), 0);
}

/// Files, folders and types that a document names in backticks, and that are not there.
fn unknown_names(text: &str, files: &[String], code: &str) -> Vec<String> {
    let is_file = |name: &str| {
        let ends = [".rs", ".toml", ".py", ".wgsl", ".json"];
        name.contains('/') && ends.iter().any(|end| name.ends_with(end))
    };
    let is_type = |name: &str| {
        name.starts_with(|c: char| c.is_ascii_uppercase())
            && name.chars().all(|c| c.is_ascii_alphanumeric() || c == ':')
            && name.contains(|c: char| c.is_ascii_lowercase())
    };
    let names = text.split('`').skip(1).step_by(2);
    let missing = names.filter(|name| {
        if is_file(name) {
            !files.iter().any(|file| file.ends_with(name))
        } else if is_type(name) {
            name.split("::").any(|part| !code.contains(part))
        } else {
            false
        }
    });
    missing.map(str::to_owned).collect()
}

fn all_files(folder: &std::path::Path, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            all_files(&path, found);
        } else {
            found.push(path.to_str().unwrap().replace('\\', "/"));
        }
    }
}

#[test]
fn files_and_types_of_the_architecture_exist() {
    let (mut files, mut code) = (Vec::new(), String::new());
    for folder in [
        "src", "shaders", "tests", "docs", "bindings", "benches", "examples",
    ] {
        all_files(std::path::Path::new(folder), &mut files);
    }
    for file in crate::house::source::sources() {
        code.push_str(&file.text);
    }
    // A type of another library.
    code.push_str("Bvh");
    for name in ["ARCHITECTURE.md", "CONTRIBUTING.md"] {
        let text = read(name);
        let outside: String = text.split("```").step_by(2).collect();
        let unknown = unknown_names(&outside, &files, &code);
        assert!(unknown.is_empty(), "{name}: {unknown:?}");
        assert!(outside.matches('`').count() > 5, "{name}");
    }
    let planted = "`scene/nowhere.rs`, `src/lib.rs`, `Planted` and `System::new`";
    let unknown = unknown_names(planted, &files, "System new");
    assert_eq!(unknown, ["scene/nowhere.rs", "Planted"]);
}

/// What a block may be called: what is run, what is printed, files, other languages, and what is neither.
const LABELS: [&str; 8] = [
    "sh",
    "console",
    "toml",
    "text",
    "yaml",
    "rust,no_run",
    "python",
    "json",
];

#[test]
fn every_block_has_a_label() {
    let mut count = 0;
    for document in super::text::all_documents() {
        for block in document.blocks() {
            count += 1;
            let place = format!("{}:{}", document.name, block.line);
            assert!(
                LABELS.contains(&block.language.as_str()),
                "{place}: `{}`",
                block.language
            );
        }
    }
    assert!(count > 60, "{count}");
}

#[test]
fn links_in_the_documents_lead_somewhere() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_dir(root.join("docs")).unwrap();
    let mut paths: Vec<_> = docs.map(|entry| entry.unwrap().path()).collect();
    paths.extend(["README.md", "ARCHITECTURE.md", "CONTRIBUTING.md"].map(|name| root.join(name)));
    let (mut links, mut dead) = (0, Vec::new());
    for path in paths
        .iter()
        .filter(|p| p.extension().is_some_and(|e| e == "md"))
    {
        for link in std::fs::read_to_string(path).unwrap().split("](").skip(1) {
            let target = link.split(')').next().unwrap().split('#').next().unwrap();
            if target.starts_with("http") || target.is_empty() {
                continue;
            }
            links += 1;
            if !path.with_file_name("").join(target).exists() {
                dead.push(format!("{} links to {target}", path.display()));
            }
        }
    }
    assert!(dead.is_empty(), "{}", dead.join("\n"));
    assert!(links > 60, "{links}");
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
    use mechanim::kinematics::results::certificate::{ProofObstacle, Reason};
    let document = read("docs/certificates.md");
    let tests = [
        Reason::Formula,
        Reason::Singular,
        Reason::HalfTurn,
        Reason::GimbalLock,
        Reason::Open,
        Reason::NotAsked,
    ];
    let obstacles = [
        ProofObstacle::NoPose,
        ProofObstacle::Drive,
        ProofObstacle::NotJoined,
    ];
    let words = tests.map(ProofObstacle::Test).into_iter().chain(obstacles);
    for word in words.map(ProofObstacle::word) {
        assert!(document.contains(&format!("| `{word}` |")), "{word}");
    }
}
