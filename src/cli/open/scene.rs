//! Finding and reading the scene that a command names.

use super::intervals::refuse_intervals;
use super::{inputs_table, mode};
use crate::cli::args::scene::SceneArgs;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::cli::term::progress::announce_work;
use crate::diag::Source;
use crate::kinematics::structure::system::System;
use crate::scene::{OtherDrives, Overrides, Scene, load_scene, source};
use std::ffi::OsStr;
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// A scene and its mechanism, ready to be solved.
pub struct OpenScene {
    /// With the overrides of the command line.
    pub scene: Scene,
    /// Made once, from the scene's mechanism.
    pub system: System,
    /// What the scene was read from: standard input can be read only once.
    pub text: (Source, Overrides),
}

/// Reads, resolves and adapts the scene, and analyses its mechanism; warnings are printed.
pub fn open_scene(args: &SceneArgs, term: &Term) -> Result<OpenScene, Failure> {
    open_changed(args, |_| {}, term)
}

/// As [`open_scene`], with more overrides than its own options.
pub fn open_changed(
    args: &SceneArgs,
    change: impl FnOnce(&mut Overrides),
    term: &Term,
) -> Result<OpenScene, Failure> {
    if args.scene == "-" && args.table.as_deref() == Some(Path::new("-")) {
        let message = "standard input is the scene or the table of inputs, not both";
        return Err(Failure::usage(message, Vec::new()));
    }
    let (source, mut overrides) = text_of(args)?;
    change(&mut overrides);
    let read = || load_scene(&source, &overrides).map_err(Box::new);
    let mut scene = announce_work(
        "reading the scene and its meshes",
        !term.shows_progress(),
        read,
    )?;
    term.diagnostics(&source, &scene.warnings);
    if let Some(path) = &args.table {
        let warning = inputs_table::apply_inputs(&scene.mechanism, &mut scene.actuation, path)?;
        warning.into_iter().for_each(|text| term.warning(&text));
    }
    let analyse = || System::new(Arc::clone(&scene.mechanism), &scene.actuation);
    let system = announce_work("analysing the mechanism", !term.shows_progress(), analyse)?;
    if let Some(choice) = &args.mode {
        scene.actuation.guess = mode::start_of(&system, &scene.actuation, choice)?;
    }
    let text = (source, overrides);
    Ok(OpenScene {
        scene,
        system,
        text,
    })
}

impl OpenScene {
    /// The scene's text with overrides that make the same scene of it, its table of inputs and its assembly included.
    pub fn text_as_opened(&self, args: &SceneArgs) -> (Source, Overrides) {
        let (source, mut overrides) = self.text.clone();
        keep_variables(args, &self.scene, &mut overrides);
        (source, overrides)
    }
}

/// `--input-table` and `--mode`, which have changed `scene`, as overrides, so that they hold wherever it is read again.
pub fn keep_variables(args: &SceneArgs, scene: &Scene, overrides: &mut Overrides) {
    let (mechanism, actuation) = (&scene.mechanism, &scene.actuation);
    if args.table.is_some() {
        overrides.drives = Some(OtherDrives {
            drives: actuation.drives.clone(),
            duration: actuation.duration,
        });
    }
    if args.mode.is_some() {
        let start = mechanism.unknowns.iter().zip(&actuation.guess);
        overrides.guess = start
            .map(|(unknown, value)| {
                let value = value * mechanism.file_units(unknown.kind);
                (unknown.name.clone(), format!("{value:?}"))
            })
            .collect();
    }
}

/// The scene's text, and its overrides on the command line.
pub fn text_of(args: &SceneArgs) -> Result<(Source, Overrides), Failure> {
    refuse_intervals(args)?;
    let overrides = Overrides {
        parameters: args.parameters.clone(),
        inputs: args.inputs.clone(),
        guess: args.guess.clone(),
        folder: source::folder_of(Path::new(&args.scene)),
        allowed_folders: args.allowed.clone(),
        ..Overrides::default()
    };
    Ok((text_by_name(&args.scene)?, overrides))
}

/// The text of a scene: built-in name, `-`, or a path.
fn text_by_name(name: &OsStr) -> Result<Source, Failure> {
    Ok(match name.to_str() {
        Some("-") => source::read_source(std::io::stdin().lock(), "<stdin>")?,
        _ => source::find_source(name)?,
    })
}

/// Extensions of the files that a scene may name.
const MESHES: &str = ".stl";

/// The existing meshes among those that a scene's text names, even if the text has errors; `None` where the scene is
/// not a file, or is too large. Pipes are left to the reader of the scene.
pub fn named_meshes(scene: &Path) -> Option<Vec<PathBuf>> {
    let about = std::fs::metadata(scene).ok()?;
    if !about.is_file() || about.len() > source::MAX_SCENE_BYTES {
        return None;
    }
    let text = std::fs::read_to_string(scene).ok()?;
    let folder = scene.parent().unwrap_or(Path::new(""));
    let quoted = text.split(['"', '\'']);
    let meshes = quoted.filter(|word| word.to_ascii_lowercase().ends_with(MESHES));
    // A missing file is an error of the scene, and not a file to wait for.
    let places = meshes.map(|name| folder.join(name));
    Some(places.filter(|path| path.exists()).collect())
}
