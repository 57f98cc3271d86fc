//! Resolves a file as typed into a mechanism: names become indices, units radians, formulas operations.

mod bars;
pub mod bodies;
mod body_constants;
pub mod camera;
mod carried;
pub mod choices;
mod clearance;
mod closure;
mod contacts;
mod coordinates;
mod decor;
mod derivative_text;
mod joints;
mod kinds_of_names;
mod loops;
mod magnitudes;
mod measures;
mod meshes;
mod named_file;
mod named_results;
mod names;
mod outputs;
mod parsed;
mod parsing;
mod placed_bodies;
mod plots;
pub mod range;
mod rates;
mod refused_names;
mod scales;
mod section;
mod settled_starts;
mod shown_dimensions;
mod size;
mod solid_formulas;
mod solids;
mod study;
mod symbolic;
mod varied;
mod view;
mod words;
mod written;

use super::file::SceneFile;
use super::loaded::Scene;
use super::overrides::Overrides;
use crate::diag::Diagnostics;
use crate::model::actuation::Actuation;
use crate::model::chain::Argument;
use crate::model::joints::Joints;
use crate::model::measure::Measures;
use crate::model::mechanism::{Kind, Mechanism};
use closure::ClosureConditions;
use coordinates::Coordinates;
use joints::FoldedJoints;
use named_file::NamedFile;
use named_results::NamedResults;
use names::Names;
use parsed::Parsed;
use placed_bodies::PlacedBodies;
use settled_starts::start_poses;
use size::mechanism_size;
use std::sync::Arc;
use varied::Dependents;

/// Resolves everything; `None` if errors leave nothing meaningful. Relative file names refer to the folder of
/// `overrides`; its varied parameters become constant inputs.
pub fn resolve_scene(
    file: &SceneFile,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let named = NamedFile::resolve(file, overrides, diagnostics);
    let mut joints = FoldedJoints::new(&named.names);
    let closure = ClosureConditions::resolve(&named, &mut joints, diagnostics);
    let dependents = Dependents::new(&named.parsed, &named.names, &overrides.vary);
    let mut placed = PlacedBodies::resolve(&named, &dependents, &mut joints, diagnostics);
    let mut results = NamedResults::resolve(&named, (&closure, &placed), &dependents, diagnostics);
    let coordinates = results.coordinates.take()?;
    // All errors have been collected; from here on nothing can fail.
    if diagnostics.has_errors() {
        return None;
    }
    let parts = (&mut placed, &mut results);
    let mechanism = assemble_mechanism(&named, closure, joints.arguments, parts);
    let (mechanism, actuation) = finish_mechanism(mechanism, coordinates, &named);
    loops::warn_of_loops(&mechanism, &named.parsed, diagnostics);
    Some(assemble_scene(
        &named, mechanism, actuation, placed, results,
    ))
}

/// The mechanism, as yet without its sizes and its table of joints.
fn assemble_mechanism(
    named: &NamedFile,
    closure: ClosureConditions,
    arguments: Vec<Argument>,
    (placed, results): (&mut PlacedBodies, &mut NamedResults),
) -> Mechanism {
    let (file, names) = (named.file, &named.names);
    let contacts = named.parsed.contacts.iter();
    let title = file.title.clone();
    Mechanism {
        title: title.unwrap_or_else(|| "untitled mechanism".to_owned()),
        length_unit: file.length_unit.clone().unwrap_or_else(|| "m".to_owned()),
        angle_unit: named.angle_unit.clone(),
        unknowns: names.unknowns.clone(),
        inputs: names.inputs.clone(),
        arguments,
        sliding: Vec::new(),
        loops: closure.loops,
        equations: closure.equations,
        bars: closure.bars,
        contacts: contacts.map(|c| c.name.value.clone()).collect(),
        crossings: closure.contacts.crossings,
        bodies: std::mem::take(&mut placed.bodies),
        traces: std::mem::take(&mut placed.traces),
        outputs: std::mem::take(&mut results.outputs),
        joints: Joints::default(),
        size: 1.0,
        scales: Vec::new(),
    }
}

/// Adds what follows from the start of the motion and from the finished chains.
fn finish_mechanism(
    mut mechanism: Mechanism,
    coordinates: Coordinates,
    named: &NamedFile,
) -> (Mechanism, Actuation) {
    let mut actuation = Actuation {
        drives: coordinates.drives,
        duration: coordinates.duration,
        guess: coordinates.guess,
        named: coordinates.named,
    };
    let texts = (&named.parsed, &named.names);
    estimate_numbers(&mut mechanism, &mut actuation, texts, named.overrides.size);
    mechanism.sliding = mechanism.sliding_arguments();
    // The table of joints and links is built once, from the finished chains.
    mechanism.joints = Joints::new(&mechanism);
    (mechanism, actuation)
}

fn assemble_scene(
    named: &NamedFile,
    mechanism: Mechanism,
    actuation: Actuation,
    placed: PlacedBodies,
    mut results: NamedResults,
) -> Scene {
    let (file, parsed, names) = (named.file, &named.parsed, &named.names);
    let measures = results.measures.iter_mut();
    let lengths = measures.filter(|m| m.kind == Kind::Length);
    lengths.for_each(|measure| measure.size = mechanism.size);
    let notation = named.overrides.notation;
    let notation = notation.then(|| written::resolve_notation(file, parsed, names, &mechanism));
    Scene {
        description: file.description.clone().unwrap_or_default(),
        mechanism: Arc::new(mechanism),
        actuation,
        measures: Arc::new(Measures {
            tracks: results.tracks,
            list: results.measures,
        }),
        view: Arc::new(results.view),
        study: results.study.map(Arc::new),
        dimensions: names.dimensions(parsed).into(),
        kinds: names.parameter_kinds().into(),
        kept: named.kept.clone(),
        clearance: results.clearance.map(Arc::new),
        plots: results.plots.into(),
        notation,
        carried: placed.carried,
        shaped_by: placed.shaped_by,
        warnings: Diagnostics::default(),
    }
}

/// Sizes, units of the loops and magnitudes of the equations, from the drives and the start values; `size` replaces the
/// mechanism's own.
fn estimate_numbers(
    mechanism: &mut Mechanism,
    actuation: &mut Actuation,
    (parsed, names): (&Parsed, &Names),
    size: Option<f64>,
) {
    // Keys and jumps of several drives whose times differ by rounding only become one instant.
    actuation.join_instants();
    for pin in &parsed.bars.pins {
        pin.start(mechanism, actuation);
    }
    let own: Vec<&str> = parsed
        .equations
        .iter()
        .map(|(name, _)| name.value.as_str())
        .collect();
    let poses = start_poses(mechanism, actuation, &own);
    mechanism.size = size.unwrap_or_else(|| mechanism_size(mechanism, (actuation, &poses), names));
    scales::estimate_scales(mechanism, poses.clone());
    magnitudes::estimate_magnitudes(mechanism, poses);
}
