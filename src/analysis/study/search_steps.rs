//! The optimisation of a study from the search to the verification, shared by the program and the library.

use super::family_error::FamilyError;
use super::kept_clearances::{Clearances, settle_clearances};
use super::loaded::LoadedStudy;
use super::optimum::{Improvement, Method, Optimum, Verified, find_optimum, verify_optimum};
use super::track_poses::Evaluator;
use super::whole_limits::{KEPT, WholeLimit};
use crate::analysis::optimise::Minimum;
use std::sync::atomic::AtomicBool;

/// Accepted difference of an objective that is measured again, as a fraction of it (or of this fraction of the first
/// value).
const SAME: f64 = 1e-6;

/// The result of an optimisation.
#[derive(Clone)]
pub struct FoundOptimum {
    /// The best values, and how they were found.
    pub optimum: Optimum,
    /// The points visited by the search, from the start on.
    pub improvements: Vec<Improvement>,
    /// The clearances with these values; `None` if none are requested.
    pub clearances: Option<Clearances>,
}

impl LoadedStudy {
    /// Searches the optimum and records the visited points. `heard` is called after every iteration with the best
    /// objective so far; the search ends when `cancel` is raised.
    ///
    /// # Errors
    /// Those of [`find_optimum`].
    pub fn search_optimum(
        &self,
        method: Method,
        iterations: usize,
        heard: &mut dyn FnMut(usize, f64),
        cancel: &AtomicBool,
    ) -> Result<FoundOptimum, FamilyError> {
        let mut found: Vec<Improvement> = Vec::new();
        let watch = |iteration: usize, values: &[f64], objective: f64| {
            add_improvement(&mut found, iteration, values, objective);
            heard(iteration, objective);
            true
        };
        let optimum = find_optimum(&self.family, method, iterations, Box::new(watch), cancel)?;
        // From the start over all improvements to the minimum.
        let mut improvements = vec![Improvement {
            iteration: 0,
            values: self.family.start(),
            objective: optimum.first_value,
        }];
        improvements.append(&mut found);
        let last = &optimum.minimum;
        add_improvement(&mut improvements, last.iterations, &last.x, last.value);
        Ok(FoundOptimum {
            optimum,
            improvements,
            clearances: None,
        })
    }

    /// Checks whether the optimum keeps the clearances of the scene, and otherwise returns to a point that does.
    ///
    /// # Errors
    /// Values that the scene does not allow.
    pub fn settle(&self, found: &mut FoundOptimum) -> Result<(), FamilyError> {
        let (minimum, improvements) = (&mut found.optimum.minimum, &found.improvements);
        found.clearances = settle_clearances(self, minimum, improvements)?;
        Ok(())
    }

    /// Follows the tracks again with these values from the start values on, and proves every pose.
    ///
    /// # Errors
    /// Those of [`verify_optimum`].
    pub fn verify(&self, values: &[f64]) -> Result<Verified, FamilyError> {
        let variables = self.family.study.variables.iter();
        let names: Vec<String> = variables.map(|v| v.name.clone()).collect();
        let passes_singular = self.family.nominal()?.singular.is_some();
        verify_optimum(
            &self.source,
            &self.overrides,
            self.parameters(values),
            (&names, passes_singular),
        )
    }
}

/// A point that differs from the previous one.
fn add_improvement(list: &mut Vec<Improvement>, iteration: usize, values: &[f64], objective: f64) {
    if list.last().is_none_or(|last| last.values != values) {
        list.push(Improvement {
            iteration,
            values: values.to_vec(),
            objective,
        });
    }
}

impl FoundOptimum {
    /// Whether the search ended before its first iteration.
    pub fn is_empty(&self) -> bool {
        self.improvements.len() < 2 && self.optimum.minimum.iterations == 0
    }

    /// Whether the verifying motion is the one that was optimised: it has the same objective or, where that is no more than
    /// rounding, the same poses.
    pub fn agrees(&self, study: &LoadedStudy, verified: &Verified) -> bool {
        let family = &study.family;
        let again = family.study.objective.map(|index| verified.measures[index]);
        let Minimum { value, x, .. } = &self.optimum.minimum;
        let scale = value.abs().max(SAME * self.optimum.first_value.abs());
        let is_equal = again.is_some_and(|again| (again - value).abs() <= SAME * scale);
        let has_same_poses = || {
            let reached = Evaluator::new(family).approach(&self.optimum.poses, x);
            let mechanism = family.mechanism();
            reached.is_ok_and(|poses| poses.are_those_of(&verified.track_poses, mechanism))
        };
        // A search that found no value has nothing to confirm.
        value.is_finite() && (is_equal || has_same_poses())
    }

    /// Whether the independent motion is the one that was optimised, all its poses and all limits of the whole motion are proved,
    /// and clearances are kept.
    pub fn holds(&self, study: &LoadedStudy, verified: &Result<Verified, FamilyError>) -> bool {
        let is_clear = self.clearances.as_ref().is_none_or(|c| c.kept);
        let is_verified = |v: &Verified| {
            let is_kept = v.whole.iter().all(WholeLimit::is_kept);
            let is_proved = v.unproved == 0 && is_kept;
            v.violation <= KEPT && is_proved && self.agrees(study, v)
        };
        verified.as_ref().is_ok_and(is_verified) && is_clear
    }
}
