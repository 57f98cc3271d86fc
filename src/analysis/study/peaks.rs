//! A study as a minimax problem: one function per pose if the objective is the largest value along a track, otherwise a
//! single function.

use super::branched::{BranchedMeasure, hides_kinks};
use super::family::ParametricMechanism;
use super::family_error::FamilyError;
use super::row_reader::{list_rows, row_nearness};
use super::rows::{Listed, Reduction, StudyRows};
use super::search::{Refusals, Watch};
use super::track_poses::{Evaluator, Rejection, TrackPoses};
use crate::analysis::optimise::VariableBounds;
use crate::analysis::optimise::minimax::{MinimaxProblem, PeakGradients, PeakValues, TrustEdge};

/// An optimum may be nearer to a singular pose than the file's values, but not nearer than this fraction: otherwise the
/// search ends at a mechanism that is about to fall apart.
const SHARE_OF_SIGMA: f64 = 0.1;

/// If the smallest singular value exceeds this multiple of the allowed minimum, a step does not need its derivative.
const SLOPES_BELOW: f64 = 4.0;

/// The quantity that is minimised.
enum PeakObjective {
    /// The largest of the first rows.
    Largest,
    /// One number computed from the first rows.
    Reduced(Reduction),
    /// A measure of another kind.
    Number(BranchedMeasure),
}

/// A family with its objective, pose by pose if possible.
pub struct Peaks<'f, 'w> {
    evaluator: Evaluator<'f>,
    base: TrackPoses,
    base_merit: f64,
    excess: f64,
    /// Poses with a smaller singular value are rejected.
    least_sigma: f64,
    objective: PeakObjective,
    /// Those of the objective if it has any, then those of the limits that apply pose by pose.
    rows: Vec<StudyRows<'f>>,
    /// Limits of measures that are single numbers.
    singles: Vec<BranchedMeasure>,
    hides_kinks: bool,
    /// Candidates that were refused.
    pub refusals: Refusals,
    /// Candidates rejected by the guard.
    pub guarded: usize,
    watch: Box<Watch<'w>>,
    guard: Option<Box<Guard<'w>>>,
    goes_on: Option<&'w dyn Fn() -> bool>,
}

/// Called with the poses on which a search is about to build: by how much they exceed what is allowed, as a number of
/// order one; zero or less accepts them.
pub type Guard<'w> = dyn FnMut(&TrackPoses) -> f64 + 'w;

/// Step of the difference quotients of a guard's answer, as a fraction of the variables' ranges.
const GUARD_STEP: f64 = 1e-7;

impl<'f, 'w> Peaks<'f, 'w> {
    /// Prepares the search from the poses `start` of `evaluator`.
    ///
    /// # Errors
    /// No objective.
    pub fn new(
        family: &'f ParametricMechanism,
        mut evaluator: Evaluator<'f>,
        start: TrackPoses,
        watch: Box<Watch<'w>>,
    ) -> Result<Self, FamilyError> {
        let measures = &family.measures.list;
        let Some(minimised) = family.study.objective else {
            let message = "there is nothing to minimise: [study] needs `minimise`";
            return Err(FamilyError::Lacks(message.to_owned()));
        };
        let measure = &measures[minimised];
        let peaks = StudyRows::of(family, measure).filter(|rows| rows.signs[0] > 0.0);
        let (objective, mut rows) = match (peaks, StudyRows::reduced(family, measure)) {
            (Some(peaks), _) => (PeakObjective::Largest, vec![peaks]),
            (None, Some((rows, reduction))) => (PeakObjective::Reduced(reduction), vec![rows]),
            (None, None) => {
                let number = BranchedMeasure::new(family, minimised, 1.0, 0.0);
                (PeakObjective::Number(number), Vec::new())
            }
        };
        // The rows of every limit that is an extreme over a track.
        let mut singles = Vec::new();
        let has_rows = matches!(objective, PeakObjective::Largest);
        let mut hidden = hides_kinks(family, minimised, has_rows);
        for (index, measure) in measures.iter().enumerate() {
            for (bound, sign) in [(measure.max, 1.0), (measure.min, -1.0)] {
                let Some(bound) = bound else { continue };
                let size = if bound == 0.0 { 1.0 } else { bound.abs() };
                let shift = -sign * bound / size;
                // Only the side of the extreme can be imposed pose by pose.
                match StudyRows::of(family, measure).filter(|rows| rows.signs[0] == sign) {
                    // Its poses are seen one by one, and those at a limit are seldom those of a kink.
                    Some(own) => rows.push(own.scaled(1.0 / size, shift)),
                    None => {
                        hidden |= hides_kinks(family, index, false);
                        singles.push(BranchedMeasure::new(family, index, sign / size, shift));
                    }
                }
            }
        }
        // The regularity at the start determines how near to singular poses the search may go.
        let base = evaluator.settled(start);
        let here = row_nearness(&evaluator, &base, 1.0, 0.0).values.into_iter();
        let least_sigma = SHARE_OF_SIGMA * (1.0 - here.fold(0.0, f64::max));
        Ok(Self {
            least_sigma,
            evaluator,
            base,
            base_merit: f64::INFINITY,
            excess: f64::INFINITY,
            objective,
            rows,
            singles,
            hides_kinks: hidden,
            refusals: Refusals::default(),
            guarded: 0,
            watch,
            guard: None,
            goes_on: None,
        })
    }

    /// The same, ended with the best point so far when `goes_on` returns false.
    pub fn while_it(self, goes_on: &'w dyn Fn() -> bool) -> Self {
        Self {
            goes_on: Some(goes_on),
            ..self
        }
    }

    /// The same with a guard.
    pub fn guarded_by(self, guard: Box<Guard<'w>>) -> Self {
        Self {
            guard: Some(guard),
            ..self
        }
    }

    /// The same where the smallest singular value may fall to `least` and no further.
    pub fn with_least_sigma(self, least: f64) -> Self {
        Self {
            least_sigma: least,
            ..self
        }
    }

    /// The box of the variables.
    pub fn bounds(&self) -> VariableBounds {
        let variables = &self.evaluator.family().study.variables;
        VariableBounds {
            lower: variables.iter().map(|v| v.lower).collect(),
            upper: variables.iter().map(|v| v.upper).collect(),
        }
    }

    /// The largest violation of a limit, as a fraction of it, at the point whose gradients were requested last; zero if
    /// there is none.
    pub fn excess(&self) -> f64 {
        self.excess
    }

    /// Unknowns at the start of the drive at that point, if a track has this pose.
    pub fn unknowns_at_start(&self) -> Option<Vec<f64>> {
        let family = self.evaluator.family();
        let (n, own) = (family.mechanism().unknowns.len(), family.own_inputs());
        let start = &family.actuation.inputs_at(0.0)[..own];
        let mut poses = self.base.poses.iter();
        let pose = poses.find(|pose| &pose[n..n + own] == start)?;
        Some(pose[..n].to_vec())
    }

    /// The poses from which candidates are reached.
    pub fn poses(&self) -> &TrackPoses {
        &self.base
    }

    /// The smallest accepted singular value.
    pub fn least_sigma(&self) -> f64 {
        self.least_sigma
    }

    fn evaluate(&mut self, x: &[f64], with_slopes: bool) -> Option<(PeakValues, PeakGradients)> {
        let found = self.evaluate_or_refuse(x, with_slopes);
        self.refusals.keep(found, self.evaluator.is_cancelled())?
    }

    fn evaluate_or_refuse(
        &mut self,
        x: &[f64],
        with_slopes: bool,
    ) -> Result<Option<(PeakValues, PeakGradients)>, Rejection> {
        // All poses of the tracks with these dimensions, from the nearest known ones.
        let track_poses = if with_slopes {
            self.evaluator.reach(&self.base, x)?
        } else {
            self.evaluator.approach(&self.base, x)?
        };
        if with_slopes {
            self.evaluator.whole(&track_poses)?;
        }
        if with_slopes
            && let Some(guard) = &mut self.guard
            && guard(&track_poses) > 0.0
        {
            self.guarded += 1;
            return Ok(None);
        }
        // The peaks of the objective first, then the limits row by row.
        let lists = list_rows(&self.evaluator, &self.rows, &track_poses, with_slopes);
        let mut lists = lists.into_iter();
        let Listed {
            values,
            slopes: rows,
            bend,
        } = match &self.objective {
            PeakObjective::Largest => lists.next().unwrap_or_default(),
            PeakObjective::Reduced(reduction) => reduction.of(lists.next().unwrap_or_default()),
            PeakObjective::Number(number) => {
                let (numbers, rows) = self.numbers(&track_poses, with_slopes)?;
                number.listed(&numbers, &rows)
            }
        };
        let mut peak_values = PeakValues {
            peaks: values,
            limits: Vec::new(),
        };
        let mut peak_gradients = PeakGradients {
            peaks: rows,
            limits: Vec::new(),
            bend,
        };
        // Regularity is also a constraint: no pose may come near a singular one.
        let near = if with_slopes { SLOPES_BELOW } else { 0.0 };
        let regular = row_nearness(&self.evaluator, &track_poses, self.least_sigma, near);
        for mut list in lists.chain([regular]) {
            peak_values.limits.append(&mut list.values);
            peak_gradients.limits.append(&mut list.slopes);
        }
        // Then limits of measures that are one number.
        if !self.singles.is_empty() {
            let (numbers, rows) = self.numbers(&track_poses, with_slopes)?;
            for single in &self.singles {
                let mut list = single.listed(&numbers, &rows);
                peak_values.limits.append(&mut list.values);
                peak_gradients.limits.append(&mut list.slopes);
            }
        }
        let mut all = peak_values.peaks.iter().chain(&peak_values.limits);
        if !all.all(|v| v.is_finite()) || self.evaluator.is_cancelled() {
            return Err(Rejection::NoValue("the objective".to_owned()));
        }
        // What counts must have derivatives: the largest peak.
        let pairs = peak_values.peaks.iter().zip(&peak_gradients.peaks);
        let top = pairs.max_by(|a, b| a.0.total_cmp(b.0));
        if top.is_some_and(|(_, row)| row.iter().any(|slope| !slope.is_finite())) {
            return Err(Rejection::NoDerivative("the objective".to_owned()));
        }
        let largest = |list: &[f64]| list.iter().copied().fold(f64::NEG_INFINITY, f64::max);
        // Slopes are requested at accepted points only, from which further candidates are reached.
        let excess = largest(&peak_values.limits).max(0.0);
        if with_slopes {
            self.excess = excess;
        }
        // The best set so far is where the next ones are followed from.
        let merit = largest(&peak_values.peaks) + excess;
        if with_slopes || merit < self.base_merit {
            self.base_merit = merit;
            self.base = self.evaluator.settled(track_poses);
        }
        Ok(Some((peak_values, peak_gradients)))
    }

    /// Inputs and measures, the slots of formulas of measures, with their gradients if requested.
    fn numbers(
        &self,
        track_poses: &TrackPoses,
        with_slopes: bool,
    ) -> Result<(Vec<f64>, Vec<Vec<f64>>), Rejection> {
        let family = self.evaluator.family();
        let mut numbers = family.actuation.inputs_at(0.0);
        numbers[family.own_inputs()..].copy_from_slice(&track_poses.values);
        if !with_slopes {
            numbers.extend(self.evaluator.measure_sought(track_poses)?.measures);
            return Ok((numbers, Vec::new()));
        }
        let found = self.evaluator.gradients(track_poses)?;
        numbers.extend(found.measures);
        let mut rows = family.input_rows();
        rows.extend(found.rows);
        Ok((numbers, rows))
    }
}

impl MinimaxProblem for Peaks<'_, '_> {
    fn values_at(&mut self, x: &[f64]) -> Option<PeakValues> {
        Some(self.evaluate(x, false)?.0)
    }

    fn gradients_at(&mut self, x: &[f64]) -> Option<(PeakValues, PeakGradients)> {
        self.evaluate(x, true)
    }

    /// By difference quotients: a guard has no derivatives, and none at all where it accepts.
    fn edge(&mut self, x: &[f64]) -> Option<TrustEdge> {
        let track_poses = self.evaluator.reach(&self.base, x).ok()?;
        let guard = self.guard.as_mut()?;
        let value = guard(&track_poses);
        if value <= 0.0 {
            return None;
        }
        let mut slope = vec![0.0; x.len()];
        let variables = self.evaluator.family().study.variables.iter();
        let steps: Vec<f64> = variables
            .map(|v| GUARD_STEP * (v.upper - v.lower))
            .collect();
        for (k, step) in steps.into_iter().enumerate() {
            // Towards the side on which the guard still has a value.
            let there = [step, -step].map(|h| {
                let mut moved = x.to_vec();
                moved[k] += h;
                let track_poses = self.evaluator.approach(&track_poses, &moved);
                (
                    h,
                    track_poses.map_or(0.0, |track_poses| guard(&track_poses)),
                )
            });
            let (h, other) = if there[0].1 >= there[1].1 {
                there[0]
            } else {
                there[1]
            };
            slope[k] = (other - value) / h;
        }
        Some(TrustEdge {
            x: x.to_vec(),
            value,
            slope,
        })
    }

    fn hides_kinks(&self) -> bool {
        self.hides_kinks
    }

    fn is_stopped(&self) -> bool {
        self.goes_on.is_some_and(|goes_on| !goes_on()) || self.evaluator.is_cancelled()
    }

    fn progress(&mut self, iteration: usize, x: &[f64], value: f64) -> bool {
        (self.watch)(iteration, x, value)
    }
}
