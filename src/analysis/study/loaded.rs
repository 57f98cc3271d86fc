//! A study as requested: the text of a scene, the changes to it, and the mechanism with its variables as inputs.

use super::family::{Nominal, ParametricMechanism};
use super::family_error::FamilyError;
use super::gradient::{Gradients, chain_rule};
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::diag::Source;
use crate::model::measure::MeasureSource;
use crate::scene::{Overrides, Scene, load_scene};

/// A scene that is studied.
#[derive(Clone, Debug)]
pub struct LoadedStudy {
    /// Its text.
    pub source: Source,
    /// The changes to it.
    pub overrides: Overrides,
    /// With its variables as inputs.
    pub family: ParametricMechanism,
}

/// A study at the file's own values.
pub struct NominalStudy {
    /// The poses and what is proved of them.
    pub drawn: Nominal,
    /// The same poses, as the start for nearby pieces.
    pub poses: TrackPoses,
    /// Measures and their derivatives.
    pub gradients: Gradients,
    /// For every measure whether its derivatives are those of one side only: at a kink of a formula, or where poses share an extreme.
    pub one_sided: Vec<bool>,
    /// For every measure whether it is of the whole motion, and not only of the poses.
    pub is_whole: Vec<bool>,
}

impl NominalStudy {
    /// Names of the measures whose derivatives are those of one side only.
    pub fn one_sided_names<'f>(&self, family: &'f ParametricMechanism) -> Vec<&'f str> {
        let list = family.measures.list.iter().zip(&self.one_sided);
        let marked = list.filter(|(_, is_one_sided)| **is_one_sided);
        marked.map(|(measure, _)| measure.name.as_str()).collect()
    }

    /// Names of the measures that lack a derivative.
    pub fn names_without_derivatives<'f>(&self, family: &'f ParametricMechanism) -> Vec<&'f str> {
        let list = family.measures.list.iter().enumerate();
        let marked = list.filter(|(index, _)| !self.gradients.has_derivatives(*index));
        marked.map(|(_, measure)| measure.name.as_str()).collect()
    }

    /// Names of the measures of which only poses are known.
    pub fn names_of_poses<'f>(&self, family: &'f ParametricMechanism) -> Vec<&'f str> {
        let list = family.measures.list.iter().zip(&self.is_whole);
        let marked = list.filter(|(_, is_whole)| !**is_whole);
        marked.map(|(measure, _)| measure.name.as_str()).collect()
    }

    /// Takes the values and derivatives of some measures from a study with more poses, and those of formulas from what they are of.
    fn take_measures(&mut self, family: &ParametricMechanism, other: Self, is_taken: &[bool]) {
        // Inputs and measures, and their derivatives by the variables, which are the last inputs.
        let mut numbers = family.actuation.inputs_at(0.0);
        let first = numbers.len();
        let mut changes = family.input_rows();
        let Gradients { measures, rows } = other.gradients;
        let found = measures.into_iter().zip(rows).zip(other.one_sided);
        for (index, ((value, row), one_sided)) in found.enumerate() {
            let own = &mut self.gradients;
            match &family.measures.list[index].source {
                MeasureSource::Formula(formula) => {
                    own.measures[index] = formula.value(&numbers);
                    own.rows[index].fill(0.0);
                    chain_rule(formula, &numbers, &changes, &mut own.rows[index]);
                    let measures = formula.slots().into_iter();
                    let mut measures = measures.filter_map(|slot| slot.checked_sub(first));
                    self.one_sided[index] |= one_sided || measures.any(|k| self.one_sided[k]);
                }
                MeasureSource::Over { .. } if is_taken[index] => {
                    own.measures[index] = value;
                    own.rows[index] = row;
                    self.one_sided[index] = one_sided;
                }
                MeasureSource::Over { .. } => {}
            }
            numbers.push(self.gradients.measures[index]);
            changes.push(self.gradients.rows[index].clone());
        }
    }
}

/// Stands for every dimension.
const ALL: &str = "all";

/// What a study varies if no names are given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DefaultVariables {
    /// The variables of the scene's `[study]`: no names.
    OfStudy,
    /// Those of them with a tolerance; all dimensions if there are none.
    WithTolerance,
    /// All dimensions.
    All,
}

/// Names of the parameters to vary, from those given; `all` stands for every dimension of the scene.
///
/// # Errors
/// A name is given twice.
pub fn varied_names(
    vary: &[String],
    default: DefaultVariables,
    scene: &Scene,
) -> Result<Vec<String>, FamilyError> {
    let dimensions = &scene.dimensions;
    if vary.is_empty() {
        let variables = scene.study.iter().flat_map(|study| &study.variables);
        let with_tolerance = variables.filter(|v| v.tolerance.is_some());
        let names: Vec<String> = match default {
            DefaultVariables::WithTolerance => with_tolerance.map(|v| v.name.clone()).collect(),
            DefaultVariables::OfStudy | DefaultVariables::All => Vec::new(),
        };
        return Ok(match default {
            DefaultVariables::OfStudy => names,
            _ if names.is_empty() => dimensions.to_vec(),
            _ => names,
        });
    }
    let all = vary.iter().any(|v| v == ALL);
    let mut names = if all { dimensions.to_vec() } else { Vec::new() };
    // Names given together with `all` may be among them.
    let named = vary.iter().filter(|name| *name != ALL);
    let more: Vec<_> = named.filter(|n| !(all && names.contains(n))).collect();
    names.extend(more.into_iter().cloned());
    for (k, name) in names.iter().enumerate() {
        if names[..k].contains(name) {
            let message = format!("`{name}` is varied twice");
            return Err(FamilyError::Lacks(message));
        }
    }
    Ok(names)
}

/// A family at the file's own values; measures may lack derivatives.
fn nominal_of(family: &ParametricMechanism) -> Result<NominalStudy, FamilyError> {
    let mut evaluator = Evaluator::new(family);
    let drawn = family.nominal()?;
    let poses = evaluator.nominal(drawn.poses.clone());
    let poses = poses.passing_singular(drawn.singular.map(|passage| passage.behind));
    let gradients = evaluator.gradients_with_gaps(&poses);
    let names = family.measures.list.iter().map(|m| &m.name);
    let gradients = gradients.and_then(|found| {
        let mut values = names.zip(&found.measures);
        match values.find(|(_, value)| !value.is_finite()) {
            Some((name, _)) => Err(Rejection::NoValue(name.clone())),
            None => Ok(found),
        }
    });
    let gradients = gradients.map_err(|rejection| evaluator.refused_start(&poses, &rejection))?;
    let one_sided = evaluator.one_sided(&poses, &gradients);
    let one_sided = one_sided.map_err(|rejection| evaluator.refused_start(&poses, &rejection))?;
    Ok(NominalStudy {
        is_whole: vec![false; gradients.measures.len()],
        drawn,
        poses,
        gradients,
        one_sided,
    })
}

impl LoadedStudy {
    /// Reads the scene with the parameters called `names` as variables, or with those of its `[study]`.
    ///
    /// # Errors
    /// Mistakes in the scene; nothing to vary or to measure; a mechanism that is not determined.
    pub fn new(
        source: Source,
        overrides: Overrides,
        names: &[String],
    ) -> Result<Self, FamilyError> {
        let family = ParametricMechanism::load(&source, &overrides, names)?;
        Ok(Self {
            source,
            overrides,
            family,
        })
    }

    /// Poses, measures and derivatives with the file's values, extremes along the drive between the poses among them. Derivatives that
    /// do not exist are NaN.
    ///
    /// # Errors
    /// A pose that does not exist, or a measure without a value.
    pub fn nominal(&self) -> Result<NominalStudy, FamilyError> {
        let mut found = self.nominal_of_pieces()?;
        let refined = self.family.refined_extremes(&found.drawn);
        if !refined.times.is_empty() {
            let family = self.family.clone().at_more_times(refined.times);
            found.take_measures(&family, nominal_of(&family)?, &refined.is_whole);
        }
        found.is_whole = refined.is_whole;
        Ok(found)
    }

    /// The measure by whose derivatives dimensions are ranked: the one called `name`, else the objective or, where that has none, the
    /// first measure that has derivatives.
    ///
    /// # Errors
    /// There is no measure of this name, or it has no derivatives; no measure has any.
    pub fn ranking(
        &self,
        nominal: &NominalStudy,
        name: Option<&str>,
    ) -> Result<usize, FamilyError> {
        let list = &self.family.measures.list;
        let named = name.map(|name| self.measure(name)).transpose()?;
        let preferred = named.or(self.family.study.objective).unwrap_or(0);
        let others = (0..list.len()).filter(|_| named.is_none());
        let mut candidates = std::iter::once(preferred).chain(others);
        let found = candidates.find(|index| nominal.gradients.has_derivatives(*index));
        found.ok_or_else(|| {
            let rejection = Rejection::NoDerivative(list[preferred].name.clone());
            Evaluator::new(&self.family).refused_start(&nominal.poses, &rejection)
        })
    }

    /// The same for pieces, without extremes between the poses.
    ///
    /// # Errors
    /// A pose that does not exist, or a measure without a value.
    pub fn nominal_of_pieces(&self) -> Result<NominalStudy, FamilyError> {
        nominal_of(&self.family)
    }

    /// Index of the measure of that name.
    ///
    /// # Errors
    /// There is none.
    pub fn measure(&self, name: &str) -> Result<usize, FamilyError> {
        let names = self.family.measures.list.iter().map(|m| &m.name);
        let found = names.clone().position(|known| known == name);
        found.ok_or_else(|| FamilyError::Unknown {
            what: "measure",
            name: name.to_owned(),
            known: names.cloned().collect(),
        })
    }

    /// Factor from internal values of the objective to the file's unit.
    pub fn objective_unit(&self) -> f64 {
        let objective = self.family.objective();
        objective.map_or(1.0, |m| self.family.units(m.kind))
    }

    /// Name of the objective.
    pub fn objective_name(&self) -> &str {
        let objective = self.family.objective();
        objective.map_or("objective", |m| &m.name)
    }

    /// Tolerance of every variable, in internal units: the study's, else `general`, in the file's units.
    ///
    /// # Errors
    /// A variable that has neither; a general tolerance without effect.
    pub fn tolerances(&self, general: Option<f64>) -> Result<Vec<f64>, FamilyError> {
        let variables = &self.family.study.variables;
        let own = variables
            .iter()
            .map(|v| (v.name.as_str(), v.tolerance.is_some()));
        FamilyError::refuse_unused(general, own)?;
        let given = variables.iter().map(|v| {
            v.tolerance
                .or(general.map(|t| t / self.family.units(v.kind)))
        });
        let missing = given.clone().zip(variables).filter(|(t, _)| t.is_none());
        let missing: Vec<&str> = missing.map(|(_, v)| v.name.as_str()).collect();
        match missing.is_empty() {
            true => Ok(given.flatten().collect()),
            false => Err(FamilyError::NoTolerance(missing.join(", "))),
        }
    }

    /// Values of the variables as formulas of the file, after the replacements made before.
    pub fn parameters(&self, values: &[f64]) -> Vec<(String, String)> {
        let mut list = self.overrides.parameters.clone();
        for (variable, value) in self.family.study.variables.iter().zip(values) {
            list.retain(|(name, _)| *name != variable.name);
            let text = self.family.variable_text(variable, *value);
            list.push((variable.name.clone(), text));
        }
        list
    }

    /// The scene with other values of the variables.
    ///
    /// # Errors
    /// Values that the scene does not allow.
    pub fn scene_at(&self, values: &[f64]) -> Result<Scene, FamilyError> {
        let overrides = Overrides {
            parameters: self.parameters(values),
            ..self.overrides.clone()
        };
        Ok(load_scene(&self.source, &overrides).map_err(Box::new)?)
    }
}
