//! Values that the command line and studies substitute for those of the file.

use super::file::{InputFile, SceneFile};
use super::plots::PlotFile;
use super::reader::Spanned;
use super::values::FormulaText;
use crate::diag::{Diagnostic, Diagnostics, name_hint};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use std::path::PathBuf;

/// Values from the command line that replace those of the file.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// `--param NAME=FORMULA`
    pub parameters: Vec<(String, String)>,
    /// `--input NAME=FORMULA`
    pub inputs: Vec<(String, String)>,
    /// `--guess NAME=FORMULA`
    pub guess: Vec<(String, String)>,
    /// `plot --y …`: replaces the scene's own plots.
    pub plot: Option<PlotText>,
    /// Folder to which relative file names in the scene refer.
    pub folder: PathBuf,
    /// Other folders from which files may be read.
    pub allowed_folders: Vec<PathBuf>,
    /// Parameters to be turned into inputs, after the scene's own: the variables of a study.
    pub vary: Vec<String>,
    /// `--minimise`: the measure to minimise instead of the file's.
    pub minimise: Option<String>,
    /// Characteristic length instead of the mechanism's own: variants that a study compares with its scene use the
    /// scene's length.
    pub size: Option<f64>,
    /// `--input-table`: drives that replace those of the scene's inputs.
    pub drives: Option<OtherDrives>,
    /// Whether to keep the chains as written, for drawings.
    pub notation: bool,
    /// Whether a study differentiates the measures by its variables.
    pub derives_measures: bool,
    /// Whether parameters may lie outside their ranges in the study: those of a neighbouring design.
    pub outside_ranges: bool,
    /// Whether solids depend on the varied parameters, for enclosures of clearances.
    pub carries_shapes: bool,
}

/// Drives that replace those of the file.
#[derive(Clone, Debug)]
pub struct OtherDrives {
    /// One for each of the scene's own inputs.
    pub drives: Vec<Drive>,
    /// Length of the motion in seconds.
    pub duration: f64,
}

impl OtherDrives {
    /// Substitutes them for the scene's own.
    pub fn replace_in(&self, actuation: &mut Actuation) {
        actuation.duration = self.duration;
        let own = actuation.drives.iter_mut().zip(&self.drives);
        own.for_each(|(drive, other)| *drive = other.clone());
        actuation.join_instants();
    }
}

/// A plot asked for on the command line: formulas as in the scene's `[[plots]]`.
#[derive(Clone, Debug, Default)]
pub struct PlotText {
    /// `--x`
    pub x: Option<String>,
    /// `--y`
    pub y: Vec<String>,
    /// `--equal`
    pub equal: bool,
}

/// Substitutes the values of the command line for those of the file.
pub fn apply_overrides(overrides: &Overrides, file: &mut SceneFile, diagnostics: &mut Diagnostics) {
    for (what, list) in [
        ("parameter or chain", &overrides.parameters),
        ("input", &overrides.inputs),
        ("start value", &overrides.guess),
    ] {
        given_twice(what, list)
            .into_iter()
            .for_each(|d| diagnostics.push(d));
    }
    let mut unknown = |what: &str, name: &str, known: Vec<&str>| {
        diagnostics.push(
            Diagnostic::error(format!("the scene has no {what} `{name}`"))
                .hint(name_hint(name, known)),
        );
    };
    let mut replaced = Vec::new();
    // Names must be those of the file, ...
    for (name, text) in &overrides.parameters {
        let mut formulas = file.parameters.iter_mut().chain(&mut file.chains);
        match formulas.find(|(n, _)| n.value == *name) {
            Some((_, formula)) => {
                let own = std::mem::replace(formula, FormulaText::outside(text));
                replaced.push((name.clone(), own));
            }
            None => {
                let known = file.parameters.iter().chain(&file.chains);
                let known = known.map(|(n, _)| n.value.as_str()).collect();
                unknown("parameter or chain", name, known);
            }
        }
    }
    file.replaced = replaced;
    for (name, text) in &overrides.inputs {
        match file.inputs.iter_mut().find(|(n, _)| n.value == *name) {
            Some((_, input)) => *input = InputFile::Formula(FormulaText::outside(text)),
            None => unknown(
                "input",
                name,
                file.inputs.iter().map(|(n, _)| n.value.as_str()).collect(),
            ),
        }
    }
    // ... except for start values: the file need not have any.
    for (name, text) in &overrides.guess {
        let formula = FormulaText::outside(text);
        file.guess.retain(|(n, _)| n.value != *name);
        file.guess.push((
            Spanned {
                value: name.clone(),
                span: formula.span.clone(),
            },
            formula,
        ));
    }
    // A plot takes the place of all plots of the file.
    if let Some(plot) = &overrides.plot {
        file.plots = vec![PlotFile {
            x: plot.x.as_deref().map(FormulaText::outside),
            y: plot
                .y
                .iter()
                .map(|text| FormulaText::outside(text))
                .collect(),
            equal: plot.equal,
            ..PlotFile::default()
        }];
    }
}

/// A mistake for each name that has two values.
fn given_twice(what: &str, list: &[(String, String)]) -> Vec<Diagnostic> {
    let again = list.iter().enumerate().filter_map(|(k, (name, text))| {
        let (_, before) = list[..k].iter().find(|(known, _)| known == name)?;
        let message = format!("the {what} `{name}` is replaced twice");
        Some(Diagnostic::error(message).hint(format!("by `{before}` and by `{text}`: leave one")))
    });
    again.collect()
}
