//! The third step: bodies and traced points; in a study their chains follow the variables.

use super::bodies::{body_traces, resolve_bodies};
use super::carried::{carry_shapes, variables_of_shapes};
use super::joints::FoldedJoints;
use super::meshes::MeshFiles;
use super::named_file::NamedFile;
use super::varied::{Dependents, carry_points};
use crate::diag::Diagnostics;
use crate::model::carried::CarriedShape;
use crate::model::mechanism::{Body, Trace};

/// What the chains of a scene carry.
pub struct PlacedBodies {
    pub bodies: Vec<Body>,
    pub traces: Vec<Trace>,
    /// Solids as functions of the varied parameters, on request.
    pub carried: Vec<CarriedShape>,
    /// For every body the varied parameters that its shapes depend on, by their number.
    pub shaped_by: Vec<Vec<usize>>,
}

impl PlacedBodies {
    /// Resolves the bodies and traced points of the file.
    pub fn resolve(
        named: &NamedFile,
        dependents: &Dependents,
        joints: &mut FoldedJoints,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let (file, parsed, names) = (named.file, &named.parsed, &named.names);
        let (overrides, varied) = (named.overrides, named.overrides.vary.as_slice());
        let mut meshes = MeshFiles::new(&overrides.folder, &overrides.allowed_folders);
        let mut bodies = resolve_bodies(file, parsed, names, joints, &mut meshes, diagnostics);
        let mut traces = body_traces(file, names, &bodies, diagnostics);
        if !varied.is_empty() && !diagnostics.has_errors() {
            let points = (&mut bodies, &mut traces[..]);
            carry_points(file, parsed, varied, joints, points, diagnostics);
        }
        let shaped_by = variables_of_shapes((file, parsed), dependents);
        let carried = match overrides.carries_shapes && !diagnostics.has_errors() {
            true => carry_shapes((file, parsed), dependents, joints, diagnostics),
            false => Vec::new(),
        };
        Self {
            bodies,
            traces,
            carried,
            shaped_by,
        }
    }
}
