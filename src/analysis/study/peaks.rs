//! A study whose objective is the largest value along a track, pose by pose: what a minimax search works on.

use super::gradient::add;
use super::measure::slots_at;
use super::{Evaluator, Family, FamilyError, Refusals, Rejection, Stand, Watch};
use crate::analysis::optimise::minimax::{Heights, Landscape, Slopes};
use crate::model::expression::Expression;
use crate::model::study::{Measure, Reducer, Reduction, Study};

/// A family whose objective is `max_over(track, e)` or `max_over(track, abs(e))`.
pub struct Peaks<'f, 'w> {
    evaluator: Evaluator<'f>,
    base: Stand,
    base_merit: f64,
    objective: &'f Reduction,
    /// The formula below the magnitude, if the objective is one.
    inner: Option<Expression>,
    /// Candidates that were refused.
    pub refusals: Refusals,
    watch: Box<Watch<'w>>,
}

/// The reduction that a measure consists of, if it is nothing else.
fn only_reduction<'s>(study: &'s Study, measure: &Measure) -> Option<&'s Reduction> {
    let slot = measure.expression.only_slot()?;
    let index = slot.checked_sub(study.variables.len())?;
    match study.reductions.get(index) {
        Some(reduction) => Some(reduction),
        // A measure that only repeats an earlier one.
        None => only_reduction(study, &study.measures[index - study.reductions.len()]),
    }
}

/// Heights and slopes of some rows: the same formula at several poses.
struct Rows<'a> {
    formula: &'a Expression,
    poses: std::ops::Range<usize>,
    /// Rows are `factor · formula + shift`.
    factor: f64,
    shift: f64,
}

impl<'f, 'w> Peaks<'f, 'w> {
    /// Prepares the search from the `start` stand of `evaluator`.
    ///
    /// # Errors
    /// An objective of another form.
    pub fn new(
        family: &'f Family,
        mut evaluator: Evaluator<'f>,
        start: Stand,
        watch: Box<Watch<'w>>,
    ) -> Result<Self, FamilyError> {
        let study = &family.study;
        let objective = study
            .objective
            .and_then(|index| only_reduction(study, &study.measures[index]))
            .filter(|r| r.reducer == Reducer::Largest);
        let Some(objective) = objective else {
            let message = "minimax needs an objective of the form `max_over(track, e)`";
            return Err(FamilyError::Lacks(message.to_owned()));
        };
        let base = evaluator.settled(start);
        Ok(Self {
            inner: objective.arguments[0].below_magnitude(),
            evaluator,
            base,
            base_merit: f64::INFINITY,
            objective,
            refusals: Refusals::default(),
            watch,
        })
    }

    /// The stand that candidates are reached from: the best one so far.
    pub fn into_parts(self) -> (Evaluator<'f>, Stand) {
        (self.evaluator, self.base)
    }

    fn peak_rows(&self) -> Vec<Rows<'_>> {
        let poses = self.evaluator.poses_of(self.objective.track);
        let rows = |formula, factor| Rows {
            formula,
            poses: poses.clone(),
            factor,
            shift: 0.0,
        };
        match &self.inner {
            Some(inner) => vec![rows(inner, 1.0), rows(inner, -1.0)],
            None => vec![rows(&self.objective.arguments[0], 1.0)],
        }
    }

    /// Rows of the constraints that hold pose by pose, as shares of their bounds.
    fn limit_rows(&self) -> Vec<Rows<'f>> {
        let study = &self.evaluator.family.study;
        let mut rows = Vec::new();
        for limit in &study.constraints {
            let Some(reduction) = only_reduction(study, &study.measures[limit.measure]) else {
                continue;
            };
            let poses = self.evaluator.poses_of(reduction.track);
            let formula = &reduction.arguments[0];
            let mut add = |bound: f64, sign: f64| {
                let size = if bound == 0.0 { 1.0 } else { bound.abs() };
                rows.push(Rows {
                    formula,
                    poses: poses.clone(),
                    factor: sign / size,
                    shift: -sign * bound / size,
                });
            };
            match (reduction.reducer, limit.at_most, limit.at_least) {
                (Reducer::Largest, Some(high), _) => add(high, 1.0),
                (Reducer::Smallest, _, Some(low)) => add(low, -1.0),
                _ => {}
            }
        }
        rows
    }

    /// Constraints that are one number, as (measure, factor, shift).
    fn single_limits(&self) -> Vec<(usize, f64, f64)> {
        let study = &self.evaluator.family.study;
        let mut list = Vec::new();
        for limit in &study.constraints {
            let reducer = only_reduction(study, &study.measures[limit.measure]).map(|r| r.reducer);
            let mut add = |bound: f64, sign: f64| {
                let size = if bound == 0.0 { 1.0 } else { bound.abs() };
                list.push((limit.measure, sign / size, -sign * bound / size));
            };
            if let (Some(high), false) = (limit.at_most, reducer == Some(Reducer::Largest)) {
                add(high, 1.0);
            }
            if let (Some(low), false) = (limit.at_least, reducer == Some(Reducer::Smallest)) {
                add(low, -1.0);
            }
        }
        list
    }

    fn look(&mut self, x: &[f64], with_slopes: bool) -> Option<(Heights, Slopes)> {
        match self.look_or_refuse(x, with_slopes) {
            Ok(found) => Some(found),
            Err(Rejection::NotReached { .. }) => {
                self.refusals.not_reached += 1;
                None
            }
            Err(Rejection::NoValue(_)) => {
                self.refusals.no_value += 1;
                None
            }
        }
    }

    fn look_or_refuse(
        &mut self,
        x: &[f64],
        with_slopes: bool,
    ) -> Result<(Heights, Slopes), Rejection> {
        let stand = self.evaluator.approach(&self.base, x)?;
        let slots: Vec<Vec<f64>> = stand
            .poses
            .iter()
            .map(|p| slots_at(&self.evaluator, p))
            .collect();
        let mut scratch = Vec::new();
        let mut values = |list: &[Rows]| -> Vec<f64> {
            let of = |rows: &Rows| -> Vec<f64> {
                let at = |s: &Vec<f64>| {
                    rows.factor * rows.formula.value_with(s, &mut scratch) + rows.shift
                };
                slots[rows.poses.clone()].iter().map(at).collect()
            };
            list.iter().map(of).collect::<Vec<_>>().concat()
        };
        let (peak_rows, limit_rows) = (self.peak_rows(), self.limit_rows());
        let (peaks, mut limits) = (values(&peak_rows), values(&limit_rows));
        let singles = self.single_limits();
        let mut slopes = Slopes {
            peaks: Vec::new(),
            limits: Vec::new(),
        };
        if with_slopes {
            let changes = self.evaluator.slot_changes(&stand)?;
            let count = x.len();
            let gather = |list: &[Rows]| -> Vec<Vec<f64>> {
                let of = |rows: &Rows| -> Vec<Vec<f64>> {
                    let at = |pose: usize| {
                        let mut row = vec![0.0; count];
                        add(
                            rows.formula,
                            &slots[pose],
                            rows.factor,
                            &changes[pose],
                            &mut row,
                        );
                        row
                    };
                    rows.poses.clone().map(at).collect()
                };
                list.iter().flat_map(of).collect()
            };
            slopes.peaks = gather(&peak_rows);
            slopes.limits = gather(&limit_rows);
            if !singles.is_empty() {
                let found = self.evaluator.gradients(&stand)?;
                for (measure, factor, _) in &singles {
                    let row = found.rows[*measure].iter();
                    slopes.limits.push(row.map(|d| d * factor).collect());
                }
            }
        }
        if !singles.is_empty() {
            let measures = self.evaluator.measure(&stand)?.measures;
            limits.extend(
                singles
                    .iter()
                    .map(|(m, factor, shift)| factor * measures[*m] + shift),
            );
        }
        let heights = Heights { peaks, limits };
        let all = heights.peaks.iter().chain(&heights.limits);
        if !all.clone().all(|v| v.is_finite()) {
            return Err(Rejection::NoValue("objective".to_owned()));
        }
        let largest = |list: &[f64]| list.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Slopes are asked for at accepted points only; those are what candidates come from.
        let merit = largest(&heights.peaks) + largest(&heights.limits).max(0.0);
        if with_slopes || merit < self.base_merit {
            self.base_merit = merit;
            self.base = self.evaluator.settled(stand);
        }
        Ok((heights, slopes))
    }
}

impl Landscape for Peaks<'_, '_> {
    fn heights(&mut self, x: &[f64]) -> Option<Heights> {
        Some(self.look(x, false)?.0)
    }

    fn slopes(&mut self, x: &[f64]) -> Option<(Heights, Slopes)> {
        self.look(x, true)
    }

    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool {
        (self.watch)(iteration, x, value)
    }
}
