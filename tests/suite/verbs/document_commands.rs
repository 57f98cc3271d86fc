//! Every command in the documents is one that the program takes; those with their output beside them print it.

use clap::Parser;
use mechanim::cli::args::Cli;
use std::path::Path;
use std::process::Command;

/// A fenced block of a document.
struct Block {
    language: String,
    /// The name in backticks that the last line before it ends in, as in "Save this as `wiper.toml`:".
    name: Option<String>,
    lines: Vec<String>,
}

fn blocks(text: &str) -> Vec<Block> {
    let mut list: Vec<Block> = Vec::new();
    let (mut is_open, mut above) = (false, String::new());
    for line in text.lines() {
        if let Some(language) = line.strip_prefix("```") {
            is_open = !is_open;
            if is_open {
                let mut words = above.rsplit('`').skip(1);
                let name = above.ends_with("`:").then(|| words.next()).flatten();
                list.push(Block {
                    language: language.to_owned(),
                    name: name.map(str::to_owned),
                    lines: Vec::new(),
                });
            }
        } else if is_open {
            list.last_mut().unwrap().lines.push(line.to_owned());
        } else if !line.trim().is_empty() {
            above = line.to_owned();
        }
    }
    list
}

/// The words of a command up to a pipe, a redirection or a comment; quotes are taken off.
pub(super) fn words(command: &str) -> Vec<String> {
    let (mut list, mut word, mut quote) = (Vec::new(), None::<String>, None);
    for c in command.chars() {
        match (quote, c) {
            (Some(q), c) if q == c => quote = None,
            (Some(_), c) => word.get_or_insert_default().push(c),
            (None, '"' | '\'') => {
                word.get_or_insert_default();
                quote = Some(c);
            }
            (None, '|' | '>' | ';' | '&') => break,
            (None, '#') if word.is_none() => break,
            (None, ' ') => list.extend(word.take()),
            (None, c) => word.get_or_insert_default().push(c),
        }
    }
    list.extend(word);
    list
}

/// All commands of a block that begin with `mechanim`, continued lines put together.
fn commands(block: &Block) -> Vec<Vec<String>> {
    let text = block.lines.join("\n").replace("\\\n", " ");
    let lines = text.lines().map(|line| line.trim_start_matches("$ "));
    let lines = lines.filter_map(|line| {
        line.split_once("cargo run --release -- ").map_or(
            line.starts_with("mechanim ").then(|| line.to_owned()),
            |(_, rest)| Some(format!("mechanim {rest}")),
        )
    });
    lines.map(|line| words(&line)).collect()
}

fn documents() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    let docs = std::fs::read_dir(root.join("docs")).unwrap();
    paths.extend(docs.map(|entry| entry.unwrap().path()));
    paths.retain(|path| path.extension().is_some_and(|e| e == "md"));
    paths.sort();
    let read = |path: &std::path::PathBuf| {
        let name = path.strip_prefix(root).unwrap().display().to_string();
        (name, std::fs::read_to_string(path).unwrap())
    };
    paths.iter().map(read).collect()
}

#[test]
fn the_program_takes_every_command_of_the_documents() {
    let (mut seen, mut refused) = (0, Vec::new());
    for (name, text) in documents() {
        for block in blocks(&text)
            .iter()
            .filter(|b| matches!(b.language.as_str(), "sh" | "console"))
        {
            for command in commands(block) {
                // Words in capitals stand for what the reader puts there.
                let filled = command.iter().map(|word| match word.as_str() {
                    "N" | "K" => "3",
                    "SHELL" => "bash",
                    other => other,
                });
                if let Err(error) = Cli::try_parse_from(filled)
                    && error.use_stderr()
                {
                    refused.push(format!("{name}: {command:?}: {error}"));
                }
                seen += 1;
            }
        }
    }
    assert!(refused.is_empty(), "{}", refused.join("\n"));
    assert!(seen > 50, "only {seen} commands found");
    assert!(Cli::try_parse_from(words("mechanim render a --planted")).is_err());
}

/// Whether `line` is what was printed: `…` stands for anything, the number of spaces does not matter.
fn is_like(line: &str, printed: &str) -> bool {
    let plain = |text: &str| text.split_whitespace().collect::<Vec<_>>().join(" ");
    let (line, mut rest) = (plain(line), plain(printed));
    let mut parts = line.split('…').map(str::trim);
    let first = parts.next().unwrap();
    let Some(after) = rest.strip_prefix(first) else {
        return false;
    };
    rest = after.to_owned();
    let mut is_open = false;
    for part in parts {
        is_open = true;
        let Some(place) = rest.find(part) else {
            return false;
        };
        rest = rest[place + part.len()..].to_owned();
    }
    is_open || rest.trim().is_empty()
}

#[test]
fn outputs_in_the_documents_are_printed() {
    let (mut faults, mut compared) = (Vec::new(), 0);
    for (name, text) in documents() {
        let folder = tempfile::tempdir().unwrap();
        for block in blocks(&text) {
            if let ("toml", Some(file)) = (block.language.as_str(), &block.name) {
                let path = folder.path().join(file);
                // A further block of the same name is the rest of the file.
                let before = std::fs::read_to_string(&path).unwrap_or_default();
                std::fs::write(&path, format!("{before}\n{}\n", block.lines.join("\n"))).unwrap();
            }
            if block.language != "console" {
                continue;
            }
            let mut printed: Vec<String> = Vec::new();
            for line in &block.lines {
                if let Some(command) = line.strip_prefix("$ mechanim ") {
                    let mut program = Command::new(env!("CARGO_BIN_EXE_mechanim"));
                    let out = program
                        .args(words(command))
                        .current_dir(&folder)
                        .output()
                        .unwrap();
                    let both = [out.stdout, out.stderr].map(|b| String::from_utf8(b).unwrap());
                    printed = both.concat().lines().map(str::to_owned).collect();
                } else if !line.starts_with('$') && !line.trim().is_empty() && line.trim() != "…"
                {
                    compared += 1;
                    if !printed.iter().any(|p| is_like(line, p)) {
                        faults.push(format!("{name}: `{line}` is not printed"));
                    }
                }
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(compared > 30, "only {compared} lines compared");
}

#[test]
fn lines_are_compared_as_they_look() {
    assert!(is_like("  a   1 …", "a 1 and more"));
    assert!(is_like("a … z", "  a b c z"));
    assert!(!is_like("a 1", "a 2"));
    assert!(!is_like("a 1", "a 1 and more"));
    assert!(!is_like("a … z", "a b c"));
    assert_eq!(words("a 'b c' \"d\" # e"), ["a", "b c", "d"]);
}
