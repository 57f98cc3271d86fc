//! Files and standard output: no output ever replaces an input of the command.

use super::args::scene::SceneArgs;
use super::open::scene::named_meshes;
use super::term::Term;
use super::term::outcome::Failure;
use crate::diag::shown_lines;
use crate::export::png::{Effort, encode_png};
use crate::export::{Output, PendingFile, Stream, folder_of, link_end};
use image::RgbaImage;
use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Refuses to overwrite an input of the command; `-` is standard output and not a file.
pub fn refuse_input(scene: &SceneArgs, path: &Path) -> Result<(), Failure> {
    if path != Path::new("-") && is_scene_file(scene, path) {
        return Err(is_input(path));
    }
    Ok(())
}

/// Refuses two reports of one run in one file, or both on standard output, and reports over the inputs, before the work
/// begins. Each comes with the name of its option.
pub fn refuse_clashes(
    scenes: &[&SceneArgs],
    reports: &[(&str, Option<&Path>)],
) -> Result<(), Failure> {
    let mut known: Vec<(&str, PathBuf)> = Vec::new();
    for (option, path) in reports {
        let Some(path) = path else { continue };
        scenes
            .iter()
            .try_for_each(|scene| refuse_input(scene, path))?;
        let place = absolute_place(path);
        if let Some((other, _)) = known.iter().find(|(_, known)| *known == place) {
            let message = format!("{other} and {option} both go to {}", path.display());
            return Err(Failure::usage(message, Vec::new()));
        }
        // Reports written to a device do not overwrite each other.
        if *path == Path::new("-") || std::fs::metadata(&place).map_or(true, |m| m.is_file()) {
            known.push((option, place));
        }
    }
    Ok(())
}

/// Refuses reports over other inputs of the command: files, and everything in folders.
pub fn refuse_over(inputs: &[PathBuf], reports: &[(&str, Option<&Path>)]) -> Result<(), Failure> {
    let inputs = inputs.iter().filter_map(|input| input.canonicalize().ok());
    let inputs: Vec<PathBuf> = inputs.collect();
    for path in reports.iter().filter_map(|(_, path)| *path) {
        let place = absolute_place(path);
        if inputs.iter().any(|input| place.starts_with(input)) {
            return Err(is_input(path));
        }
    }
    Ok(())
}

/// The target of a path, also through links to a file that does not exist yet.
fn absolute_place(path: &Path) -> PathBuf {
    if path == Path::new("-") {
        return path.to_owned();
    }
    let end = link_end(path).unwrap_or_else(|_| path.to_owned());
    let folder = folder_of(&end).canonicalize();
    match (folder, end.file_name()) {
        (Ok(folder), Some(name)) => folder.join(name),
        _ => end.canonicalize().unwrap_or(end),
    }
}

/// Path for the result of an interrupted run: beside a complete one, which it does not replace (`t.partial.csv`).
pub fn unless_complete(path: &Path, is_whole: bool) -> PathBuf {
    let is_file = std::fs::metadata(path).is_ok_and(|about| about.is_file());
    if is_whole || !is_file {
        return path.to_owned();
    }
    let extension = path.extension().unwrap_or_default();
    let mut partial = std::ffi::OsString::from("partial.");
    partial.push(extension);
    path.with_extension(partial)
}

/// A closed reader is no reason to fail, nor to forget the result: the exit code stays that of the answer.
pub fn unless_reader_left(written: Result<(), Failure>) -> Result<(), Failure> {
    match written {
        Err(failure) if failure.is_broken_pipe() => Ok(()),
        other => other,
    }
}

/// Refuses to overwrite an input.
pub fn is_input(path: &Path) -> Failure {
    let message = format!("{} is an input of this command", path.display());
    Failure::usage(message, Vec::new())
}

/// Whether `out` is a file that the command reads: the scene, its table of inputs, a mesh that it names.
fn is_scene_file(args: &SceneArgs, out: &Path) -> bool {
    let Ok(out) = out.canonicalize() else {
        return false;
    };
    let same = |a: &Path| a.canonicalize().is_ok_and(|a| a == out);
    let scene = Path::new(&args.scene);
    let meshes = || named_meshes(scene).unwrap_or_default();
    same(scene) || args.table.as_deref().is_some_and(same) || meshes().iter().any(|mesh| same(mesh))
}

/// Opens a file, or standard output for `-`.
pub fn open_output(path: &Path) -> Result<Box<dyn Output>, Failure> {
    if path == Path::new("-") {
        return Ok(Box::new(Stream::new("standard output", std::io::stdout())));
    }
    Ok(Box::new(PendingFile::create(path)?))
}

/// Writes a report to a file, or to standard output for `-`; never over an input of the command.
pub fn write_json(scene: &SceneArgs, path: &Path, document: &Value) -> Result<(), Failure> {
    write_text(scene, path, &format!("{document:#}\n"))
}

/// The same for any text.
pub fn write_text(scene: &SceneArgs, path: &Path, text: &str) -> Result<(), Failure> {
    refuse_input(scene, path)?;
    write_out(path, text)
}

/// Writes a JSON document to a file, or to standard output for `-`.
pub fn write_document(path: &Path, document: &Value) -> Result<(), Failure> {
    write_out(path, &format!("{document:#}\n"))
}

fn write_out(path: &Path, text: &str) -> Result<(), Failure> {
    unless_reader_left(write_bytes(open_output(path)?, text.as_bytes()))
}

/// Writes a picture as PNG.
pub fn write_png(image: &RgbaImage, path: &Path) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    encode_png(image, Effort::Balanced, &mut bytes)?;
    write_bytes(Box::new(PendingFile::create(path)?), &bytes)
}

fn write_bytes(mut output: Box<dyn Output>, bytes: &[u8]) -> Result<(), Failure> {
    output.emit(bytes)?;
    Ok(output.commit()?)
}

/// Prints the text of a verb, unless one of its `reports` goes to standard output, or the text is empty.
pub fn print_beside<'a>(
    term: &Term,
    reports: impl IntoIterator<Item = &'a Path>,
    text: &str,
) -> Result<(), Failure> {
    if term.quiet() || reports.into_iter().any(|path| path == Path::new("-")) {
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    let written = out.write_all(shown_lines(text).as_bytes());
    let written = written.and_then(|()| out.flush());
    unless_reader_left(written.map_err(Failure::from))
}
