//! Gimbal lock of a ball joint in a regular mechanism.

use super::events::Events;
use crate::kinematics::ball::joint::Ball;
use crate::kinematics::motion::tracker::path_tracker::{PathPoint, PathTracker};
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::newton::Pace;
use glam::DVec2;

/// Largest distance from a locked pose that is reported, as the cosine of the middle angle measured from perpendicular
/// axes: the angles then change a thousand times faster than the joint.
const NEAR_LOCK: f64 = 1e-3;

/// A ball joint this near to its lock is locked: the rest is rounding.
const LOCKED: f64 = 1e-12;

/// Distance of the straight line between two poses below which it is examined.
const WORTH_A_LOOK: f64 = 0.05;

/// Closest approaches of one joint within this fraction of the motion are merged.
const SAME_LOCK: f64 = 1e-6;

/// Iterations that locate the closest approach: it is a linear problem but for the curvature of the path.
const LOCATING: usize = 12;

/// Distance of the second pose that tells the direction of the path, as a fraction of the step: that of the last change,
/// but no nearer than rounding and no farther than the path is straight.
const BESIDE: [f64; 2] = [1e-9, 1e-3];

/// A change of the place below this fraction of the step is rounding.
const SETTLED: f64 = 1e-15;

impl Events {
    /// Reports ball joints whose angles were locked, or nearly so, since the previous pose.
    pub(crate) fn watch_locks(&mut self, tracker: &mut PathTracker, point: &PathPoint) {
        let before = tracker.recent[0].clone();
        for ball in tracker.system().balls() {
            let from = before.as_ref().unwrap_or(point);
            if !ball.may_have_locked(&from.coordinates, &point.coordinates) {
                continue;
            }
            let now = ball.lock(&point.coordinates);
            let Some(before) = &before else {
                if now.length() <= NEAR_LOCK {
                    self.report_lock(tracker, ball, point.time, now.length());
                }
                continue;
            };
            let then = ball.lock(&before.coordinates);
            let (part, distance) = closest_approach(then, now);
            // On the way to a lock the closest pose is still to come; after it, it has been reported.
            let still_coming = part >= 1.0 && now.length() > LOCKED;
            if distance > WORTH_A_LOOK || part <= 0.0 || still_coming || then.length() <= LOCKED {
                continue;
            }
            let (time, distance) = locate_lock(tracker, ball, [before, point], part);
            let is_inside =
                time > before.time.min(point.time) && time <= before.time.max(point.time);
            if distance <= NEAR_LOCK && is_inside {
                self.report_lock(tracker, ball, time, distance);
            }
        }
    }

    fn report_lock(&mut self, tracker: &PathTracker, ball: &Ball, time: f64, distance: f64) {
        let unknowns = &tracker.system().mechanism().unknowns;
        let names = ball.slots.map(|slot| unknowns[slot].name.clone());
        let again = SAME_LOCK * tracker.actuation().duration;
        let known = self.list.iter().rev().any(|event| {
            let is_same =
                matches!(&event.kind, EventKind::GimbalLock { names: n, .. } if *n == names);
            is_same && (event.time - time).abs() <= again
        });
        if !known {
            let kind = EventKind::GimbalLock { names, distance };
            self.add(tracker.actuation(), time, kind);
        }
    }
}

/// Poses between two others, each predicted from the nearest known one.
struct PoseInterpolation<'t, 's> {
    tracker: &'t mut PathTracker<'s>,
    ball: &'t Ball,
    start: f64,
    span: f64,
    /// Part of the way, and coordinates.
    known: Vec<(f64, Vec<f64>)>,
}

impl PoseInterpolation<'_, '_> {
    /// The two numbers that vanish where the angles are locked, at the fraction `s` of the way.
    fn lock_at(&mut self, s: f64) -> Option<DVec2> {
        let near = |x: &&(f64, Vec<f64>), y: &&(f64, Vec<f64>)| {
            (x.0 - s).abs().total_cmp(&(y.0 - s).abs())
        };
        let (at, base) = self.known.iter().min_by(near)?;
        if *at == s {
            return Some(self.ball.lock(base));
        }
        let inputs = self.tracker.inputs(self.start + s * self.span).ok()?;
        let iterations = self.tracker.solver.iterations;
        // Tangent from the nearest known pose, then Newton; its iterations do not count for the motion.
        let (mut coordinates, _) = self.tracker.solver.predict(base, &inputs, 1);
        let correction = self.tracker.solver.correct(&mut coordinates, Pace::Patient);
        self.tracker.solver.iterations = iterations;
        let lock = self.ball.lock(&coordinates);
        self.known.push((s, coordinates));
        correction.converged.then_some(lock)
    }
}

/// Time and size of the closest approach between two poses, starting from the estimate of the straight line.
fn locate_lock(
    tracker: &mut PathTracker,
    ball: &Ball,
    [a, b]: [&PathPoint; 2],
    part: f64,
) -> (f64, f64) {
    let span = b.time - a.time;
    let mut between = PoseInterpolation {
        tracker,
        ball,
        start: a.time,
        span,
        known: vec![(0.0, a.coordinates.to_vec()), (1.0, b.coordinates.to_vec())],
    };
    let (mut s, mut best) = (part, (part, f64::INFINITY));
    let mut step = BESIDE[1];
    for _ in 0..LOCATING {
        let Some(here) = between.lock_at(s) else {
            break;
        };
        if here.length() < best.1 {
            best = (s, here.length());
        }
        // The path's direction from a second pose beside; the closest point of that line is the next guess.
        let beside = if s + step > 1.0 { s - step } else { s + step };
        let Some(there) = between.lock_at(beside) else {
            break;
        };
        let direction = (there - here) / (beside - s);
        let change = -here.dot(direction) / direction.length_squared();
        if !change.is_finite() || change.abs() < SETTLED {
            break;
        }
        s = (s + change).clamp(0.0, 1.0);
        step = change.abs().clamp(BESIDE[0], BESIDE[1]);
    }
    // The proof of the pose shares the last observation.
    let _ = tracker.solver.observe(&b.coordinates);
    (a.time + best.0 * span, best.1)
}

/// Where the straight line from a to b comes closest to the origin, as a fraction of it, and its distance.
fn closest_approach(a: DVec2, b: DVec2) -> (f64, f64) {
    let way = b - a;
    let part = (-a.dot(way) / way.length_squared()).clamp(0.0, 1.0);
    let part = if part.is_nan() { 0.0 } else { part };
    (part, (a + way * part).length())
}
