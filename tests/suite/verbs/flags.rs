//! One name of an option has one meaning over all verbs; JSON documents are named in one form.

use crate::house::source::sources;
use clap::{Command, CommandFactory};
use mechanim::cli::args::Cli;
use std::collections::{BTreeMap, BTreeSet};

/// The help of every long option, with the verb that has it.
fn helps() -> BTreeMap<String, Vec<(String, String)>> {
    let mut helps = BTreeMap::new();
    for verb in Cli::command().get_subcommands() {
        collect(verb, verb.get_name(), &mut helps);
    }
    helps
}

/// The options of a verb and of the verbs below it.
fn collect(verb: &Command, path: &str, helps: &mut BTreeMap<String, Vec<(String, String)>>) {
    for argument in verb.get_arguments() {
        let Some(flag) = argument.get_long() else {
            continue;
        };
        let help = argument.get_long_help().or(argument.get_help());
        let help = help.map(ToString::to_string).unwrap_or_default();
        let row = (path.to_owned(), help);
        helps.entry(flag.to_owned()).or_default().push(row);
    }
    for below in verb.get_subcommands() {
        collect(below, &format!("{path} {}", below.get_name()), helps);
    }
}

/// What the documents say that options mean.
fn meanings() -> BTreeMap<String, String> {
    let text = std::fs::read_to_string("docs/commands.md").unwrap();
    let table = text.split("## What options mean").nth(1).unwrap();
    let rows = table.lines().filter_map(|line| {
        let (flag, means) = line.strip_prefix("| `--")?.split_once("` | ")?;
        Some((flag.to_owned(), means.trim_end_matches(" |").to_owned()))
    });
    rows.collect()
}

/// Options whose helps neither are the same nor begin with the words of the table, and words of the table that no two verbs need.
fn faults(
    helps: &BTreeMap<String, Vec<(String, String)>>,
    meanings: &BTreeMap<String, String>,
) -> Vec<String> {
    let mut faults = Vec::new();
    for (flag, verbs) in helps {
        let distinct: BTreeSet<&str> = verbs.iter().map(|(_, help)| help.as_str()).collect();
        if distinct.len() < 2 {
            continue;
        }
        let means = meanings.get(flag);
        let strange = verbs
            .iter()
            .filter(|(_, help)| means.is_none_or(|means| !help.starts_with(means)));
        faults.extend(strange.map(|(verb, help)| format!("{verb} --{flag}: {help}")));
    }
    let unused = meanings.keys().filter(|flag| {
        let verbs = helps.get(*flag).map_or(0, Vec::len);
        verbs < 2
    });
    faults.extend(unused.map(|flag| format!("--{flag} is no option of two verbs")));
    faults
}

#[test]
fn an_option_means_the_same_in_every_verb() {
    let (mut helps, meanings) = (helps(), meanings());
    assert!(helps.len() > 80 && meanings.len() > 15);
    let found = faults(&helps, &meanings);
    assert!(found.is_empty(), "{}", found.join("\n"));
    // What the names meant once.
    let planted = ("render".to_owned(), "Samples per pixel.".to_owned());
    helps.get_mut("samples").unwrap().push(planted);
    let found = faults(&helps, &meanings);
    assert_eq!(found, ["render --samples: Samples per pixel."]);
}

#[test]
fn the_old_names_are_read() {
    for line in [
        "render four-bar --out a.gif --samples 8",
        "tolerance four-bar --samples 10",
        "check four-bar --tolerance 0.1",
        "optimise four-bar --tolerance 0.1",
        "optimise four-bar --pairs --worst 3",
        "check four-bar --worst 3 --closure 1e-9",
        "solve four-bar --out a.csv --inputs table.csv",
        "render four-bar --out a.gif --show clearance",
        "tolerance four-bar --first 10",
        "study run folder --units 0..3",
        "diff a.png b.png --tolerance 3",
    ] {
        let words = ["mechanim"].into_iter().chain(line.split(' '));
        assert!(Cli::command().try_get_matches_from(words).is_ok(), "{line}");
    }
}

/// Names of documents in a source, as `mechanim-what/1`; those of another form.
fn misnamed(text: &str) -> Vec<String> {
    let names = text.split("\"mechanim-").skip(1).filter_map(|rest| {
        let name = rest.split('"').next()?;
        // Only what ends in a version is the name of a document.
        let has_version =
            name.ends_with(|c: char| c.is_ascii_digit()) || name.ends_with("{SCHEMA}");
        has_version.then_some(name)
    });
    let well = |name: &str| {
        let parts = name.split_once('/');
        parts.is_some_and(|(what, version)| {
            let is_number = version.chars().all(|c| c.is_ascii_digit()) || version == "{SCHEMA}";
            is_number && what.chars().all(|c| c.is_ascii_lowercase())
        })
    };
    names
        .filter(|name| !well(name))
        .map(str::to_owned)
        .collect()
}

#[test]
fn documents_are_named_in_one_form() {
    let mut count = 0;
    for file in sources() {
        let wrong = misnamed(&file.text);
        assert!(wrong.is_empty(), "{}: {wrong:?}", file.name);
        count += file.text.matches("\"mechanim-").count();
    }
    assert!(count > 10, "{count}");
    let planted = "json!({ \"schema\": \"mechanim-pairs-1\" })";
    assert_eq!(misnamed(planted), ["pairs-1"]);
}
