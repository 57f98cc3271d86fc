//! Inputs that jump: the drive gives no way on there, though poses exist.

use super::path_tracker::{PathPoint, PathTracker, SMALLEST_STEP, Unwatched};
use crate::model::actuation::Actuation;
use crate::model::mechanism::Kind;

/// Change of an input, relative to its size, that two times a few smallest steps apart cannot make in a smooth drive.
const JUMP: f64 = 1e-6;

/// Nor can it be this many times what the rates at the two times make it: on its way through zero an input has no size.
const FASTER: f64 = 100.0;

impl PathTracker<'_> {
    /// The inputs right after a pose, and the time then, if the drive jumps there.
    pub fn jump_after(&self, point: &PathPoint) -> Option<(f64, Vec<f64>)> {
        let step = (4.0 * SMALLEST_STEP * self.interval).max(4.0 * f64::EPSILON * point.time.abs());
        let time = point.time + step;
        let inputs = self.inputs(time).ok()?;
        let before = &point.coordinates[self.unknowns()..];
        let mechanism = self.system().mechanism();
        let least = |slot: usize| match mechanism.kind_of(slot) {
            Kind::Length => JUMP * mechanism.scale_of(slot),
            Kind::Angle | Kind::Number => JUMP * mechanism.size,
        };
        let actuation = self.actuation();
        let rates = actuation.rates_at(point.time);
        let rates = rates.into_iter().zip(actuation.rates_at(time));
        let pairs = (self.unknowns()..).zip(before.iter().zip(&inputs));
        let mut jumps = pairs.zip(rates).map(|((slot, (a, b)), (before, after))| {
            let smooth = FASTER * step * (before.abs() + after.abs());
            let change = (a - b).abs();
            // Rates that are no numbers say nothing.
            change > JUMP * a.abs().max(b.abs()).max(least(slot))
                && (smooth.is_nan() || change > smooth)
        });
        jumps.any(|jump| jump).then_some((time, inputs))
    }

    /// Over a jump of the drive the motion is followed as if the inputs went straight from their old values to the new;
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
