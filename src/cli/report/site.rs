//! `mechanim site`: a folder of pages with a front page, to be opened from a disk or published on a server unchanged.

use super::engine::find_engine;
use super::{Live, scene_article};
use crate::cli::args::report::SiteArgs;
use crate::cli::io;
use crate::cli::open::patterns::scenes_of;
use crate::cli::term::Term;
use crate::cli::term::outcome::{Failure, Outcome};
use crate::page::{SiteEntry, page_text, site_text};
use crate::report::sentences::counted_things;
use std::path::Path;

/// Runs the verb. Its exit code is that of `report` for all scenes.
pub fn run_site(args: &SiteArgs, term: &Term) -> Result<Outcome, Failure> {
    let engine = match (find_engine(args.wasm.as_deref()), &args.wasm) {
        (Ok(engine), _) => Some(engine),
        (Err(failure), Some(_)) => return Err(failure),
        (Err(_), None) => {
            term.note("no engine of live pages beside the program: pages without sliders (mechanim report --help)");
            None
        }
    };
    let scenes = scenes_of(&args.scene, &args.more)?;
    std::fs::create_dir_all(&args.out).map_err(|error| {
        let message = format!("cannot create the folder {}: {error}", args.out.display());
        Failure::usage(message, Vec::new())
    })?;
    let (mut entries, mut outcome, mut failed) = (Vec::new(), Outcome::Done, None);
    for scene in &scenes {
        let name = page_name(Path::new(&scene.scene), &entries);
        let path = args.out.join(&name);
        // Including those that are read after this page is written.
        scenes
            .iter()
            .try_for_each(|read| io::refuse_input(read, &path))?;
        let live = if engine.is_some() {
            Live::WherePossible
        } else {
            Live::Not
        };
        let judged = scene_article(&args.asked, scene, (1, live), term)?;
        let text = page_text(
            &name,
            std::slice::from_ref(&judged.article),
            engine.as_ref(),
        );
        io::write_text(scene, &path, &text)?;
        entries.push(SiteEntry::new(&judged.article, &name, &judged.description));
        match judged.end {
            Ok(end) => outcome = outcome.worse(end),
            Err(failure) => failed = failed.or(Some(failure)),
        }
    }
    let title = args
        .title
        .clone()
        .unwrap_or_else(|| counted_things(entries.len(), "mechanism"));
    let index = args.out.join("index.html");
    io::write_text(&args.scene, &index, &site_text(&title, &entries))?;
    term.note(&format!(
        "{}: {}",
        index.display(),
        counted_things(entries.len(), "page")
    ));
    match failed {
        Some(failure) => Err(failure),
        None => Ok(outcome),
    }
}

/// The file of a scene's page: its own name, with a number if the name is taken.
fn page_name(scene: &Path, known: &[SiteEntry]) -> String {
    let stem = scene.file_stem().unwrap_or_default().to_string_lossy();
    let plain = |c: char| {
        if c.is_alphanumeric() || "-_.".contains(c) {
            c
        } else {
            '-'
        }
    };
    let stem: String = stem.chars().map(plain).collect();
    let is_free =
        |name: &String| name != "index.html" && known.iter().all(|entry| entry.file != *name);
    let names = (1..).map(|k| match k {
        1 => format!("{stem}.html"),
        k => format!("{stem}-{k}.html"),
    });
    names.into_iter().find(is_free).unwrap_or_default()
}
