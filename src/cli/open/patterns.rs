//! Several scenes by one name: patterns such as `designs/*.toml`, expanded here, since not every shell does.

use crate::cli::args::scene::SceneArgs;
use crate::cli::term::outcome::Failure;
use std::ffi::{OsStr, OsString};
use std::path::{Component, Path, PathBuf};

/// A pattern with more files is regarded as a mistake.
const MOST_FILES: usize = 100_000;

/// The scenes of a command line, patterns expanded, each with its overrides from the command line.
///
/// Errors: a pattern that matches no file; standard input among several scenes.
pub fn scenes_of(first: &SceneArgs, more: &[OsString]) -> Result<Vec<SceneArgs>, Failure> {
    let mut names = Vec::new();
    for name in std::iter::once(&first.scene).chain(more) {
        names.extend(expand_pattern(name)?);
    }
    if names.len() > 1 && names.iter().any(|name| name == "-") {
        let message = "standard input is one scene: it cannot be among several";
        return Err(Failure::usage(message, Vec::new()));
    }
    let named = |scene: OsString| SceneArgs {
        scene,
        ..first.clone()
    };
    Ok(names.into_iter().map(named).collect())
}

/// The files that a name denotes: itself, unless it contains `*` or `?` and no file has exactly that name.
fn expand_pattern(name: &OsStr) -> Result<Vec<OsString>, Failure> {
    let text = name.to_string_lossy();
    if !text.contains(['*', '?']) || Path::new(name).exists() {
        return Ok(vec![name.to_owned()]);
    }
    let mut paths = vec![PathBuf::new()];
    for part in Path::new(name).components() {
        paths = match part {
            Component::Normal(part) if part.to_string_lossy().contains(['*', '?']) => {
                let pattern: Vec<char> = part.to_string_lossy().chars().collect();
                paths
                    .iter()
                    .flat_map(|folder| matching_paths(folder, &pattern))
                    .collect()
            }
            part => paths.into_iter().map(|path| path.join(part)).collect(),
        };
        if paths.len() > MOST_FILES {
            let message = format!("`{text}` matches more than {MOST_FILES} files");
            return Err(Failure::usage(message, Vec::new()));
        }
    }
    paths.retain(|path| path.exists());
    paths.sort();
    if paths.is_empty() {
        return Err(Failure::usage(
            format!("no file matches `{text}`"),
            Vec::new(),
        ));
    }
    Ok(paths.into_iter().map(PathBuf::into_os_string).collect())
}

/// The entries of a folder that match the pattern. Hidden files match only patterns that begin with a dot.
fn matching_paths(folder: &Path, pattern: &[char]) -> Vec<PathBuf> {
    let place = if folder.as_os_str().is_empty() {
        Path::new(".")
    } else {
        folder
    };
    // A folder that cannot be read has no matching files.
    let entries = std::fs::read_dir(place).into_iter().flatten().flatten();
    let names = entries.map(|entry| entry.file_name());
    let is_meant = |name: &OsString| {
        let name: Vec<char> = name.to_string_lossy().chars().collect();
        let is_hidden = name.first() == Some(&'.') && pattern.first() != Some(&'.');
        !is_hidden && is_like(&name, pattern)
    };
    names
        .filter(is_meant)
        .map(|name| folder.join(name))
        .collect()
}

/// Whether a name matches a pattern: `*` stands for any characters, `?` for one. Time grows with the product of both
/// lengths.
fn is_like(name: &[char], pattern: &[char]) -> bool {
    let (mut at, mut next) = (0, 0);
    // Position of the last star, and of the name when it was reached: the star takes one character more where the rest
    // fails.
    let mut star: Option<(usize, usize)> = None;
    while at < name.len() {
        match pattern.get(next) {
            Some('*') => {
                star = Some((next, at));
                next += 1;
            }
            Some(c) if *c == '?' || *c == name[at] => (at, next) = (at + 1, next + 1),
            _ => match star {
                None => return false,
                Some((place, taken)) => {
                    star = Some((place, taken + 1));
                    (at, next) = (taken + 1, place + 1);
                }
            },
        }
    }
    pattern[next..].iter().all(|c| *c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_match_whole_names() {
        let like = |name: &str, pattern: &str| {
            let [name, pattern] = [name, pattern].map(|text| text.chars().collect::<Vec<_>>());
            is_like(&name, &pattern)
        };
        for (name, pattern) in [
            ("a.toml", "*.toml"),
            ("a.toml", "?.toml"),
            ("", "*"),
            ("abcabd", "*ab?"),
            ("größe.toml", "gr??e.*"),
        ] {
            assert!(like(name, pattern), "{name} {pattern}");
        }
        for (name, pattern) in [
            ("a.tom", "*.toml"),
            ("ab.toml", "?.toml"),
            ("", "?"),
            ("abc", "*b"),
        ] {
            assert!(!like(name, pattern), "{name} {pattern}");
        }
        // Many stars take no longer than the product of both lengths.
        assert!(!like(
            &"a".repeat(20_000),
            &"*a".repeat(200).replace("*a*a*a", "*a*ab")
        ));
    }
}
