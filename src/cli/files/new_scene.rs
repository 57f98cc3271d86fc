//! `mechanim new`: a copy of a built-in scene as a starting point.

use crate::cli::args::files::NewArgs;
use crate::cli::study::submit::shell_word;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::scene::builtin::find_builtin;
use crate::scene::source::no_builtin;
use crate::scene::template::titled_template;
use std::io::{ErrorKind, Write};

/// Runs the verb.
pub fn run_new(args: &NewArgs, term: &Term) -> Result<Outcome, Failure> {
    let Some(source) = find_builtin(&args.from) else {
        return Err(no_builtin(&args.from).into());
    };
    let mut path = args.name.clone();
    if path.extension().is_none_or(|e| e != "toml") {
        path.as_mut_os_string().push(".toml");
    }
    let title = path
        .file_stem()
        .map(|stem| stem.to_string_lossy().into_owned());
    let shown = path.display();
    let head = format!(
        "Made from the built-in scene {}. `mechanim check` judges this file, `mechanim render` draws it,\n\
         `mechanim report FILE --out page.html --watch` keeps a page of it up to date; docs/scene-format.md explains every key.",
        source.name
    );
    let text = titled_template(&source.text, &title.unwrap_or_default(), &head);
    // Created only if the file does not exist: an existing file is never lost.
    let file = std::fs::OpenOptions::new()
        .write(true)
        .create_new(true)
        .open(&path);
    let written = file.and_then(|mut file| file.write_all(text.as_bytes()));
    written.map_err(|error| match error.kind() {
        ErrorKind::AlreadyExists => Failure::usage(
            format!("{shown} already exists and is left unchanged"),
            vec!["take another name, or remove the file".to_owned()],
        ),
        _ => Failure::usage(format!("cannot write {shown}: {error}"), Vec::new()),
    })?;
    term.note(&format!("{shown}: a scene made from {}", source.name));
    let name = shown.to_string();
    let word = match name
        .chars()
        .all(|c| c.is_alphanumeric() || "/._-".contains(c))
    {
        true => name,
        false => shell_word(&name),
    };
    term.note(&format!("next: mechanim check {word}"));
    Ok(Outcome::Done)
}
