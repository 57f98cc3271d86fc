//! Dimensions with tolerances: which, how large, and the family of all pieces within them.

use super::plan::MOST_DIMENSIONS;
use crate::analysis::study::{DefaultVariables, FamilyError, ParametricMechanism, varied_names};
use crate::diag::Source;
use crate::model::mechanism::{Kind, Mechanism};
use crate::scene::{Overrides, Scene};

/// The requested tolerances.
#[derive(Clone, Copy, Debug)]
pub struct PieceTolerances<'a> {
    /// Names in place of the scene's own choice.
    pub vary: &'a [String],
    /// Tolerances by name, in the dimension's unit; they replace the scene's.
    pub own: &'a [(String, f64)],
    /// The tolerance of every dimension that has none of its own, in its unit.
    pub tolerance: Option<f64>,
    /// The same, where nobody asked for one and only ratios count.
    pub otherwise: Option<f64>,
    /// Whether bands between samples are requested, too.
    pub between: bool,
}

impl PieceTolerances<'_> {
    /// The family of all pieces, and the tolerances by name in internal units. `drawn` is the scene as written.
    ///
    /// # Errors
    /// Nothing has a tolerance; a dimension has none; the general one has no effect; there are too many; a dimension appears where
    /// tolerances cannot be followed; errors in the scene.
    pub fn family(
        &self,
        source: &Source,
        overrides: &Overrides,
        drawn: &Scene,
    ) -> Result<(ParametricMechanism, Vec<(String, f64)>), FamilyError> {
        let names = self.names(drawn)?;
        let mut parameters = names.clone();
        parameters.retain(|name| !is_input(&drawn.mechanism, name));
        // A name that the scene does not have is refused here, before it lacks a tolerance.
        let mut family = ParametricMechanism::varying(source, overrides, &parameters)?;
        let tolerances = self.tolerances(drawn, names)?;
        // Drives and tracks keep the file's dimensions, and measures may contain computed ones: results would be wrong
        // for other pieces.
        match family.kept.pop() {
            Some(kept) => Err(FamilyError::Kept(kept)),
            None => Ok((family, tolerances)),
        }
    }

    /// Names of the dimensions with a tolerance.
    fn names(&self, drawn: &Scene) -> Result<Vec<String>, FamilyError> {
        let variables = drawn.study.iter().flat_map(|s| &s.variables);
        let has_tolerances = variables.clone().any(|v| v.tolerance.is_some());
        // With tolerances of their own, no others vary by default than those of the scene.
        let listed = match self.vary.is_empty() && !self.own.is_empty() && !has_tolerances {
            true => Vec::new(),
            false => varied_names(self.vary, DefaultVariables::WithTolerance, drawn)?,
        };
        let mut all: Vec<String> = self.own.iter().map(|(name, _)| name.clone()).collect();
        let more = listed.into_iter();
        all.extend(more.filter(|name| !self.own.iter().any(|(n, _)| n == name)));
        if all.is_empty() {
            return Err(FamilyError::nothing_to_vary(&drawn.dimensions));
        }
        // Between samples the inputs are dimensions as well.
        let inputs = if self.between {
            drawn.mechanism.inputs.len()
        } else {
            0
        };
        if all.len() + inputs > MOST_DIMENSIONS {
            let message = format!(
                "at most {MOST_DIMENSIONS} dimensions are enclosed together, found {}: name fewer parameters to vary",
                all.len() + inputs
            );
            return Err(FamilyError::Lacks(message));
        }
        Ok(all)
    }

    /// Tolerances by name, in internal units.
    fn tolerances(
        &self,
        drawn: &Scene,
        names: Vec<String>,
    ) -> Result<Vec<(String, f64)>, FamilyError> {
        let own = names.iter().map(|name| {
            let own = Self {
                tolerance: None,
                otherwise: None,
                ..*self
            }
            .tolerance_of(drawn, name);
            (name.as_str(), own.is_some())
        });
        FamilyError::refuse_unused(self.tolerance, own)?;
        let (mut missing, mut list) = (Vec::new(), Vec::new());
        for name in names {
            match self.tolerance_of(drawn, &name) {
                Some(tolerance) => list.push((name, tolerance)),
                None => missing.push(name),
            }
        }
        match missing.is_empty() {
            true => Ok(list),
            false => Err(FamilyError::NoTolerance(missing.join(", "))),
        }
    }

    fn tolerance_of(&self, drawn: &Scene, name: &str) -> Option<f64> {
        let unit = drawn.mechanism.unit_of(kind_of(drawn, name)).number();
        let mut study = drawn.study.iter().flat_map(|s| &s.variables);
        let own = self.own.iter().find(|(n, _)| n == name);
        let of_study = || study.find(|v| v.name == name)?.tolerance;
        let general = || Some(self.tolerance? * unit);
        own.map(|(_, t)| t * unit)
            .or_else(of_study)
            .or_else(general)
            .or_else(|| Some(self.otherwise? * unit))
    }
}

fn is_input(mechanism: &Mechanism, name: &str) -> bool {
    mechanism.inputs.iter().any(|input| input.name == name)
}

/// The kind of a parameter or input.
fn kind_of(drawn: &Scene, name: &str) -> Kind {
    let inputs = drawn.mechanism.inputs.iter();
    let input = inputs.filter(|i| i.name == name).map(|i| i.kind).next();
    let study = drawn.study.iter().flat_map(|s| &s.variables);
    let variable = study.filter(|v| v.name == name).map(|v| v.kind).next();
    let parameter = drawn.kinds.iter().find(|(n, _)| n == name).map(|(_, k)| *k);
    input.or(variable).or(parameter).unwrap_or(Kind::Number)
}
