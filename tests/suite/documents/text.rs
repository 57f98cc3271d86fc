//! Documents as their readers see them: blocks of code, code within sentences, and the commands in both.

use crate::program::Workspace;
use std::path::Path;

/// A document and its name relative to the repository.
pub struct Document {
    pub name: String,
    pub text: String,
}

/// A fenced block of a document.
pub struct Block {
    /// Empty for a fence without a label.
    pub language: String,
    /// The name in backticks that the last line before it ends in, as in "Save this as `wiper.toml`:".
    pub name: Option<String>,
    /// Number of the line that opens it.
    pub line: usize,
    pub lines: Vec<String>,
}

/// README, CONTRIBUTING and everything in `docs/`, in the order of their names.
pub fn documents() -> Vec<Document> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut paths = vec![root.join("README.md"), root.join("CONTRIBUTING.md")];
    let docs = std::fs::read_dir(root.join("docs")).unwrap();
    paths.extend(docs.map(|entry| entry.unwrap().path()));
    paths.retain(|path| path.extension().is_some_and(|e| e == "md"));
    paths.sort();
    let read = |path: &std::path::PathBuf| Document {
        name: path.strip_prefix(root).unwrap().display().to_string(),
        text: std::fs::read_to_string(path).unwrap(),
    };
    paths.iter().map(read).collect()
}

/// The same with ARCHITECTURE and CHANGELOG, which name files and what has changed.
pub fn all_documents() -> Vec<Document> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut list = documents();
    for name in ["ARCHITECTURE.md", "CHANGELOG.md"] {
        list.push(Document {
            name: name.to_owned(),
            text: std::fs::read_to_string(root.join(name)).unwrap(),
        });
    }
    list
}

impl Document {
    /// Its fenced blocks.
    pub fn blocks(&self) -> Vec<Block> {
        let mut list: Vec<Block> = Vec::new();
        let (mut is_open, mut above) = (false, String::new());
        for (number, line) in self.text.lines().enumerate() {
            if let Some(language) = line.trim_start().strip_prefix("```") {
                is_open = !is_open;
                if is_open {
                    let mut words = above.rsplit('`').skip(1);
                    let name = above.ends_with("`:").then(|| words.next()).flatten();
                    list.push(Block {
                        language: language.to_owned(),
                        name: name.map(str::to_owned),
                        line: number + 1,
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

    /// What stands in single backticks within sentences and tables, each with the rest of its paragraph or row.
    pub fn inline_code(&self) -> Vec<(String, String)> {
        let mut paragraphs = vec![String::new()];
        let mut is_open = false;
        for line in self.text.lines() {
            let is_fence = line.trim_start().starts_with("```");
            is_open ^= is_fence;
            let is_alone = line.trim().is_empty() || line.starts_with(['|', '*', '#']);
            if is_alone || is_fence {
                paragraphs.push(String::new());
            }
            if !is_open && !is_fence {
                let last = paragraphs.last_mut().unwrap();
                last.push_str(line.trim());
                last.push(' ');
            }
        }
        let mut list = Vec::new();
        for paragraph in paragraphs {
            let code = paragraph.split('`').skip(1).step_by(2);
            list.extend(code.map(|code| (code.to_owned(), paragraph.clone())));
        }
        list
    }
}

impl Block {
    /// Writes the file that it shows, if it shows one; a further block of the same name is the rest of the file.
    pub fn save_in(&self, workspace: &Workspace) {
        if let ("toml", Some(file)) = (self.language.as_str(), &self.name) {
            let path = workspace.path(file);
            let before = std::fs::read_to_string(path).unwrap_or_default();
            workspace.write(file, format!("{before}\n{}\n", self.lines.join("\n")));
        }
    }

    /// Its lines, continued ones put together, without the `$` of a prompt.
    pub fn command_lines(&self) -> Vec<String> {
        let text = self.lines.join("\n").replace("\\\n", " ");
        let lines = text.lines().map(|line| line.trim_start_matches("$ "));
        lines.map(str::to_owned).collect()
    }
}

/// The command of the program in a line of a shell, from `mechanim` on; `None` if there is none. Settings of the environment may
/// stand before it, and `cargo run` in its place.
pub fn program_command(line: &str) -> Option<String> {
    let mut rest = line.trim_start();
    if let Some((_, arguments)) = rest.split_once("cargo run --release -- ") {
        return Some(format!("mechanim {arguments}"));
    }
    while let Some((first, more)) = rest.split_once(' ') {
        let is_setting = first
            .split_once('=')
            .is_some_and(|(name, _)| name.chars().all(|c| c.is_ascii_uppercase() || c == '_'));
        if !is_setting {
            break;
        }
        rest = more.trim_start();
    }
    rest.starts_with("mechanim ").then(|| rest.to_owned())
}

/// The words of a command up to a pipe, a redirection or a comment; quotes are taken off.
pub fn words(command: &str) -> Vec<String> {
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

/// The exit code that a text states, as in "exit code 4".
pub fn stated_code(text: &str) -> Option<i32> {
    let after = text.split("exit code ").nth(1)?;
    let digits: String = after.chars().take_while(char::is_ascii_digit).collect();
    digits.parse().ok()
}

#[test]
fn documents_are_read_as_they_look() {
    let document = Document {
        name: "planted.md".to_owned(),
        text: "A `one\ntwo` b.\n\nSave as `a.toml`:\n```toml\nx = 1\n```\n| `c d` | e |\n"
            .to_owned(),
    };
    let [block] = document
        .blocks()
        .try_into()
        .unwrap_or_else(|_| panic!("one block"));
    assert_eq!(
        (block.language.as_str(), block.name.as_deref(), block.line),
        ("toml", Some("a.toml"), 5)
    );
    let code: Vec<String> = document.inline_code().into_iter().map(|c| c.0).collect();
    assert_eq!(code, ["one two", "a.toml", "c d"]);
    assert_eq!(
        words("mechanim a 'b c' \"d\" # e"),
        ["mechanim", "a", "b c", "d"]
    );
    assert_eq!(
        program_command("A=1 mechanim x").as_deref(),
        Some("mechanim x")
    );
    assert_eq!(program_command("cargo test"), None);
    assert_eq!(stated_code("(exit code 4)"), Some(4));
}
