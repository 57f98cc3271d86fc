//! `mechanim check --swept`: the swept volume of a body, as a file.

use crate::clearance::covered::CoveredMotion;
use crate::clearance::swept::Swept;
use crate::cli::args::motion::CheckArgs;
use crate::cli::io;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::export::glb::{Corners, write_glb};
use crate::export::solid::{write_obj, write_stl};
use crate::export::{Format, PendingFile};
use crate::report::rounded::at_most_three;
use crate::staging::model::of_mesh;
use std::path::Path;

/// Writes the requested mesh, if any.
pub fn write(
    args: &CheckArgs,
    opened: &OpenScene,
    covered: &mut CoveredMotion,
    term: &Term,
) -> Result<(), Failure> {
    let (Some(path), Some(name)) = (&args.swept, &args.body) else {
        return Ok(());
    };
    let body = body_index(opened, name)?;
    let from = args.relative_to.as_ref();
    let seen_from = from.map(|name| body_index(opened, name)).transpose()?;
    let format = format_of(path)?;
    io::refuse_input(&args.scene, path)?;
    let swept = Swept::new(covered.proved(), body, seen_from, args.cells).map_err(|error| {
        Failure::usage(
            format!("no mesh around the volume swept by `{name}`: {error}"),
            Vec::new(),
        )
    })?;
    let sure = if swept.is_certified {
        "proved"
    } else {
        "estimated"
    };
    let (within, triangles) = (at_most_three(swept.within), swept.mesh.triangles.len());
    let model = of_mesh(&opened.scene, name, swept.mesh);
    let output = Box::new(PendingFile::create(path)?);
    match format {
        Format::Stl => write_stl(&model, output)?,
        Format::Obj => write_obj(&model, output, None)?,
        _ => write_glb(&model, Corners::Full, output)?,
    };
    let unit = &opened.scene.mechanism.length_unit;
    term.note(&format!(
        "{}: encloses the volume swept by `{name}` to within {within} {unit} ({sure}); {triangles} triangles",
        path.display(),
    ));
    Ok(())
}

fn body_index(opened: &OpenScene, name: &str) -> Result<usize, Failure> {
    let bodies = &opened.scene.mechanism.bodies;
    bodies
        .iter()
        .position(|body| body.name == name)
        .ok_or_else(|| {
            let names = bodies.iter().map(|b| b.name.as_str());
            Failure::unknown_name("body", name, names)
        })
}

fn format_of(path: &Path) -> Result<Format, Failure> {
    let extension = path
        .extension()
        .and_then(|e| e.to_str())
        .unwrap_or_default();
    match extension.to_ascii_lowercase().as_str() {
        "stl" => Ok(Format::Stl),
        "obj" => Ok(Format::Obj),
        "glb" => Ok(Format::Glb),
        _ => Err(Failure::unknown_kind(
            path,
            "model",
            "known kinds: .stl, .obj and .glb",
        )),
    }
}
