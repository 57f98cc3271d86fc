//! How far inputs move within a step: a pose at its end says nothing about a drive that has gone elsewhere and come back, or
//! about two singular poses that a crank passes within one turn.

use super::bounded_formulas::BoundedFormula;
use super::path_tracker::{PathPoint, PathTracker};
use crate::numbers::interval::Interval;
use crate::numbers::scalar::Scalar;
use crate::numbers::series::Series;

/// A jump excuses what strays in steps of at most this share of the time between two samples.
const BESIDE_JUMP: f64 = 1e-9;

/// Formulas of unknowns are trusted in steps of at most this share of it.
const SHORT: f64 = 1.0 / 1024.0;

/// Parts of a step over which a drive is bounded, since bounds of a formula that has its time in several places are too wide.
const PARTS: usize = 8;

/// Most halvings of a step that has no pose between to start from.
const REACHES: usize = 40;

impl PathTracker<'_> {
    /// Whether inputs, or formulas of them in loops and equations, move farther between a pose and the instant of other inputs
    /// than a single step may take them. Without unknowns nothing can be missed.
    pub(crate) fn strays(&self, here: &PathPoint, time: f64, inputs: &[f64]) -> bool {
        let n = self.unknowns();
        if n == 0 {
            return false;
        }
        let times = [here.time, time];
        let is_beside = (time - here.time).abs() <= BESIDE_JUMP * self.interval;
        // Inputs first, then what formulas make of them.
        let mut pairs = here.coordinates[n..].iter().zip(inputs).enumerate();
        let input_strays = pairs.any(|(index, (a, b))| {
            let is_far = self.bounds[index].is_far(*a, *b);
            let strays = is_far || self.leaves(index, times, [*a, *b]);
            // A jump ends no halving: what crosses it has rules of its own.
            strays && !(is_beside && self.drive_jumps(index, times))
        });
        input_strays || !self.driven.is_empty() && self.formulas_of_inputs_stray(here, time, inputs)
    }

    /// Steps that a motion takes at least from a pose to an instant; without unknowns a single one does.
    pub(super) fn least_steps(&self, here: &PathPoint, time: f64) -> f64 {
        let n = self.unknowns();
        if n == 0 {
            return 0.0;
        }
        let given = &here.coordinates[n..];
        let values = self.actuation().values_at(time);
        let ways = given.iter().zip(values).zip(self.bounds.iter());
        let steps = ways.map(|((a, b), bound)| (b - a).abs() / bound.farthest);
        steps.fold(0.0, f64::max)
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

    /// Whether formulas of unknowns in loops stray between a pose and another one, in all that lies between their coordinates.
    /// A short step is trusted: their jumps have rules of their own.
    pub(super) fn formulas_stray(&self, here: &PathPoint, time: f64, there: &[f64]) -> bool {
        if self.bent.is_empty() || (time - here.time).abs() <= SHORT * self.interval {
            return false;
        }
        // All that lies between, unknowns included.
        let ends = [&here.coordinates[..], there];
        let pairs = ends[0].iter().zip(there);
        let between: Vec<Interval> = pairs.map(|(a, b)| hull([*a, *b])).collect();
        self.bent.iter().any(|formula| {
            let bound = formula.bound_at(ends[0]);
            let [a, b] = ends.map(|slots| formula.formula.value(slots));
            bound.is_far(a, b) || !formula.stays(bound, [a, b], &between)
        })
    }

    /// Whether a drive jumps between two instants.
    fn drive_jumps(&self, index: usize, [a, b]: [f64; 2]) -> bool {
        let drive = &self.actuation().drives[index];
        drive.may_jump() && drive.jumps_between(a.min(b), a.max(b)).is_any()
    }

    /// Whether a drive leaves the range between its values at two instants.
    fn leaves(&self, index: usize, times: [f64; 2], values: [f64; 2]) -> bool {
        let (bound, drive) = (self.bounds[index], &self.actuation().drives[index]);
        self.turning[index]
            && !holds_part_by_part(times, |part| {
                let part = hull(part);
                bound.holds(values, drive.range(part))
                    || bound.holds(values, drive.sharp_range(part))
            })
    }

    /// Whether a formula of inputs goes too far, or elsewhere and back.
    fn formulas_of_inputs_stray(&self, here: &PathPoint, time: f64, inputs: &[f64]) -> bool {
        let n = self.unknowns();
        let there = [&here.coordinates[..n], inputs].concat();
        let (ends, times) = ([&here.coordinates[..], &there], [here.time, time]);
        let is_beside = (time - here.time).abs() <= BESIDE_JUMP * self.interval;
        // Of a jump of the drive, or of the formula itself.
        let jumps = |driven: &BoundedFormula| {
            let mut used = driven.slots.iter();
            used.any(|slot| self.drive_jumps(slot - n, times))
                || driven.formula.jump_on_way(ends[0], ends[1]).is_some()
        };
        self.driven.iter().any(|driven| {
            let bound = driven.bound_at(ends[0]);
            let [a, b] = ends.map(|slots| driven.formula.value(slots));
            let stays = |part| {
                driven.stays(bound, [a, b], &self.boxes_of(driven, part))
                    || (self.range_over_time(driven, part))
                        .is_some_and(|range| bound.holds([a, b], Some(range)))
            };
            let strays = bound.is_far(a, b) || !holds_part_by_part(times, stays);
            strays && !(is_beside && jumps(driven))
        })
    }

    /// Bounds of a formula of inputs by its rate in time: drives that move together may hardly change what they make together.
    /// `None` where nothing is known of rates.
    fn range_over_time(&self, driven: &BoundedFormula, part: [f64; 2]) -> Option<Interval> {
        let n = self.unknowns();
        let drives = &self.actuation().drives;
        let times = hull(part);
        let middle = Interval::point(times.middle());
        let mut moving = vec![Series::constant(Interval::ZERO); n + drives.len()];
        let mut middles = vec![Interval::ZERO; n + drives.len()];
        for slot in &driven.slots {
            moving[*slot] = drives[slot - n].series_over(times)?;
            middles[*slot] = drives[slot - n].range(middle)?;
        }
        // Mean value form: the middle, and all rates.
        let all: Series<Interval, 2> = driven.formula.value(&moving);
        if !all.is_finite() {
            return None;
        }
        let rate = all.coefficients().get(1).copied().unwrap_or(Interval::ZERO);
        let near = driven.formula.range(&middles)? + rate * (times - middle);
        let Interval { lo, hi } = all.coefficients()[0];
        Some(Interval::new(lo.max(near.lo), hi.min(near.hi)))
    }

    /// All values that the inputs of a formula have between two instants; the other coordinates are zero.
    fn boxes_of(&self, driven: &BoundedFormula, part: [f64; 2]) -> Vec<Interval> {
        let n = self.unknowns();
        let drives = &self.actuation().drives;
        let mut boxes = vec![Interval::ZERO; n + drives.len()];
        for slot in &driven.slots {
            // Without a value nothing is bounded.
            boxes[*slot] = drives[slot - n]
                .sharp_range(hull(part))
                .unwrap_or(Interval::ENTIRE);
        }
        boxes
    }
}

/// Whether something holds between two instants: as a whole, which tells of most, or in each of some parts.
fn holds_part_by_part([from, to]: [f64; 2], holds: impl Fn([f64; 2]) -> bool) -> bool {
    let at = |k: usize| match k {
        0 => from,
        PARTS => to,
        k => from + (to - from) * (k as f64 / PARTS as f64),
    };
    holds([from, to]) || (0..PARTS).all(|k| holds([at(k), at(k + 1)]))
}

fn hull([a, b]: [f64; 2]) -> Interval {
    Interval::new(a.min(b), a.max(b))
}
