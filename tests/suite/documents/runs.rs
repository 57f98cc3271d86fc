//! The commands of the documents run as a shell runs them, and end with the exit code that stands beside them, or 0.
#![cfg_attr(not(unix), allow(dead_code))]

use super::fixtures::{filled, write_files};
use super::text::{Document, documents, program_command, stated_code};
use crate::program::{Workspace, undisturbed};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Commands that are not run here, why, and where they are run.
const NOT_RUN: [(&str, &str); 2] = [
    (
        "--watch",
        "runs until it is interrupted: verbs/many_scenes.rs",
    ),
    (
        "--live",
        "needs the engine as WebAssembly: verbs/live_pages.rs, .ci/browsers",
    ),
];

/// What makes a long command short: part of the command, what is taken out of it, and what is put in its place; where nothing
/// is taken out, it follows the part.
const SHORTENED: &[(&str, &str, &str)] = &[
    ("render gearshift --out", "--size 1280x720 --fps 60", TINY),
    ("--format rgba", "--fps 25", "--fps 1"),
    ("render gearshift --out anim.gif", "", TINY),
    ("--out four-bar.gif", "", TINY),
    ("render bricard", "--fps 12", "--fps 1"),
    ("--out iterates.gif", "", "--size 64x48"),
    ("view%:*", "\"${view%:*}\"", "bricard"),
    ("view#*:", "\"${view#*:}\"", "96"),
    ("view%:*", "docs/gallery/${view%:*}.png", "bricard.png"),
    ("docs/gallery/", "docs/gallery/", ""),
    (
        "--pieces 100000",
        "--pieces 100000",
        "--pieces 40 --vary ZR1,L6s",
    ),
    (
        "--tolerance 0.5 --picture",
        "--picture",
        "--pieces 40 --vary ZR1,L6s --picture",
    ),
    ("--design grid:ZR1", ":31", ":4"),
    ("--trials 1000000", "--trials 1000000", "--trials 2000"),
    ("--film search.gif", "", "--iterations 2"),
    ("--map map.svg", "", "--iterations 5"),
    ("--history h.csv", "", "--iterations 5"),
    ("gearshift --pairs", "", "--vary ZR1,L6s,L3k"),
    ("optimise gearshift --vary all", "", "--iterations 2"),
    ("--method minimax", "", "--iterations 2"),
    ("enclose gearshift", "", "--samples 1 --vary ZR1,L6s"),
    ("mechanim accuracy", "", "--poses 6 --turns 1"),
    ("tests/data/", "tests/data/", ""),
    (
        "examples/",
        "examples/",
        concat!(env!("CARGO_MANIFEST_DIR"), "/examples/"),
    ),
    ("grid:frame_is_shortest", ":16", ":2"),
    ("grid:x=1.2", ":120", ":8"),
    ("sobol:", ":100000", ":16"),
    ("synthesise", "torus-torus", "gearshift"),
    (
        "synthesise",
        "sphere-torus sphere-sphere",
        "gearshift-optimised",
    ),
    ("--minimise K", "--minimise K", ""),
    ("synthesise", "--starts 256", ""),
    ("synthesise", "--starts 1", ""),
    (
        "synthesise",
        "synthesise",
        "synthesise --starts 1 --iterations 2",
    ),
];

/// Few and small frames.
const TINY: &str = "--size 64x48 --fps 1";

/// The command with what makes it short.
fn shortened(command: &str) -> String {
    let mut text = command.to_owned();
    for (part, old, new) in SHORTENED.iter().filter(|(part, ..)| command.contains(part)) {
        text = match *old {
            "" => text.replacen(part, &format!("{part} {new}"), 1),
            old => text.replace(old, new),
        };
    }
    text
}

/// Whether a command is not run.
pub fn is_left_out(command: &str) -> bool {
    NOT_RUN.iter().any(|(part, _)| command.contains(part))
}

/// A command of a document and the exit code that it should end with.
struct Promise {
    command: String,
    code: i32,
}

/// The commands of a document: those of its blocks, where a comment may state an exit code, those in tables, where the row may,
/// and those within sentences, which end with 0.
fn promises(document: &Document) -> Vec<Promise> {
    let mut list = Vec::new();
    for block in document.blocks().iter().filter(|b| b.language == "sh") {
        for line in block.command_lines() {
            list.extend(promise(&line, &line));
        }
    }
    for (code, paragraph) in document.inline_code() {
        let is_row = paragraph.starts_with('|');
        list.extend(promise(&code, if is_row { &paragraph } else { "" }));
    }
    list
}

fn promise(line: &str, beside: &str) -> Option<Promise> {
    let command = program_command(line).filter(|_| !is_left_out(line))?;
    // The settings of the environment that stand before it.
    let settings = line.split("mechanim ").next()?.trim_start();
    let settings = if settings.contains('=') { settings } else { "" };
    Some(Promise {
        command: format!("{settings}{command}"),
        code: stated_code(beside).unwrap_or(0),
    })
}

/// Whether a command is run as it is written.
pub fn runs_whole(command: &str) -> bool {
    !is_left_out(command) && shortened(command) == command
}

/// A command without its comment, and with single spaces.
fn bare_command(command: &str) -> String {
    let command = command.split(" #").next().unwrap_or_default();
    command.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// What ends otherwise than promised; a shortened command in `known` is not run again.
fn broken(document: &Document, known: &mut BTreeSet<String>) -> (Vec<String>, usize) {
    let workspace = Workspace::new();
    write_files(&workspace);
    for block in document.blocks() {
        block.save_in(&workspace);
    }
    let (mut faults, mut done) = (Vec::new(), BTreeSet::new());
    for (number, promise) in promises(document).iter().enumerate() {
        let Some(command) = filled(&promise.command, number) else {
            continue;
        };
        let is_verb = command.split(' ').count() < 3;
        let (whole, command) = (command.clone(), shortened(&command));
        let is_known = command != whole && !known.insert(bare_command(&command));
        if is_verb || is_known || !done.insert(command.clone()) {
            continue;
        }
        let begun = std::time::Instant::now();
        let out = shell(&command, &workspace);
        println!("{:5.2} s  {command}", begun.elapsed().as_secs_f64());
        if out.status.code() != Some(promise.code) {
            let said = String::from_utf8_lossy(&out.stderr).into_owned();
            faults.push(format!(
                "{}: `{command}` ends with {:?}, not {}:\n{said}",
                document.name,
                out.status.code(),
                promise.code
            ));
        }
    }
    (faults, done.len())
}

/// Runs a line as a shell does, with the program on the path.
fn shell(line: &str, workspace: &Workspace) -> std::process::Output {
    let program = Path::new(env!("CARGO_BIN_EXE_mechanim"));
    let folder = program.parent().unwrap().display();
    let own = workspace.path("bin").display().to_string();
    let path = std::env::var("PATH").unwrap_or_default();
    let mut shell = Command::new("sh");
    shell
        .args(["-c", line])
        .current_dir(workspace.path(""))
        .env("PATH", format!("{own}:{folder}:{path}"))
        .stdin(std::process::Stdio::null());
    undisturbed(&mut shell);
    shell.output().unwrap()
}

#[cfg(unix)]
#[test]
fn commands_of_the_documents_end_as_stated() {
    let (mut faults, mut seen, mut known) = (Vec::new(), 0, BTreeSet::new());
    for document in documents() {
        // Those of sources.md are run by its own test.
        if document.name.ends_with("sources.md") {
            continue;
        }
        let (found, count) = broken(&document, &mut known);
        faults.extend(found);
        seen += count;
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(seen > 80, "only {seen} commands run");
}

#[cfg(unix)]
#[test]
fn a_command_that_ends_otherwise_is_seen() {
    let planted = Document {
        name: "planted.md".to_owned(),
        text:
            "```sh\nmechanim show SCENE --chain none\nmechanim scenes none   # exit code 2\n```\n"
                .to_owned(),
    };
    let (faults, seen) = broken(&planted, &mut BTreeSet::new());
    assert_eq!((faults.len(), seen), (1, 2), "{faults:?}");
}
