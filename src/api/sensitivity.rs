//! Derivatives of measures with respect to dimensions.

use super::error::Error;
use crate::analysis::study::{LoadedStudy, NominalStudy};
use crate::report::sensitivity::SensitivityTable;

/// The exact derivatives of all measures of a study with respect to all variables. Returned by
/// [`Study::sensitivity`](crate::Study::sensitivity).
pub struct Sensitivity {
    study: LoadedStudy,
    nominal: NominalStudy,
    rank: usize,
}

impl Sensitivity {
    pub(super) fn of(study: LoadedStudy) -> Result<Self, Error> {
        let nominal = study.nominal()?;
        let rank = study.ranking(&nominal, None)?;
        Ok(Self {
            study,
            nominal,
            rank,
        })
    }

    /// The variables, sorted by decreasing derivative of the objective, or of the first measure with derivatives if it has none or
    /// there is no objective.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4", "L5d"]);
    /// assert_eq!(study.sensitivity()?.variables().len(), 2);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn variables(&self) -> Vec<&str> {
        let variables = &self.study.family.study.variables;
        let order = self.table().order;
        order.iter().map(|k| variables[*k].name.as_str()).collect()
    }

    /// The measures with their values, in the scene's units.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// assert!(study.sensitivity()?.measures().iter().all(|(_, value)| value.is_finite()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn measures(&self) -> Vec<(&str, f64)> {
        let family = &self.study.family;
        let pairs = family
            .measures
            .list
            .iter()
            .zip(&self.nominal.gradients.measures);
        let shown = pairs.map(|(m, value)| (m.name.as_str(), family.shown(m, *value)));
        shown.collect()
    }

    /// The derivative of a measure with respect to a variable, in the scene's units; NaN where there is none.
    ///
    /// Errors: no measure or no variable has that name.
    ///
    /// ```
    /// let sensitivity = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4"]).sensitivity()?;
    /// let (measure, _) = sensitivity.measures()[0];
    /// assert!(sensitivity.derivative(measure, "L4")?.is_finite());
    /// assert!(sensitivity.derivative(measure, "L5d").is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn derivative(&self, measure: &str, variable: &str) -> Result<f64, Error> {
        let index = self.study.measure(measure)?;
        let variables = self.study.family.study.variables.iter();
        let mut names = variables.map(|v| v.name.as_str());
        match names.clone().position(|name| name == variable) {
            Some(k) => Ok(self.table().slope(index, k)),
            None => Err(Error::unknown_name("variable", variable, names.by_ref())),
        }
    }

    /// The table that `mechanim sensitivity` prints.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// assert!(study.sensitivity()?.text().contains("L4"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> String {
        self.table().text(self.rank)
    }

    /// The same as a JSON document.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("gearshift")?.study().vary(&["L4"]);
    /// assert!(study.sensitivity()?.to_json().contains("mechanim-sensitivity/1"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> String {
        format!("{:#}\n", self.table().document())
    }

    fn table(&self) -> SensitivityTable<'_> {
        SensitivityTable::new(&self.study.family, &self.nominal, self.rank, None)
    }
}
