//! Names and comments of the source, counted: `cargo test --release --test suite house::names -- --nocapture`.

use super::source::{bare, is_test, sources, without_words};
use std::collections::{BTreeMap, HashMap};

/// Rooms whose functions compute, and the one that makes a mechanism of a file.
const NUMERIC: [&str; 12] = [
    "analysis/",
    "clearance/",
    "distance/",
    "geometry/",
    "intervals/",
    "kinematics/",
    "linalg/",
    "model/",
    "numbers/",
    "render/cpu/",
    "render/mutual_shade/",
    "scene/resolve/",
];

/// Comments per hundred lines that the long functions of each of these rooms have at least, and those of each folder in them.
const LEAST: f64 = 3.0;

/// Lines of long functions from which on a folder is counted by itself.
const LARGE_FOLDER: usize = 200;

/// Lines of code from which on a function is long: the median has ten.
const LONG: usize = 10;

/// Words that may stand before `fn`, `struct` and the like.
const BEFORE: [&str; 4] = ["const ", "unsafe ", "async ", "default "];

/// A line without visibility and other words before the item's own.
fn item(line: &str) -> &str {
    let mut rest = line.trim_start();
    if let Some(after) = rest.strip_prefix("pub") {
        rest = match after.strip_prefix('(') {
            Some(inside) => inside.split_once(')').map_or("", |(_, rest)| rest),
            None => after,
        };
        rest = rest.trim_start();
    }
    while let Some(after) = BEFORE.iter().find_map(|word| rest.strip_prefix(word)) {
        rest = after;
    }
    rest
}

/// The name of the item that a line begins with one of `words`.
fn name_after<'l>(line: &'l str, words: &[&str]) -> Option<&'l str> {
    let after = words
        .iter()
        .find_map(|word| item(line).strip_prefix(word))?;
    let end = after.find(|c: char| !c.is_alphanumeric() && c != '_');
    Some(&after[..end.unwrap_or(after.len())]).filter(|name| !name.is_empty())
}

/// Whether bare text that begins with `impl` implements a trait, whose names are not ours to choose.
fn is_of_trait(from_impl: &str) -> bool {
    let head = from_impl.split('{').next().unwrap_or_default();
    head.split_whitespace().any(|word| word == "for")
}

/// The names of functions, each with whether an implemented trait gives it.
fn functions(bare: &str) -> Vec<(&str, bool)> {
    let mut names = Vec::new();
    let (mut is_given, mut at) = (false, 0);
    for line in bare.split_inclusive('\n') {
        if line.starts_with("impl") {
            is_given = is_of_trait(&bare[at..]);
        } else if line.starts_with('}') {
            is_given = false;
        }
        names.extend(name_after(line, &["fn "]).map(|name| (name, is_given)));
        at += line.len();
    }
    names
}

/// The names of types and traits; associated types are indented and left out.
fn types(bare: &str) -> impl Iterator<Item = &str> {
    let lines = bare.lines().filter(|line| !line.starts_with(' '));
    lines.filter_map(|line| name_after(line, &["struct ", "enum ", "trait ", "type ", "union "]))
}

/// Lines of code and of comments in the long functions of a text.
fn comments_of_long_functions(text: &str) -> [usize; 2] {
    let bare = without_words(text);
    let lines: Vec<(&str, &str)> = text.lines().zip(bare.lines()).collect();
    let mut sums = [0, 0];
    let mut next = 0;
    while next < lines.len() {
        let begin = next;
        next += 1;
        if name_after(lines[begin].1, &["fn "]).is_none() {
            continue;
        }
        let mut depth = 0;
        let ends = |line: &str| {
            let opens = line.matches('{').count() as i64;
            depth += opens - line.matches('}').count() as i64;
            depth == 0 && (opens > 0 || line.contains(['}', ';']))
        };
        let length = lines[begin..].iter().map(|(_, bare)| *bare).position(ends);
        next = begin + length.map_or(1, |length| length + 1);
        let own = lines[begin..next].iter();
        let code = own.clone().filter(|(_, bare)| !bare.trim().is_empty());
        let said = own.filter(|(text, bare)| {
            let is_comment = text.contains("//") && !text.trim_start().starts_with("///");
            is_comment && !bare.contains("//") && text.trim_end().len() > bare.trim_end().len()
        });
        let counts = [code.count(), said.count()];
        if counts[0] >= LONG {
            sums = [sums[0] + counts[0], sums[1] + counts[1]];
        }
    }
    sums
}

fn share(part: usize, all: usize) -> f64 {
    100.0 * part as f64 / all as f64
}

#[test]
fn functions_of_one_word_are_the_fewer() {
    // With those that traits give, and the chosen ones alone.
    let (mut all, mut short) = ([0, 0], [0, 0]);
    for file in sources().iter().filter(|file| !is_test(&file.name)) {
        for (name, is_given) in functions(&bare(&file.text)) {
            for k in 0..=usize::from(!is_given) {
                all[k] += 1;
                short[k] += usize::from(!name.contains('_'));
            }
        }
    }
    for (all, short) in all.into_iter().zip(short) {
        let percent = share(short, all);
        println!("functions of one word: {short} of {all}, {percent:.1} %");
        assert!(all > 2000 && percent <= 45.0, "{short} of {all}");
    }
    let planted = "impl fmt::Display for A {\n    fn fmt() {}\n}\nimpl A {\n    pub(super) const fn b_c() {}\n}\nfn d() {}\n";
    let planted = functions(planted);
    assert_eq!(planted, [("fmt", true), ("b_c", false), ("d", false)]);
}

#[test]
fn types_have_names_of_their_own() {
    let mut places: HashMap<String, Vec<String>> = HashMap::new();
    for file in sources().iter().filter(|file| !is_test(&file.name)) {
        for name in types(&bare(&file.text)) {
            places
                .entry(name.to_owned())
                .or_default()
                .push(file.name.clone());
        }
    }
    let all: usize = places.values().map(Vec::len).sum();
    let shared: Vec<_> = places.iter().filter(|(_, files)| files.len() > 1).collect();
    let count: usize = shared.iter().map(|(_, files)| files.len()).sum();
    println!(
        "types that share a name: {count} of {all}, {:.1} %: {shared:?}",
        share(count, all)
    );
    assert!(all > 500 && share(count, all) <= 2.0, "{shared:?}");
}

/// The folders of a file, from its room down: `a/`, `a/b/` for `a/b/c.rs`.
fn folders(name: &str) -> impl Iterator<Item = &str> {
    name.match_indices('/').map(|(end, _)| &name[..=end])
}

#[test]
fn long_numeric_functions_say_what_they_do() {
    let mut sums: BTreeMap<String, [usize; 2]> = BTreeMap::new();
    for file in sources().iter().filter(|file| !is_test(&file.name)) {
        let code = file.text.split("#[cfg(test)]\nmod tests {").next();
        let counts = comments_of_long_functions(code.unwrap_or_default());
        let is_numeric = |folder: &&str| NUMERIC.iter().any(|room| folder.starts_with(room));
        for folder in folders(&file.name).filter(is_numeric) {
            let own = sums.entry(folder.to_owned()).or_default();
            *own = [own[0] + counts[0], own[1] + counts[1]];
        }
    }
    let mut poor = Vec::new();
    for (folder, [code, said]) in &sums {
        let line = format!(
            "{folder}: {said} comments to {code} lines of functions of {LONG} lines or more, {:.1} %",
            share(*said, *code)
        );
        println!("{line}");
        let counts = *code >= LARGE_FOLDER || NUMERIC.contains(&folder.as_str());
        if counts && share(*said, *code) < LEAST {
            poor.push(line);
        }
    }
    assert!(poor.is_empty(), "{}", poor.join("\n"));
    let all: usize = NUMERIC.iter().map(|room| sums[*room][0]).sum();
    assert!(all > 25_000, "only {all} lines found");
    let planted = format!(
        "fn a() {{\n    // One.\n    let b = \"// {{\"; // Two.\n{}}}\n",
        "    c();\n".repeat(LONG)
    );
    assert_eq!(comments_of_long_functions(&planted), [LONG + 3, 2]);
}
