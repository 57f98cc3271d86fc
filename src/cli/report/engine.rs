//! The engine of live pages: where it is found, and which scenes it can contain.

use crate::cli::args::scene::SceneArgs;
use crate::cli::term::outcome::Failure;
use crate::model::shape::Solid;
use crate::page::PackedEngine;
use crate::scene::Scene;
use std::path::{Path, PathBuf};

/// Its name beside the program.
const NAME: &str = "mechanim.wasm";

/// The command that builds it.
const BUILD: &str = "build it from the sources, rustup target add wasm32-unknown-unknown, then \
    cargo build --profile web --target wasm32-unknown-unknown -p mechanim-web, \
    and put target/wasm32-unknown-unknown/web/mechanim.wasm beside the program or name it with --wasm FILE";

/// Reads the engine that was named, or the one beside the program.
///
/// Errors: there is none; it is of another version.
pub fn find_engine(named: Option<&Path>) -> Result<PackedEngine, Failure> {
    let refused = |message: String| Failure::usage(message, vec![BUILD.to_owned()]);
    let beside = || Some(std::env::current_exe().ok()?.with_file_name(NAME));
    let path: PathBuf = named
        .map(Path::to_owned)
        .or_else(beside)
        .unwrap_or_else(|| PathBuf::from(NAME));
    let bytes = std::fs::read(&path).map_err(|error| {
        let what = "a live page contains the engine as WebAssembly, which was not found";
        refused(format!("{what}: {}: {error}", path.display()))
    })?;
    PackedEngine::new(&bytes).map_err(|why| refused(format!("{}: {why}", path.display())))
}

/// Refuses scenes whose text is not available, or incomplete.
///
/// Errors: a scene from a pipe; one with meshes.
pub fn refuse_files(args: &SceneArgs, scene: &Scene) -> Result<(), Failure> {
    if args.scene == "-" {
        let hint = "write the scene into a file".to_owned();
        return Err(Failure::usage(
            "a live page needs a scene file, not standard input",
            vec![hint],
        ));
    }
    let bodies = scene.mechanism.bodies.iter();
    let mut shapes = bodies.flat_map(|body| &body.shapes);
    match shapes.any(|shape| matches!(shape.solid, Solid::Triangles(_))) {
        false => Ok(()),
        true => Err(Failure::usage(
            "a live page contains only the text of a scene, and this one names mesh files",
            vec![
                "leave out --live: the page shows the meshes and everything except the sliders"
                    .to_owned(),
            ],
        )),
    }
}
