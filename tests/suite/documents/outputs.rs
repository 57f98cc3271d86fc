//! What stands below a command in the documents is what the command prints, line by line and in its order, and `echo $?` is its
//! exit code; a command without one ends with 0.

use super::text::{Document, documents, words};
use crate::program::{Run, Workspace};

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

/// What a command printed, with the line of each stream that was found last.
struct Printed {
    command: String,
    code: i32,
    streams: [Vec<String>; 2],
    next: [usize; 2],
    is_code_stated: bool,
}

impl Printed {
    fn new(command: &str, run: &Run) -> Self {
        let lines = |text: &str| text.lines().map(str::to_owned).collect();
        Self {
            command: command.to_owned(),
            code: run.code,
            streams: [lines(&run.text()), lines(&run.stderr)],
            next: [0, 0],
            is_code_stated: false,
        }
    }

    /// Whether `line` comes behind those found so far.
    fn has_next(&mut self, line: &str) -> bool {
        for (stream, next) in self.streams.iter().zip(&mut self.next) {
            let place = stream[*next..].iter().position(|p| is_like(line, p));
            if let Some(place) = place {
                *next += place + 1;
                return true;
            }
        }
        false
    }

    /// A command that fails says so in the document.
    fn unstated_code(&self) -> Option<String> {
        (self.code != 0 && !self.is_code_stated)
            .then(|| format!("`{}` ends with {}", self.command, self.code))
    }
}

/// Lines that are not printed, codes that are not those; and how many lines were compared.
fn faults(document: &Document) -> (Vec<String>, usize) {
    let workspace = Workspace::new();
    let (mut faults, mut compared) = (Vec::new(), 0);
    for block in document.blocks() {
        block.save_in(&workspace);
        if block.language != "console" {
            continue;
        }
        let mut printed: Option<Printed> = None;
        for line in &block.lines {
            let last = printed.as_mut();
            if let Some(command) = line.strip_prefix("$ mechanim ") {
                faults.extend(last.and_then(|p| p.unstated_code()));
                printed = Some(Printed::new(command, &workspace.run(&words(command))));
            } else if line == "$ echo $?" {
                last.unwrap().is_code_stated = true;
            } else if !line.starts_with('$') && !line.trim().is_empty() && line.trim() != "…" {
                compared += 1;
                let last = last.unwrap();
                let is_printed = if last.is_code_stated {
                    *line == last.code.to_string()
                } else {
                    last.has_next(line)
                };
                if !is_printed {
                    faults.push(format!("`{line}` is not printed by {}", last.command));
                }
            }
        }
        faults.extend(printed.and_then(|p| p.unstated_code()));
    }
    let named = faults.iter().map(|f| format!("{}: {f}", document.name));
    (named.collect(), compared)
}

#[test]
fn outputs_in_the_documents_are_printed() {
    let (mut list, mut compared) = (Vec::new(), 0);
    for document in documents() {
        let (found, count) = faults(&document);
        list.extend(found);
        compared += count;
    }
    assert!(list.is_empty(), "{}", list.join("\n"));
    assert!(compared > 60, "only {compared} lines compared");
}

#[test]
fn lines_are_compared_as_they_look() {
    assert!(is_like("  a   1 …", "a 1 and more"));
    assert!(is_like("a … z", "  a b c z"));
    assert!(!is_like("a 1", "a 2"));
    assert!(!is_like("a 1", "a 1 and more"));
    assert!(!is_like("a … z", "a b c"));
    let planted = Document {
        name: "planted.md".to_owned(),
        text: "```console\n$ mechanim scenes none\n$ mechanim show slider-crank\nloop A = …\nSlider-crank …\n$ echo $?\n1\n```\n"
            .to_owned(),
    };
    let (faults, compared) = faults(&planted);
    assert_eq!(compared, 3);
    // The code of the first, a line out of order, and a wrong code.
    assert_eq!(faults.len(), 3, "{faults:?}");
}
