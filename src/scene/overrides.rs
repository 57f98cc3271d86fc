//! What the command line and studies put in place of the file's values.

use super::file::{InputFile, SceneFile};
use super::plots::PlotFile;
use super::reader::Spanned;
use super::values::FormulaText;
use crate::diag::{Diagnostic, Diagnostics};
use crate::model::actuation::Actuation;
use crate::model::drive::Drive;
use std::path::PathBuf;

/// Values given on the command line instead of the file's.
#[derive(Clone, Debug, Default)]
pub struct Overrides {
    /// `--param NAME=FORMULA`
    pub parameters: Vec<(String, String)>,
    /// `--input NAME=FORMULA`
    pub inputs: Vec<(String, String)>,
    /// `--guess NAME=FORMULA`
    pub guess: Vec<(String, String)>,
    /// `plot --y …`: drawn in place of the scene's own plots.
    pub plot: Option<PlotText>,
    /// Folder that relative file names in the scene start from.
    pub folder: PathBuf,
    /// Other folders that they may stand in.
    pub allowed_folders: Vec<PathBuf>,
    /// Parameters that are to be inputs, behind the scene's own: what a study varies.
    pub vary: Vec<String>,
    /// `--minimise`: the measure that a study makes small, in place of the file's.
    pub minimise: Option<String>,
    /// Characteristic length in place of the mechanism's own: what a study compares with its scene keeps the scene's.
    pub size: Option<f64>,
    /// `--input-table`: other drives of the scene's own inputs.
    pub drives: Option<OtherDrives>,
    /// Whether the chains are kept as they are written, for drawings.
    pub notation: bool,
    /// Whether a study derives the measures by what is varied.
    pub derives_measures: bool,
    /// Whether solids follow what is varied, for enclosures of clearances.
    pub carries_shapes: bool,
}

/// Drives in place of those of the file.
#[derive(Clone, Debug)]
pub struct OtherDrives {
    /// One for each of the scene's own inputs.
    pub drives: Vec<Drive>,
    /// Length of the motion in seconds.
    pub duration: f64,
}

impl OtherDrives {
    /// Puts them in place of a scene's own.
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

/// Puts the command line's values in place of the file's.
pub fn apply_overrides(overrides: &Overrides, file: &mut SceneFile, diagnostics: &mut Diagnostics) {
    let mut unknown = |what: &str, name: &str, known: Vec<&str>| {
        diagnostics.push(
            Diagnostic::error(format!("the scene has no {what} `{name}`"))
                .suggest(name, known.iter().copied())
                .hint(if known.is_empty() {
                    format!("it has no {what} at all")
                } else {
                    format!("it has: {}", known.join(", "))
                }),
        );
    };
    for (name, text) in &overrides.parameters {
        let mut formulas = file.parameters.iter_mut().chain(&mut file.chains);
        match formulas.find(|(n, _)| n.value == *name) {
            Some((_, formula)) => *formula = FormulaText::outside(text),
            None => {
                let known = file.parameters.iter().chain(&file.chains);
                let known = known.map(|(n, _)| n.value.as_str()).collect();
                unknown("parameter or chain", name, known);
            }
        }
    }
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
