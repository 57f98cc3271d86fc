//! Which file uses which: the graph of `use` lines and paths, and its circles.

use std::collections::{BTreeMap, BTreeSet};

use super::paths::{Paths, paths};
use super::source::{Source, bare, is_test};

/// The files that each file uses, itself left out. Names are relative to `src/`.
pub type Graph = BTreeMap<String, BTreeSet<String>>;

/// A path from the root of the crate.
type Module = Vec<String>;

/// The graph of the program's code; files of tests are left out.
///
/// A path leads to the file of the longest module that it begins with: an item that `mod.rs` hands on is one of
/// `mod.rs`. A `mod` line alone is no use.
pub fn graph(sources: &[Source]) -> Graph {
    let code: Vec<&Source> = sources.iter().filter(|s| !is_test(&s.name)).collect();
    let files: BTreeMap<Module, &str> = code
        .iter()
        .map(|s| (module(&s.name), s.name.as_str()))
        .collect();
    let used = |source: &&Source| {
        let own = module(&source.name);
        let mut used = absolute_paths(&paths(&bare(&source.text)), &own, &files)
            .iter()
            .map(|path| file_of(path, &files))
            .collect::<BTreeSet<String>>();
        used.remove(&source.name);
        (source.name.clone(), used)
    };
    code.iter().map(used).collect()
}

/// The module of a file.
fn module(name: &str) -> Module {
    let path = name.strip_suffix(".rs").unwrap();
    let path = path.strip_suffix("/mod").unwrap_or(path);
    if path == "lib" {
        return Module::new();
    }
    path.split('/').map(str::to_owned).collect()
}

/// The file of the longest module that `path` begins with.
fn file_of(path: &[String], files: &BTreeMap<Module, &str>) -> String {
    let lengths = (0..=path.len()).rev();
    let mut found = lengths.filter_map(|length| files.get(&path[..length]));
    found.next().copied().unwrap_or("lib.rs").to_owned()
}

/// The paths of a file that stay in the crate, from its root.
fn absolute_paths(found: &Paths, own: &Module, files: &BTreeMap<Module, &str>) -> Vec<Module> {
    let mut names = BTreeMap::new();
    let mut absolute = Vec::new();
    // A `use` line may begin with what a later one brings.
    for _ in 0..2 {
        for (path, name) in &found.uses {
            if let Some(path) = from_root(path, own, &names, files) {
                names.insert(name.clone(), path.clone());
                absolute.push(path);
            }
        }
    }
    let mentions = found.mentions.iter();
    absolute.extend(mentions.filter_map(|path| from_root(path, own, &names, files)));
    absolute
}

/// `path` as written in module `own`, from the root of the crate; none for other crates and for local names.
fn from_root(
    path: &[String],
    own: &Module,
    names: &BTreeMap<String, Module>,
    files: &BTreeMap<Module, &str>,
) -> Option<Module> {
    let (first, mut rest) = path.split_first()?;
    let mut base = match first.as_str() {
        "crate" | "mechanim" => Module::new(),
        "self" => own.clone(),
        "super" => own[..own.len() - 1].to_vec(),
        name => {
            let child = [own.as_slice(), &[name.to_owned()]].concat();
            let is_child = files.contains_key(&child);
            names.get(name).cloned().or(is_child.then_some(child))?
        }
    };
    while let Some((_, after)) = rest.split_first().filter(|(next, _)| *next == "super") {
        base.pop();
        rest = after;
    }
    base.extend_from_slice(rest);
    Some(base)
}

/// The circles of a graph: sets of files each of which leads to all others of the set.
pub fn circles(graph: &Graph) -> Vec<BTreeSet<&str>> {
    let reached: BTreeMap<&str, BTreeSet<&str>> = graph
        .keys()
        .map(|file| (file.as_str(), reach(graph, file)))
        .collect();
    let circle = |file: &&str| -> BTreeSet<&str> {
        let there = reached[file].iter();
        there
            .filter(|other| reached.get(*other).is_some_and(|back| back.contains(file)))
            .copied()
            .collect()
    };
    let all: BTreeSet<BTreeSet<&str>> = reached.keys().map(circle).collect();
    all.into_iter().filter(|circle| circle.len() > 1).collect()
}

/// All files that `file` leads to.
fn reach<'g>(graph: &'g Graph, file: &str) -> BTreeSet<&'g str> {
    let mut reached = BTreeSet::new();
    let mut open = vec![file];
    while let Some(next) = open.pop() {
        for used in graph.get(next).into_iter().flatten() {
            if reached.insert(used.as_str()) {
                open.push(used);
            }
        }
    }
    reached
}

/// What a circle is reported as: its files, and for each those of the circle that it uses.
pub fn describe(graph: &Graph, circle: &BTreeSet<&str>) -> String {
    let mut lines = format!("circle of {} files:", circle.len());
    for file in circle {
        let used = graph[*file]
            .iter()
            .filter(|used| circle.contains(used.as_str()));
        let used: Vec<&str> = used.map(String::as_str).collect();
        lines += &format!("\n  {file} -> {}", used.join(", "));
    }
    lines
}
