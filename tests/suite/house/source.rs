//! The source files, and their text without what is no code of the program.

use std::path::{Path, PathBuf};

/// A source file: its name relative to `src/`, with `/`, and its text.
pub struct Source {
    pub name: String,
    pub text: String,
}

/// All files under `src/`, in the order of their names.
pub fn sources() -> Vec<Source> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    rust_files(&root, &mut files);
    files.sort();
    assert!(files.len() > 50, "only {} files found", files.len());
    let read = |path: PathBuf| Source {
        name: path
            .strip_prefix(&root)
            .unwrap()
            .to_str()
            .unwrap()
            .replace('\\', "/"),
        text: std::fs::read_to_string(&path).unwrap(),
    };
    files.into_iter().map(read).collect()
}

fn rust_files(folder: &Path, found: &mut Vec<PathBuf>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            rust_files(&path, found);
        } else if path.extension().is_some_and(|e| e == "rs") {
            found.push(path);
        }
    }
}

/// Whether a whole file holds tests.
pub fn is_test(name: &str) -> bool {
    name.ends_with("tests.rs") || name.contains("/tests/")
}

/// The text without comments at the beginning of lines, and without the test module that ends a file.
pub fn with_strings(text: &str) -> String {
    let lines = before_tests(text).lines();
    let lines = lines.filter(|line| !line.trim_start().starts_with("//"));
    lines.collect::<Vec<_>>().join("\n")
}

/// The text without its test module, which ends every file.
pub fn before_tests(text: &str) -> &str {
    let end = text.find("#[cfg(test)]\nmod tests {");
    &text[..end.unwrap_or(text.len())]
}

/// The text with comments, strings and characters blanked out, and without what is compiled for tests only.
pub fn bare(text: &str) -> String {
    without_tests(&without_words(text))
}

/// The text with comments, strings and characters blanked out. Line breaks stay.
pub fn without_words(text: &str) -> String {
    let mut bare = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(next) = rest.chars().next() {
        let length = comment(rest)
            .or_else(|| raw_string(rest, bare.chars().last()))
            .or_else(|| string(rest))
            .or_else(|| character(rest));
        match length {
            Some(length) => bare.push_str(&blank(&rest[..length])),
            None => bare.push(next),
        }
        rest = &rest[length.unwrap_or(next.len_utf8())..];
    }
    bare
}

fn blank(text: &str) -> String {
    let breaks = text.chars().filter(|c| *c == '\n');
    std::iter::once(' ').chain(breaks).collect()
}

/// Length of the comment that `text` begins with. Comments in comments count.
fn comment(text: &str) -> Option<usize> {
    if text.starts_with("//") {
        return Some(text.find('\n').unwrap_or(text.len()));
    }
    let mut at = text.strip_prefix("/*").map(|_| 2)?;
    let mut depth = 1;
    while depth > 0 && at < text.len() {
        let (step, change) = match &text.as_bytes()[at..] {
            [b'/', b'*', ..] => (2, 1),
            [b'*', b'/', ..] => (2, -1),
            _ => (1, 0),
        };
        at += step;
        depth += change;
    }
    Some(at)
}

/// Length of the raw string that `text` begins with, where `before` does not make its `r` the end of a name.
fn raw_string(text: &str, before: Option<char>) -> Option<usize> {
    if before.is_some_and(|c| c.is_alphanumeric() && c != 'b' || c == '_') {
        return None;
    }
    let after = text.strip_prefix('r')?;
    let hashes = after.len() - after.trim_start_matches('#').len();
    let inside = after[hashes..].strip_prefix('"')?;
    let end = format!("\"{}", "#".repeat(hashes));
    let length = inside.find(&end).unwrap_or(inside.len() - end.len());
    Some(text.len() - inside.len() + length + end.len())
}

fn string(text: &str) -> Option<usize> {
    quoted(text, '"')
}

/// Length of the character that `text` begins with; a lifetime is none.
fn character(text: &str) -> Option<usize> {
    let mut inside = text.strip_prefix('\'')?.chars();
    let is_escape = inside.next()? == '\\';
    if is_escape || inside.next() == Some('\'') {
        return quoted(text, '\'');
    }
    None
}

fn quoted(text: &str, mark: char) -> Option<usize> {
    let inside = text.strip_prefix(mark)?;
    let mut is_escaped = false;
    for (at, c) in inside.char_indices() {
        if c == mark && !is_escaped {
            return Some(1 + at + 1);
        }
        is_escaped = c == '\\' && !is_escaped;
    }
    Some(text.len())
}

/// The bare text without the items under `#[cfg(test)]`.
fn without_tests(bare: &str) -> String {
    const MARK: &str = "#[cfg(test)]";
    let mut kept = String::with_capacity(bare.len());
    let mut rest = bare;
    while let Some(at) = rest.find(MARK) {
        kept.push_str(&rest[..at]);
        let item = &rest[at + MARK.len()..];
        rest = &item[item_length(item)..];
    }
    kept + rest
}

/// Length of the item that bare text begins with: to its closing brace, or to a semicolon outside braces.
fn item_length(bare: &str) -> usize {
    let mut depth = 0;
    for (at, c) in bare.char_indices() {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            _ => {}
        }
        if depth == 0 && (c == '}' || c == ';') {
            return at + 1;
        }
    }
    bare.len()
}

#[test]
fn only_code_is_left() {
    let text = r##"//! a::a
use b::b; /* c::c /* d::d */ e::e */
fn f<'a>(x: &'a str) -> char { let y = "g::g \" h::h"; let z = r#"i::i " j::j"#; '"' }
const K: [char; 2] = ['\'', '{'];
#[cfg(test)]
#[allow(clippy::panic)]
mod tests { use l::l; fn m() {} }
#[cfg(test)]
mod more;
fn last() { n::n() }
"##;
    let bare = bare(text);
    for word in ["b::b", "n::n", "'a"] {
        assert!(bare.contains(word), "{word} in {bare}");
    }
    for word in [
        "a::a", "c::c", "d::d", "e::e", "g::g", "h::h", "i::i", "j::j", "l::l", "more",
    ] {
        assert!(!bare.contains(word), "{word} in {bare}");
    }
}
