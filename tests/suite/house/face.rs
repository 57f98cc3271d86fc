//! The library's face: few items, each function with an example, no room of the engine in what it hands out.

use super::source::{Source, sources};

/// Most public items: types, functions, fields and variants.
const MOST_ITEMS: usize = 150;

fn face() -> Vec<Source> {
    let all = sources().into_iter();
    let face = all.filter(|file| file.name.starts_with("api/"));
    face.collect()
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
        if !line.trim_start().starts_with("pub fn ") {
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
        if line.starts_with("pub mod") {
            assert_eq!(lines[index - 1], "#[doc(hidden)]", "{line}");
            hidden += 1;
        }
    }
    assert!(hidden > 15, "{hidden}");
}
