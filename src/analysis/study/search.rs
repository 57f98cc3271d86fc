//! A study as a function for the minimisers: poses are reached from the best ones so far, rejected candidates are
//! counted by cause.

use super::family::ParametricMechanism;
use super::family_error::FamilyError;
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::analysis::optimise::constraints::Constrained;
use crate::analysis::optimise::{Objective, VariableBounds};
use std::sync::atomic::AtomicBool;

/// Numbers of rejected candidates, by cause.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Refusals {
    /// A pose could not be reached: no assembly, or a singular pose on the way.
    pub not_reached: usize,
    /// A singular pose passed between two samples.
    pub branch_lost: usize,
    /// The objective or a limited measure had no value or no derivative.
    pub no_value: usize,
}

impl Refusals {
    /// The result for a candidate. A rejection is counted by its cause, unless the search was cancelled meanwhile.
    pub(super) fn keep<T>(&mut self, found: Result<T, Rejection>, is_stopped: bool) -> Option<T> {
        match found {
            Ok(found) => return Some(found),
            Err(_) if is_stopped => {}
            Err(Rejection::NotReached { .. }) => self.not_reached += 1,
            Err(Rejection::BranchLost { .. }) => self.branch_lost += 1,
            Err(Rejection::NoValue(_) | Rejection::NoDerivative(_)) => self.no_value += 1,
        }
        None
    }

    /// All of them.
    pub fn count(&self) -> usize {
        self.not_reached + self.branch_lost + self.no_value
    }
}

/// Called with iteration, values of the variables and the objective; `false` ends the search.
pub type Watch<'w> = dyn FnMut(usize, &[f64], f64) -> bool + 'w;

/// A family with its objective.
pub struct StudySearch<'f, 'w> {
    evaluator: Evaluator<'f>,
    base: TrackPoses,
    base_value: f64,
    objective: usize,
    /// Candidates that were refused.
    pub refusals: Refusals,
    /// The point of the last iteration, then those evaluated since.
    looked_at: Vec<EvaluatedPoint>,
    /// Number of points that were actually evaluated.
    looks: usize,
    watch: Box<Watch<'w>>,
}

/// A point with the objective and the constraints there.
struct EvaluatedPoint {
    x: Vec<f64>,
    values: Vec<f64>,
}

impl EvaluatedPoint {
    /// The largest difference of a variable, as a share of it.
    fn distance(&self, x: &[f64]) -> f64 {
        let shares = self.x.iter().zip(x).map(|(a, b)| {
            let size = a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
            (a - b).abs() / size
        });
        shares.fold(0.0, f64::max)
    }
}

/// Points nearer than this are equal: minimisers convert to scaled variables and back.
const SAME_POINT: f64 = 1e-12;

impl<'f, 'w> StudySearch<'f, 'w> {
    /// Prepares the search from the file's own values.
    ///
    /// # Errors
    /// No objective; poses or measures that do not exist at the start.
    pub fn new(
        family: &'f ParametricMechanism,
        watch: Box<Watch<'w>>,
    ) -> Result<Self, FamilyError> {
        let Some(objective) = family.study.objective else {
            let message =
                "the study has nothing to minimise: name a measure with `minimise` in `[study]`";
            return Err(FamilyError::Lacks(message.to_owned()));
        };
        // Everything is measured at the file's own values, from which the search starts.
        let mut evaluator = Evaluator::new(family);
        let base = evaluator.nominal(family.nominal()?.poses);
        let measured = evaluator.measure_sought(&base);
        let measures = measured.map_err(|refusal| evaluator.refused_start(&base, &refusal))?;
        Ok(Self {
            base_value: measures.measures[objective],
            evaluator,
            base,
            objective,
            refusals: Refusals::default(),
            looked_at: Vec::new(),
            looks: 0,
            watch,
        })
    }

    /// The same, which rejects all new points when `cancel` is raised, so that a search ends with the best point so
    /// far.
    pub fn until(self, cancel: &'f AtomicBool) -> Self {
        Self {
            evaluator: self.evaluator.until(cancel),
            ..self
        }
    }

    /// The objective at the best values so far (at the start: at the file's own).
    pub fn value(&self) -> f64 {
        self.base_value
    }

    /// The poses from which candidates are reached.
    pub fn poses(&self) -> &TrackPoses {
        &self.base
    }

    /// Number of points evaluated, without those rejected because the search was cancelled.
    pub fn evaluations(&self) -> usize {
        self.looks
    }

    /// The box of the variables.
    pub fn bounds(&self) -> VariableBounds {
        let variables = &self.evaluator.family().study.variables;
        VariableBounds {
            lower: variables.iter().map(|v| v.lower).collect(),
            upper: variables.iter().map(|v| v.upper).collect(),
        }
    }

    /// Typical sizes of the variables: their values, or the width of their range where that is zero.
    pub fn scales(&self) -> Vec<f64> {
        let family = self.evaluator.family();
        let variables = family.study.variables.iter();
        variables
            .map(|v| {
                let width = v.upper - v.lower;
                if v.start != 0.0 {
                    v.start.abs()
                } else if width.is_finite() {
                    width
                } else {
                    family.mechanism().size
                }
            })
            .collect()
    }

    /// Typical sizes of the constraints: the measures' limits.
    pub fn constraint_scales(&self) -> Vec<f64> {
        let measures = self.evaluator.family().measures.list.iter();
        let scales = measures.flat_map(|m| {
            let limits = m.max.into_iter().chain(m.min);
            limits.map(|limit| m.scale_of(limit))
        });
        scales.collect()
    }

    /// All measures at `x`, and their gradients if `with_gradients`.
    fn evaluate(&mut self, x: &[f64], with_gradients: bool) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        self.looks += usize::from(!self.evaluator.is_cancelled());
        let found = self.evaluate_or_refuse(x, with_gradients);
        self.refusals.keep(found, self.evaluator.is_cancelled())
    }

    fn evaluate_or_refuse(
        &mut self,
        x: &[f64],
        with_gradients: bool,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), Rejection> {
        let track_poses = match with_gradients {
            true => self.evaluator.reach(&self.base, x)?,
            false => self.evaluator.approach(&self.base, x)?,
        };
        let (measures, rows) = if with_gradients {
            let found = self.evaluator.gradients(&track_poses)?;
            (found.measures, found.rows)
        } else {
            (
                self.evaluator.measure_sought(&track_poses)?.measures,
                Vec::new(),
            )
        };
        // The next candidates are mostly near the best one, so they start from it.
        if measures[self.objective] < self.base_value {
            self.base_value = measures[self.objective];
            self.base = self.evaluator.settled(track_poses);
        }
        Ok((measures, rows))
    }

    fn remember(&mut self, x: &[f64], values: &[f64]) {
        self.looked_at.push(EvaluatedPoint {
            x: x.to_vec(),
            values: values.to_vec(),
        });
    }
}

impl Constrained for StudySearch<'_, '_> {
    fn values(&mut self, x: &[f64]) -> Option<Vec<f64>> {
        if self.evaluator.is_cancelled() {
            let known = self.looked_at.iter().find(|p| p.distance(x) <= SAME_POINT);
            return known.map(|point| point.values.clone());
        }
        let (measures, _) = self.evaluate(x, false)?;
        // The objective, then every limit as a number that must not be positive.
        let mut values = vec![measures[self.objective]];
        for (measure, value) in self.evaluator.family().measures.list.iter().zip(&measures) {
            values.extend(measure.max.map(|high| value - high));
            values.extend(measure.min.map(|low| low - value));
        }
        self.remember(x, &values);
        Some(values)
    }

    fn gradients(&mut self, x: &[f64]) -> Option<(Vec<f64>, Vec<Vec<f64>>)> {
        let (measures, rows) = self.evaluate(x, true)?;
        let mut values = vec![measures[self.objective]];
        let mut gradients = vec![rows[self.objective].clone()];
        let list = self.evaluator.family().measures.list.iter();
        for ((measure, value), row) in list.zip(&measures).zip(&rows) {
            if let Some(high) = measure.max {
                values.push(value - high);
                gradients.push(row.clone());
            }
            if let Some(low) = measure.min {
                values.push(low - value);
                gradients.push(row.iter().map(|d| -d).collect());
            }
        }
        self.remember(x, &values);
        Some((values, gradients))
    }

    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool {
        self.looked_at
            .retain(|point| point.distance(x) <= SAME_POINT);
        (self.watch)(iteration, x, value) && !self.evaluator.is_cancelled()
    }
}

impl Objective for StudySearch<'_, '_> {
    fn value(&mut self, x: &[f64]) -> f64 {
        self.evaluate(x, false)
            .map_or(f64::INFINITY, |(measures, _)| measures[self.objective])
    }

    fn gradient(&mut self, x: &[f64]) -> Option<(f64, Vec<f64>)> {
        let (measures, mut rows) = self.evaluate(x, true)?;
        Some((measures[self.objective], rows.swap_remove(self.objective)))
    }

    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool {
        (self.watch)(iteration, x, value) && !self.evaluator.is_cancelled()
    }
}
