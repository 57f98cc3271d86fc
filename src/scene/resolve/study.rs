//! The `[study]` section: variables with their bounds, and the objective.

use super::super::file::SceneFile;
use super::super::formula::compile::constant_node;
use super::super::studies::{StudyFile, VariableFile};
use super::names::{Meaning, Names};
use super::parsing::parsed_expression;
use super::range::limits_in_order;
use crate::diag::{Diagnostic, Diagnostics, shown_number};
use crate::model::measure::Measure;
use crate::model::mechanism::{AngleUnit, Kind};
use crate::model::study::{RANGE_ROUNDING, Study, Variable};
use crate::numbers::constant::Constant;
use crate::scene::overrides::Overrides;
use crate::scene::reader::Spanned;
use crate::scene::values::FormulaText;

/// Half the default range of a variable, as a fraction of its value.
const DEFAULT_RANGE: f64 = 0.2;

/// Resolves the study; its variables are the parameters named in `varied`, otherwise those of the file, and its
/// objective is `minimised` or that of the file.
pub fn resolve_study(
    file: &SceneFile,
    (names, unit): (&Names, &AngleUnit),
    measures: &[Measure],
    overrides: &Overrides,
    diagnostics: &mut Diagnostics,
) -> Option<Study> {
    let (empty, varied) = (StudyFile::default(), overrides.vary.as_slice());
    let study = match &file.study {
        Some(study) => study,
        None if varied.is_empty() => return None,
        None => &empty,
    };
    let mut resolver = Resolver {
        names,
        unit,
        outside_ranges: overrides.outside_ranges,
        diagnostics,
    };
    // Options of the command line take precedence over the file.
    let variables = resolver.study_variables(study, varied);
    let objective = match overrides.minimise.as_deref() {
        Some(name) => resolver.other_objective(name, measures),
        None => resolver.objective(study, file, measures),
    };
    let printed = resolver.printed(study, file, measures);
    let limits = resolver.limits(study, file, measures);
    Some(Study {
        variables,
        objective,
        limits,
        printed,
        note: study.note.clone(),
    })
}

struct Resolver<'a, 'd> {
    names: &'a Names,
    unit: &'a AngleUnit,
    outside_ranges: bool,
    diagnostics: &'d mut Diagnostics,
}

impl Resolver<'_, '_> {
    fn objective(
        &mut self,
        study: &StudyFile,
        file: &SceneFile,
        measures: &[Measure],
    ) -> Option<usize> {
        self.measure(study.minimise.as_ref()?, file, measures)
    }

    fn other_objective(&mut self, name: &str, measures: &[Measure]) -> Option<usize> {
        let found = measures.iter().position(|m| m.name == name);
        if found.is_none() {
            let known = measures.iter().map(|m| m.name.as_str());
            let message = format!("--minimise: there is no measure `{name}`");
            self.diagnostics
                .push(Diagnostic::error(message).suggest(name, known));
        }
        found
    }

    fn limits(
        &mut self,
        study: &StudyFile,
        file: &SceneFile,
        measures: &[Measure],
    ) -> Vec<(usize, [Option<f64>; 2])> {
        let mut list = Vec::new();
        for (name, ends) in &study.limits {
            let Some(index) = self.measure(name, file, measures) else {
                continue;
            };
            let kind = measures[index].kind;
            let mut value = |text: &Option<FormulaText>| self.value(text.as_ref()?, kind);
            let own = [value(&ends[0]), value(&ends[1])];
            // What stands here takes the place of the measure's own limit, and the other end remains.
            let all = [
                own[0].or(measures[index].min),
                own[1].or(measures[index].max),
            ];
            let order = limits_in_order(&name.value, all, ends);
            if self.diagnostics.taken(order).is_some() {
                list.push((index, own));
            }
        }
        list
    }

    fn printed(
        &mut self,
        study: &StudyFile,
        file: &SceneFile,
        measures: &[Measure],
    ) -> Vec<(usize, f64)> {
        let mut list = Vec::new();
        for (name, text) in &study.printed {
            if let Some(index) = self.measure(name, file, measures)
                && let Some(value) = self.value(text, measures[index].kind)
            {
                list.push((index, value));
            }
        }
        list
    }

    fn measure(
        &mut self,
        wanted: &Spanned<String>,
        file: &SceneFile,
        measures: &[Measure],
    ) -> Option<usize> {
        let found = measures.iter().position(|m| m.name == wanted.value);
        let declared = file.measures.iter().any(|m| m.name.value == wanted.value);
        if found.is_none() && !declared {
            let known = measures.iter().map(|m| m.name.as_str());
            let message = format!("there is no measure `{}`", wanted.value);
            self.diagnostics.push(
                Diagnostic::error(message)
                    .at(wanted.span.clone())
                    .suggest(&wanted.value, known)
                    .hint("`[measures]` gives names to numbers of the whole motion"),
            );
        }
        found
    }

    fn study_variables(&mut self, study: &StudyFile, varied: &[String]) -> Vec<Variable> {
        let listed = || study.variables.iter().map(|(name, _)| name.value.clone());
        let wanted: Vec<String> = if varied.is_empty() {
            listed().collect()
        } else {
            varied.to_vec()
        };
        let mut variables = Vec::new();
        for name in &wanted {
            let typed = study.variables.iter().find(|(n, _)| n.value == *name);
            let index = match self.names.meaning(name) {
                Some(Meaning::Parameter(index)) => index,
                _ => {
                    // Unknown names from the command line are reported where they are turned into inputs.
                    if let Some((name, _)) = typed {
                        self.no_parameter(name);
                    }
                    continue;
                }
            };
            let parameter = &self.names.parameters[index];
            let kind = parameter.kind.unwrap_or(Kind::Number);
            let blank = VariableFile::default();
            let file = typed.map_or(&blank, |(_, file)| file);
            let is_told = parameter.is_placed || kind != Kind::Angle;
            let value = parameter.value.number();
            if let Some(mut variable) = self.variable(name, kind, value, file) {
                if !is_told && self.unit.radians != Constant::exact(1.0) {
                    variable.suffix = "deg";
                }
                variables.push(variable);
            }
        }
        variables
    }

    fn no_parameter(&mut self, name: &Spanned<String>) {
        let known = self.names.parameters.iter().map(|p| p.name.as_str());
        let message = format!("a study varies parameters, and `{}` is not one", name.value);
        let diagnostic = Diagnostic::error(message).at(name.span.clone());
        self.diagnostics
            .push(diagnostic.suggest(&name.value, known));
    }

    fn variable(
        &mut self,
        name: &str,
        kind: Kind,
        start: f64,
        file: &VariableFile,
    ) -> Option<Variable> {
        // Without a range: a share of the start to either side, or everything where that would be nothing.
        let (lower, upper) = match &file.range {
            Some(range) => self.range(name, kind, start, range)?,
            None if start == 0.0 => (f64::NEG_INFINITY, f64::INFINITY),
            None => {
                let half = DEFAULT_RANGE * start.abs();
                (start - half, start + half)
            }
        };
        // Half the width of its tolerance, if one is stated.
        let tolerance = match &file.tolerance {
            None => None,
            Some(text) => {
                let value = self.value(text, kind)?;
                if value < 0.0 {
                    let message = format!(
                        "a tolerance must not be negative, found {}",
                        shown_number(value)
                    );
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
            suffix: "",
            tolerance,
        })
    }

    fn range(
        &mut self,
        name: &str,
        kind: Kind,
        start: f64,
        [low, high]: &[FormulaText; 2],
    ) -> Option<(f64, f64)> {
        let (lower, upper) = (self.value(low, kind)?, self.value(high, kind)?);
        let place = low.span.start..high.span.end;
        if lower >= upper {
            let message = format!("the range of `{name}` must ascend");
            self.diagnostics.push(Diagnostic::error(message).at(place));
            return None;
        }
        let rounding = RANGE_ROUNDING * lower.abs().max(upper.abs());
        let is_inside = lower - rounding <= start && start <= upper + rounding;
        if !self.outside_ranges && !is_inside {
            let message = format!("`{name}` starts outside its range");
            let hint = "the range must contain the parameter's own value";
            self.diagnostics
                .push(Diagnostic::error(message).at(place).hint(hint));
            return None;
        }
        Some((lower, upper))
    }

    /// A constant of the given kind.
    fn value(&mut self, text: &FormulaText, kind: Kind) -> Option<f64> {
        let node = parsed_expression(text, self.diagnostics)?;
        let names = self.names;
        let node = names.in_radians(node, Some(kind));
        let value = constant_node(&node, &|n, s| names.constant(n, s));
        self.diagnostics.taken(value)
    }
}
