//! How far inputs move within a step: a pose at its end says nothing about a drive that has gone elsewhere and come back, or
//! about two singular poses that a crank passes within one turn.

use super::path_tracker::{PathPoint, PathTracker};
use crate::model::mechanism::Kind;
use crate::numbers::interval::Interval;
use std::f64::consts::FRAC_PI_2;

/// A step turns no input farther than this, radians: linkages flatten at every half turn.
const FARTHEST_TURN: f64 = FRAC_PI_2;

/// Within a step an input may leave the range between its ends by this much, radians or mechanism sizes.
const STRAY: f64 = 0.01;

/// The same in shares of its value, far more than rounding.
const STRAY_OF_VALUE: f64 = 1e-9;

/// A jump excuses an input in steps of at most this share of the time between two samples.
const BESIDE_JUMP: f64 = 1.0 / 1024.0;

/// Parts of a step over which a drive is bounded, since bounds of a formula that has its time in several places are too wide.
const PARTS: usize = 8;

impl PathTracker<'_> {
    /// Whether inputs move farther between a pose and the instant of other inputs than a single step may take them. Without
    /// unknowns nothing can be missed.
    pub(crate) fn strays(&self, here: &PathPoint, time: f64, inputs: &[f64]) -> bool {
        let n = self.unknowns();
        if n == 0 {
            return false;
        }
        let ends = [here.time.min(time), here.time.max(time)];
        let is_short = ends[1] - ends[0] <= BESIDE_JUMP * self.interval;
        let mut pairs = here.coordinates[n..].iter().zip(inputs).enumerate();
        pairs.any(|(index, (a, b))| {
            let strays =
                self.turns_far(index, b - a) || self.leaves(index, [here.time, time], [*a, *b]);
            // A jump ends no halving: what crosses it has rules of its own.
            let drive = &self.actuation().drives[index];
            let jumps = || drive.may_jump() && drive.jumps_between(ends[0], ends[1]).is_any();
            strays && !(is_short && jumps())
        })
    }

    /// Whether an input is an angle that turns too far.
    fn turns_far(&self, index: usize, by: f64) -> bool {
        let kind = self.system().mechanism().inputs[index].kind;
        kind == Kind::Angle && by.abs() > FARTHEST_TURN
    }

    /// Whether a drive leaves the range between its values at two instants.
    fn leaves(&self, index: usize, [from, to]: [f64; 2], [a, b]: [f64; 2]) -> bool {
        if !self.turning[index] {
            return false;
        }
        let mechanism = self.system().mechanism();
        let unit = match mechanism.inputs[index].kind {
            Kind::Angle => 1.0,
            Kind::Length | Kind::Number => mechanism.size,
        };
        let stray = STRAY * unit + STRAY_OF_VALUE * a.abs().max(b.abs());
        let allowed = Interval::point(a).hull(Interval::point(b)) + Interval::around_zero(stray);
        let drive = &self.actuation().drives[index];
        let within = |[from, to]: [f64; 2]| {
            let times = Interval::point(from).hull(Interval::point(to));
            let range = drive.range(times);
            range.is_none_or(|range| allowed.lo <= range.lo && range.hi <= allowed.hi)
        };
        // As a whole first, which tells of most drives; then part by part.
        if within([from, to]) {
            return false;
        }
        let at = |k: usize| match k {
            0 => from,
            PARTS => to,
            k => from + (to - from) * (k as f64 / PARTS as f64),
        };
        !(0..PARTS).all(|k| within([at(k), at(k + 1)]))
    }
}
