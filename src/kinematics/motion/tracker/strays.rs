//! How far inputs move within a step: a pose at its end says nothing about a drive that has gone elsewhere and come back, or
//! about two singular poses that a crank passes within one turn.

use super::bent_arguments::{FARTHEST_SLIDE, FARTHEST_TURN};
use super::path_tracker::{PathPoint, PathTracker};
use crate::model::mechanism::Kind;
use crate::numbers::interval::Interval;

/// Within a step an input may leave the range between its ends by this much, radians or mechanism sizes.
const STRAY: f64 = 1e-4;

/// The same in shares of its value, far more than rounding.
const STRAY_OF_VALUE: f64 = 1e-9;

/// A jump excuses an input in steps of at most this share of the time between two samples.
const BESIDE_JUMP: f64 = 1.0 / 1024.0;

/// Parts of a step over which a drive is bounded, since bounds of a formula that has its time in several places are too wide.
const PARTS: usize = 8;

/// Most halvings of a step that has no pose between to start from.
const REACHES: usize = 40;

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
                self.goes_far(index, b - a) || self.leaves(index, [here.time, time], [*a, *b]);
            // A jump ends no halving: what crosses it has rules of its own.
            let drive = &self.actuation().drives[index];
            let jumps = || drive.may_jump() && drive.jumps_between(ends[0], ends[1]).is_any();
            strays && !(is_short && jumps())
        })
    }

    /// The farthest instant up to `time` that a single step from a pose may go to: halved until no input strays.
    pub(crate) fn reach(&self, here: &PathPoint, time: f64) -> f64 {
        let mut way = time - here.time;
        for _ in 0..REACHES {
            let inputs = self.inputs(here.time + way);
            if inputs.is_ok_and(|inputs| !self.strays(here, here.time + way, &inputs)) {
                break;
            }
            way *= 0.5;
        }
        here.time + way
    }

    /// Whether formulas in loops stray between a pose and another one, in all that lies between their coordinates. A short
    /// step is trusted: their jumps have rules of their own.
    pub(super) fn formulas_stray(&self, here: &PathPoint, time: f64, there: &[f64]) -> bool {
        if self.bent.is_empty() || (time - here.time).abs() <= BESIDE_JUMP * self.interval {
            return false;
        }
        let mechanism = self.system().mechanism();
        let ends = here.coordinates.iter().zip(there);
        let between = ends.map(|(a, b)| Interval::new(a.min(*b), a.max(*b)));
        let between: Vec<Interval> = between.collect();
        let mut bent = self.bent.iter();
        bent.any(|argument| argument.strays(mechanism, [&here.coordinates, there], &between))
    }

    /// Whether an input turns or slides too far.
    fn goes_far(&self, index: usize, by: f64) -> bool {
        let mechanism = self.system().mechanism();
        match mechanism.inputs[index].kind {
            Kind::Angle => by.abs() > FARTHEST_TURN,
            Kind::Length => by.abs() > FARTHEST_SLIDE * mechanism.size,
            Kind::Number => false,
        }
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
