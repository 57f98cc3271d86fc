//! The library's face: few items, each function with an example, no room of the engine in what it hands out.

use super::source::{Source, bare, sources};

/// Most public items: types, functions and fields.
const MOST_ITEMS: usize = 150;

/// Most types at the root of the crate; what studies take and give is in a module of its own.
const MOST_AT_ROOT: usize = 20;

/// Types of the engine that the face hands on, with the files they stand in.
const HANDED_ON: [(&str, &str); 4] = [
    ("Certificate", "kinematics/results/certificate.rs"),
    ("Reason", "kinematics/results/certificate.rs"),
    ("SearchMethod", "analysis/study/optimum.rs"),
    ("Distribution", "analysis/tolerance.rs"),
];

/// The files of the face, and of types that are handed on what is written for them.
fn face() -> Vec<Source> {
    let all = sources();
    let of_types = HANDED_ON.iter().map(|(name, file)| {
        let file = all.iter().find(|source| source.name == *file).expect(file);
        let begins = |line: &str| {
            let head = line.trim_end_matches(" {");
            head.ends_with(&format!(" {name}")) && !head.contains(" for ")
        };
        Source {
            name: file.name.clone(),
            text: blocks_of(&file.text, begins),
        }
    });
    let of_types: Vec<Source> = of_types.collect();
    let face = all.into_iter().filter(|file| file.name.starts_with("api/"));
    face.chain(of_types).collect()
}

/// Blocks at the left margin, up to their closing brace, whose first line `begins` one.
fn blocks_of(text: &str, begins: impl Fn(&str) -> bool) -> String {
    let mut is_inside = false;
    let lines = text.lines().filter(|line| {
        let is_kept = is_inside || begins(line);
        is_inside = is_kept && *line != "}";
        is_kept
    });
    lines.collect::<Vec<&str>>().join("\n")
}

/// Whether a line begins a public item, or is a public field.
fn is_public(line: &str) -> bool {
    line.trim_start().starts_with("pub ") && !line.trim_start().starts_with("pub use")
}

/// Public functions of a file without an example in their documentation.
fn without_example(file: &Source) -> Vec<String> {
    let lines: Vec<&str> = file.text.lines().collect();
    let mut faults = Vec::new();
    for (index, line) in lines.iter().enumerate() {
        let line_of_function = line.trim_start().replace("pub const fn ", "pub fn ");
        if !line_of_function.starts_with("pub fn ") {
            continue;
        }
        let above = lines[..index].iter().rev();
        let doc = above.take_while(|line| line.trim_start().starts_with("///"));
        if !doc.into_iter().any(|line| line.contains("```")) {
            faults.push(format!("{}:{}: {}", file.name, index + 1, line.trim()));
        }
    }
    faults
}

#[test]
fn the_face_is_small() {
    let lines = face().into_iter().map(|file| {
        let lines = file.text.lines();
        lines.filter(|line| is_public(line)).count()
    });
    let items: usize = lines.sum();
    assert!((40..=MOST_ITEMS).contains(&items), "{items} public items");
}

#[test]
fn every_function_of_the_face_has_an_example() {
    let faults: Vec<String> = face().iter().flat_map(without_example).collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let planted = Source {
        name: "api/a.rs".to_owned(),
        text: "/// Says so.\npub fn a() {}\n/// ```\n/// b();\n/// ```\npub fn b() {}".to_owned(),
    };
    assert_eq!(without_example(&planted), ["api/a.rs:2: pub fn a() {}"]);
}

/// The names that a `pub use` of the root hands out.
fn names_at_root(root: &str) -> Vec<String> {
    let bare = bare(root);
    let uses = bare.split("\npub use ").skip(1);
    let lists = uses.filter_map(|rest| rest.split(';').next());
    let names = lists.flat_map(|list| list.rsplit("::").next().unwrap_or_default().split(','));
    let names = names.map(|name| name.trim_matches(|c: char| !c.is_alphanumeric()));
    names
        .filter(|name| !name.is_empty())
        .map(str::to_owned)
        .collect()
}

#[test]
fn the_root_holds_few_types() {
    let all = sources();
    let root = all
        .iter()
        .find(|file| file.name == "lib.rs")
        .expect("lib.rs");
    let names = names_at_root(&root.text);
    println!("{} types at the root: {names:?}", names.len());
    assert!((10..=MOST_AT_ROOT).contains(&names.len()), "{names:?}");
    for name in ["Scene", "Motion", "Pose", "Check", "Film", "Study", "Error"] {
        assert!(names.iter().any(|known| known == name), "{name}");
    }
}

/// A bare library has the face alone: every room is private without the feature `engine`, and undocumented with it.
#[test]
fn engine_rooms_are_hidden() {
    let all = sources();
    let root = all
        .iter()
        .find(|file| file.name == "lib.rs")
        .expect("lib.rs");
    let lines: Vec<&str> = root.text.lines().collect();
    let mut hidden = 0;
    for (index, line) in lines.iter().enumerate() {
        let Some(room) = line
            .strip_prefix("pub mod ")
            .and_then(|l| l.strip_suffix(';'))
        else {
            continue;
        };
        assert_eq!(lines[index - 1], "#[doc(hidden)]", "{line}");
        if room == "cli" {
            assert_eq!(lines[index - 2], "#[cfg(feature = \"cli\")]", "{line}");
            continue;
        }
        assert_eq!(lines[index - 2], "#[cfg(feature = \"engine\")]", "{line}");
        let private = [
            "#[cfg(not(feature = \"engine\"))]".to_owned(),
            format!("mod {room};"),
        ];
        assert_eq!(lines[index + 1..index + 3], private, "{line}");
        hidden += 1;
    }
    assert!(hidden > 15, "{hidden}");
}
