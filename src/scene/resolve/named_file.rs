//! The first step of resolving a file: what every name is, and what it measures.

use super::super::file::SceneFile;
use super::super::loaded::KeptParameter;
use super::super::overrides::Overrides;
use super::choices::chosen_angle_unit;
use super::contacts::parallel::settle_parallel;
use super::kinds_of_names::dimensions_of_solids;
use super::names::Names;
use super::parsed::Parsed;
use super::varied::{expand_dependents, kept_parameters};
use crate::diag::Diagnostics;
use crate::model::mechanism::AngleUnit;

/// A file with its formulas and names, which all further steps read.
pub struct NamedFile<'f> {
    pub file: &'f SceneFile,
    pub overrides: &'f Overrides,
    pub parsed: Parsed,
    pub names: Names,
    pub angle_unit: AngleUnit,
    /// Varied parameters whose file values are still used somewhere.
    pub kept: Vec<KeptParameter>,
    /// The file's values of the varied parameters.
    pub varied_values: Vec<f64>,
}

impl<'f> NamedFile<'f> {
    /// Parses everything, then finds out what each name is.
    pub fn resolve(
        file: &'f SceneFile,
        overrides: &'f Overrides,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let angle_unit = file.angle_unit.as_ref();
        let angle_unit = angle_unit.and_then(|word| chosen_angle_unit(word, diagnostics));
        let angle_unit = angle_unit.unwrap_or_default();
        let mut parsed = Parsed::new(file, diagnostics);
        let mut names = Names::collect(file, &parsed, &angle_unit, diagnostics);
        names.infer_kinds(&parsed, diagnostics);
        if overrides.carries_shapes {
            let of_solids = dimensions_of_solids(file, &parsed);
            names.infer_more_kinds(&of_solids, &parsed);
        }
        names.evaluate_parameters(&parsed, diagnostics);
        // Variables of a study become constant inputs, with parameters computed from them written out.
        let varied = overrides.vary.as_slice();
        let kept = kept_parameters(&parsed, &names, varied);
        expand_dependents(&mut parsed, &names, varied, diagnostics);
        let varied_values = names.promote_parameters(varied);
        settle_parallel(&parsed, &mut names);
        Self {
            file,
            overrides,
            parsed,
            names,
            angle_unit,
            kept,
            varied_values,
        }
    }
}
