//! Covering of the interval between two samples: by tubes as far as they are proved, then by estimates, and not at all
//! where there is no pose.

use super::motion::{ESTIMATE_SHARE, MotionStretch, ProvedMotion, SampledInstant, StretchMotion};
use super::undefined;
use crate::kinematics::certificate::tube::{TaylorModel, Tube};
use crate::kinematics::results::trajectory::Sample;
use crate::kinematics::solve::newton::Pace;
use crate::model::chain::ArgumentValue;
use crate::model::mechanism::Kind;
use std::f64::consts::TAU;

/// Shortest interval that a proof is tried for, as a fraction of that between two samples.
const FLOOR: f64 = 1.0 / 1024.0;

/// A pose is that of the motion if it is no farther from the line between two known ones, in radians and sizes.
const NEAR: f64 = 0.05;

/// A closure error of this much, in radians and sizes, does not tell a double root from none: the square of a rounded number.
const HIDDEN: f64 = 1e-7;

/// At a double root the smallest singular value is at most so large where the closure error is [`HIDDEN`]: its root, times a
/// generous bound of the curvature. Of a regular pose nothing is hidden.
const LARGEST_AT_DOUBLE_ROOT: f64 = 1e-2;

/// An estimated motion deviates from the parabola by at most this times the deviation of the parabola from the line, plus a
/// fraction of the displacement.
const ESTIMATE_FACTOR: f64 = 2.0;

impl ProvedMotion<'_> {
    /// Remembers where the drive jumps from one sample to the next.
    pub(super) fn note_jumps(&mut self, from: f64, to: f64) {
        let jumps = self.prover.jumps_between(from, to);
        let found = [(jumps.at_start, from), (jumps.at_end, to)];
        for (_, time) in found.into_iter().filter(|(is_found, _)| *is_found) {
            if self.jumps.last() != Some(&time) {
                self.jumps.push(time);
            }
        }
    }

    /// Whether what was true before this pose of a sample may not be any more: the motion jumps to it, or is not proved.
    pub fn begins_anew(&self, instant: usize) -> bool {
        self.anew.contains(&instant)
    }

    /// Covers the interval between two samples, `places` in the list of samples, but for what lacks a pose; whether they are
    /// proved to be joined.
    pub(super) fn cover(
        &mut self,
        pair: &[Sample],
        places: [usize; 2],
        lacking: &[[f64; 2]],
    ) -> bool {
        let (from, to) = (pair[0].time, pair[1].time);
        let floor = FLOOR.min(self.shortest / (to - from));
        let (tubes, refused) = self.prover.tubes(pair, floor);
        let before = self.stretches.len();
        let mut whole = refused.is_none();
        for tube in tubes {
            let arguments = self.prover.arguments(&tube);
            if !arguments.iter().all(TaylorModel::is_finite) {
                // A joint outside all loops whose formula has a kink or no value here.
                whole = false;
                break;
            }
            // Both poses are held by the tubes that begin and end with them, if their inputs are.
            let begins = tube.start == from && self.prover.has_inputs(&tube, &pair[0]);
            let ends = tube.end == to && self.prover.has_inputs(&tube, &pair[1]);
            let ends = [begins.then_some(places[0]), ends.then_some(places[1])];
            self.add_tube(tube, arguments, ends);
        }
        if whole {
            let [first, last] = [self.stretches.get(before), self.stretches.last()];
            return first.is_some_and(|s| s.ends[0] == Some(places[0]))
                && last.is_some_and(|s| s.ends[1] == Some(places[1]));
        }
        // Beyond the refusal the rest is estimated as a whole, except where there is no pose.
        let reached = self.stretches.last().map(|s| s.end);
        let reached = reached.filter(|t| *t > from && *t < to);
        let samples = places.map(|place| self.samples[place]);
        let (mut at, mut first) = (
            reached.unwrap_or(from),
            reached.is_none().then_some(places[0]),
        );
        let mut start = match reached {
            None => Some(samples[0]),
            Some(time) => self.between(samples[0], samples[1], time),
        };
        for [off, on] in undefined::gaps(self.system, &self.actuation, [at, to], lacking) {
            if off > at {
                let end = self.between(samples[0], samples[1], off);
                self.estimate([at, off], [start, end], [first, None]);
            }
            self.leave_out(off, on);
            (at, first) = (on, None);
            start = match on < to {
                true => self.between(samples[0], samples[1], on),
                false => None,
            };
        }
        if at < to {
            self.estimate(
                [at, to],
                [start, Some(samples[1])],
                [first, Some(places[1])],
            );
        }
        false
    }

    /// An estimate between two instants; without one of them, or if there is no estimate, the interval is left out.
    fn estimate(
        &mut self,
        [from, to]: [f64; 2],
        ends: [Option<usize>; 2],
        samples: [Option<usize>; 2],
    ) {
        let known = match ends {
            [Some(start), Some(end)] => self.add_estimate([start, end], samples),
            _ => None,
        };
        if known.is_none() {
            self.leave_out(from, to);
        }
    }

    pub(super) fn add_tube(
        &mut self,
        tube: Tube,
        arguments: Vec<TaylorModel>,
        ends: [Option<usize>; 2],
    ) -> usize {
        self.stretches.push(MotionStretch {
            start: tube.start,
            end: tube.end,
            ends,
            arguments,
            is_certified: true,
            way: StretchMotion::Proved(Box::new(tube)),
            halves: None,
        });
        self.stretches.len() - 1
    }

    /// A stretch between two instants with a parabola; `None` if its middle cannot be solved.
    pub(super) fn add_estimate(
        &mut self,
        ends: [usize; 2],
        samples: [Option<usize>; 2],
    ) -> Option<usize> {
        let [start, end] = ends.map(|k| self.instants[k].time);
        let middle = self.between(ends[0], ends[1], 0.5 * (start + end))?;
        let [a, b, c] = [ends[0], middle, ends[1]].map(|k| &self.instants[k].arguments);
        // A parabola through both ends and the middle.
        let of = |k: usize| {
            let (way, bend) = (
                0.5 * (c[k].value - a[k].value),
                0.5 * (c[k].value + a[k].value) - b[k].value,
            );
            let mut model = TaylorModel::constant(b[k].value);
            (model.c[1], model.c[2]) = (way, bend);
            model.rest = ESTIMATE_FACTOR * bend.abs() + ESTIMATE_SHARE * way.abs();
            model
        };
        self.stretches.push(MotionStretch {
            start,
            end,
            ends: samples,
            arguments: (0..a.len()).map(of).collect(),
            is_certified: false,
            way: StretchMotion::Estimated(ends),
            halves: None,
        });
        Some(self.stretches.len() - 1)
    }

    /// The closed pose near the straight line between two instants, or between poses on the way from one to the other.
    pub(super) fn between(&mut self, start: usize, end: usize, time: f64) -> Option<usize> {
        let (a, b) = (&self.instants[start], &self.instants[end]);
        let ends = [a, b].map(|instant| (instant.time, &instant.coordinates[..]));
        let [from, to] = self.passed.nearest(time, ends);
        let share = (time - from.0) / (to.0 - from.0);
        let inputs = self.actuation.inputs_at(time);
        // Of poses on the way the inputs are those of the drive; those of instants may be the limits at a jump.
        let unknowns = self.system.mechanism().unknowns.len();
        let with_inputs =
            [from, to].map(|(time, coordinates)| match coordinates.len() > unknowns {
                true => coordinates.to_vec(),
                false => [coordinates, &self.actuation.inputs_at(time)].concat(),
            });
        let ends = [&with_inputs[0][..], &with_inputs[1]];
        let coordinates = (self.solver).between_on_branch(ends, share, &inputs, Pace::Brisk)?;
        let instant = self.instant(time, coordinates);
        let mut arguments = self.instants[instant].arguments.iter();
        if arguments.all(|argument| argument.value.is_finite()) {
            return Some(instant);
        }
        self.instants.truncate(instant);
        None
    }

    /// Whether there is a closed pose at a time, near those that are known.
    pub(super) fn has_pose(&mut self, time: f64) -> bool {
        let mut roots = self.stretches[..self.roots].iter();
        if roots.any(|s| s.is_certified && s.start <= time && time <= s.end) {
            return true;
        }
        let times = self.samples.iter().map(|k| self.instants[*k].time);
        let after = times.take_while(|t| *t < time).count().max(1);
        let Some(&[a, b]) = self.samples.get(after - 1..=after) else {
            return false;
        };
        // From a pose on the way: a singular one is found by descent only.
        let ends = [a, b].map(|k| &self.instants[k]);
        let ends = ends.map(|instant| (instant.time, &instant.coordinates[..]));
        let [from, to] = self.passed.nearest(time, ends);
        let share = (time - from.0) / (to.0 - from.0);
        let unknowns = self.system.mechanism().unknowns.len();
        let pairs = from.1.iter().zip(to.1).take(unknowns);
        let mut start: Vec<f64> = pairs.map(|(a, b)| a + share * (b - a)).collect();
        start.extend(self.actuation.inputs_at(time));
        let found = match self.solver.assembled(&start, None) {
            Ok(found) => found.coordinates,
            // At a double root the descent ends where rounding hides the rest.
            Err(best) if best.amount() <= HIDDEN && self.is_flat(&best.coordinates) => {
                best.coordinates
            }
            Err(_) => return false,
        };
        let mechanism = self.system.mechanism();
        let mut pairs = found.iter().zip(&start).take(unknowns).enumerate();
        // Of an angle whole turns do not count.
        pairs.all(|(k, (a, b))| {
            let turns = match mechanism.kind_of(k) {
                Kind::Angle => TAU * ((a - b) / TAU).round(),
                Kind::Length | Kind::Number => 0.0,
            };
            (a - b - turns).abs() <= NEAR * mechanism.scale_of(k)
        })
    }

    /// Whether coordinates may be those of a double root.
    fn is_flat(&mut self, coordinates: &[f64]) -> bool {
        let sigma = self.solver.observe(coordinates).sigma_min;
        sigma.is_nan() || sigma <= LARGEST_AT_DOUBLE_ROOT
    }

    /// Keeps a closed pose; its index.
    pub(super) fn instant(&mut self, time: f64, coordinates: Vec<f64>) -> usize {
        let mut arguments = self.system.mechanism().argument_values(&coordinates);
        // All that jumps at one instant does so together, which rounded inputs do not tell.
        if time.is_finite() {
            for (k, timed) in self.prover.jumping() {
                arguments[k] = ArgumentValue::new(timed.value(time));
            }
        }
        self.instants.push(SampledInstant {
            time,
            arguments,
            coordinates,
        });
        self.instants.len() - 1
    }
}
