//! The way over a singular pose to which no tangent leads, as that of `x^7 = t^3` at zero: the path comes to it and leaves it
//! flat, and is closed within the tolerance all about.
//!
//! Poses straight beyond are guessed at several distances. One is taken only if the way back from it ends where the way there
//! did, and poses between close to rounding: two folds that face each other over a gap do not.

use super::path_tracker::{PathPoint, PathTracker, UpToSingular};
use super::singular::SingularTarget;
use crate::kinematics::solve::newton::Pace;

/// How far beyond the end poses are guessed, in ways and times from the last trusted pose to the end.
const STRIDES: [f64; 5] = [0.5, 1.0, 2.0, 4.0, 8.0];

/// Least cosine between the ways to the singular pose and from it.
const STRAIGHT: f64 = 0.9;

/// Residual of a guessed pose, in radians and sizes: rounding.
const CLOSED_TO_ROUNDING: f64 = 1e-14;

/// How much longer the way over a pose between two others may be than the straight one.
const DETOUR: f64 = 1.5;

impl PathTracker<'_> {
    /// A pose straight beyond the singular one at which all else ends, or at it if `time` is its time.
    pub fn pass_flat(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let anchor = self.anchor.clone()?;
        let way = end.time - anchor.time;
        let left = time - end.time;
        if self.is_trusted(&end.branch) || way * left <= 0.0 {
            return None;
        }
        // The last sample before it may be the singular pose itself.
        for stride in STRIDES {
            let there = match stride * way.abs() < left.abs() {
                true => end.time + stride * way,
                false => time,
            };
            for reach in STRIDES {
                let Some(found) = self.guessed([&anchor, end], reach, there) else {
                    continue;
                };
                let is_met = match self.is_usable(&found.branch) {
                    true => self.meets(end, &found),
                    false => there == time && self.is_filled(end, &found),
                };
                if is_met {
                    return Some(found);
                }
            }
            if there == time {
                break;
            }
        }
        let stays = self.guessed([&anchor, end], 0.0, time)?;
        let is_there = !self.is_usable(&stays.branch) && self.is_filled(end, &stays);
        is_there.then_some(stays)
    }

    /// The pose at `time` that is corrected from a guess straight beyond the second of two, if it lies straight beyond.
    fn guessed(
        &mut self,
        [anchor, end]: [&PathPoint; 2],
        reach: f64,
        time: f64,
    ) -> Option<PathPoint> {
        let inputs = self.inputs(time).ok()?;
        let n = self.unknowns();
        let pairs = anchor
            .coordinates
            .iter()
            .zip(end.coordinates.iter())
            .take(n);
        let mut coordinates: Vec<f64> = pairs.map(|(a, b)| b + reach * (b - a)).collect();
        coordinates.extend(inputs);
        let correction = self.solver.correct(&mut coordinates, Pace::Patient);
        if !correction.converged || correction.residual > CLOSED_TO_ROUNDING {
            return None;
        }
        let cosine = self.cosine(&anchor.coordinates, &end.coordinates, &coordinates);
        (cosine >= STRAIGHT).then(|| self.point(time, coordinates))
    }

    /// Whether the way back from `found` ends at the singular pose where the way to `end` did.
    fn meets(&mut self, end: &PathPoint, found: &PathPoint) -> bool {
        let mut scout = self.clone();
        let first = scout.walk_back(found, SingularTarget::Gap(end.time), &mut UpToSingular);
        self.solver.iterations = scout.solver.iterations;
        self.regularity.learn_from(&scout.regularity);
        // A motion that has no singular pose here is another one.
        first.is_some_and(|first| self.is_filled(end, &first))
    }

    /// Whether poses join two others, and lie between.
    fn is_filled(&mut self, a: &PathPoint, b: &PathPoint) -> bool {
        let a = &self.regular_before(a, b);
        let apart = self.solver.apart(&a.coordinates, &b.coordinates);
        let Some(between) = self.joining(a, b) else {
            return false;
        };
        between.iter().all(|middle| {
            let ways = [a, b].map(|end| self.solver.apart(&end.coordinates, middle));
            ways[0] + ways[1] <= DETOUR * apart
        })
    }

    /// The cosine between the ways from the first to the second pose and on to the third, in scaled unknowns.
    fn cosine(&self, a: &[f64], b: &[f64], c: &[f64]) -> f64 {
        let mechanism = self.system().mechanism();
        let mut sums = [0.0; 3];
        for slot in 0..self.unknowns() {
            let scale = mechanism.scale_of(slot);
            let [first, second] = [(b[slot] - a[slot]) / scale, (c[slot] - b[slot]) / scale];
            sums[0] += first * second;
            sums[1] += first * first;
            sums[2] += second * second;
        }
        sums[0] / (sums[1] * sums[2]).sqrt()
    }
}
