//! THIRD-PARTY.txt names every library that the program is made of, with the licence and notices that must go with it.
//!
//! `MECHANIM_BLESS=1 cargo test --test suite third_party` writes it anew from the sources of the locked versions.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;
use std::path::Path;
use std::process::Command;

const FILE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/THIRD-PARTY.txt");

/// Beginnings of the names of files that hold licences and notices.
const NOTICES: [&str; 6] = [
    "licen",
    "copying",
    "notice",
    "unlicense",
    "copyright",
    "ofl",
];

/// Name and version of everything locked that comes from a registry.
fn locked(lock: &str) -> BTreeSet<[String; 2]> {
    let entries = lock.split("[[package]]").skip(1);
    let entries = entries.filter(|entry| entry.contains("\nsource = "));
    let value = |entry: &str, key: &str| {
        let line = entry.lines().find_map(|line| line.strip_prefix(key));
        line.unwrap().trim_matches('"').to_owned()
    };
    entries
        .map(|entry| [value(entry, "name = "), value(entry, "version = ")])
        .collect()
}

/// Name, version and licence of the rows of the table.
fn listed(text: &str) -> Vec<[String; 3]> {
    let rows = text.lines().filter_map(|line| line.strip_prefix("| "));
    // The head of the table; its rule begins otherwise.
    rows.skip(1)
        .map(|row| {
            let mut cells = row.split('|').map(|cell| cell.trim().to_owned());
            [(); 3].map(|()| cells.next().unwrap())
        })
        .collect()
}

/// Whether one of the licences offered is enough, by the list of `deny.toml`.
fn is_allowed(licence: &str, allowed: &str) -> bool {
    let is_listed =
        |word: &str| allowed.contains(&format!("\"{}\"", word.trim_matches(['(', ')', ' '])));
    licence
        .split(" AND ")
        .all(|part| part.replace('/', " OR ").split(" OR ").any(is_listed))
}

#[test]
fn every_library_is_named_with_a_licence_that_is_allowed() {
    if std::env::var_os("MECHANIM_BLESS").is_some() {
        std::fs::write(FILE, written()).unwrap();
    }
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"));
    let lock = std::fs::read_to_string(folder.join("Cargo.lock")).unwrap();
    let deny = std::fs::read_to_string(folder.join("deny.toml")).unwrap();
    let allowed = deny.split("allow = [").nth(1).unwrap();
    let allowed = allowed.split(']').next().unwrap();
    let text = std::fs::read_to_string(FILE).unwrap();
    let rows = listed(&text);
    let named: BTreeSet<[String; 2]> = rows
        .iter()
        .map(|[name, version, _]| [name.clone(), version.clone()])
        .collect();
    let (locked, bless) = (
        locked(&lock),
        "MECHANIM_BLESS=1 cargo test --test suite third_party",
    );
    assert!(locked.len() > 100, "the lock file is not understood");
    assert_eq!(named, locked, "{bless}");
    for [name, _, licence] in &rows {
        assert!(is_allowed(licence, allowed), "{name}: {licence}");
    }
    assert!(text.contains("SIL OPEN FONT LICENSE"), "{bless}");
}

#[test]
fn a_licence_that_is_not_allowed_is_noticed() {
    let allowed = "\"MIT\", \"Apache-2.0\", \"Unicode-3.0\"";
    for (licence, may) in [
        ("MIT", true),
        ("GPL-3.0", false),
        ("MIT/GPL-3.0", true),
        ("MIT OR LGPL-2.1-or-later", true),
        ("(MIT OR Apache-2.0) AND Unicode-3.0", true),
        ("MIT AND GPL-3.0", false),
    ] {
        assert_eq!(is_allowed(licence, allowed), may, "{licence}");
    }
    let lock =
        "[[package]]\nname = \"own\"\n[[package]]\nname = \"a\"\nversion = \"1\"\nsource = \"x\"\n";
    assert_eq!(
        locked(lock),
        BTreeSet::from([["a".to_owned(), "1".to_owned()]])
    );
}

/// A text as it stands first, and the libraries that have it; texts of equal words are one.
type Text = (String, Vec<String>);

/// The file, made from what cargo says of the locked versions and from their sources.
fn written() -> String {
    let cargo = Command::new(env!("CARGO"))
        .args([
            "metadata",
            "--format-version",
            "1",
            "--locked",
            "--offline",
            "--all-features",
        ])
        .current_dir(env!("CARGO_MANIFEST_DIR"))
        .output()
        .unwrap();
    let found: Value = serde_json::from_slice(&cargo.stdout)
        .unwrap_or_else(|_| panic!("{}", String::from_utf8_lossy(&cargo.stderr)));
    let mut packages: Vec<&Value> = found["packages"].as_array().unwrap().iter().collect();
    packages.retain(|p| p["source"].is_string());
    packages.sort_by_key(|p| (p["name"].to_string(), p["version"].to_string()));
    let mut texts: BTreeMap<String, Text> = BTreeMap::new();
    let mut add = |text: String, name: &str| {
        let words: Vec<&str> = text.split_whitespace().collect();
        let known = texts.entry(words.join(" "));
        let (_, names) = known.or_insert_with(|| (text.clone(), Vec::new()));
        if names.last().is_none_or(|last| last != name) {
            names.push(name.to_owned());
        }
    };
    let mut table = String::new();
    for package in packages {
        let word = |key: &str| package[key].as_str().unwrap_or_default();
        let (name, version) = (word("name"), word("version"));
        writeln!(
            table,
            "| {name} | {version} | {} | {} |",
            word("license"),
            word("repository")
        )
        .unwrap();
        let folder = Path::new(word("manifest_path")).parent().unwrap();
        for text in notices(folder) {
            add(text, name);
        }
    }
    let font = Path::new(env!("CARGO_MANIFEST_DIR")).join("src/render/text");
    for text in notices(&font) {
        add(text, "the font");
    }
    let mut file = format!(
        "# Third-party notices\n\nThe libraries that mechanim is built and tested with, on all systems, at the versions of `Cargo.lock`, \
         and the texts that go with them. Libraries without a text of their own are under one of the standard texts below.\n\n\
         | library | version | licence | source |\n|---|---|---|---|\n{table}"
    );
    for (text, names) in texts.into_values() {
        let names = names.join(", ");
        write!(file, "\n## {names}\n\n```text\n{text}\n```\n").unwrap();
    }
    file
}

/// Texts of licences and notices in a folder, ends of lines made equal.
fn notices(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder)
        .unwrap()
        .map(|e| e.unwrap().path());
    let mut paths: Vec<_> = entries.filter(|path| path.is_file()).collect();
    paths.retain(|path| {
        let name = path.file_name().unwrap().to_string_lossy().to_lowercase();
        NOTICES.iter().any(|start| name.starts_with(start))
    });
    paths.sort();
    let texts = paths.iter().map(|path| {
        let text = String::from_utf8_lossy(&std::fs::read(path).unwrap()).into_owned();
        let lines: Vec<&str> = text.lines().map(str::trim_end).collect();
        lines.join("\n").trim_matches('\n').to_owned()
    });
    texts.filter(|text| !text.is_empty()).collect()
}
