//! Resolves a file as typed into a mechanism: names become indices, units radians, formulas operations.

mod bars;
pub mod bodies;
mod body_constants;
pub mod camera;
mod carried;
pub mod choices;
mod clearance;
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
mod names;
mod outputs;
mod parsed;
mod parsing;
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
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use crate::model::joints::Joints;
use crate::model::measure::Measures;
use crate::model::mechanism::{AngleUnit, Bar, Equation, Kind, Loop, Mechanism};
use crate::numbers::constant::Constant;
use bars::equations::resolve_bars;
use contacts::closure::Contacts;
use joints::FoldedJoints;
use meshes::MeshFiles;
use names::Names;
use outputs::Scope;
use parsed::Parsed;
use settled_starts::start_poses;
use size::mechanism_size;
use std::sync::Arc;

/// Resolves everything; `None` if errors leave nothing meaningful. Relative file names refer to the folder of
/// `overrides`; its varied parameters become constant inputs.
pub fn resolve_scene(
    file: &SceneFile,
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<Scene> {
    let varied = overrides.vary.as_slice();
    let mut meshes = MeshFiles::new(&overrides.folder, &overrides.allowed_folders);
    let angle_unit = angle_unit(file, diagnostics);
    // Names: parse everything, then find out what each name is and what it measures.
    let mut parsed = Parsed::new(file, diagnostics);
    let mut names = Names::collect(file, &parsed, &angle_unit, diagnostics);
    names.infer_kinds(&parsed, diagnostics);
    if overrides.carries_shapes {
        let of_solids = kinds_of_names::dimensions_of_solids(file, &parsed);
        names.infer_more_kinds(&of_solids, &parsed);
    }
    names.evaluate_parameters(&parsed, diagnostics);
    // Variables of a study become constant inputs, with parameters computed from them written out.
    let kept = varied::kept_parameters(&parsed, &names, varied);
    varied::expand_dependents(&mut parsed, &names, varied, diagnostics);
    let varied_values = names.promote_parameters(varied);
    // Equations: the file's loops and equations, then those of bars and contacts.
    contacts::parallel::settle_parallel(&parsed, &mut names);
    let mut joints = FoldedJoints::new(&names);
    let ClosureConditions {
        loops,
        equations,
        bars,
        contacts,
    } = resolve_closure(&parsed, (&names, &angle_unit), &mut joints, diagnostics);
    // Bodies and traced points; in a study their chains follow the variables.
    let mut bodies =
        bodies::resolve_bodies(file, &parsed, &names, &mut joints, &mut meshes, diagnostics);
    let mut traces = bodies::body_traces(file, &names, &bodies, diagnostics);
    if !varied.is_empty() && !diagnostics.has_errors() {
        let points = (&mut bodies, &mut traces[..]);
        varied::carry_points(file, &parsed, varied, &mut joints, points, diagnostics);
    }
    let dependents = varied::Dependents::new(&parsed, &names, varied);
    let shaped_by = carried::variables_of_shapes((file, &parsed), &dependents);
    let mut carried = Vec::new();
    if overrides.carries_shapes && !diagnostics.has_errors() {
        carried = carried::carry_shapes((file, &parsed), &dependents, &mut joints, diagnostics);
    }
    // Outputs come last of the formulas on poses, since they may use contacts and traced points.
    let scope = Scope::resolve(
        (file, &parsed),
        &bodies,
        &names,
        &traces,
        &contacts,
        &angle_unit,
        diagnostics,
    );
    // Drives and start values; the variables of a study are constant drives.
    let mut coordinates = coordinates::resolve_coordinates(file, &parsed, &names, diagnostics);
    if let Some(coordinates) = &mut coordinates {
        let resting = varied_values.into_iter().map(Drive::constant);
        coordinates.drives.extend(resting);
    }
    // Everything that refers to the finished mechanism by name: plots, view, clearance, tracks, measures, study.
    let plots = plots::resolve_plots(file, &scope, diagnostics);
    let view = view::resolve_view(file, &names, &bodies, &traces, diagnostics);
    let constants = body_constants::BodyConstants { names: &names };
    let clearance = file
        .clearance
        .as_ref()
        .map(|section| clearance::resolve_clearance(section, &constants, &bodies, diagnostics));
    let start = coordinates.iter().flat_map(|c| &c.drives);
    let start: Vec<f64> = start.map(|drive| drive.value(0.0)).collect();
    // Without drives, whose errors have been reported, tracks cannot be resolved.
    let tracks = match start.len() == names.inputs.len() {
        true => measures::resolve_tracks(file, &scope, &start, diagnostics),
        false => Vec::new(),
    };
    let mut measures = measures::resolve_measures(
        file,
        (&scope, &dependents),
        (&tracks, overrides.derives_measures),
        diagnostics,
    );
    let outputs = scope.outputs;
    let is_empty = loops.is_empty() && equations.is_empty() && bodies.is_empty();
    if is_empty && outputs.is_empty() && !diagnostics.has_errors() {
        diagnostics.push(nothing_to_solve());
    }
    let units = (&names, &angle_unit);
    let study = study::resolve_study(file, units, &measures, overrides, diagnostics);
    let coordinates = coordinates?;
    // All errors have been collected; from here on nothing can fail.
    if diagnostics.has_errors() {
        return None;
    }
    let arguments = joints.arguments;
    let mut mechanism = Mechanism {
        title: file
            .title
            .clone()
            .unwrap_or_else(|| "untitled mechanism".to_owned()),
        length_unit: file.length_unit.clone().unwrap_or_else(|| "m".to_owned()),
        angle_unit: angle_unit.clone(),
        unknowns: names.unknowns.clone(),
        inputs: names.inputs.clone(),
        arguments,
        sliding: Vec::new(),
        loops,
        equations,
        bars,
        contacts: parsed
            .contacts
            .iter()
            .map(|c| c.name.value.clone())
            .collect(),
        crossings: contacts.crossings,
        bodies,
        traces,
        outputs,
        joints: Joints::default(),
        size: 1.0,
        scales: Vec::new(),
    };
    let mut actuation = Actuation {
        drives: coordinates.drives,
        duration: coordinates.duration,
        guess: coordinates.guess,
        named: coordinates.named,
    };
    estimate_numbers(
        &mut mechanism,
        &mut actuation,
        (&parsed, &names),
        overrides.size,
    );
    let lengths = measures.iter_mut().filter(|m| m.kind == Kind::Length);
    lengths.for_each(|measure| measure.size = mechanism.size);
    mechanism.sliding = mechanism.sliding_arguments();
    // The table of joints and links is built once, from the finished chains.
    mechanism.joints = Joints::new(&mechanism);
    loops::warn_of_loops(&mechanism, &parsed, diagnostics);
    let notation = overrides
        .notation
        .then(|| written::resolve_notation(file, &parsed, &names, &mechanism));
    let description = file.description.clone().unwrap_or_default();
    Some(Scene {
        description,
        mechanism: Arc::new(mechanism),
        actuation,
        measures: Arc::new(Measures {
            tracks,
            list: measures,
        }),
        view: Arc::new(view),
        study: study.map(Arc::new),
        dimensions: names.dimensions(&parsed).into(),
        kinds: names.parameter_kinds().into(),
        kept,
        clearance: clearance.map(Arc::new),
        plots: plots.into(),
        notation,
        carried,
        shaped_by,
        warnings: Diagnostics::default(),
    })
}

/// Everything that must close: loops and equations, with the bars and contacts that some of them come from.
struct ClosureConditions {
    loops: Vec<Loop>,
    equations: Vec<Equation>,
    bars: Vec<Bar>,
    contacts: Contacts,
}

/// The file's loops and equations, then those of its bars and contacts.
fn resolve_closure(
    parsed: &Parsed,
    named: (&Names, &AngleUnit),
    joints: &mut FoldedJoints,
    diagnostics: &mut Diagnostics,
) -> ClosureConditions {
    let mut loops = joints.loops(parsed, diagnostics);
    let mut equations = joints.equations(parsed, diagnostics);
    let mut bars = resolve_bars(&parsed.bars, named.0, joints, diagnostics);
    loops.append(&mut bars.loops);
    equations.append(&mut bars.equations);
    let mut contacts = Contacts::resolve(&parsed.contacts, named.0, joints, diagnostics);
    loops.append(&mut contacts.loops);
    equations.append(&mut contacts.equations);
    ClosureConditions {
        loops,
        equations,
        bars: bars.list,
        contacts,
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

fn nothing_to_solve() -> Diagnostic {
    Diagnostic::error("the scene has no loop, no body and no output")
        .at(0..0)
        .hint("write at least one closed loop: `[loops]` then `A = \"T12 T23 T31\"`")
}

fn angle_unit(file: &SceneFile, diagnostics: &mut Diagnostics) -> AngleUnit {
    let unit = file.angle_unit.as_ref();
    let name = unit.map_or("rad", |s| s.value.as_str());
    AngleUnit::from_name(name).unwrap_or_else(|| {
        let span = unit.map_or(0..0, |s| s.span.clone());
        diagnostics.push(
            Diagnostic::error(format!("unknown angle unit `{name}`"))
                .at(span)
                .hint("rad or deg"),
        );
        AngleUnit {
            name: name.to_owned(),
            radians: Constant::exact(1.0),
        }
    })
}
