//! Jumps, recognised from the formulas and not from their size: of an input, where the drive is discontinuous although poses
//! exist on both sides, and of formulas in loops and equations, at which the motion ends.

use super::jump_sites::FormulaBehaviour;
use super::path_tracker::{PathPoint, PathTracker, SMALLEST_STEP, Unwatched};
use crate::model::actuation::Actuation;

impl PathTracker<'_> {
    /// What the formulas of loops and equations do between two poses.
    pub(crate) fn way_between(&self, from: &[f64], to: &[f64]) -> FormulaBehaviour<'_> {
        FormulaBehaviour::between(&self.jump_sites, from, to)
    }

    /// Whether no formula jumps between two poses, as far as can be decided.
    pub(crate) fn is_smooth(&self, from: &PathPoint, to: &PathPoint) -> bool {
        let way = self.way_between(&from.coordinates, &to.coordinates);
        !matches!(way, FormulaBehaviour::Jumps(_))
    }

    /// The inputs right after a pose, and the time then, if the drive jumps there.
    pub fn jump_after(&self, point: &PathPoint) -> Option<(f64, Vec<f64>)> {
        let step = (4.0 * SMALLEST_STEP * self.interval).max(4.0 * f64::EPSILON * point.time.abs());
        let time = point.time + step;
        let inputs = self.inputs(time).ok()?;
        let jumps = self.actuation().jumps_between(point.time, time);
        jumps.is_any().then_some((time, inputs))
    }

    /// Across a jump of the drive the motion is followed along a straight line from the old inputs to the new ones,
    /// not beyond `last`.
    pub fn leap(&mut self, point: &PathPoint, last: f64) -> Option<PathPoint> {
        let (mut time, mut inputs) = self.jump_after(point)?;
        if time > last {
            time = last;
            inputs = self.inputs(time).ok()?;
        }
        if time <= point.time {
            return None;
        }
        // Across a jump the inputs are led along a straight line.
        let n = self.unknowns();
        let guess = self.actuation().guess.clone();
        let bridge = Actuation::straight(&point.coordinates[n..], &inputs, guess);
        let cancelled = || self.is_cancelled();
        let mut tracker = PathTracker::new(self.system(), &bridge, &cancelled);
        // A drive may jump millions of times: its leaps take from the steps of the motion.
        tracker.budget = self.budget.clone();
        let begin = tracker.point(0.0, point.coordinates.clone());
        let begin = tracker.keep(begin, &mut Unwatched);
        let end = tracker.follow(begin, 1.0, &mut Unwatched);
        let iterations = tracker.solver.iterations;
        let end = end.ok()?;
        let mut coordinates = end.coordinates.to_vec();
        coordinates[n..].copy_from_slice(&inputs);
        self.solver.iterations += iterations;
        Some(self.point(time, coordinates))
    }
}
