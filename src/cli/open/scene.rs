//! Finding and reading the scene that a command names.

use super::{inputs_table, mode};
use crate::cli::args::scene::SceneArgs;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::cli::term::progress::announced;
use crate::diag::{Source, nearest};
use crate::kinematics::structure::system::System;
use crate::scene::{Overrides, PlotText, Scene, builtin, load};
use std::io::Read;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Largest scene file that is read: a hundred times the largest hand-written one.
const MAX_SCENE_BYTES: u64 = 4 << 20;

/// A scene and its mechanism ready to be solved.
pub struct OpenScene {
    /// As the file and the command line say.
    pub scene: Scene,
    /// Made once, from the scene's mechanism.
    pub system: System,
}

/// Reads, resolves and adapts the scene, and analyses its mechanism; warnings are printed.
pub fn open(args: &SceneArgs, term: &Term) -> Result<OpenScene, Failure> {
    open_with_plot(args, None, term)
}

/// As [`open`], with a plot asked for in place of the scene's own.
pub fn open_with_plot(
    args: &SceneArgs,
    plot: Option<PlotText>,
    term: &Term,
) -> Result<OpenScene, Failure> {
    let (source, mut overrides) = text_of(args)?;
    overrides.plot = plot;
    let read = || load(&source, &overrides).map_err(Box::new);
    let mut scene = announced("reading the scene and its meshes", term.quiet(), read)?;
    term.diagnostics(&source, &scene.warnings);
    if let Some(path) = &args.table {
        inputs_table::apply(&scene.mechanism, &mut scene.actuation, path)?;
    }
    let system = System::new(Arc::clone(&scene.mechanism), &scene.actuation)?;
    if let Some(choice) = &args.mode {
        scene.actuation.guess = mode::start_of(&system, &scene.actuation, choice)?;
    }
    Ok(OpenScene { scene, system })
}

/// The scene's text, and what the command line changes in it.
pub fn text_of(args: &SceneArgs) -> Result<(Source, Overrides), Failure> {
    let overrides = Overrides {
        parameters: args.parameters.clone(),
        inputs: args.inputs.clone(),
        guess: args.guess.clone(),
        folder: folder(&args.scene),
        ..Overrides::default()
    };
    Ok((source(&args.scene)?, overrides))
}

fn folder(scene: &str) -> PathBuf {
    Path::new(scene)
        .parent()
        .map(Path::to_path_buf)
        .unwrap_or_default()
}

/// The text of a scene: built-in name, `-`, or a path.
fn source(name: &str) -> Result<Source, Failure> {
    if name == "-" {
        return read_limited(std::io::stdin().lock(), "<stdin>");
    }
    if let Some(source) = builtin::find(name) {
        return Ok(source);
    }
    match std::fs::File::open(name) {
        Ok(file) => read_limited(file, name),
        Err(error) => Err(missing(name, &error)),
    }
}

fn read_limited(reader: impl Read, name: &str) -> Result<Source, Failure> {
    let mut bytes = Vec::new();
    let failed =
        |e: &dyn std::fmt::Display| Failure::usage(format!("cannot read {name}: {e}"), Vec::new());
    reader
        .take(MAX_SCENE_BYTES + 1)
        .read_to_end(&mut bytes)
        .map_err(|e| failed(&e))?;
    if bytes.len() as u64 > MAX_SCENE_BYTES {
        return Err(failed(&format!(
            "a scene has at most {MAX_SCENE_BYTES} bytes"
        )));
    }
    let text = String::from_utf8(bytes).map_err(|_| failed(&"the file is not UTF-8 text"))?;
    Ok(Source {
        name: name.to_owned(),
        text,
    })
}

fn missing(name: &str, error: &std::io::Error) -> Failure {
    let looks_like_path = name.contains(std::path::is_separator) || name.ends_with(".toml");
    if looks_like_path {
        return Failure::usage(format!("cannot read {name}: {error}"), Vec::new());
    }
    let names = builtin::ALL.map(|scene| scene.name);
    let mut hints = Vec::new();
    if let Some(near) = nearest(name, names) {
        hints.push(format!("did you mean `{near}`?"));
    }
    hints.push(format!(
        "built-in scenes: {}; or give the path of a .toml file",
        names.join(", ")
    ));
    Failure::usage(format!("there is no scene `{name}`"), hints)
}
