//! Excluded pairs of a check: examined as densely as the motion itself is described, although nothing is proved about them.
//!
//! They are measured at every sample and in the middle of every interval of the motion (fast motions have many), and
//! in decreasing steps around the smallest distance found.

use super::motion::ProvedMotion;
use super::sweep::{Least, NearestPose, PairSweep};
use super::track::PairTrack;
use crate::distance::bodies::nearest_bodies;

/// Steps from the smallest distance found to smaller ones, each half the previous: down to 1e-4 of an interval.
pub(super) const HALVINGS: u32 = 13;

/// The same for close decisions: the error of a minimum is quadratic in the step.
const FINE_HALVINGS: u32 = 26;

/// At the end of an interval a drive may jump, so that the pose of that instant is another one: no location is closer to the
/// ends, although the smallest distance may lie there.
const INNERMOST: f64 = 1.0 - 1e-8;

impl PairSweep<'_> {
    /// The least distance over the whole motion as a search finds it, without a bound.
    pub(super) fn searched(&self, motion: &mut ProvedMotion) -> Option<Least> {
        let samples = motion.samples.clone();
        let mut best = self.best_of(motion, &samples, None)?;
        if let Some(stretch) = self.lowest_middle(motion, &best) {
            self.descend(motion, (stretch, 0.0), [-1.0, 1.0], HALVINGS, &mut best);
        }
        for place in places_of(motion, best.instant) {
            self.descend(motion, place, [-1.0, 1.0], HALVINGS, &mut best);
        }
        let bound = best.found.proximity.distance;
        Some(self.least(motion, &best, bound, [false; 2]))
    }

    /// The stretch in whose middle the bodies are nearest, if that is nearer than at the samples.
    fn lowest_middle(&self, motion: &ProvedMotion, best: &NearestPose) -> Option<usize> {
        let mut limit = best.found.proximity.distance - self.slack();
        let mut track = PairTrack::new(self.hulls, &self.left_out);
        let mut lowest = None;
        for index in 0..motion.roots {
            let pose = self
                .chain
                .around(&motion.stretches[index].arguments, 0.0, 0.0)
                .pose;
            // Poses that cannot be lower are skipped by their track.
            let found = track.at(&pose, limit);
            if let Some(found) = found.filter(|f| f.proximity.distance < limit) {
                (limit, lowest) = (found.proximity.distance - self.slack(), Some(index));
            }
        }
        lowest
    }

    /// Goes from a place of a stretch to the lowest one that is found from there, to nearly all digits.
    pub(super) fn descend_finely(
        &self,
        motion: &mut ProvedMotion,
        place: (usize, f64),
        best: &mut NearestPose,
    ) {
        self.descend(motion, place, [-1.0, 1.0], FINE_HALVINGS, best);
    }

    /// Goes from a place of a stretch to lower ones within a part of it, down to the last of so many halvings of that part.
    pub(super) fn descend(
        &self,
        motion: &mut ProvedMotion,
        (stretch, start): (usize, f64),
        ends: [f64; 2],
        halvings: u32,
        best: &mut NearestPose,
    ) {
        let [low, high] = [ends[0].max(-INNERMOST), ends[1].min(INNERMOST)];
        // Only an end of the stretch belongs to that part.
        if low >= high {
            return;
        }
        let arguments = &motion.stretches[stretch].arguments;
        let mut track = PairTrack::new(self.hulls, &self.left_out);
        // Distances above the limit, except for rounding, are irrelevant.
        let mut distance = |s: f64, limit: f64| {
            let pose = self.chain.around(arguments, s, 0.0).pose;
            let found = track.at(&pose, limit - self.slack());
            found.map_or(f64::INFINITY, |f| f.proximity.distance)
        };
        // Compass search along the stretch, with steps that are halved.
        let (mut at, mut lowest) = (start, distance(start, f64::INFINITY));
        for halving in 1..=halvings {
            let step = 0.5 * (high - low) * 0.5_f64.powi(halving as i32);
            for s in [at - step, at + step].map(|s| s.max(low).min(high)) {
                let value = distance(s, lowest);
                if value < lowest {
                    (at, lowest) = (s, value);
                }
            }
        }
        let Some(instant) = motion.pose_at(stretch, at) else {
            return;
        };
        let pose = self.relative(motion, instant);
        let found = nearest_bodies(self.hulls[0], self.hulls[1], &pose, &self.left_out);
        if let Some(found) = found.filter(|f| f.proximity.distance < best.found.proximity.distance)
        {
            *best = NearestPose {
                found,
                instant,
                ..*best
            };
        }
    }
}

/// The stretches that contain the time of an instant, and where on them that is.
pub(super) fn places_of(motion: &ProvedMotion, instant: usize) -> Vec<(usize, f64)> {
    let time = motion.instants[instant].time;
    let place = |root: usize| {
        let [start, end] = motion.times(root, [-1.0, 1.0]);
        let is_there = start <= time && time <= end && start < end;
        is_there.then(|| (root, place_at(motion, root, time)))
    };
    (0..motion.roots).filter_map(place).collect()
}

/// Where a time is on a stretch; at an end of it for times before or after it.
pub(super) fn place_at(motion: &ProvedMotion, stretch: usize, time: f64) -> f64 {
    let [start, end] = motion.times(stretch, [-1.0, 1.0]);
    ((2.0 * time - start - end) / (end - start)).clamp(-1.0, 1.0)
}
