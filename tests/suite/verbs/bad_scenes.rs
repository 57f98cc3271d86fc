//! Every mistake in a scene gets its message at its place: the scenes of `tests/bad/` say themselves what is expected.
//!
//! Comments that start with `#!` are expectations:
//! - `#! error 14 text`: an error at column 14 of the nearest line above that is not itself such a comment, whose
//!   message holds the text; `#! error 7:14 text` names the line too; `#! error - text` is one without a place;
//! - `#! says text`: somewhere in the output of that error there is this text (a hint, a second place);
//! - `#! exit 4`: the exit code, if it is not 2;
//! - `#! schema .bodies[0]: lacks `name``: a fault that the schema for editors sees (`schema.rs` compares them).
//!
//! The number of errors must be the number of expectations.

use crate::program::{Run, Workspace};
use std::path::{Path, PathBuf};

/// One message of the program, or one that is expected.
#[derive(Debug, Default)]
struct Message {
    text: String,
    /// Line and column.
    place: Option<(usize, usize)>,
    /// The message with its excerpt and hints, or what must be among them.
    body: Vec<String>,
}

/// What a scene expects.
#[derive(Debug)]
struct Expected {
    messages: Vec<Message>,
    code: i32,
}

fn expectations(text: &str) -> Result<Expected, String> {
    let mut expected = Expected {
        messages: Vec::new(),
        code: 2,
    };
    let mut line_above = 0;
    for (number, line) in (1..).zip(text.lines()) {
        let Some(comment) = line.strip_prefix("#! ") else {
            line_above = number;
            continue;
        };
        let (word, rest) = comment.split_once(' ').ok_or("an empty expectation")?;
        match word {
            "error" => {
                let (place, text) = rest.split_once(' ').ok_or("a place and no message")?;
                expected.messages.push(Message {
                    text: text.to_owned(),
                    place: place_of(place, line_above)?,
                    body: Vec::new(),
                });
            }
            "says" => {
                let last = expected
                    .messages
                    .last_mut()
                    .ok_or("`says` before `error`")?;
                last.body.push(rest.to_owned());
            }
            "schema" => {}
            "exit" => expected.code = rest.parse().map_err(|_| "no exit code")?,
            other => return Err(format!("unknown expectation `{other}`")),
        }
    }
    if expected.messages.is_empty() {
        return Err("the file expects nothing".to_owned());
    }
    Ok(expected)
}

/// `-`, `12` or `7:12`.
fn place_of(text: &str, line_above: usize) -> Result<Option<(usize, usize)>, String> {
    let number = |t: &str| t.parse().map_err(|_| format!("`{t}` is no place"));
    match text.split_once(':') {
        _ if text == "-" => Ok(None),
        Some((line, column)) => Ok(Some((number(line)?, number(column)?))),
        None => Ok(Some((line_above, number(text)?))),
    }
}

/// The messages in what the program wrote about the file `name`.
fn messages(stderr: &str, name: &str) -> Vec<Message> {
    let mut list: Vec<Message> = Vec::new();
    for line in stderr.lines() {
        if let Some(text) = line.strip_prefix("error: ") {
            list.push(Message {
                text: text.to_owned(),
                ..Message::default()
            });
        }
        let Some(last) = list.last_mut() else {
            continue;
        };
        let place = line.trim_start().strip_prefix("┌─ ");
        if let Some(place) = place.and_then(|p| p.strip_prefix(name)) {
            let mut numbers = place.split(':').skip(1).map(|n| n.parse().unwrap());
            last.place = Some((numbers.next().unwrap(), numbers.next().unwrap()));
        }
        last.body.push(line.to_owned());
    }
    list
}

/// What is wrong with the run, if anything.
fn compare(expected: &Expected, run: &Run, name: &str) -> Result<(), String> {
    if run.code != expected.code {
        return Err(format!("exit code {} for {}", run.code, expected.code));
    }
    if !run.stdout.is_empty() {
        return Err("something on standard output".to_owned());
    }
    let mut found = messages(&run.stderr, name);
    let (got, wanted) = (found.len(), expected.messages.len());
    if got != wanted {
        return Err(format!("{got} errors where {wanted} are expected"));
    }
    for wanted in &expected.messages {
        let fits = |m: &Message| m.place == wanted.place && m.text.contains(&wanted.text);
        let Some(index) = found.iter().position(fits) else {
            return Err(format!("no error `{}` at {:?}", wanted.text, wanted.place));
        };
        let found = found.swap_remove(index).body.join("\n");
        if let Some(part) = wanted.body.iter().find(|part| !found.contains(*part)) {
            return Err(format!("`{part}` is not said"));
        }
    }
    Ok(())
}

fn scenes(folder: &Path) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut list: Vec<PathBuf> = entries.map(|e| e.unwrap().path()).collect();
    list.retain(|path| path.extension().is_some_and(|e| e == "toml"));
    list.sort();
    list
}

#[test]
fn every_bad_scene_is_refused_as_it_says() {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/bad");
    let scenes = scenes(&folder);
    assert!(!scenes.is_empty(), "no scenes in {}", folder.display());
    let workspace = Workspace::new();
    let mut failures = Vec::new();
    for path in &scenes {
        let name = path.to_str().unwrap();
        let text = std::fs::read_to_string(path).unwrap();
        let run = workspace.run(&["check", name]);
        let outcome = expectations(&text).and_then(|expected| compare(&expected, &run, name));
        if let Err(reason) = outcome {
            failures.push(format!("{name}: {reason}\n{}", run.stderr));
        }
    }
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// The comparison must see each kind of difference.
#[test]
fn the_comparison_can_fail() {
    let scene = "a = 1\n#! error 5 wrong\n#! says hint: mend it\n";
    let said = "error: quite wrong\n  ┌─ a.toml:1:5\n  │\n  = hint: mend it\n";
    let outcome = |scene: &str, stderr: &str, code: i32| {
        let run = Run {
            code,
            stdout: Vec::new(),
            stderr: stderr.to_owned(),
        };
        expectations(scene).and_then(|expected| compare(&expected, &run, "a.toml"))
    };
    assert_eq!(outcome(scene, said, 2), Ok(()));
    assert!(outcome(scene, said, 4).is_err());
    assert!(outcome(scene, &said.replace("1:5", "1:4"), 2).is_err());
    assert!(outcome(scene, &said.replace("1:5", "2:5"), 2).is_err());
    assert!(outcome(scene, &said.replace("wrong", "right"), 2).is_err());
    assert!(outcome(scene, &said.replace("mend", "leave"), 2).is_err());
    assert!(outcome(scene, &said.repeat(2), 2).is_err());
    assert!(outcome(scene, "", 2).is_err());
    assert!(outcome("a = 1\n", said, 2).is_err());
    assert!(outcome("#! eror 5 wrong\n", said, 2).is_err());
}

#[test]
fn a_scene_that_is_not_text_is_refused() {
    let workspace = Workspace::new();
    workspace.write("latin.toml", b"title = \"K\xe4fig\"\n");
    let run = workspace.run(&["check", "latin.toml"]).exits(2);
    run.prints_nothing().says(&["latin.toml", "not UTF-8"]);
    workspace.write("image.toml", [0u8, 159, 146, 150].repeat(64));
    workspace
        .run(&["check", "image.toml"])
        .exits(2)
        .says(&["image.toml"]);
}

#[test]
fn an_empty_scene_says_that_nothing_is_in_it() {
    let workspace = Workspace::new();
    for text in ["", "\n\n# a comment\n", "title = \"nothing\"\n"] {
        workspace.write("empty.toml", text);
        workspace
            .run(&["check", "empty.toml"])
            .exits(2)
            .prints_nothing()
            .says(&["empty.toml", "no loop"]);
    }
}

#[test]
fn a_scene_of_five_megabytes_is_refused_with_the_limit() {
    let workspace = Workspace::new();
    workspace.write("large.toml", "# nothing\n".repeat(500_000));
    workspace
        .run(&["check", "large.toml"])
        .exits(2)
        .says(&["large.toml", "at most 4194304 bytes"]);
}

#[test]
fn hostile_nesting_of_tables_ends_in_a_message() {
    let workspace = Workspace::new();
    let depth = 100_000;
    for text in [
        format!("a = {}{}\n", "[".repeat(depth), "]".repeat(depth)),
        format!("a = {}1{}\n", "{a=".repeat(depth), "}".repeat(depth)),
        format!("[{}]\n", vec!["a"; depth].join(".")),
    ] {
        workspace.write("deep.toml", text);
        workspace
            .run(&["check", "deep.toml"])
            .exits(2)
            .prints_nothing();
    }
}

#[test]
fn a_stranger_among_the_characters_keeps_the_column_right() {
    let workspace = Workspace::new();
    workspace.write("greek.toml", "[parameters]\n\"ä\" = 1\na = \"ä + φ\"\n");
    let run = workspace.run(&["check", "greek.toml"]).exits(2);
    run.says(&["greek.toml:3:10", "`φ`"]);
}
