//! Studies: how the measures of a scene depend on its parameters.

use super::enclosure::Enclosure;
use super::error::Error;
use super::loaded::Loaded;
use super::motion::Samples;
use super::optimum::{OptimiseOptions, Optimum};
use super::sensitivity::Sensitivity;
use super::tolerance::{Tolerance, ToleranceOptions};
use crate::analysis::study::{DefaultVariables, LoadedStudy, varied_names};
use crate::diag::Source;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;

/// The measures of a scene as functions of its parameters. Returned by [`Scene::study`](crate::Scene::study).
///
/// ```
/// let study = mechanim::Scene::builtin("gearshift")?.study();
/// let sensitivity = study.vary(&["L4", "L5d"]).sensitivity()?;
/// println!("{}", sensitivity.text());
/// # Ok::<(), mechanim::Error>(())
/// ```
#[derive(Clone)]
pub struct Study {
    loaded: Arc<Loaded>,
    names: Vec<String>,
    cancel: Arc<AtomicBool>,
}

impl Study {
    pub(super) fn new(loaded: Arc<Loaded>) -> Self {
        Self {
            loaded,
            names: Vec::new(),
            cancel: Arc::default(),
        }
    }

    /// The study with these parameters as its variables. By default, a search varies the scene's `[study.variables]`, and
    /// everything else every length and angle; `"all"` also selects the latter.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("gearshift")?.study();
    /// assert!(study.vary(&["L4"]).sensitivity().is_ok());
    /// assert!(study.vary(&["O2X"]).sensitivity().is_err());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn vary(&self, names: &[&str]) -> Self {
        Self {
            loaded: Arc::clone(&self.loaded),
            names: names.iter().map(|name| (*name).to_owned()).collect(),
            cancel: Arc::clone(&self.cancel),
        }
    }

    /// The study with a flag: when `cancel` is set, searches and random pieces end and return their results so far.
    ///
    /// ```
    /// use mechanim::{Scene, study::OptimiseOptions};
    /// use std::sync::{Arc, atomic::AtomicBool};
    ///
    /// let raised = Arc::new(AtomicBool::new(true));
    /// let study = Scene::builtin("gearshift-optimised")?.study().until(&raised);
    /// assert!(study.optimise(&OptimiseOptions::default()).is_ok_and(|best| !best.objective()[1].is_nan()));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn until(&self, cancel: &Arc<AtomicBool>) -> Self {
        Self {
            cancel: Arc::clone(cancel),
            ..self.clone()
        }
    }

    /// The exact derivatives of all measures with respect to all variables.
    ///
    /// Errors: the scene has no measures; no parameter has that name; a variable where it cannot be followed (a drive, a track,
    /// the limits of a measure); a pose does not exist.
    ///
    /// ```
    /// let study = mechanim::Scene::builtin("twin-steer")?.study();
    /// let sensitivity = study.sensitivity()?;
    /// assert!(!sensitivity.variables().is_empty());
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn sensitivity(&self) -> Result<Sensitivity, Error> {
        Sensitivity::of(self.load(DefaultVariables::All)?)
    }

    /// Tolerance analysis of the measures: worst case and root sum square, random pieces, and proved bands. Dimensions vary as
    /// for [`enclose`](Self::enclose).
    ///
    /// Errors: as for [`sensitivity`](Self::sensitivity); a variable without a tolerance.
    ///
    /// ```
    /// use mechanim::{Scene, study::ToleranceOptions};
    ///
    /// let study = Scene::builtin("gearshift")?.study().vary(&["L4", "L5d"]);
    /// let options = ToleranceOptions { tolerance: Some(0.01), pieces: 64, ..Default::default() };
    /// let tolerance = study.tolerance(&options)?;
    /// for measure in tolerance.measures() {
    ///     println!("{}: {} +- {}", measure.name, measure.nominal, measure.linear_sum);
    /// }
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn tolerance(&self, options: &ToleranceOptions) -> Result<Tolerance, Error> {
        let loaded = self.load(DefaultVariables::WithTolerance)?;
        Tolerance::of(&loaded, options, &self.cancel)
    }

    /// Proved bands that contain the motion of every piece within its tolerances. `tolerance` is half the width, in the
    /// dimension's unit, for every dimension without a tolerance in the scene.
    ///
    /// The varied dimensions are those named with [`vary`](Self::vary), otherwise the variables of the study with a
    /// tolerance, otherwise every length and angle. The scene needs no measures.
    ///
    /// Errors: a dimension without a tolerance, or used where tolerances are not supported; samples that do not fit the
    /// motion. Samples without a band are not an error: see [`Enclosure::to_json`].
    ///
    /// ```
    /// # use mechanim::{Samples, Scene};
    /// let study = Scene::builtin("gearshift")?.study();
    /// let enclosure = study.vary(&["all"]).enclose(Some(0.01), Samples::Even(4))?;
    /// assert!(enclosure.bands("M.x")?.iter().all(|[low, high]| high - low < 2.0));
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn enclose(&self, tolerance: Option<f64>, samples: Samples) -> Result<Enclosure, Error> {
        Enclosure::of(
            &self.loaded,
            &self.names,
            (tolerance, &samples),
            &self.cancel,
        )
    }

    /// The values of the variables that minimise the study's objective within its limits, verified by an independent
    /// motion.
    ///
    /// Errors: no objective or no variables; a pose that does not exist. Limits that cannot be kept are not an error:
    /// see [`Optimum::holds`].
    ///
    /// ```
    /// use mechanim::{Scene, study::OptimiseOptions};
    ///
    /// let study = Scene::builtin("gearshift-optimised")?.study();
    /// let best = study.optimise(&OptimiseOptions { iterations: 1, ..Default::default() })?;
    /// let [before, after] = best.objective();
    /// assert!(after <= before);
    /// # Ok::<(), mechanim::Error>(())
    /// ```
    pub fn optimise(&self, options: &OptimiseOptions) -> Result<Optimum, Error> {
        Optimum::search(self.load(DefaultVariables::OfStudy)?, options, &self.cancel)
    }

    fn load(&self, default: DefaultVariables) -> Result<LoadedStudy, Error> {
        let Loaded {
            text,
            overrides,
            scene,
            ..
        } = &*self.loaded;
        let names = varied_names(&self.names, default, scene)?;
        Ok(LoadedStudy::new(
            Source::clone(text),
            overrides.clone(),
            &names,
        )?)
    }
}
