//! Every command in the documents, in blocks and within sentences, is one that the program takes; every option that they name
//! is one of some verb; every test, bench and script that they name exists.

use super::text::{Document, documents, program_command, words};
use clap::{Command, CommandFactory, Parser};
use mechanim::cli::args::Cli;
use std::collections::BTreeSet;
use std::path::Path;

/// What a reader puts in place of the words in capitals.
fn filled(word: &str) -> String {
    match word {
        "N" | "K" => "3".to_owned(),
        "SHELL" => "bash".to_owned(),
        "VERB" => "check".to_owned(),
        // Variables of a shell's loop, here numbers.
        _ if word.contains("${") => "3".to_owned(),
        other => other.to_owned(),
    }
}

/// Why the program refuses a command; help and versions are no refusals.
fn refusal(words: &[String]) -> Option<String> {
    let error = Cli::try_parse_from(words.iter().map(|word| filled(word))).err()?;
    error.use_stderr().then(|| error.to_string())
}

/// Whether words only name a verb, as in "see `mechanim study run`".
fn is_verb(words: &[String]) -> bool {
    let whole = Cli::command();
    let mut verb = &whole;
    for word in words.iter().skip(1) {
        match verb.find_subcommand(word) {
            Some(below) => verb = below,
            None => return false,
        }
    }
    words.len() > 1
}

/// What the program does not take of a document, and how many commands there were.
fn refused(document: &Document) -> (Vec<String>, usize) {
    let mut commands = Vec::new();
    for block in document.blocks() {
        if matches!(block.language.as_str(), "sh" | "console" | "yaml") {
            let lines = block.command_lines();
            let lines = lines
                .iter()
                .map(|line| line.trim_start_matches("      - run: "));
            commands.extend(lines.filter_map(program_command));
        }
    }
    // Brackets stand around what may be left out.
    let code = document.inline_code().into_iter();
    let code = code.map(|(code, _)| code.replace(['[', ']'], ""));
    commands.extend(code.filter_map(|code| program_command(&code)));
    let seen = commands.len();
    let faults = commands.iter().filter_map(|command| {
        let words = words(command);
        if is_verb(&words) {
            return None;
        }
        let error = refusal(&words)?;
        Some(format!("{}: {command}: {error}", document.name))
    });
    (faults.collect(), seen)
}

#[test]
fn the_program_takes_every_command_of_the_documents() {
    let (mut faults, mut seen) = (Vec::new(), 0);
    for document in documents() {
        let (found, count) = refused(&document);
        faults.extend(found);
        seen += count;
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(seen > 190, "only {seen} commands found");
    let planted = Document {
        name: "planted.md".to_owned(),
        text: "Run `mechanim render a --planted` or\n```sh\nmechanim chek a\n```\n".to_owned(),
    };
    assert_eq!(refused(&planted).0.len(), 2);
}

/// All long options of a verb and of the verbs below it, with their older names.
fn long_options(verb: &Command, found: &mut BTreeSet<String>) {
    for argument in verb.get_arguments() {
        let names = argument.get_all_aliases().unwrap_or_default();
        let names = names.into_iter().chain(argument.get_long());
        found.extend(names.map(str::to_owned));
    }
    for below in verb.get_subcommands() {
        long_options(below, found);
    }
}

#[test]
fn every_option_within_a_sentence_exists() {
    let mut known = BTreeSet::from(["help".to_owned(), "version".to_owned()]);
    long_options(&Cli::command(), &mut known);
    let (mut strange, mut seen) = (Vec::new(), 0);
    for document in documents() {
        for (code, _) in document.inline_code() {
            // Options of cargo are named with cargo, or set its profile.
            let Some(rest) = code
                .strip_prefix("--")
                .filter(|r| !r.starts_with("config "))
            else {
                continue;
            };
            let end = rest.find(|c: char| !c.is_ascii_lowercase() && c != '-');
            let option = &rest[..end.unwrap_or(rest.len())];
            seen += 1;
            if !known.contains(option) {
                strange.push(format!("{}: --{option}", document.name));
            }
        }
    }
    assert!(strange.is_empty(), "{}", strange.join("\n"));
    assert!(seen > 100, "only {seen} options found");
}

/// What a command of cargo, python or a shell names that must exist: test filters, benches, scripts.
fn missing(command: &str, tests: &str) -> Vec<String> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let words = words(command);
    let mut faults = Vec::new();
    for (k, word) in words.iter().enumerate() {
        let next = words.get(k + 1).map_or("", String::as_str);
        let exists = match word.as_str() {
            "--bench" => root
                .join("benches")
                .join(next)
                .with_extension("rs")
                .exists(),
            // Filters are parts of the paths of tests.
            "suite" if words[k - 1] == "--test" && !next.is_empty() && next != "--" => {
                let name = next.trim_end_matches(':');
                tests.contains(&format!("mod {name};")) || tests.contains(&format!("fn {name}"))
            }
            _ if word.starts_with("benches/") || word.starts_with(".ci/") => {
                root.join(word.trim_end_matches("/")).exists()
            }
            _ => true,
        };
        if !exists {
            faults.push(format!("{word} {next}"));
        }
    }
    faults
}

#[test]
fn tests_benches_and_scripts_of_the_documents_exist() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let mut tests = String::new();
    super::sources_page::sources_of_tests(&root, &mut tests);
    let (mut faults, mut seen) = (Vec::new(), 0);
    for document in super::text::all_documents() {
        let blocks = document.blocks();
        let lines = blocks.iter().flat_map(|block| block.command_lines());
        let code = document.inline_code().into_iter().map(|(code, _)| code);
        for command in lines.chain(code) {
            let is_ours = [
                "cargo ",
                "python",
                ".ci/",
                "bash .ci",
                "MECHANIM_",
                "FAULTS_",
            ];
            if is_ours.iter().any(|word| command.starts_with(word)) {
                seen += 1;
                let missing = missing(&command, &tests);
                faults.extend(missing.iter().map(|m| format!("{}: {m}", document.name)));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(seen > 30, "only {seen} commands found");
    let planted = "cargo test --release --test suite planted_nowhere";
    assert_eq!(missing(planted, &tests), ["suite planted_nowhere"]);
}
