//! One name of an option has one meaning over all verbs, which `docs/commands.md` states for each option; JSON documents are
//! named in one form.

use crate::house::source::sources;
use clap::{Command, CommandFactory};
use mechanim::cli::args::Cli;
use std::collections::{BTreeMap, BTreeSet};

/// An option: its helps, by the verbs that have it.
type Helps = BTreeMap<String, BTreeMap<String, String>>;

/// The help of every long option, with the verb that has it; options of the program stand under "every verb".
fn helps() -> Helps {
    let mut helps = BTreeMap::new();
    let program = Cli::command();
    add_options(&program, "every verb", &mut helps);
    for verb in program.get_subcommands() {
        collect(verb, verb.get_name(), &mut helps);
    }
    helps
}

fn add_options(verb: &Command, path: &str, helps: &mut Helps) {
    for argument in verb.get_arguments() {
        if let Some(flag) = argument.get_long() {
            let help = argument.get_long_help().or(argument.get_help());
            let help = help.map(ToString::to_string).unwrap_or_default();
            let verbs: &mut BTreeMap<_, _> = helps.entry(flag.to_owned()).or_default();
            verbs.insert(path.to_owned(), help);
        }
    }
}

/// The options of a verb and of the verbs below it.
fn collect(verb: &Command, path: &str, helps: &mut Helps) {
    add_options(verb, path, helps);
    for below in verb.get_subcommands() {
        collect(below, &format!("{path} {}", below.get_name()), helps);
    }
}

/// A row of the table of options.
#[derive(Clone, Debug, PartialEq)]
struct Row {
    flag: String,
    /// What it means, in the words with which its helps begin.
    means: String,
    /// Names of verbs; `SCENE` stands for all that read one scene.
    verbs: String,
}

/// What the documents say that options mean.
fn table() -> Vec<Row> {
    let text = std::fs::read_to_string("docs/commands.md").unwrap();
    let table = text.split("## What options mean").nth(1).unwrap();
    let rows = table.lines().filter_map(|line| {
        let (flag, rest) = line.strip_prefix("| `--")?.split_once("` | ")?;
        let (means, verbs) = rest.trim_end_matches(" |").rsplit_once(" | ")?;
        Some(Row {
            flag: flag.to_owned(),
            means: means.to_owned(),
            verbs: verbs.to_owned(),
        })
    });
    rows.collect()
}

/// The verbs of an option as the table writes them.
fn written_verbs(flag: &str, helps: &Helps) -> String {
    let of_scene: BTreeSet<&str> = verbs_of("input-table", helps);
    let own = verbs_of(flag, helps);
    let others: Vec<&str> = own.difference(&of_scene).copied().collect();
    if of_scene.is_subset(&own) {
        [&["SCENE"][..], &others].concat().join(", ")
    } else {
        own.into_iter().collect::<Vec<_>>().join(", ")
    }
}

fn verbs_of<'h>(flag: &str, helps: &'h Helps) -> BTreeSet<&'h str> {
    let verbs = helps.get(flag).into_iter().flat_map(BTreeMap::keys);
    verbs.map(String::as_str).collect()
}

/// Options without a row, rows without an option, verbs that the row lacks, and helps that begin with other words.
fn faults(helps: &Helps, table: &[Row]) -> Vec<String> {
    let mut faults = Vec::new();
    for (flag, verbs) in helps {
        let written = written_verbs(flag, helps);
        let Some(row) = table.iter().find(|row| row.flag == *flag) else {
            let means = verbs.values().next().cloned().unwrap_or_default();
            faults.push(format!("| `--{flag}` | {means} | {written} |"));
            continue;
        };
        if row.verbs != written {
            faults.push(format!("--{flag} is an option of {written}"));
        }
        for (verb, help) in verbs {
            let rest = help.strip_prefix(&row.means);
            // The words end where a clause does, so that a prefix like "Where" is no meaning.
            let is_clause = rest
                .is_some_and(|rest| rest.is_empty() || !rest.starts_with(char::is_alphanumeric));
            if !is_clause || row.means.split(' ').count() < 2 {
                faults.push(format!("{verb} --{flag}: {help}"));
            }
        }
    }
    let mut flags = BTreeSet::new();
    for row in table {
        if !helps.contains_key(&row.flag) || !flags.insert(&row.flag) {
            faults.push(format!("--{} is no option, or twice", row.flag));
        }
    }
    faults
}

#[test]
fn every_option_is_documented_with_its_one_meaning() {
    let (mut helps, table) = (helps(), table());
    assert!(helps.len() > 130);
    let found = faults(&helps, &table);
    assert!(found.is_empty(), "{}", found.join("\n"));
    // What a name meant once, and an option that is nowhere.
    let planted = "Samples per pixel.".to_owned();
    let samples = helps.get_mut("samples").unwrap();
    samples.insert("check".to_owned(), planted.clone());
    helps.insert("new-one".to_owned(), [("new".to_owned(), planted)].into());
    assert_eq!(
        faults(&helps, &table),
        [
            "| `--new-one` | Samples per pixel. | new |",
            "check --samples: Samples per pixel."
        ]
    );
}

/// An option that takes one of some words: these words, by the verbs that have it.
fn words_of_options() -> BTreeMap<String, BTreeMap<String, BTreeSet<String>>> {
    fn add(
        verb: &Command,
        path: &str,
        words: &mut BTreeMap<String, BTreeMap<String, BTreeSet<String>>>,
    ) {
        for argument in verb.get_arguments() {
            let possible = argument.get_possible_values();
            let known = possible.iter().map(|word| word.get_name().to_owned());
            let known: BTreeSet<String> = known.collect();
            if let (Some(flag), false) = (argument.get_long(), known.is_empty()) {
                let verbs = words.entry(flag.to_owned()).or_default();
                verbs.insert(path.to_owned(), known);
            }
        }
        for below in verb.get_subcommands() {
            add(below, &format!("{path} {}", below.get_name()), words);
        }
    }
    let mut words = BTreeMap::new();
    for verb in Cli::command().get_subcommands() {
        add(verb, verb.get_name(), &mut words);
    }
    words
}

/// Options that mean different things by their words: no verb takes all words that the others take.
fn options_of_several_meanings(
    words: &BTreeMap<String, BTreeMap<String, BTreeSet<String>>>,
) -> Vec<&str> {
    let differ = words.iter().filter(|(_, verbs)| {
        let all: BTreeSet<&String> = verbs.values().flatten().collect();
        !verbs.values().any(|words| words.len() == all.len())
    });
    differ.map(|(flag, _)| flag.as_str()).collect()
}

#[test]
fn an_option_takes_the_same_words_in_all_verbs() {
    let mut words = words_of_options();
    // Every verb writes its own kinds of files.
    assert_eq!(options_of_several_meanings(&words), ["format"]);
    let planted = ["trials", "formal"].map(str::to_owned).into();
    let method = words.get_mut("method").unwrap();
    method.insert("intervals".to_owned(), planted);
    assert_eq!(options_of_several_meanings(&words), ["format", "method"]);
}

/// The other names of an option that are read without being shown.
fn aliases(verb: &Command, found: &mut BTreeMap<String, BTreeSet<String>>) {
    for argument in verb.get_arguments() {
        for alias in argument.get_all_aliases().unwrap_or_default() {
            let flag = argument.get_long().unwrap_or_default().to_owned();
            found.entry(alias.to_owned()).or_default().insert(flag);
        }
    }
    for below in verb.get_subcommands() {
        aliases(below, found);
    }
}

#[test]
fn older_names_stand_for_one_option_and_are_listed() {
    let mut found = BTreeMap::new();
    aliases(&Cli::command(), &mut found);
    let helps = helps();
    let text = std::fs::read_to_string("docs/commands.md").unwrap();
    let older = text.split("Older names are still accepted").nth(1).unwrap();
    for (alias, flags) in &found {
        let flags: Vec<&String> = flags.iter().collect();
        assert!(flags.len() == 1 && !helps.contains_key(alias), "{alias}");
        let listed = format!("`--{alias}` for `--{}`", flags[0]);
        assert!(older.contains(&listed), "{listed}");
    }
    assert!(!found.is_empty());
    assert_eq!(older.matches(" for `--").count(), found.len());
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
