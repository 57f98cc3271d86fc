//! The optimal values of a study's variables.

use super::error::Error;
use crate::analysis::study::optimum::{SearchMethod, Verified};
use crate::analysis::study::{FamilyError, FoundOptimum, LoadedStudy};
use crate::jobs::Stopwatch;
use crate::model::asked_ranges::{ACCURACY, WITHIN};
use crate::report::optimum::OptimumReport;
use crate::scene::edit::with_values;
use std::sync::atomic::AtomicBool;

/// Options of an optimisation.
#[derive(Clone, Debug, PartialEq)]
pub struct OptimiseOptions {
    /// The method.
    pub method: SearchMethod,
    /// Maximum number of iterations; of a study with limits, in each of its rounds.
    pub iterations: usize,
    /// Relative accuracy, positive and at most 1; the default of the method if absent.
    pub tolerance: Option<f64>,
    /// Lets every variable move by this fraction of its value, positive and at most 1000, instead of within the study's ranges.
    pub within: Option<f64>,
    /// Seed of the random numbers ([`SearchMethod::Evolution`]).
    pub seed: u64,
}

impl Default for OptimiseOptions {
    fn default() -> Self {
        Self {
            method: SearchMethod::Bfgs,
            iterations: 1000,
            tolerance: None,
            within: None,
            seed: 1,
        }
    }
}

/// Values of a study's variables that minimise its objective. Returned by [`Study::optimise`](crate::Study::optimise).
pub struct Optimum {
    study: LoadedStudy,
    found: FoundOptimum,
    verified: Result<Verified, FamilyError>,
    seconds: f64,
}

impl Optimum {
    pub(super) fn search(
        mut study: LoadedStudy,
        options: &OptimiseOptions,
        cancel: &AtomicBool,
    ) -> Result<Self, Error> {
        if let Some(tolerance) = options.tolerance {
            Error::unless_in(&ACCURACY, "tolerance", tolerance)?;
        }
        if let Some(share) = options.within {
            Error::unless_in(&WITHIN, "within", share)?;
            study.family.free_within(share);
        }
        let begun = Stopwatch::start();
        let method = options
            .method
            .with_tolerance(options.tolerance, options.seed);
        let mut found = study.search_optimum(method, options.iterations, &mut |_, _| {}, cancel)?;
        study.settle(&mut found)?;
        let verified = study.verify(&found.optimum.minimum.x);
        Ok(Self {
            seconds: begun.seconds(),
            study,
            found,
            verified,
        })
    }

    /// The objective before and after the optimisation, in the scene's units.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let [before, after] = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?.objective();
    /// assert!(after <= before);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn objective(&self) -> [f64; 2] {
        let (unit, optimum) = (self.study.objective_unit(), &self.found.optimum);
        [optimum.first_value, optimum.minimum.value].map(|value| value * unit)
    }

    /// The variables with their optimal values, in the scene's units.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// assert!(best.values().iter().all(|(_, value)| value.is_finite()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn values(&self) -> Vec<(&str, f64)> {
        let family = &self.study.family;
        let pairs = family.study.variables.iter().zip(self.best());
        let shown = pairs.map(|(v, value)| (v.name.as_str(), value * family.units(v.kind)));
        shown.collect()
    }

    /// Whether an independent motion with these values confirms the objective and keeps all limits and clearances.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// assert!(best.holds(), "{}", best.text());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn holds(&self) -> bool {
        self.report().holds()
    }

    /// The text of the scene with the optimal values.
    ///
    /// Errors: a text whose values cannot be replaced.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// let better = Scene::parse("better", &best.scene_text()?)?;
    /// assert!(better.check(&Default::default())?.passed());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn scene_text(&self) -> Result<String, Error> {
        let LoadedStudy {
            source, overrides, ..
        } = &self.study;
        let parameters = self.study.parameters(self.best());
        Ok(with_values(source, &parameters, &overrides.guess)?)
    }

    /// The report that `mechanim optimise` prints.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// assert!(best.text().contains("Solved again"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn text(&self) -> String {
        self.report().text()
    }

    /// The same as a JSON document.
    ///
    /// ```
    /// # use mechanim::{Scene, study::OptimiseOptions};
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// assert!(best.to_json().contains("mechanim-optimise/1"));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn to_json(&self) -> String {
        format!("{:#}\n", self.report().document())
    }

    fn best(&self) -> &[f64] {
        &self.found.optimum.minimum.x
    }

    fn report(&self) -> OptimumReport<'_> {
        OptimumReport {
            study: &self.study,
            found: &self.found,
            verified: &self.verified,
            seconds: self.seconds,
        }
    }
}
