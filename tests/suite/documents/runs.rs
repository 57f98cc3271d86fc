//! The commands of the documents run as a shell runs them, and end with the exit code that stands beside them, or 0.
#![cfg_attr(not(unix), allow(dead_code))]

use super::fixtures::{filled, write_files};
use super::text::{Document, documents, program_command, stated_code};
use crate::program::{Workspace, undisturbed};
use std::collections::BTreeSet;
use std::path::Path;
use std::process::Command;

/// Commands that are not run, and why.
const NOT_RUN: [(&str, &str); 25] = [
    ("--watch", "runs until it is interrupted"),
    (
        "--live",
        "needs the engine as WebAssembly, see .ci/browsers",
    ),
    ("ffmpeg", "needs another program"),
    (".mp4", "needs another program"),
    ("--format rgba", "many frames"),
    ("--format y4m", "many frames"),
    ("seven-r.gif", "many frames"),
    ("render gearshift --out anim", "many frames"),
    ("render bricard --orbit", "many frames"),
    ("iterates.gif", "see tests of films"),
    ("--pieces 100000", "many pieces"),
    ("--trials 1000000", "many trials"),
    ("--film search.gif", "seconds"),
    ("map.svg", "seconds"),
    ("nelder-mead --history", "seconds"),
    ("gearshift --pairs", "seconds"),
    ("--vary all --within", "a minute"),
    ("--method minimax", "a minute"),
    ("synthesise", "minutes"),
    ("twin-steer", "seconds"),
    ("accuracy tests", "seconds"),
    ("enclose gearshift", "seconds"),
    ("gearshift-optimised", "seconds"),
    ("benches", "measurements"),
    ("${", "a loop over all scenes"),
];

/// Whether a command is not run.
pub fn is_left_out(command: &str) -> bool {
    NOT_RUN.iter().any(|(part, _)| command.contains(part))
}

/// A command of a document and the exit code that it should end with.
struct Promise {
    command: String,
    code: i32,
}

/// The commands of a document: those of its blocks, where a comment may state an exit code, and those in tables, where the row
/// may.
fn promises(document: &Document) -> Vec<Promise> {
    let mut list = Vec::new();
    for block in document.blocks().iter().filter(|b| b.language == "sh") {
        for line in block.command_lines() {
            list.extend(promise(&line, &line));
        }
    }
    for (code, paragraph) in document.inline_code() {
        if paragraph.starts_with('|') {
            list.extend(promise(&code, &paragraph));
        }
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

/// What ends otherwise than promised.
fn broken(document: &Document) -> (Vec<String>, usize) {
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
        if command.split(' ').count() < 3 || !done.insert(command.clone()) {
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
    let path = std::env::var("PATH").unwrap_or_default();
    let mut shell = Command::new("sh");
    shell
        .args(["-c", line])
        .current_dir(workspace.path(""))
        .env("PATH", format!("{folder}:{path}"))
        .stdin(std::process::Stdio::null());
    undisturbed(&mut shell);
    shell.output().unwrap()
}

#[cfg(unix)]
#[test]
fn commands_of_the_documents_end_as_stated() {
    let (mut faults, mut seen) = (Vec::new(), 0);
    for document in documents() {
        // Those of sources.md are run by its own test.
        if document.name.ends_with("sources.md") {
            continue;
        }
        let (found, count) = broken(&document);
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
    let (faults, seen) = broken(&planted);
    assert_eq!((faults.len(), seen), (1, 2), "{faults:?}");
}
