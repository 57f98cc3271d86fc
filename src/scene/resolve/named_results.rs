//! The fourth step: everything that refers to the finished mechanism by name: outputs, drives, plots, view, clearance,
//! tracks, measures, study.

use super::body_constants::BodyConstants;
use super::clearance::resolve_clearance;
use super::closure::ClosureConditions;
use super::coordinates::{Coordinates, resolve_coordinates};
use super::measures::{resolve_measures, resolve_tracks};
use super::named_file::NamedFile;
use super::outputs::Scope;
use super::placed_bodies::PlacedBodies;
use super::plots::resolve_plots;
use super::study::resolve_study;
use super::varied::Dependents;
use super::view::resolve_view;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::clearance::ClearanceRules;
use crate::model::drive::Drive;
use crate::model::measure::{Measure, MeasuredTrack};
use crate::model::mechanism::MechanismOutput;
use crate::model::plot::Plot;
use crate::model::study::Study;
use crate::model::view::View;

/// What is asked of a mechanism and its motion.
pub struct NamedResults {
    /// Drives and start values; none after an error.
    pub coordinates: Option<Coordinates>,
    pub outputs: Vec<MechanismOutput>,
    pub plots: Vec<Plot>,
    pub view: View,
    pub clearance: Option<ClearanceRules>,
    pub tracks: Vec<MeasuredTrack>,
    pub measures: Vec<Measure>,
    pub study: Option<Study>,
}

impl NamedResults {
    /// Resolves them for a mechanism that closes and carries these.
    pub fn resolve(
        named: &NamedFile,
        (closure, placed): (&ClosureConditions, &PlacedBodies),
        dependents: &Dependents,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let (file, names) = (named.file, &named.names);
        let (bodies, traces) = (&placed.bodies, &placed.traces);
        let scope = Scope::resolve(
            (file, &named.parsed),
            bodies,
            names,
            traces,
            &closure.contacts,
            &named.angle_unit,
            diagnostics,
        );
        let coordinates = driven_coordinates(named, diagnostics);
        let plots = resolve_plots(file, &scope, diagnostics);
        let view = resolve_view(file, names, bodies, traces, diagnostics);
        let constants = BodyConstants { names };
        let clearance = file.clearance.as_ref();
        let clearance =
            clearance.map(|section| resolve_clearance(section, &constants, bodies, diagnostics));
        let tracks = driven_tracks(named, &scope, coordinates.as_ref(), diagnostics);
        let measures = resolve_measures(
            file,
            (&scope, dependents),
            (&tracks, named.overrides.derives_measures),
            diagnostics,
        );
        let is_empty = closure.loops.is_empty() && closure.equations.is_empty();
        let is_empty = is_empty && bodies.is_empty() && scope.outputs.is_empty();
        if is_empty && !diagnostics.has_errors() {
            diagnostics.push(nothing_to_solve());
        }
        let units = (names, &named.angle_unit);
        let study = resolve_study(file, units, &measures, named.overrides, diagnostics);
        Self {
            coordinates,
            outputs: scope.outputs,
            plots,
            view,
            clearance,
            tracks,
            measures,
            study,
        }
    }
}

/// Drives and start values; the variables of a study are constant drives.
fn driven_coordinates(named: &NamedFile, diagnostics: &mut Diagnostics) -> Option<Coordinates> {
    let mut coordinates =
        resolve_coordinates(named.file, &named.parsed, &named.names, diagnostics)?;
    let resting = named.varied_values.iter().copied().map(Drive::constant);
    coordinates.drives.extend(resting);
    Some(coordinates)
}

/// The tracks; none without drives, whose errors have been reported.
fn driven_tracks(
    named: &NamedFile,
    scope: &Scope,
    coordinates: Option<&Coordinates>,
    diagnostics: &mut Diagnostics,
) -> Vec<MeasuredTrack> {
    let drives = coordinates.map_or(&[][..], |c| &c.drives);
    if drives.len() != named.names.inputs.len() {
        return Vec::new();
    }
    let start: Vec<f64> = drives.iter().map(|drive| drive.value(0.0)).collect();
    resolve_tracks(named.file, scope, &start, diagnostics)
}

fn nothing_to_solve() -> Diagnostic {
    Diagnostic::error("the scene has no loop, no body and no output")
        .at(0..0)
        .hint("write at least one closed loop: `[loops]` then `A = \"T12 T23 T31\"`")
}
