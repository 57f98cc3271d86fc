//! The schemas for editors: committed ones are those that the program prints, scenes fit them, and of faulty scenes they see
//! exactly the mistakes of form.

use super::json_schema::{faults, parse, read};
use mechanim::report::schema::keys_schema;
use mechanim::scene::keys::Keys;
use mechanim::scene::keys::tables::SCENE;
use mechanim::snapshot::keys::LIST;
use serde_json::json;
use std::path::PathBuf;

fn root() -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR"))
}

fn files(folder: &str) -> Vec<PathBuf> {
    let mut list: Vec<PathBuf> = std::fs::read_dir(root().join(folder))
        .unwrap()
        .map(|entry| entry.unwrap().path())
        .filter(|path| path.extension().is_some_and(|e| e == "toml"))
        .collect();
    list.sort();
    list
}

#[test]
fn committed_schemas_are_those_of_the_program() {
    let both: [(&str, &'static Keys, &str); 2] = [
        ("scene", &SCENE, "Scene of mechanim"),
        ("snapshots", &LIST, "List of golden pictures of mechanim"),
    ];
    for (name, keys, title) in both {
        let path = root().join(format!("docs/schema/{name}.json"));
        let printed = format!("{:#}\n", keys_schema(keys, title));
        if std::env::var_os("MECHANIM_BLESS").is_some() {
            std::fs::write(&path, &printed).unwrap();
        }
        let committed = std::fs::read_to_string(&path).unwrap();
        assert_eq!(
            committed, printed,
            "run `mechanim schema {name} > docs/schema/{name}.json`"
        );
    }
}

#[test]
fn all_scenes_fit_the_schema() {
    let schema = keys_schema(&SCENE, "Scene");
    let mut seen = 0;
    for folder in ["scenes", "tests/hard"] {
        for path in files(folder) {
            let scene = read(&path).expect("a scene");
            let found = faults(&schema, &schema, &scene, "");
            assert!(found.is_empty(), "{}: {found:#?}", path.display());
            seen += 1;
        }
    }
    assert!(seen > 30, "{seen}");
    let goldens = read(&root().join("tests/golden/snapshots.toml")).expect("a list");
    let list = mechanim::report::schema::keys_schema(&LIST, "List");
    assert_eq!(faults(&list, &list, &goldens, ""), Vec::<String>::new());
}

/// Every fault that the schema sees in a scene of `tests/bad` stands there after `#! schema`, and only these: keys that are
/// unknown, missing or together where they exclude each other, types, counts and words. All other mistakes are in formulas,
/// names, ranges and dimensions, which only the program sees.
#[test]
fn the_schema_sees_every_mistake_of_form() {
    let schema = keys_schema(&SCENE, "Scene");
    let (mut wrong, mut seen) = (Vec::new(), 0);
    for path in files("tests/bad") {
        let text = std::fs::read_to_string(&path).unwrap();
        let stated = text.lines().filter_map(|l| l.strip_prefix("#! schema "));
        let mut stated: Vec<String> = stated.map(str::to_owned).collect();
        // What is no TOML is no matter of a schema.
        let scene = read(&path).unwrap_or_else(|| json!({}));
        let mut found = faults(&schema, &schema, &scene, "");
        stated.sort();
        found.sort();
        seen += found.len();
        let name = path.display();
        let is_in = |list: &[String], fault: &String| list.contains(fault);
        let unseen = stated.iter().filter(|fault| !is_in(&found, fault));
        wrong.extend(unseen.map(|fault| format!("{name}: not seen: {fault}")));
        let unstated = found.iter().filter(|fault| !is_in(&stated, fault));
        wrong.extend(unstated.map(|fault| format!("{name}: seen: #! schema {fault}")));
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
    assert!(seen > 40, "{seen}");
}

/// Planted faults of every kind are refused by the schema and by the program.
#[test]
fn what_the_schema_refuses_the_reader_refuses() {
    let schema = keys_schema(&SCENE, "Scene");
    for planted in [
        "duration = true",
        "titel = \"a\"",
        "[units]\nangle = \"grad\"",
        "[loops]\nA = 3",
        "[[bodies]]\nshapes = []",
        "[[bodies]]\nname = \"a\"\nframe = 1",
        "[[bodies]]\nname = \"a\"\ncolour = \"red\"",
        "[[bodies]]\nname = \"a\"\nshapes = [{ sphere = { radius = 1 }, box = { size = [1, 1, 1] } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ sphere = { radius = 1, size = 2 } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ box = { size = [1, 1] } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ tube = { points = [], radius = 1 } }]",
        "[[bodies]]\nname = \"a\"\nshapes = [{ lathe = { profile = [[0, 1]] } }]",
        "[[bodies]]\nname = \"a\"\n[[labels]]\ntext = \"a\"",
        "[[dimensions]]\nfrom = {}\nto = {}\nradius = 1",
        "[[dimensions]]\nfrom = {}\nto = {}\nat = {}\noffset = [0, 0, 1]",
        "[contacts.c]\nfirst = { plane = {} }",
        "[inputs]\na = { keys = [] }",
        "[inputs]\na = { keys = [[0, 0]], formula = 1 }",
        "[bars]\nb = { from = [0], to = [0, 0], length = 1 }",
        "[outputs]\nd = { distance = [\"a\"] }",
        "[measures]\nm = { of = [], take = \"max\" }",
        "[[plots]]\ny = []",
        "[view]\nup = \"w\"",
        "[view]\ncamera_path = [{ zoom = 1, distance = 1 }]",
    ] {
        let value = parse(planted).unwrap();
        assert!(
            !faults(&schema, &schema, &value, "").is_empty(),
            "{planted}"
        );
        let whole =
            format!("duration = 1\n{planted}").replace("duration = 1\nduration", "duration");
        assert!(
            mechanim::Scene::parse("planted", &whole).is_err(),
            "{planted}"
        );
    }
}

/// Every key of a list of pictures stands in its document; those of scenes are in `documents/key_tables.rs`.
#[test]
fn every_key_of_a_list_is_documented() {
    fn walk(
        keys: &'static Keys,
        document: &str,
        missing: &mut Vec<String>,
        seen: &mut Vec<&'static str>,
    ) {
        use mechanim::scene::keys::Holds;
        if seen.contains(&keys.name) {
            return;
        }
        seen.push(keys.name);
        for key in keys.list {
            let forms = ["`{}`", "`[{}]`", "`[[{}]]`", "{} =", "{}`"];
            let is_there = forms
                .iter()
                .any(|form| document.contains(&form.replace("{}", key.name)));
            if !is_there {
                missing.push(format!("{} of {}", key.name, keys.name));
            }
            let inner: &[Holds] = match &key.holds {
                Holds::Named(values) | Holds::Any(values) => values,
                one => std::slice::from_ref(one),
            };
            for holds in inner {
                if let Holds::Table(inner) | Holds::Tables(inner) = holds {
                    walk(inner, document, missing, seen);
                }
            }
        }
    }
    let path = "docs/formats.md";
    let document = std::fs::read_to_string(root().join(path)).unwrap();
    let (mut missing, mut seen) = (Vec::new(), Vec::new());
    walk(&LIST, &document, &mut missing, &mut seen);
    assert!(missing.is_empty(), "{path} lacks {missing:?}");
    assert!(!seen.is_empty());
}
