//! `docs/sources.md`: every figure of "ours" is in the output of the command beside it, to all its digits, or the test that is
//! named there exists.

use super::text::words;
use crate::program::Workspace;
use std::collections::HashMap;
use std::path::Path;

/// A row of a table with the columns `ours` and `printed by`.
struct Row {
    figure: String,
    ours: String,
    printed_by: String,
}

fn rows(page: &str) -> Vec<Row> {
    let mut list: Vec<Row> = Vec::new();
    let mut columns: Option<[usize; 2]> = None;
    for line in page.lines() {
        let cells: Vec<&str> = line.split('|').map(str::trim).collect();
        if cells.len() < 3 {
            columns = None;
            continue;
        }
        let of = |name: &str| cells.iter().position(|cell| *cell == name);
        if let (Some(ours), Some(by)) = (of("ours"), of("printed by")) {
            columns = Some([ours, by]);
        } else if let Some([ours, by]) = columns.filter(|_| !cells[1].starts_with("---")) {
            let printed_by = match cells[by] {
                "likewise" => list.last().unwrap().printed_by.clone(),
                own => own.to_owned(),
            };
            list.push(Row {
                figure: cells[1..ours].join(" | "),
                ours: cells[ours].to_owned(),
                printed_by,
            });
        }
    }
    list
}

/// The numbers of a text as they are written, without what stands in backticks.
pub fn numbers(text: &str) -> Vec<String> {
    let outside: String = text.split('`').step_by(2).collect::<Vec<_>>().join(" ");
    let is_part = |c: char| c.is_ascii_digit() || matches!(c, '.' | '-' | 'e');
    let words = outside.split(|c| !is_part(c));
    let words = words.map(|word| word.trim_end_matches(['.', 'e', '-']));
    let words = words.filter(|word| word.parse::<f64>().is_ok());
    words.map(str::to_owned).collect()
}

/// Whether a number that was printed is `figure`, rounded to its digits.
pub fn is_rounded_to(printed: f64, figure: &str) -> bool {
    let (mantissa, exponent) = figure.split_once('e').unwrap_or((figure, "0"));
    let digits = mantissa.split_once('.').map_or(0, |(_, after)| after.len());
    let exponent: i32 = exponent.parse().unwrap_or(0);
    let half = 0.5 * 10_f64.powi(exponent - i32::try_from(digits).unwrap());
    figure
        .parse::<f64>()
        .is_ok_and(|value| (printed - value).abs() <= half * (1.0 + 1e-6))
}

/// What is not in the output of a row's command.
fn missing(row: &Row, output: &str) -> Vec<String> {
    let printed: Vec<f64> = numbers(output).iter().map(|n| n.parse().unwrap()).collect();
    let quoted = row.ours.split('`').skip(1).step_by(2);
    let quoted = quoted
        .filter(|part| !output.contains(part))
        .map(str::to_owned);
    let figures = numbers(&row.ours).into_iter();
    let figures = figures.filter(|n| !printed.iter().any(|p| is_rounded_to(*p, n)));
    quoted.chain(figures).collect()
}

pub fn sources_of_tests(folder: &Path, text: &mut String) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources_of_tests(&path, text);
        } else if path.extension().is_some_and(|e| e == "rs") {
            text.push_str(&std::fs::read_to_string(path).unwrap());
        }
    }
}

#[test]
fn figures_of_the_sources_page_are_printed_by_the_commands_beside_them() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let page = std::fs::read_to_string(root.join("docs/sources.md")).unwrap();
    let mut tests = String::new();
    sources_of_tests(&root.join("tests"), &mut tests);
    let (mut outputs, mut faults, mut compared) = (HashMap::new(), Vec::new(), 0);
    for row in rows(&page) {
        let name = row.printed_by.split('`').nth(1).unwrap_or_default();
        if row.printed_by.starts_with("test `") {
            if !tests.contains(&format!("fn {name}()")) {
                faults.push(format!("{}: there is no test `{name}`", row.figure));
            }
            continue;
        }
        let Some(("mechanim", arguments)) = name.split_once(' ') else {
            faults.push(format!("{}: no command", row.figure));
            continue;
        };
        let output = outputs.entry(name.to_owned()).or_insert_with(|| {
            let run = Workspace::new().run(&words(arguments));
            format!("{}{}", run.text(), run.stderr)
        });
        compared += numbers(&row.ours).len() + row.ours.matches('`').count() / 2;
        for part in missing(&row, output) {
            faults.push(format!("{}: {part} is not printed by {name}", row.figure));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(compared > 60, "{compared} figures");
}

#[test]
fn wrong_figures_are_seen() {
    let page = "| figure | ours | printed by |\n|---|---|---|\n| a | 0.125, `one way` | `mechanim x` |\n| b | -2.5 | likewise |";
    let [a, b] = rows(page).try_into().unwrap_or_else(|_| panic!("two rows"));
    assert_eq!(b.printed_by, "`mechanim x`");
    assert!(missing(&a, "x = 0.12499999 one way").is_empty());
    assert_eq!(missing(&a, "x = 0.1244 one  way"), ["one way", "0.125"]);
    assert_eq!(missing(&b, "2.5, 0"), ["-2.5"]);
    assert!(missing(&b, "y=-2.46").is_empty() && !missing(&b, "y=-2.44").is_empty());
}
