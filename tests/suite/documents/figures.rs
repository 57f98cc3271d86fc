//! `docs/figures.md`: the picture beside every command is the one that the command draws, byte for byte.

use super::text::{Document, documents, stated_code, words};
use crate::program::Workspace;
use std::path::{Path, PathBuf};

/// A row of a table: the command, its exit code, the files that it writes.
struct Figure {
    command: String,
    code: i32,
    files: Vec<String>,
}

/// Options whose value is a file with a picture.
const FILES: [&str; 4] = ["--out", "--plot", "--picture", "--map"];

/// What is compared: tables are printed elsewhere.
const PICTURES: [&str; 3] = [".svg", ".png", ".gif"];

fn page() -> Document {
    let mut documents = documents().into_iter();
    documents.find(|d| d.name.ends_with("figures.md")).unwrap()
}

fn figures(page: &Document) -> Vec<Figure> {
    let mut list = Vec::new();
    for (code, row) in page.inline_code() {
        let Some(command) = code
            .strip_prefix("mechanim ")
            .filter(|_| row.starts_with('|'))
        else {
            continue;
        };
        let arguments = words(command);
        let after = arguments
            .windows(2)
            .filter(|w| FILES.contains(&w[0].as_str()));
        let names = after.map(|w| w[1].clone());
        let is_picture = |name: &String| PICTURES.iter().any(|end| name.ends_with(end));
        let files: Vec<String> = names.filter(is_picture).collect();
        list.push(Figure {
            command: command.to_owned(),
            code: stated_code(&row).unwrap_or(0),
            files,
        });
        let shown = list.last().unwrap();
        for file in &shown.files {
            assert!(
                row.contains(&format!("](figures/{file})")),
                "{file} is not shown in its row"
            );
        }
    }
    list
}

fn golden(file: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("docs/figures")
        .join(file)
}

#[test]
fn every_figure_is_the_picture_that_its_command_draws() {
    let (mut faults, mut compared) = (Vec::new(), Vec::new());
    let page = page();
    let workspace = Workspace::new();
    page.blocks()
        .iter()
        .for_each(|block| block.save_in(&workspace));
    for figure in figures(&page) {
        let run = workspace.run(&words(&figure.command));
        run.exits(figure.code);
        for file in figure.files {
            let drawn = workspace.read(&file);
            if std::env::var_os("MECHANIM_BLESS").is_some() {
                std::fs::write(golden(&file), &drawn).unwrap();
            }
            if std::fs::read(golden(&file)).ok() != Some(drawn) {
                faults.push(format!("{file}: look at it, then MECHANIM_BLESS=1"));
            }
            compared.push(file);
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    assert!(compared.len() > 30, "{compared:?}");
    // Nothing lies there that no command draws.
    let folder = std::fs::read_dir(golden("")).unwrap();
    for entry in folder {
        let name = entry.unwrap().file_name().into_string().unwrap();
        assert!(compared.contains(&name), "no command draws {name}");
    }
}
