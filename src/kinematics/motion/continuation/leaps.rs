//! Where the drive or the tangent gives no way on though poses exist: inputs that jump, and motions that start on a
//! singular pose.

use super::{Follower, SINGULAR_START, SMALLEST_STEP, Stand};
use crate::kinematics::results::trajectory::EventKind;
use crate::kinematics::solve::assembly::{assemble, shake, turns_matter};
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::TAU;

/// Change of an input, relative to its size, that two times a few smallest steps apart cannot make in a smooth drive.
const JUMP: f64 = 1e-6;

/// Beyond a singular start poses are looked for after this share of the interval between two samples: far enough for
/// the branches to have parted.
const BESIDE_START: f64 = 0.1;

/// Starts around the singular pose that are tried, and how far from it they lie at most, in scaled unknowns.
const STARTS: usize = 16;
const AROUND: f64 = 0.2;

/// Farther from the singular pose is another assembly, in scaled unknowns.
const OTHER_ASSEMBLY: f64 = 0.6;

impl Follower<'_> {
    /// The inputs right after a stand, and the time then, if the drive jumps there.
    pub(crate) fn jump_after(&self, stand: &Stand) -> Option<(f64, Vec<f64>)> {
        let step = (4.0 * SMALLEST_STEP * self.interval).max(4.0 * f64::EPSILON * stand.time.abs());
        let time = stand.time + step;
        let inputs = self.inputs(time).ok()?;
        let before = &stand.coordinates[self.system.mechanism().unknowns.len()..];
        let jumps = before.iter().zip(&inputs).any(|(a, b)| {
            (a - b).abs()
                > JUMP
                    * a.abs()
                        .max(b.abs())
                        .max(JUMP * self.system.mechanism().size)
        });
        jumps.then_some((time, inputs))
    }

    /// Over a jump of the drive the motion is followed as if the inputs went straight from their old values to the new.
    pub(crate) fn leap(&mut self, stand: &Stand) -> Option<Stand> {
        let (time, inputs) = self.jump_after(stand)?;
        let n = self.system.mechanism().unknowns.len();
        let guess = self.actuation.guess.clone();
        let bridge = Actuation::straight(&stand.coordinates[n..], &inputs, guess);
        let mut follower = Follower::new(self.system, &bridge);
        follower.cancelled = self.cancelled;
        follower.certifier = None;
        follower.interval = 1.0;
        let begin = follower.stand(0.0, stand.coordinates.clone());
        let begin = follower.keep(begin);
        let mut end = follower.follow(begin, 1.0).ok()?;
        end.coordinates[n..].copy_from_slice(&inputs);
        self.iterations += follower.iterations;
        Some(self.stand(time, end.coordinates))
    }

    /// A motion that starts where branches meet has several ways on. Poses right beyond are found from many starts
    /// around; the one nearest to the start values is taken, which then say on which branch the motion goes.
    pub(crate) fn leave_singular_start(&mut self, stand: &Stand, time: f64) -> Option<Stand> {
        let is_start = self.trajectory.samples.len() == 1;
        if !is_start || stand.branch.condition < SINGULAR_START {
            return None;
        }
        let beside = stand.time + BESIDE_START * (time - stand.time);
        let inputs = self.inputs(beside).ok()?;
        let n = self.system.mechanism().unknowns.len();
        let mut best: Option<(f64, Stand)> = None;
        let mut met: Vec<String> = Vec::new();
        for attempt in 0..STARTS {
            let mut start = [&stand.coordinates[..n], &inputs].concat();
            let amplitude = AROUND * attempt as f64 / STARTS as f64;
            shake(self.system.mechanism(), attempt, amplitude, &mut start);
            let system = self.system;
            let mechanism = system.mechanism();
            let Ok(mut found) = assemble(system, &mut self.corrector, &start, false) else {
                continue;
            };
            self.iterations += found.iterations;
            unwind(mechanism, &stand.coordinates, &mut found.coordinates);
            if self.apart(&found.coordinates, &stand.coordinates) > OTHER_ASSEMBLY {
                continue;
            }
            let far = self.apart(&found.coordinates, &self.actuation.guess);
            let beyond = self.stand(beside, found.coordinates);
            let signature = beyond.branch.signature();
            if self.is_usable(&beyond.branch) && !met.contains(&signature) {
                met.push(signature);
            }
            if best.as_ref().is_none_or(|(least, _)| far < *least) {
                best = Some((far, beyond));
            }
        }
        let (_, beyond) = best?;
        self.anchor = Some(beyond.clone());
        if !self.is_usable(&beyond.branch) {
            return None;
        }
        let taken = beyond.branch.signature();
        met.retain(|other| *other != taken);
        met.sort();
        self.event(stand.time, EventKind::BranchChosen { taken, others: met });
        Some(beyond)
    }

    /// Largest difference of two poses in scaled unknowns.
    pub(crate) fn apart(&self, a: &[f64], b: &[f64]) -> f64 {
        let pairs = a.iter().zip(b).take(self.system.mechanism().unknowns.len());
        let scaled = pairs
            .enumerate()
            .map(|(k, (a, b))| (a - b).abs() / self.system.mechanism().scale_of(k));
        scaled.fold(0.0, f64::max)
    }
}

/// Takes whole turns out of angles that only differ by them from those of `near`.
fn unwind(mechanism: &Mechanism, near: &[f64], coordinates: &mut [f64]) {
    for (slot, unknown) in mechanism.unknowns.iter().enumerate() {
        if unknown.kind == Kind::Angle && !turns_matter(mechanism, slot) {
            let turns = ((coordinates[slot] - near[slot]) / TAU).round();
            coordinates[slot] -= TAU * turns;
        }
    }
}
