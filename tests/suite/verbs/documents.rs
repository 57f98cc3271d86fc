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
