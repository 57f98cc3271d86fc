//! The other half of `mechanim render`: shapes in space instead of pictures.

use crate::cli::args::files::FileArgs;
use crate::cli::files::sinks;
use crate::cli::files::sinks::to_stdout;
use crate::cli::term::Term;
use crate::cli::term::outcome::Failure;
use crate::export::glb::{Corners, write_glb};
use crate::export::solid::{Library, write_obj, write_stl};
use crate::export::{ExportSummary, Format, PendingFile};
use crate::kinematics::results::trajectory::Trajectory;
use crate::model::view::{Ghosts, ShownAxes};
use crate::report::rounded::at_most;
use crate::report::sentences::input_sentence;
use crate::scene::Scene;
use crate::staging::Staging;
use crate::staging::model::{Facets, of_motion};
use std::ops::Range;

/// Writes the samples of the motion as the model that `format` names.
///
/// Errors: a still of an instant without a pose; a failed write.
pub fn write_model(
    (args, facets): (&FileArgs, Facets),
    format: &Format,
    scene: &Scene,
    trajectory: &Trajectory,
    staging: &Staging,
    samples: Range<usize>,
    term: &Term,
) -> Result<(), Failure> {
    if samples.len() == 1 {
        refuse_missing(scene, trajectory, samples.start)?;
    }
    let [width, height] = staging.stage.size.map(f64::from);
    let camera = Some((staging.stage.camera, width / height));
    let model = of_motion(scene, trajectory, samples, camera, facets);
    let output = sinks::open_file(args)?;
    if let Some(moved) = model.coarse_rounding().filter(|_| *format != Format::Obj) {
        term.warning(&format!(
            "{} has single precision: so far from the origin it moves corners by up to {} {}",
            format.name(),
            at_most(moved),
            scene.mechanism.length_unit
        ));
    }
    let corners = match facets {
        Facets::Picture => Corners::Quantised,
        Facets::Tool | Facets::Within(_) => Corners::Full,
    };
    let summary = match format {
        Format::Stl => write_stl(&model, output)?,
        Format::Obj => write_obj(&model, output, material_library(args)?)?,
        _ => write_glb(&model, corners, output)?,
    };
    if let Some(left_out) = left_out(scene) {
        let name = format.name();
        let shapes = match format {
            Format::Glb => "shapes and their motion",
            _ => "the shapes of one pose",
        };
        term.note(&format!("{name} contains {shapes}, not {left_out}"));
    }
    if !to_stdout(args) {
        let parts = model.bodies.iter().flat_map(|body| &body.parts);
        let triangles: usize = parts.map(|part| part.mesh.triangles.len()).sum();
        tell_model(args, &summary, model.bodies.len(), triangles, term);
    }
    Ok(())
}

/// What pictures of the scene show in addition to its shapes and paths.
fn left_out(scene: &Scene) -> Option<String> {
    let (view, decor) = (&scene.view, &scene.view.decor);
    let shown = [
        (!view.labels.is_empty(), "labels"),
        (decor.ghosts != Ghosts::Count(0), "ghosts"),
        (decor.arrows, "arrows"),
        (decor.axes != ShownAxes::None, "axes"),
        (decor.scale, "scale"),
        (decor.ticks.is_some(), "ticks"),
        (!view.dimensions.is_empty(), "dimensions"),
        (decor.gauge, "gauges"),
        (decor.joints, "joint symbols"),
    ];
    let shown = shown.iter().filter(|(is_shown, _)| *is_shown);
    let names: Vec<&str> = shown.map(|(_, name)| *name).collect();
    (!names.is_empty()).then(|| names.join(", "))
}

/// Name and file of an OBJ's materials, beside the OBJ and named after it. `None` where the OBJ has no file name.
fn material_library(args: &FileArgs) -> Result<Option<Library>, Failure> {
    let path = args.out.with_extension("mtl");
    let name = path.file_name().and_then(|name| name.to_str());
    // A name with blanks would be read as several.
    let name = name.filter(|name| !name.contains(char::is_whitespace));
    match name {
        Some(name) if !to_stdout(args) && path != args.out => Ok(Some((
            name.to_owned(),
            Box::new(PendingFile::create(&path)?),
        ))),
        _ => Ok(None),
    }
}

/// Such a file cannot say that a pose does not exist, and its neighbour must not take its place.
fn refuse_missing(scene: &Scene, trajectory: &Trajectory, sample: usize) -> Result<(), Failure> {
    let sample = &trajectory.samples[sample];
    if sample.pose.is_some() {
        return Ok(());
    }
    let values = input_sentence(&scene.mechanism, &sample.inputs);
    Err(Failure::without_pose(
        trajectory.is_undecided(),
        format!("the motion has no pose at t = {} s ({values})", sample.time),
        vec!["take another time with --at SECONDS".to_owned()],
    ))
}

fn tell_model(
    args: &FileArgs,
    summary: &ExportSummary,
    bodies: usize,
    triangles: usize,
    term: &Term,
) {
    let keys = match summary.frames {
        1 => String::new(),
        keys => format!(", {keys} keys over {:.2} s", summary.seconds),
    };
    term.note(&format!(
        "{}: {bodies} bodies, {triangles} triangles{keys}, {:.2} MB",
        args.out.display(),
        summary.bytes as f64 / 1e6,
    ));
}
