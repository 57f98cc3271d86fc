//! The `[study]` section: variables with their bounds, tracks, and limits. Formulas of measures are in `measures`.

use super::super::file::SceneFile;
use super::super::formula::compile::constant;
use super::super::formula::kinds::to_radians;
use super::super::reader::{FormulaText, Spanned};
use super::super::studies::{LimitFile, StudyFile, TrackFile, VariableFile};
use super::measures::{MeasureBuilder, Scope};
use super::names::{Meaning, Names};
use super::parsed::expression;
use crate::diag::{Diagnostic, Diagnostics, Span, shown};
use crate::model::drive::Drive;
use crate::model::mechanism::{AngleUnit, Kind, Output, Trace};
use crate::model::study::{Limit, Study, Track, Variable};

/// Half the default range of a variable, as a share of its value.
const DEFAULT_RANGE: f64 = 0.2;

/// Most poses of one track: a turn in steps of a hundredth of a degree, and more.
const MAX_SAMPLES: f64 = 100_000.0;

/// What a study refers to.
pub struct Surroundings<'a> {
    pub names: &'a Names,
    pub traces: &'a [Trace],
    pub outputs: &'a [Output],
    pub drives: &'a [Drive],
    pub unit: &'a AngleUnit,
}

/// Resolves the study; the parameters called `varied` are its variables, else those the file names.
pub fn resolve(
    file: &SceneFile,
    around: &Surroundings,
    varied: &[String],
    diagnostics: &mut Diagnostics,
) -> Option<Study> {
    let empty = StudyFile::default();
    let study = match &file.study {
        Some(study) => study,
        None if varied.is_empty() => return None,
        None => &empty,
    };
    let mut resolver = Resolver {
        around,
        diagnostics,
    };
    let variables = resolver.variables(study, varied);
    let inputs = &file.inputs;
    let tracks: Vec<Track> = study
        .tracks
        .iter()
        .filter_map(|(name, track)| resolver.track(name, track, inputs.len()))
        .collect();
    if tracks.len() < study.tracks.len() {
        return None;
    }
    let scope = Scope {
        around,
        tracks: &tracks,
        variables: &variables,
    };
    let mut builder = MeasureBuilder::new(scope);
    for (name, text) in &study.measures {
        builder.measure(name, text, diagnostics);
    }
    let objective = study
        .minimise
        .as_ref()
        .and_then(|text| builder.unnamed("objective", text, diagnostics));
    let constraints = limits(&study.constraints, &mut builder, around, diagnostics);
    let requirements = limits(&study.requirements, &mut builder, around, diagnostics);
    let (rates, reductions, measures) = builder.finish(diagnostics)?;
    Some(Study {
        variables,
        tracks,
        rates,
        reductions,
        measures,
        objective,
        constraints,
        requirements,
    })
}

struct Resolver<'a, 'd> {
    around: &'a Surroundings<'a>,
    diagnostics: &'d mut Diagnostics,
}

impl Resolver<'_, '_> {
    fn variables(&mut self, study: &StudyFile, varied: &[String]) -> Vec<Variable> {
        let listed = || study.variables.iter().map(|(name, _)| name.value.clone());
        let names: Vec<String> = if varied.is_empty() {
            listed().collect()
        } else {
            varied.to_vec()
        };
        let mut variables = Vec::new();
        for name in &names {
            let typed = study.variables.iter().find(|(n, _)| n.value == *name);
            let index = match self.around.names.meaning(name) {
                Some(Meaning::Parameter(index)) => index,
                _ => {
                    self.no_parameter(name, typed.map(|(n, _)| n.span.clone()));
                    continue;
                }
            };
            let parameter = &self.around.names.parameters[index];
            let kind = parameter.kind.unwrap_or(Kind::Number);
            let blank = VariableFile::default();
            let file = typed.map_or(&blank, |(_, file)| file);
            if let Some(variable) = self.variable(name, kind, parameter.value, file) {
                variables.push(variable);
            }
        }
        variables
    }

    fn no_parameter(&mut self, name: &str, span: Option<Span>) {
        let known = self.around.names.parameters.iter().map(|p| p.name.as_str());
        let message = format!("a study varies parameters, and `{name}` is none");
        let diagnostic = Diagnostic::error(message).suggest(name, known);
        self.diagnostics.push(match span {
            Some(span) => diagnostic.at(span),
            None => diagnostic,
        });
    }

    fn variable(
        &mut self,
        name: &str,
        kind: Kind,
        start: f64,
        file: &VariableFile,
    ) -> Option<Variable> {
        let (lower, upper) = match &file.range {
            Some([low, high]) => {
                let (lower, upper) = (self.value(low, kind)?, self.value(high, kind)?);
                let place = low.span.start..high.span.end;
                if lower >= upper {
                    let message = format!("the range of `{name}` must ascend");
                    self.diagnostics.push(Diagnostic::error(message).at(place));
                    return None;
                }
                if !(lower..=upper).contains(&start) {
                    let message = format!("`{name}` starts outside its range");
                    let hint = "the range must hold the parameter's own value";
                    self.diagnostics
                        .push(Diagnostic::error(message).at(place).hint(hint));
                    return None;
                }
                (lower, upper)
            }
            None if start == 0.0 => (f64::NEG_INFINITY, f64::INFINITY),
            None => {
                let half = DEFAULT_RANGE * start.abs();
                (start - half, start + half)
            }
        };
        let tolerance = match &file.tolerance {
            None => None,
            Some(text) => {
                let value = self.value(text, kind)?;
                if value < 0.0 {
                    let message = format!("a tolerance is not negative, found {}", shown(value));
                    let place = text.span.clone();
                    self.diagnostics.push(Diagnostic::error(message).at(place));
                    return None;
                }
                Some(value)
            }
        };
        Some(Variable {
            name: name.to_owned(),
            kind,
            start,
            lower,
            upper,
            tolerance,
        })
    }

    /// A constant of the given kind.
    fn value(&mut self, text: &FormulaText, kind: Kind) -> Option<f64> {
        let node = expression(text, self.diagnostics)?;
        let names = self.around.names;
        let radians = self.around.unit.radians;
        let node = to_radians(node, Some(kind), radians, &|n| names.is_angle(n));
        match constant(&node, &|n, s| names.constant(n, s)) {
            Ok(value) => Some(value),
            Err(diagnostic) => {
                self.diagnostics.push(diagnostic);
                None
            }
        }
    }

    fn track(&mut self, name: &Spanned<String>, file: &TrackFile, own: usize) -> Option<Track> {
        let samples = match &file.samples {
            Some(text) => {
                let value = self.value(text, Kind::Number)?;
                if value.fract() != 0.0 || !(1.0..=MAX_SAMPLES).contains(&value) {
                    let message = format!("samples must be a whole number from 1 to {MAX_SAMPLES}");
                    let place = text.span.clone();
                    self.diagnostics.push(Diagnostic::error(message).at(place));
                    return None;
                }
                value as usize
            }
            None => {
                let message = format!("track `{}` needs `samples`", name.value);
                let place = name.span.clone();
                self.diagnostics.push(Diagnostic::error(message).at(place));
                return None;
            }
        };
        let share = |k: usize| k as f64 / (samples.max(2) - 1) as f64;
        let drives = &self.around.drives[..own];
        if let Some([start, end]) = &file.time {
            let [start, end] = [
                self.value(start, Kind::Number)?,
                self.value(end, Kind::Number)?,
            ];
            let at = |k| start + (end - start) * share(k);
            let row = |k: usize| drives.iter().map(|d| d.value(at(k))).collect();
            return Some(Track {
                name: name.value.clone(),
                inputs: (0..samples).map(row).collect(),
            });
        }
        let mut from: Vec<f64> = drives.iter().map(|d| d.value(0.0)).collect();
        self.set_inputs(&file.from, own, &mut from)?;
        let mut to = from.clone();
        self.set_inputs(&file.to, own, &mut to)?;
        let between = |k: usize| {
            let ends = from.iter().zip(&to);
            ends.map(|(a, b)| a + (b - a) * share(k)).collect()
        };
        Some(Track {
            name: name.value.clone(),
            inputs: (0..samples).map(between).collect(),
        })
    }

    fn set_inputs(
        &mut self,
        list: &[(Spanned<String>, FormulaText)],
        own: usize,
        values: &mut [f64],
    ) -> Option<()> {
        for (name, text) in list {
            let inputs = &self.around.names.inputs[..own];
            let Some(index) = inputs.iter().position(|i| i.name == name.value) else {
                let known = inputs.iter().map(|i| i.name.as_str());
                let message = format!("`{}` is no input of the scene", name.value);
                let diagnostic = Diagnostic::error(message).at(name.span.clone());
                self.diagnostics
                    .push(diagnostic.suggest(&name.value, known));
                return None;
            };
            values[index] = self.value(text, inputs[index].kind)?;
        }
        Some(())
    }
}

fn limits(
    list: &[(Spanned<String>, LimitFile)],
    builder: &mut MeasureBuilder,
    around: &Surroundings,
    diagnostics: &mut Diagnostics,
) -> Vec<Limit> {
    let mut limits = Vec::new();
    for (name, file) in list {
        let Some(text) = &file.value else { continue };
        let Some(measure) = builder.unnamed(&name.value, text, diagnostics) else {
            continue;
        };
        let kind = builder.kind(measure);
        let mut resolver = Resolver {
            around,
            diagnostics,
        };
        let mut bound = |text: &Option<FormulaText>| match text {
            None => Some(None),
            Some(text) => resolver.value(text, kind).map(Some),
        };
        let (Some(at_most), Some(at_least)) = (bound(&file.at_most), bound(&file.at_least)) else {
            continue;
        };
        if let (Some(high), Some(low), Some(text)) = (at_most, at_least, &file.at_most)
            && low > high
        {
            let message = format!("`{}` can never hold: at_least is above at_most", name.value);
            diagnostics.push(Diagnostic::error(message).at(text.span.clone()));
            continue;
        }
        limits.push(Limit {
            name: name.value.clone(),
            measure,
            at_most,
            at_least,
        });
    }
    limits
}
