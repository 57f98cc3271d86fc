//! One step along the drive, and the ways through or up to a singular pose.

use super::{Follower, Stand};
use crate::kinematics::solve::branch::BranchState;
use crate::kinematics::solve::newton::{Correction, Pace};
use crate::kinematics::solve::predictor::{HIGHEST_ORDER, Prediction};
use crate::model::mechanism::Kind;

/// Largest correction of a prediction, in scaled unknowns. A larger one could have reached another branch.
const MAX_CORRECTION: f64 = 0.05;

/// A correction may be this fraction of the predicted step (plus a floor for tiny steps): the tangent is
/// then a good picture of the path.
const CORRECTION_OF_STEP: f64 = 0.25;

/// Floor of the above: corrections of this size are rounding at a badly conditioned pose.
const CORRECTION_FLOOR: f64 = 1e-9;

/// A step across a singular pose starts from the last pose whose smallest singular value is above this fraction
/// of the best seen; nearer to the singular pose the tangent is noise.
const TRUSTED_SIGMA: f64 = 1e-4;

/// Below this fraction of the best smallest singular value no tangent is taken from a pose: it has lost its last
/// digits. Folds are approached to the square of it.
const USABLE_SIGMA: f64 = 1e-6;

/// A sample this close to the end of the steps, in intervals between samples, is the singular pose itself.
const BESIDE: f64 = 1e-6;

/// The same in inputs, in radians and sizes: a drive that turns back on a fold lingers there. Steps end a little
/// nearer to a fold.
const BESIDE_INPUTS: f64 = 1e-11;

/// Longest stretch, in intervals between samples, over which a singular pose is crossed.
const LONGEST_CROSSING: f64 = 1.0;

impl Follower<'_> {
    /// One predictor-corrector step; `Ok(None)` where it cannot be trusted.
    ///
    /// From a singular pose no tangent is usable; the prediction then starts from the last trusted pose,
    /// which leads straight through, and the determinant may change its sign.
    pub(crate) fn step(&mut self, here: &Stand, time: f64) -> Result<Option<Stand>, usize> {
        let inputs = self.inputs(time)?;
        let usable = self.is_usable(&here.branch);
        let base = match &self.anchor {
            Some(anchor) if !usable => anchor.clone(),
            _ => here.clone(),
        };
        let order = if usable && self.is_trusted(&base.branch) {
            HIGHEST_ORDER
        } else {
            1
        };
        let (mut coordinates, predicted) = self.predict(&base, &inputs, order);
        let correction = self.correct(&mut coordinates, Pace::Brisk);
        let allowed =
            (CORRECTION_OF_STEP * predicted.length + CORRECTION_FLOOR).min(MAX_CORRECTION);
        // Measured from the tangent, whatever the order of the prediction.
        let is_near = correction.first_step + predicted.bend <= allowed;
        if !correction.converged || !is_near {
            return Ok(None);
        }
        self.rename(&base, time, &mut coordinates);
        let stand = self.stand(time, coordinates);
        let same = stand
            .branch
            .signs
            .iter()
            .zip(&base.branch.signs)
            .all(|(a, b)| a == b);
        let fine = same || !usable || !self.is_usable(&stand.branch);
        // On the way to a fold poses are hardly usable too; only a changed sign tells that the singular pose is behind.
        if fine && !usable && self.is_usable(&stand.branch) {
            if same {
                self.left_singular_sample();
            } else if !self.is_judging && self.is_joined(here, &stand) {
                self.passed(here.time);
            } else {
                return Ok(None);
            }
        }
        Ok(fine.then_some(stand))
    }

    /// Whether the tangent of a pose is worth anything.
    pub(crate) fn is_usable(&self, branch: &BranchState) -> bool {
        branch.sigma_min >= USABLE_SIGMA * self.best_sigma
    }

    /// Whether a pose is far enough from singular ones to predict from across one.
    fn is_trusted(&self, branch: &BranchState) -> bool {
        branch.sigma_min >= TRUSTED_SIGMA * self.best_sigma
    }

    pub(crate) fn correct(&mut self, coordinates: &mut [f64], pace: Pace) -> Correction {
        let correction = self
            .correct_in_chart(coordinates, pace)
            .unwrap_or_else(|| self.corrector.correct(self.system, coordinates, pace));
        self.iterations += correction.iterations;
        correction
    }

    /// Prediction at new inputs: the tangent, or a polynomial of higher order.
    pub(crate) fn predict(
        &mut self,
        here: &Stand,
        inputs: &[f64],
        order: usize,
    ) -> (Vec<f64>, Prediction) {
        if let Some((coordinates, length)) = self.predict_in_chart(here, inputs) {
            return (coordinates, Prediction { length, bend: 0.0 });
        }
        let mut coordinates = here.coordinates.clone();
        let prediction = self.predictor.predict(
            self.system,
            &mut self.corrector,
            &mut coordinates,
            inputs,
            order,
        );
        (coordinates, prediction)
    }

    /// A sample that lies on a singular pose itself is reached by a patient correction from right beside it.
    pub(crate) fn settle(&mut self, end: &Stand, time: f64) -> Option<Stand> {
        let inputs = self.inputs(time).ok()?;
        let n = self.system.mechanism().unknowns.len();
        let moved = self.inputs_apart(&end.coordinates[n..], &inputs);
        if time - end.time > BESIDE * self.interval && moved > BESIDE_INPUTS {
            return None;
        }
        let mut coordinates = [&end.coordinates[..n], &inputs].concat();
        let correction = self.correct(&mut coordinates, Pace::Patient);
        self.rename(end, time, &mut coordinates);
        (correction.converged && correction.first_step <= MAX_CORRECTION)
            .then(|| self.stand(time, coordinates))
    }

    /// Tries to go straight through a singular pose next to `end`: along the tangent of the last trusted pose, to
    /// a pose beyond that lies where the tangent says.
    pub(crate) fn cross(&mut self, end: &Stand, time: f64) -> Option<Stand> {
        let anchor = self.anchor.clone().filter(|a| a.time < end.time)?;
        let mut reach = (end.time - anchor.time) * 2.0;
        let limit = (LONGEST_CROSSING * self.interval).min(time - anchor.time);
        while reach <= limit * (1.0 + 1e-12) {
            let beyond = (anchor.time + reach).min(time);
            let inputs = self.inputs(beyond).ok()?;
            let (mut coordinates, predicted) = self.predict(&anchor, &inputs, 1);
            let correction = self.correct(&mut coordinates, Pace::Brisk);
            let allowed = (CORRECTION_OF_STEP * predicted.length).min(MAX_CORRECTION);
            if correction.converged && correction.first_step <= allowed && beyond > end.time {
                self.rename(&anchor, beyond, &mut coordinates);
                let stand = self.stand(beyond, coordinates);
                return self.is_joined(end, &stand).then_some(stand);
            }
            reach = if reach < limit {
                (reach * 2.0).min(limit)
            } else {
                reach * 2.0
            };
        }
        None
    }

    /// Whether poses join `end` to `beyond`. What looks like a crossing may be two folds that face each other over a
    /// narrow gap; there the way back ends at the other one, and nothing closes between them.
    fn is_joined(&mut self, end: &Stand, beyond: &Stand) -> bool {
        let anchor = self.anchor.clone();
        let kept = (self.last_kept.clone(), self.kept_before.clone());
        let singular_sample = self.singular_sample;
        // On the way back no singular pose is crossed: it is to end at the first one.
        self.is_judging = true;
        let first = self.walk_back(beyond, Some(end.time));
        self.is_judging = false;
        self.anchor = anchor;
        (self.last_kept, self.kept_before) = kept;
        self.singular_sample = singular_sample;
        let Some(first) = first else { return true };
        let time = 0.5 * (end.time + first.time);
        let Ok(inputs) = self.inputs(time) else {
            return false;
        };
        let n = self.system.mechanism().unknowns.len();
        let pairs = end.coordinates[..n].iter().zip(&first.coordinates);
        let mut coordinates: Vec<f64> = pairs.map(|(a, b)| 0.5 * (a + b)).collect();
        coordinates.extend(inputs);
        self.correct(&mut coordinates, Pace::Patient).converged
    }

    /// Largest difference of inputs in radians, sizes, and shares of numbers.
    fn inputs_apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).zip(&self.system.mechanism().inputs);
        let scaled = pairs.map(|((a, b), input)| {
            let unit = match input.kind {
                Kind::Angle => 1.0,
                Kind::Length => self.system.mechanism().size,
                Kind::Number => a.abs().max(b.abs()).max(f64::MIN_POSITIVE),
            };
            (a - b).abs() / unit
        });
        scaled.fold(0.0, f64::max)
    }

    /// Observes a closed pose.
    pub(crate) fn stand(&mut self, time: f64, coordinates: Vec<f64>) -> Stand {
        let branch = self.observe(&coordinates);
        if branch.sigma_min.is_finite() {
            self.best_sigma = self.best_sigma.max(branch.sigma_min);
        }
        Stand {
            time,
            coordinates,
            branch,
        }
    }

    /// Remembers an accepted pose as an anchor if it is well away from singular ones.
    pub(crate) fn keep(&mut self, stand: Stand) -> Stand {
        self.watch_gimbals(&stand);
        if self.is_trusted(&stand.branch) {
            self.renew_rows(&stand.coordinates);
            self.locate_crossing(&stand);
            self.anchor = Some(stand.clone());
        }
        stand
    }
}
