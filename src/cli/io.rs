//! Files and standard output: what is written never replaces an input of the command.

use super::args::scene::SceneArgs;
use super::term::Term;
use super::term::outcome::Failure;
use crate::export::png::{Effort, encode};
use crate::export::{Output, Stream, Target};
use image::RgbaImage;
use serde_json::Value;
use std::io::Write;
use std::path::Path;

/// Refuses to write over an input of the command; `-` is standard output and no file.
pub fn refuse_input(scene: &SceneArgs, path: &Path) -> Result<(), Failure> {
    if path != Path::new("-") && is_scene_file(scene, path) {
        return Err(is_input(path));
    }
    Ok(())
}

/// The refusal to write over an input.
pub fn is_input(path: &Path) -> Failure {
    let message = format!("{} is an input of this command", path.display());
    Failure::usage(message, Vec::new())
}

/// True when `out` is a file that the command reads.
fn is_scene_file(args: &SceneArgs, out: &Path) -> bool {
    let same =
        |a: &Path| matches!((a.canonicalize(), out.canonicalize()), (Ok(a), Ok(b)) if a == b);
    same(Path::new(&args.scene)) || args.table.as_deref().is_some_and(same)
}

/// Opens a file, or standard output for `-`.
pub fn open(path: &Path) -> Result<Box<dyn Output>, Failure> {
    if path == Path::new("-") {
        return Ok(Box::new(Stream::new("standard output", std::io::stdout())));
    }
    Ok(Box::new(Target::create(path)?))
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
    write_bytes(open(path)?, text.as_bytes())
}

/// Writes a picture as PNG.
pub fn write_png(image: &RgbaImage, path: &Path) -> Result<(), Failure> {
    let mut bytes = Vec::new();
    encode(image, Effort::Balanced, &mut bytes)?;
    write_bytes(Box::new(Target::create(path)?), &bytes)
}

fn write_bytes(mut output: Box<dyn Output>, bytes: &[u8]) -> Result<(), Failure> {
    output.emit(bytes)?;
    Ok(output.commit()?)
}

/// Prints the text of a verb, but where its `report` goes to standard output, or where nothing is to be said.
pub fn print_beside(term: &Term, report: Option<&Path>, text: &str) -> Result<(), Failure> {
    if term.quiet() || report == Some(Path::new("-")) {
        return Ok(());
    }
    let mut out = std::io::stdout().lock();
    out.write_all(text.as_bytes())?;
    Ok(out.flush()?)
}
