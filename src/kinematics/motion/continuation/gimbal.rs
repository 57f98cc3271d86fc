//! Passing poses where the angles of a ball joint are locked though the mechanism is not, and saying where they are.
//!
//! Next to such a pose everything is solved in a [`Chart`]; the scene's angles are read
//! from the result so that they go on smoothly.

use super::{Follower, Stand};
use crate::kinematics::ball::chart::Chart;
use crate::kinematics::certificate::Certifier;
use crate::kinematics::results::certificate::{Certificate, Reason};
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::assembly::{Assembled, NotClosed, assemble};
use crate::kinematics::solve::branch::BranchState;
use crate::kinematics::solve::newton::{Correction, Corrector, Pace};
use glam::DVec2;

/// Closest approach to a locked pose that is reported, as the cosine between the first and the last axis' plane and
/// the middle angle: the angles then turn a thousand times faster than the joint.
const NEAR_LOCK: f64 = 1e-3;

/// A ball joint this near to its lock is locked: what is left is rounding.
const LOCKED: f64 = 1e-12;

/// Approach of the straight line between two poses that is looked at more closely.
const WORTH_A_LOOK: f64 = 0.05;

/// Closest approaches of one joint within this share of the motion are the same: a start beside a lock, and the lock.
const SAME_LOCK: f64 = 1e-6;

/// Iterations that locate the closest approach: it is a linear problem but for the curvature of the path.
const LOCATING: usize = 12;

impl Follower<'_> {
    /// Assembles from the scene's angles, and where they fail in the chart.
    pub(crate) fn assembled(
        &mut self,
        start: &[f64],
        persist: bool,
    ) -> Result<Assembled, NotClosed> {
        let system = self.system;
        let found = assemble(system, &mut self.corrector, start, persist);
        let Some(chart) = &self.chart else {
            return found;
        };
        let mut found = match found {
            Ok(found) => found,
            Err(gap) => {
                let own = chart.base(start);
                let mut corrector = Corrector::new(chart.system);
                let again = assemble(chart.system, &mut corrector, &own, persist);
                let again = again.map_err(|_| gap)?;
                let coordinates = chart.scene(&again.coordinates, start);
                Assembled {
                    coordinates,
                    ..again
                }
            }
        };
        // Angles that run into a locked pose get there with half of the digits.
        let correction = self.correct(&mut found.coordinates, Pace::Patient);
        found.iterations += correction.iterations;
        Ok(found)
    }

    /// Newton's method in the chart, if there is need for it.
    pub(crate) fn correct_in_chart(
        &mut self,
        coordinates: &mut [f64],
        pace: Pace,
    ) -> Option<Correction> {
        let chart = self.chart.as_ref().filter(|c| c.is_needed(coordinates))?;
        let mut own = chart.base(coordinates);
        let mut corrector = Corrector::new(chart.system);
        let correction = corrector.correct(chart.system, &mut own, pace);
        let found = chart.scene(&own, coordinates);
        coordinates.copy_from_slice(&found);
        Some(correction)
    }

    /// Prediction in the chart, if there is need for it: new coordinates and the length of the step.
    pub(crate) fn predict_in_chart(
        &mut self,
        here: &Stand,
        inputs: &[f64],
    ) -> Option<(Vec<f64>, f64)> {
        let chart = self
            .chart
            .as_ref()
            .filter(|c| c.is_needed(&here.coordinates))?;
        let n = chart.system.mechanism().unknowns.len();
        let own = chart.base(&here.coordinates);
        let mut change = vec![0.0; own.len()];
        for (k, input) in inputs.iter().enumerate() {
            change[n + k] = input - own[n + k];
        }
        let mut corrector = Corrector::new(chart.system);
        corrector.tangent(chart.system, &own, &mut change);
        let scaled = (0..n).map(|k| (change[k] / chart.system.mechanism().scale_of(k)).abs());
        let length = scaled.fold(0.0, f64::max);
        let moved: Vec<f64> = own.iter().zip(&change).map(|(q, d)| q + d).collect();
        let mut coordinates = chart.scene(&moved, &here.coordinates);
        coordinates[n..].copy_from_slice(inputs);
        Some((coordinates, length))
    }

    /// Gives angles that are nearly locked the values in which they go on smoothly from the stands before.
    pub(crate) fn rename(&self, base: &Stand, time: f64, coordinates: &mut [f64]) {
        let needed = |chart: &&Chart| chart.is_needed(coordinates);
        let Some(chart) = self.chart.as_ref().filter(needed) else {
            return;
        };
        let near: Vec<f64> = match &self.kept_before {
            Some(before) if before.time != base.time => {
                let part = (time - base.time) / (base.time - before.time);
                let pairs = base.coordinates.iter().zip(&before.coordinates);
                pairs.map(|(q, p)| q + part * (q - p)).collect()
            }
            _ => base.coordinates.clone(),
        };
        chart.rename(coordinates, &near);
    }

    /// Has the rows of over-determined blocks replaced where they are worn out.
    pub(crate) fn renew_rows(&mut self, coordinates: &[f64]) {
        if self.chart.is_none() {
            let system = self.system;
            self.watch.renew(system, &mut self.corrector, coordinates);
        }
    }

    /// Singular values and signs, with ball joints as rotations: no angle's sign enters, and next to locked poses no
    /// angle's singularity.
    pub(crate) fn observe(&mut self, coordinates: &[f64]) -> BranchState {
        let Some(chart) = &self.chart else {
            let system = self.system;
            return self.watch.observe(system, &mut self.corrector, coordinates);
        };
        if chart.is_needed(coordinates) {
            let own = chart.base(coordinates);
            let mut corrector = Corrector::new(chart.system);
            return self.watch.observe(chart.system, &mut corrector, &own);
        }
        let system = self.system;
        let mut state = self.watch.observe(system, &mut self.corrector, coordinates);
        for ball in chart.balls {
            state.signs[ball.block] *= ball.orientation(coordinates);
        }
        state
    }

    /// The certificate of a pose, which it may move within its error; what fails for the angles alone is called by its
    /// name.
    pub(crate) fn certified(&mut self, coordinates: &mut [f64]) -> Certificate {
        let needed = self
            .chart
            .as_ref()
            .is_some_and(|c| c.is_needed(coordinates));
        if needed {
            // The pose was observed in the chart; the proof is about the scene's angles.
            let system = self.system;
            let _ = self.watch.observe(system, &mut self.corrector, coordinates);
        }
        let Some(certifier) = &mut self.certifier else {
            return Certificate::Refused {
                reason: Reason::NotAsked,
            };
        };
        // Poses beside this one may have been looked at since it was observed.
        self.corrector.prepare(self.system, coordinates);
        let certificate = certifier.polish(coordinates, self.watch.bases(), &self.corrector);
        let is_singular = Certificate::Refused {
            reason: Reason::Singular,
        };
        if needed && certificate == is_singular {
            return self.certified_in_chart(coordinates);
        }
        certificate
    }

    /// The certificate of a pose whose angles are too nearly locked to have one: of the joints' rotations.
    fn certified_in_chart(&mut self, coordinates: &[f64]) -> Certificate {
        let locked = Certificate::Refused {
            reason: Reason::GimbalLock,
        };
        let Some(chart) = &self.chart else {
            return locked;
        };
        let own = chart.base(coordinates);
        let mut certifier = Certifier::new(chart.system);
        match certifier.certify(&own, self.watch.bases()) {
            Certificate::Certified {
                error_bound,
                unique_radius,
            } => Certificate::Locked {
                error_bound,
                unique_radius,
            },
            _ => locked,
        }
    }

    /// Rates of the unknowns in the chart, if there is need for it; `rates` holds those of the inputs in its tail.
    pub(crate) fn rates_in_chart(&mut self, coordinates: &[f64], rates: &mut [f64]) -> Option<()> {
        let chart = self.chart.as_ref().filter(|c| c.is_needed(coordinates))?;
        let own = chart.base(coordinates);
        let mut own_rates = rates.to_vec();
        // What the chart is based on stands still.
        own_rates.resize(own.len(), 0.0);
        let mut corrector = Corrector::new(chart.system);
        corrector.tangent(chart.system, &own, &mut own_rates);
        rates.copy_from_slice(&own_rates[..rates.len()]);
        chart.scene_rates(coordinates, rates);
        Some(())
    }

    /// Reports ball joints whose angles were locked, or nearly, since the stand before.
    pub(crate) fn watch_gimbals(&mut self, stand: &Stand) {
        let balls = self.chart.as_ref().map_or(0, |chart| chart.balls.len());
        let before = self.last_kept.take();
        for index in 0..balls {
            let from = before.as_ref().unwrap_or(stand);
            if !self.may_have_locked(index, from, stand) {
                continue;
            }
            let now = self.lock_of(index, &stand.coordinates);
            let Some(before) = &before else {
                if now.length() <= NEAR_LOCK {
                    self.report_lock(index, stand.time, now.length());
                }
                continue;
            };
            let then = self.lock_of(index, &before.coordinates);
            let (part, distance) = closest(then, now);
            // On the way to a lock the closest pose is yet to come; having left one, it has been said.
            let still_coming = part >= 1.0 && now.length() > LOCKED;
            if distance > WORTH_A_LOOK || part <= 0.0 || still_coming || then.length() <= LOCKED {
                continue;
            }
            let (time, distance) = self.locate_lock(index, before, stand, part);
            let is_inside =
                time > before.time.min(stand.time) && time <= before.time.max(stand.time);
            if distance <= NEAR_LOCK && is_inside {
                self.report_lock(index, time, distance);
            }
        }
        if balls > 0 {
            self.kept_before = before;
            self.last_kept = Some(stand.clone());
        }
    }

    fn may_have_locked(&self, index: usize, a: &Stand, b: &Stand) -> bool {
        let ball = self.chart.as_ref().map(|chart| &chart.balls[index]);
        ball.is_some_and(|ball| ball.may_have_locked(&a.coordinates, &b.coordinates))
    }

    fn lock_of(&self, index: usize, coordinates: &[f64]) -> DVec2 {
        let ball = self.chart.as_ref().map(|chart| &chart.balls[index]);
        ball.map_or(DVec2::ONE, |ball| ball.lock(coordinates))
    }

    /// Time and size of the closest approach between two stands, from the part of the way that the straight line says.
    fn locate_lock(&mut self, index: usize, a: &Stand, b: &Stand, part: f64) -> (f64, f64) {
        let span = b.time - a.time;
        // Poses on the way; the next one is predicted from the nearest.
        let mut known = vec![(0.0, a.clone()), (1.0, b.clone())];
        let mut value = |follower: &mut Self, s: f64| -> Option<DVec2> {
            let near =
                |x: &&(f64, Stand), y: &&(f64, Stand)| (x.0 - s).abs().total_cmp(&(y.0 - s).abs());
            let (at, base) = known.iter().min_by(near)?;
            if *at == s {
                return Some(follower.lock_of(index, &base.coordinates));
            }
            let time = a.time + s * span;
            let inputs = follower.inputs(time).ok()?;
            let iterations = follower.iterations;
            let (mut coordinates, _) = follower.predict(base, &inputs, 1);
            let correction = follower.correct(&mut coordinates, Pace::Patient);
            follower.iterations = iterations;
            let lock = follower.lock_of(index, &coordinates);
            let branch = base.branch.clone();
            let stand = Stand {
                time,
                coordinates,
                branch,
            };
            known.push((s, stand));
            correction.converged.then_some(lock)
        };
        let (mut s, mut best) = (part, (part, f64::INFINITY));
        let mut step = 1e-3_f64;
        for _ in 0..LOCATING {
            let Some(here) = value(self, s) else { break };
            if here.length() < best.1 {
                best = (s, here.length());
            }
            // The path's direction from a second pose beside; the closest point of that line is the next guess.
            let beside = if s + step > 1.0 { s - step } else { s + step };
            let Some(there) = value(self, beside) else {
                break;
            };
            let direction = (there - here) / (beside - s);
            let change = -here.dot(direction) / direction.length_squared();
            if !change.is_finite() || change.abs() < 1e-15 {
                break;
            }
            s = (s + change).clamp(0.0, 1.0);
            step = change.abs().clamp(1e-9, 1e-3);
        }
        // The proof of the stand shares what was observed last.
        let _ = self.observe(&b.coordinates);
        (a.time + best.0 * span, best.1)
    }

    fn report_lock(&mut self, index: usize, time: f64, distance: f64) {
        let Some(chart) = &self.chart else { return };
        let unknowns = &self.system.mechanism().unknowns;
        let names = chart.balls[index]
            .slots
            .map(|slot| unknowns[slot].name.clone());
        let again = SAME_LOCK * self.actuation.duration;
        let known = self.trajectory.events.iter().rev().any(|event| {
            let is_same =
                matches!(&event.kind, EventKind::GimbalLock { names: n, .. } if *n == names);
            is_same && (event.time - time).abs() <= again
        });
        if !known {
            self.event(time, EventKind::GimbalLock { names, distance });
        }
    }
}

/// Where the straight line from a to b comes closest to the origin, as a part of the way, and how close.
fn closest(a: DVec2, b: DVec2) -> (f64, f64) {
    let way = b - a;
    let part = (-a.dot(way) / way.length_squared()).clamp(0.0, 1.0);
    let part = if part.is_nan() { 0.0 } else { part };
    (part, (a + way * part).length())
}
