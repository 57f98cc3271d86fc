//! Tables of commands and their results: what stands in a row is printed by the command in its first cell.

use super::runs::runs_whole;
use super::sources_page::{is_rounded_to, numbers};
use super::text::{Document, documents, words};
use crate::program::Workspace;

/// A command and the cells behind it.
struct Row {
    command: String,
    result: String,
}

/// The rows of all tables whose first column is headed `command`.
fn rows(document: &Document) -> Vec<Row> {
    let (mut list, mut is_inside) = (Vec::new(), false);
    for line in document.text.lines() {
        if !line.starts_with('|') {
            is_inside = false;
        } else if line.starts_with("| command |") {
            is_inside = true;
        } else if let Some(command) = line.split("`mechanim ").nth(1).filter(|_| is_inside) {
            let command = command.split('`').next().unwrap().to_owned();
            let result = line.split(" | ").skip(1).collect::<Vec<_>>().join(" ");
            list.push(Row { command, result });
        }
    }
    list
}

/// Numbers of a row that its command does not print.
fn missing(row: &Row, output: &str) -> Vec<String> {
    let printed: Vec<f64> = numbers(output).iter().map(|n| n.parse().unwrap()).collect();
    let figures = numbers(&row.result).into_iter();
    let is_printed = |figure: &String| printed.iter().any(|p| is_rounded_to(*p, figure));
    figures.filter(|figure| !is_printed(figure)).collect()
}

#[test]
fn results_in_tables_are_printed_by_the_commands_beside_them() {
    let (mut faults, mut compared) = (Vec::new(), 0);
    for document in documents() {
        for row in rows(&document) {
            let whole = format!("mechanim {}", row.command);
            if !runs_whole(&whole) {
                continue;
            }
            let run = Workspace::new().run(&words(&row.command));
            let output = format!("{}{}", run.text(), run.stderr);
            compared += numbers(&row.result).len();
            for part in missing(&row, &output) {
                faults.push(format!(
                    "{}: {part} is not printed by {whole}",
                    document.name
                ));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(compared >= 8, "{compared} figures");
    let planted = Document {
        name: "planted.md".to_owned(),
        text: "| command | result |\n|---|---|\n| `mechanim x` | F = 1.25e-3 at `4` |\n".to_owned(),
    };
    let rows = rows(&planted);
    assert_eq!(missing(&rows[0], "F 0.0012499"), Vec::<String>::new());
    assert_eq!(missing(&rows[0], "F 0.00126"), ["1.25e-3"]);
}
