//! Passing a singular pose, stopping at it, and returning from it.

use super::path_tracker::{PathPoint, PathTracker, PathWatcher, Unwatched};
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::{MAX_CORRECTION, follows_prediction};
use crate::model::mechanism::Kind;

/// A sample this close to the end of the steps, in intervals between samples, is the singular pose itself.
const BESIDE: f64 = 1e-6;

/// The same in inputs, in radians and sizes: a drive that turns back on a fold lingers there. Steps end a little
/// nearer to a fold.
const BESIDE_INPUTS: f64 = 1e-11;

/// Longest stretch, in intervals between samples, over which a singular pose is crossed.
const LONGEST_CROSSING: f64 = 1.0;

/// A reach beyond the limit by rounding is still within it.
const SAME_REACH: f64 = 1.0 + 1e-12;

/// How far beyond a kink the next pose is looked for, in intervals between samples, and how far the unknowns may move
/// there, in scaled unknowns: an inverse cosine near its end is known to 1e-8.
const HOPS: [f64; 4] = [1e-6, 1e-7, 1e-8, 1e-9];
const LONGEST_HOP: f64 = 1e-5;

/// The same behind a kink where a formula has no finite rate, as a root has at zero: the pose moves far in no time, and less
/// by a thousandth of the time, by a factor that steps of rounding and jumps do not have.
const STEEP_HOPS: [f64; 3] = [1e-12, 1e-9, 1e-6];
const LONGEST_STEEP: f64 = 0.1;
const STEEP_GROWTH: f64 = 2.0;

/// A crossing is looked for at no more than this many distances: as many as there are bits in the last step.
const MOST_REACHES: usize = 64;

/// A gap is seen if it is wider than this power of one half of the way on which it is looked for.
const HALVINGS: i32 = 30;

/// How far from its end the other of two branches that meet there is looked for, as shares of what was followed back:
/// as far as mirroring at the fold is a good picture of it.
const BESIDE_FOLD: [f64; 5] = [3e-2, 3e-3, 3e-4, 3e-5, 3e-6];

/// The end of a return path.
#[derive(Clone, Copy, Debug)]
pub enum SingularTarget {
    /// A time.
    Time(f64),
    /// A time before which there may be a gap, however narrow: it is approached by ever shorter stretches.
    Gap(f64),
}

impl PathTracker<'_> {
    /// A sample that lies on a singular pose itself is reached by a patient correction from a pose right before it.
    pub fn settle(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let inputs = self.inputs(time).ok()?;
        let n = self.unknowns();
        let moved = self.inputs_apart(&end.coordinates[n..], &inputs);
        let is_beside = time - end.time <= BESIDE * self.interval;
        // A drive may have come back to the same inputs.
        if !is_beside && (moved > BESIDE_INPUTS || self.strays(end, time, &inputs)) {
            return None;
        }
        let mut coordinates = [&end.coordinates[..n], &inputs].concat();
        let correction = self.solver.correct(&mut coordinates, Pace::Patient);
        self.rename(end, time, &mut coordinates);
        (correction.converged && correction.first_step <= MAX_CORRECTION)
            .then(|| self.point(time, coordinates))
    }

    /// Tries to go straight through a singular pose next to `end`: along the tangent of the last trusted pose, to
    /// a pose beyond that lies where the tangent says.
    pub fn cross(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let anchor = self.anchor.clone().filter(|a| a.time < end.time)?;
        let mut reach = (end.time - anchor.time) * 2.0;
        let limit = (LONGEST_CROSSING * self.interval).min(time - anchor.time);
        for _ in 0..MOST_REACHES {
            if reach > limit * SAME_REACH {
                break;
            }
            // The tangent of the last good point reaches over the singular pose.
            let beyond = (anchor.time + reach).min(time);
            let inputs = self.inputs(beyond).ok()?;
            if self.strays(&anchor, beyond, &inputs) {
                return None;
            }
            let (mut coordinates, predicted) = self.solver.predict(&anchor.coordinates, &inputs, 1);
            let correction = self.solver.correct(&mut coordinates, Pace::Brisk);
            if follows_prediction(&correction, &predicted) && beyond > end.time {
                self.rename(&anchor, beyond, &mut coordinates);
                let point = self.point(beyond, coordinates);
                return Some(point);
            }
            reach = if reach < limit {
                (reach * 2.0).min(limit)
            } else {
                reach * 2.0
            };
        }
        None
    }

    /// Over a kink of a formula, or the steps that its rounding makes: the pose right beyond is the nearest one, and the
    /// Jacobian is as regular there as before.
    pub fn hop(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        if !self.is_trusted(&end.branch) {
            return None;
        }
        let mut hops = HOPS.iter();
        let near = hops.find_map(|share| self.beside(end, (share, time), LONGEST_HOP));
        near.or_else(|| self.steep_hop(end, time))
    }

    /// Over a kink beyond which the pose has no finite rate: ever farther, from where the path is still near.
    fn steep_hop(&mut self, end: &PathPoint, time: f64) -> Option<PathPoint> {
        let (mut here, mut far) = (end.clone(), 0.0);
        for share in &STEEP_HOPS {
            let next = self.beside(&here, (share, time), LONGEST_STEEP)?;
            let apart = self.solver.apart(&next.coordinates, &end.coordinates);
            if apart < STEEP_GROWTH * far {
                return None;
            }
            (here, far) = (next, apart);
        }
        Some(here)
    }

    /// The pose that is next to another, a share of the interval between two samples behind it but not beyond `time`, and as
    /// regular.
    fn beside(
        &mut self,
        here: &PathPoint,
        (share, time): (&f64, f64),
        longest: f64,
    ) -> Option<PathPoint> {
        let n = self.unknowns();
        let beyond = here.time + (share * self.interval).min(time - here.time);
        let inputs = self.inputs(beyond).ok()?;
        // Corrected from the pose itself, without a prediction.
        let mut coordinates = [&here.coordinates[..n], &inputs].concat();
        let correction = self.solver.correct(&mut coordinates, Pace::Brisk);
        if !correction.converged || correction.first_step > longest {
            return None;
        }
        let point = self.point(beyond, coordinates);
        // As regular as before, on the same branch: nothing was crossed.
        let ratio = point.branch.sigma_min / here.branch.sigma_min;
        let is_alike = point.branch.signs == here.branch.signs && (0.5..=2.0).contains(&ratio);
        (beyond > here.time && is_alike).then_some(point)
    }

    /// Whether the motion may go on from `end`, where steps ended, at `beyond`: no formula jumps between them, and poses
    /// join them over a singular one.
    pub(crate) fn continues(&mut self, end: &PathPoint, beyond: &PathPoint) -> bool {
        self.is_smooth(end, beyond) && (self.is_trusted(&end.branch) || self.is_joined(end, beyond))
    }

    /// Whether poses join the last regular one before `end` to `beyond`. What looks like a crossing may be two folds that face
    /// each other over a narrow gap, in which nothing closes; `end` may be behind it, since nearly singular poses close nearly.
    pub(crate) fn is_joined(&mut self, end: &PathPoint, beyond: &PathPoint) -> bool {
        let from = self.regular_before(end, beyond);
        self.joining(&from, beyond).is_some()
    }

    /// The last regular pose before `end` on the way to `beyond`, or `end` itself.
    pub(super) fn regular_before(&self, end: &PathPoint, beyond: &PathPoint) -> PathPoint {
        let is_before = |a: &&PathPoint| (end.time - a.time) * (beyond.time - end.time) > 0.0;
        self.anchor
            .as_ref()
            .filter(is_before)
            .unwrap_or(end)
            .clone()
    }

    /// Follows the motion backwards from `found` to where it ends; `None` if it reaches the target.
    pub fn walk_back(
        &mut self,
        found: &PathPoint,
        target: SingularTarget,
        watcher: &mut dyn PathWatcher,
    ) -> Option<PathPoint> {
        self.anchor = Some(found.clone());
        let (time, halvings) = match target {
            SingularTarget::Time(time) => (time, 0),
            SingularTarget::Gap(time) => (time, HALVINGS),
        };
        let way = found.time - time;
        let mut stops = (1..=halvings).map(|k| time + way * 0.5_f64.powi(k));
        let end = stops.try_fold(found.clone(), |here, stop| self.follow(here, stop, watcher));
        let end = end.and_then(|here| self.follow(here, time, watcher));
        end.err().map(|stop| stop.last())
    }

    /// The other of the two branches that meet at the fold `first`, with the signs of `wanted`, at the time of `found`.
    pub fn other_branch(
        &mut self,
        first: &PathPoint,
        found: &PathPoint,
        wanted: &[i8],
    ) -> Option<PathPoint> {
        let other = BESIDE_FOLD.iter().find_map(|share| {
            let time = first.time + share * (found.time - first.time);
            let mirrored = self.mirrored(first, found, time)?;
            (*mirrored.branch.signs == *wanted).then_some(mirrored)
        })?;
        self.anchor = Some(other.clone());
        self.follow(other, found.time, &mut Unwatched).ok()
    }

    /// The pose at `time` of the branch that `found` is not on, mirrored at the fold where both begin.
    fn mirrored(&mut self, fold: &PathPoint, found: &PathPoint, time: f64) -> Option<PathPoint> {
        self.anchor = Some(found.clone());
        let followed = self.follow(found.clone(), time, &mut Unwatched).ok()?;
        let mut coordinates = followed.coordinates.to_vec();
        let n = self.unknowns();
        for (q, fold) in coordinates[..n].iter_mut().zip(fold.coordinates.iter()) {
            *q = 2.0 * fold - *q;
        }
        self.corrected(time, coordinates, Pace::Brisk)
    }

    /// Largest difference of inputs in radians, sizes, and shares of numbers.
    fn inputs_apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let mechanism = self.system().mechanism();
        let slots = mechanism.unknowns.len()..;
        let scaled = slots.zip(a.iter().zip(b)).map(|(slot, (a, b))| {
            let unit = match mechanism.kind_of(slot) {
                Kind::Angle => 1.0,
                Kind::Length => mechanism.scale_of(slot),
                Kind::Number => a.abs().max(b.abs()).max(f64::MIN_POSITIVE),
            };
            (a - b).abs() / unit
        });
        scaled.fold(0.0, f64::max)
    }
}
