//! The paths of a source text: the leaves of its `use` lines and the paths in its code.

use std::collections::BTreeSet;

/// The paths of a text, as written.
#[derive(Debug, Default, PartialEq)]
pub struct Paths {
    /// Leaves of `use` trees and the names that they bring.
    pub uses: Vec<(Vec<String>, String)>,
    /// Paths of two segments or more elsewhere.
    pub mentions: BTreeSet<Vec<String>>,
}

/// The paths of bare code, see [`bare`](super::source::bare).
pub fn paths(bare: &str) -> Paths {
    let tokens = tokens(bare);
    let mut paths = Paths::default();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at] == "use" && tokens.get(at + 1).is_some_and(|t| t != "<") {
            at += 1;
            leaves(&tokens, &mut at, &[], &mut paths.uses);
        } else if is_name(&tokens[at]) {
            let path = path(&tokens, &mut at);
            if path.len() > 1 {
                paths.mentions.insert(path);
            }
        } else {
            at += 1;
        }
    }
    paths
}

/// Names, `::` and single signs.
fn tokens(bare: &str) -> Vec<String> {
    let mut tokens = Vec::new();
    let mut rest = bare.trim_start();
    while let Some(first) = rest.chars().next() {
        let is_part = |c: char| c.is_alphanumeric() || c == '_';
        let length = if is_part(first) {
            rest.find(|c| !is_part(c)).unwrap_or(rest.len())
        } else if rest.starts_with("::") {
            2
        } else {
            first.len_utf8()
        };
        tokens.push(rest[..length].to_owned());
        rest = rest[length..].trim_start();
    }
    tokens
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// The names joined by `::` from token `at` on.
fn path(tokens: &[String], at: &mut usize) -> Vec<String> {
    let mut path = vec![tokens[*at].clone()];
    *at += 1;
    while tokens.get(*at).is_some_and(|t| t == "::")
        && tokens.get(*at + 1).is_some_and(|t| is_name(t))
    {
        path.push(tokens[*at + 1].clone());
        *at += 2;
    }
    path
}

/// Adds the leaves of the use tree that begins at token `at`, under `prefix`.
fn leaves(
    tokens: &[String],
    at: &mut usize,
    prefix: &[String],
    found: &mut Vec<(Vec<String>, String)>,
) {
    let mut whole = prefix.to_vec();
    if tokens.get(*at).is_some_and(|t| is_name(t)) {
        whole.extend(path(tokens, at));
        if tokens.get(*at).is_some_and(|t| t == "::") {
            *at += 1;
        } else {
            return found.push(leaf(tokens, at, whole));
        }
    }
    match tokens.get(*at).map(String::as_str) {
        Some("*") => {
            *at += 1;
            found.push((whole, "*".to_owned()));
        }
        Some("{") => {
            while tokens
                .get(*at)
                .is_some_and(|t| matches!(t.as_str(), "{" | ","))
            {
                *at += 1;
                if tokens.get(*at).is_some_and(|t| t != "}") {
                    leaves(tokens, at, &whole, found);
                }
            }
            *at += 1;
        }
        _ => *at += 1,
    }
}

/// A leaf and the name it brings; `a::{self}` is `a`.
fn leaf(tokens: &[String], at: &mut usize, mut whole: Vec<String>) -> (Vec<String>, String) {
    if whole.len() > 1 && whole.last().is_some_and(|last| last == "self") {
        whole.pop();
    }
    let mut name = whole.last().unwrap().clone();
    if tokens.get(*at).is_some_and(|t| t == "as") {
        name.clone_from(&tokens[*at + 1]);
        *at += 2;
    }
    (whole, name)
}

#[test]
fn use_trees_and_paths_are_read() {
    let text = "use a::{\n    self, b::{C, d as e},\n    f::*,\n};\npub(crate) use super::g;\n\
                fn h(x: Vec<super::super::i::J>) -> impl Sized + use<> { k::l::<M>(n) }";
    let found = paths(text);
    let uses: Vec<String> = found
        .uses
        .iter()
        .map(|(path, name)| format!("{} {name}", path.join("::")))
        .collect();
    assert_eq!(
        uses,
        ["a a", "a::b::C C", "a::b::d e", "a::f *", "super::g g"]
    );
    let mentions: Vec<String> = found.mentions.iter().map(|p| p.join("::")).collect();
    assert_eq!(mentions, ["k::l", "super::super::i::J"]);
}
