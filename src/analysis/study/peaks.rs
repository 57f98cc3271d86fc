//! A study whose objective is the largest value along a track, pose by pose: what a minimax search works on.

use super::{Evaluator, Family, FamilyError, Refusals, Rejection, Stand, Watch};
use crate::analysis::optimise::minimax::{Heights, Landscape, Slopes};
use crate::model::expression::Expression;
use crate::model::measure::{Measure, MeasureSource, Taking};

/// A family whose objective is the largest value or magnitude along a track.
pub struct Peaks<'f, 'w> {
    evaluator: Evaluator<'f>,
    base: Stand,
    base_merit: f64,
    peaks: Vec<Rows<'f>>,
    limits: Vec<Rows<'f>>,
    /// Limits of measures that are one number, as (measure, factor, shift).
    singles: Vec<(usize, f64, f64)>,
    /// Candidates that were refused.
    pub refusals: Refusals,
    watch: Box<Watch<'w>>,
}

/// The same formula at several poses: `factor · formula + shift`.
struct Rows<'a> {
    formula: &'a Expression,
    per: Option<usize>,
    poses: std::ops::Range<usize>,
    factor: f64,
    shift: f64,
}

/// The rows of a measure that is the largest or smallest value of a row of poses, once for each sign it looks at.
fn rows_of<'f>(family: &'f Family, measure: &'f Measure) -> Vec<Rows<'f>> {
    let MeasureSource::Over {
        track,
        of,
        per,
        taking,
        ..
    } = &measure.source
    else {
        return Vec::new();
    };
    let signs: &[f64] = match taking {
        Taking::Max => &[1.0],
        Taking::Min => &[-1.0],
        Taking::Largest => &[1.0, -1.0],
        _ => &[],
    };
    let rows = signs.iter().map(|sign| Rows {
        formula: &of[0],
        per: *per,
        poses: family.poses_of(*track),
        factor: *sign,
        shift: 0.0,
    });
    rows.collect()
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
        let measures = &family.mechanism.measures;
        let objective = family.study.objective.map(|index| &measures[index]);
        let peaks = objective.map(|m| rows_of(family, m)).unwrap_or_default();
        let is_least = peaks.len() == 1 && peaks[0].factor < 0.0;
        if peaks.is_empty() || is_least {
            let message =
                "minimax needs an objective that takes \"max\" or \"largest\" over a track";
            return Err(FamilyError::Lacks(message.to_owned()));
        }
        let (mut limits, mut singles) = (Vec::new(), Vec::new());
        for (index, measure) in measures.iter().enumerate() {
            for (bound, sign) in [(measure.max, 1.0), (measure.min, -1.0)] {
                let Some(bound) = bound else { continue };
                let size = if bound == 0.0 { 1.0 } else { bound.abs() };
                let mut rows = rows_of(family, measure);
                // Only the side that the extreme is on can be asked pose by pose.
                let fits =
                    rows.len() == 2 && sign > 0.0 || rows.len() == 1 && rows[0].factor == sign;
                if !fits {
                    singles.push((index, sign / size, -sign * bound / size));
                    continue;
                }
                for row in &mut rows {
                    (row.factor, row.shift) = (row.factor / size, -sign * bound / size);
                }
                limits.append(&mut rows);
            }
        }
        let base = evaluator.settled(start);
        Ok(Self {
            evaluator,
            base,
            base_merit: f64::INFINITY,
            peaks,
            limits,
            singles,
            refusals: Refusals::default(),
            watch,
        })
    }

    fn look(&mut self, x: &[f64], with_slopes: bool) -> Option<(Heights, Slopes)> {
        match self.look_or_refuse(x, with_slopes) {
            Ok(found) => Some(found),
            Err(rejection) => {
                self.refusals.count_one(&rejection);
                None
            }
        }
    }

    fn look_or_refuse(
        &mut self,
        x: &[f64],
        with_slopes: bool,
    ) -> Result<(Heights, Slopes), Rejection> {
        let stand = match with_slopes {
            true => self.evaluator.reach(&self.base, x)?,
            false => self.evaluator.approach(&self.base, x)?,
        };
        let shown = self.evaluator.shown(&stand);
        let mut scratch = Vec::new();
        let mut values = |list: &[Rows]| -> Vec<f64> {
            let mut all = Vec::new();
            for rows in list {
                let poses = shown[rows.poses.clone()].iter();
                all.extend(poses.map(|s| {
                    rows.factor * s.value(rows.formula, rows.per, &mut scratch) + rows.shift
                }));
            }
            all
        };
        let mut heights = Heights {
            peaks: values(&self.peaks),
            limits: values(&self.limits),
        };
        let mut slopes = Slopes {
            peaks: Vec::new(),
            limits: Vec::new(),
        };
        if with_slopes {
            let changes = self.evaluator.changes(&stand, &shown)?;
            let gather = |list: &[Rows]| -> Vec<Vec<f64>> {
                let mut all = Vec::new();
                for rows in list {
                    all.extend(rows.poses.clone().map(|pose| {
                        let mut row = vec![0.0; x.len()];
                        changes[pose].add(
                            rows.formula,
                            rows.per,
                            &shown[pose],
                            rows.factor,
                            &mut row,
                        );
                        row
                    }));
                }
                all
            };
            slopes.peaks = gather(&self.peaks);
            slopes.limits = gather(&self.limits);
        }
        if !self.singles.is_empty() {
            self.add_singles(&stand, with_slopes, &mut heights, &mut slopes)?;
        }
        let mut all = heights.peaks.iter().chain(&heights.limits);
        if !all.all(|v| v.is_finite()) {
            return Err(Rejection::NoValue("the objective".to_owned()));
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

    /// Limits of measures that are one number.
    fn add_singles(
        &self,
        stand: &Stand,
        with_slopes: bool,
        heights: &mut Heights,
        slopes: &mut Slopes,
    ) -> Result<(), Rejection> {
        let measures = if with_slopes {
            let found = self.evaluator.gradients(stand)?;
            for (measure, factor, _) in &self.singles {
                let row = found.rows[*measure].iter();
                slopes.limits.push(row.map(|d| d * factor).collect());
            }
            found.measures
        } else {
            self.evaluator.measure(stand)?.measures
        };
        let singles = self.singles.iter();
        heights
            .limits
            .extend(singles.map(|(m, factor, shift)| factor * measures[*m] + shift));
        Ok(())
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
