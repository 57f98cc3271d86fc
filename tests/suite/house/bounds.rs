//! Bounds in texts are rounded to the safe side, by `report/rounded.rs`: no format rounds one to the nearest number.

use super::source::{is_test, sources, with_strings};

/// Words before a number that is a bound.
const BEFORE: [&str; 8] = [
    "at most {",
    "at least {",
    "never below {",
    "never above {",
    "no more than {",
    "no less than {",
    "up to {",
    "proved to {",
];

/// Words behind one.
const BEHIND: [&str; 2] = ["} at most", "} at least"];

/// The formats of bounds that have a precision.
fn rounded_bounds(text: &str) -> Vec<String> {
    let text = joined(&with_strings(text));
    let before = BEFORE.iter().flat_map(|words| {
        let places = text.match_indices(words);
        places.map(|(at, words)| &text[at + words.len()..])
    });
    let before = before.filter_map(|rest| rest.split('}').next());
    let behind = BEHIND.iter().flat_map(|words| {
        let places = text.match_indices(words);
        places.map(|(at, _)| &text[..at])
    });
    let behind = behind.filter_map(|rest| rest.rsplit('{').next());
    let formats = before.chain(behind).filter(|format| {
        let how = format.split_once(':').map(|(_, how)| how);
        how.is_some_and(|how| how.contains('.'))
    });
    formats.map(str::to_owned).collect()
}

/// Strings over several lines in one.
fn joined(text: &str) -> String {
    let mut parts = text.split("\\\n");
    let first = parts.next().unwrap_or_default().to_owned();
    parts.fold(first, |all, part| all + part.trim_start())
}

#[test]
fn no_bound_is_rounded_to_the_nearest_number() {
    let files = sources().into_iter().filter(|file| !is_test(&file.name));
    let faults = files.flat_map(|file| {
        let formats = rounded_bounds(&file.text).into_iter();
        formats.map(move |format| format!("{}: {{{format}}}", file.name))
    });
    let faults: Vec<String> = faults.collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}

#[test]
fn a_planted_bound_is_found() {
    for (line, count) in [
        ("format!(\"at most {error:.2e} mm\")", 1),
        ("format!(\"at least {:.3} mm\", far.apart)", 1),
        ("format!(\"never below {bound:>10.4}\")", 1),
        ("format!(\"never above \\\n    {bound:.*}\", 3)", 1),
        ("format!(\"off by {off:.0e} at most\")", 1),
        ("format!(\"at most {}\", at_most(error))", 0),
        ("format!(\"at most {LARGEST:e}\")", 0),
        ("format!(\"{value:.3} of at most {count}\")", 0),
        ("// at most {error:.2e}", 0),
    ] {
        assert_eq!(rounded_bounds(line).len(), count, "{line}");
    }
}
