//! Shared by studies in units: the scene beside a plan, its meshes, and arguments that are read again.

use super::intervals::refuse_intervals;
use crate::cli::args::scene::{ModeChoice, SceneArgs};
use crate::cli::term::outcome::Failure;
use crate::diag::Source;
use crate::model::mechanism::Mechanism;
use crate::model::shape::Solid;
use crate::parts::plan::StudyPlan;
use crate::scene::{Overrides, source};
use std::path::{Path, PathBuf};

/// Name of the scene's text beside a plan.
pub const SCENE_FILE: &str = "scene.toml";

/// The text of a plan's scene, and its overrides.
pub fn planned_text(
    scene: &SceneArgs,
    plan: &StudyPlan,
    folder: &Path,
) -> Result<(Source, Overrides), Failure> {
    refuse_intervals(scene)?;
    let place = folder.join(SCENE_FILE);
    let file = source::open_input(&place).map_err(|e| cannot_read(&place, &e))?;
    let source = source::read_source(file, &plan.scene)?;
    let overrides = Overrides {
        parameters: scene.parameters.clone(),
        inputs: scene.inputs.clone(),
        guess: scene.guess.clone(),
        folder: PathBuf::from(&plan.meshes),
        allowed_folders: scene.allowed.clone(),
        ..Overrides::default()
    };
    Ok((source, overrides))
}

/// The folder of a scene's meshes, as stored in a plan.
pub fn mesh_folder(overrides: &Overrides) -> String {
    let folder = overrides.folder.canonicalize();
    let folder = folder.unwrap_or_else(|_| overrides.folder.clone());
    folder.display().to_string()
}

/// Refuses drives from a table: they are not part of a plan.
pub fn refuse_table(scene: &SceneArgs, what: &str) -> Result<(), Failure> {
    if scene.table.is_none() {
        return Ok(());
    }
    let message = format!("{what} follows the scene's own drive: --input-table cannot be used");
    let hint = "replace a drive with --input NAME=FORMULA";
    Err(Failure::usage(message, vec![hint.to_owned()]))
}

/// The overrides of the command line, in the form in which they are read again.
pub fn scene_arguments(scene: &SceneArgs) -> Vec<String> {
    let mut list = Vec::new();
    let changed = [
        ("param", &scene.parameters),
        ("input", &scene.inputs),
        ("guess", &scene.guess),
    ];
    for (option, pairs) in changed {
        let named = pairs.iter();
        list.extend(named.map(|(name, value)| format!("--{option}={name}={value}")));
    }
    let allowed = scene.allowed.iter();
    list.extend(allowed.map(|path| format!("--allow-files={}", path.display())));
    if let Some(mode) = &scene.mode {
        list.push(match mode {
            ModeChoice::Number(number) => format!("--mode={number}"),
            ModeChoice::Signature(signs) => format!("--mode={signs}"),
        });
    }
    list
}

/// The meshes of the scene as numbers: their contents count, not their file names.
pub fn mesh_bytes(mechanism: &Mechanism) -> Vec<u8> {
    let mut bytes = Vec::new();
    let shapes = mechanism.bodies.iter().flat_map(|body| &body.shapes);
    for shape in shapes {
        if let Solid::Triangles(soup) = &shape.solid {
            let corners = soup.triangles.iter().flatten();
            let places = corners.filter_map(|k| soup.vertices.get(*k as usize));
            for place in places {
                bytes.extend(place.to_array().iter().flat_map(|v| v.to_le_bytes()));
            }
        }
    }
    bytes
}

/// The message of the system about a file.
pub fn cannot_read(path: &Path, error: &std::io::Error) -> Failure {
    Failure::usage(
        format!("cannot read {}: {error}", path.display()),
        Vec::new(),
    )
}
