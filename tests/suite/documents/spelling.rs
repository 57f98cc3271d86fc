//! One spelling, the British one, in documents, help texts and comments. What others have named keeps its letters: titles of
//! papers, and what stands in backticks (`center` is a key of scenes).

use super::text::all_documents;
use crate::house::source::sources;
use clap::{Command, CommandFactory};
use mechanim::cli::args::Cli;
use std::path::Path;

/// Beginnings of words as they are spelt in America.
const AMERICAN: [&str; 26] = [
    "color",
    "center",
    "optimiz",
    "minimiz",
    "maximiz",
    "normaliz",
    "behavior",
    "neighbor",
    "gray",
    "analyz",
    "recogniz",
    "labeled",
    "labeling",
    "modeled",
    "modeling",
    "catalog ",
    "synthesiz",
    "summariz",
    "initializ",
    "millimeter",
    "organiz",
    "parametriz",
    "discretiz",
    "factoriz",
    "traveled",
    "traveling",
];

/// Titles and names that are not ours to spell.
const TITLES: [&str; 7] = [
    "Global Optimization",
    "Methods of Optimization",
    "Numerical Optimization",
    "Color Universal Design",
    "simulation of color vision",
    "Gray code",
    "Gray's order",
];

/// The words of a text that are spelt in the American way.
fn american(text: &str) -> Vec<String> {
    let outside: Vec<&str> = text.split('`').step_by(2).collect();
    let mut outside = outside.join(" ");
    for title in TITLES {
        outside = outside.replace(title, "");
    }
    let words = outside.split(|c: char| !c.is_alphabetic() && c != '_');
    let words = words.filter(|word| {
        let plain = word.to_lowercase() + " ";
        let is_name = word.contains('_') || word.chars().all(char::is_uppercase);
        !is_name && AMERICAN.iter().any(|stem| plain.starts_with(stem))
    });
    words.map(str::to_owned).collect()
}

/// The comments of a source, joined, since titles may be broken into two lines.
fn comments(text: &str) -> String {
    let lines = text.lines().filter_map(|line| line.split_once("//"));
    let lines = lines.map(|(_, comment)| comment.trim_start_matches(['/', '!', ' ']));
    lines.collect::<Vec<_>>().join(" ")
}

fn helps(verb: &Command, text: &mut String) {
    for argument in verb.get_arguments() {
        let help = argument.get_long_help().or(argument.get_help());
        text.push_str(&format!("{} ", help.cloned().unwrap_or_default()));
        text.push_str(&format!("{} ", argument.get_long().unwrap_or_default()));
    }
    text.push_str(&verb.get_about().cloned().unwrap_or_default().to_string());
    for below in verb.get_subcommands() {
        helps(below, text);
    }
}

#[test]
fn words_are_spelt_in_one_way() {
    let mut texts = Vec::new();
    for document in all_documents() {
        // Sentences only: blocks hold scenes and other programs.
        let mut prose = document.text.split("```").step_by(2).collect::<String>();
        prose.push('\n');
        texts.push((document.name, prose));
    }
    for file in sources() {
        texts.push((file.name, comments(&file.text)));
    }
    let mut tests = String::new();
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    super::sources_page::sources_of_tests(&folder, &mut tests);
    texts.push(("tests".to_owned(), comments(&tests)));
    let mut help = String::new();
    helps(&Cli::command(), &mut help);
    assert!(help.len() > 5000);
    texts.push(("help".to_owned(), help));
    let faults = texts.iter().flat_map(|(name, text)| {
        let words = american(text).into_iter();
        words.map(move |word| format!("{name}: {word}"))
    });
    let faults: Vec<String> = faults.collect();
    assert!(faults.is_empty(), "{}", faults.join("\n"));
    let planted = "Center the gray colors, `center`, NO_COLOR; Numerical Optimization; a colour.";
    assert_eq!(american(planted), ["Center", "gray", "colors"]);
}
