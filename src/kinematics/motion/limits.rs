//! Limit positions: where a coordinate or an output reverses while the drive continues, such as the dead points of a
//! crank's slider. They are found between samples of a refined motion, and located where the exact rate vanishes.
//!
//! Where the drive itself reverses, everything does; that is not a limit position. Two reversals of one quantity within one
//! refined interval are missed.

use super::continuation::solve_motion;
use super::input_reversals::{InputsBetween, begins_to_move, pace_at};
use super::sampling::is_cyclic;
use super::value_roundings::{RESOLVED, ValueRoundings, output_roundings};
use crate::kinematics::loops::forward::Observation;
use crate::kinematics::loops::observed::dependencies;
use crate::kinematics::rates::columns::{RateColumns, RateVariable, needed_series};
use crate::kinematics::rates::rated::fill_rated_outputs;
use crate::kinematics::results::trajectory::{Event, EventKind, Sample, Trajectory};
use crate::kinematics::solve::newton::Pace;
use crate::kinematics::solve::pose_solver::PoseSolver;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use crate::numbers::bracket::Bracket;
use crate::numbers::series::HIGHEST_ORDER;
use crate::sorting::sort_by_number;

/// Fewest intervals over the motion that are searched: half a degree of a turn each.
const INTERVALS: usize = 720;

/// An unknown is constant if its largest rate is below this fraction of that of the inputs, all over their natural sizes.
const STILL: f64 = 1e-10;

/// Inputs slower than this fraction of their largest rate are at rest.
const RESTING: f64 = 1e-6;

/// Most steps of the search for a zero; bisection, every fourth of them, needs 53 to exhaust f64.
const STEPS: usize = 220;

/// Relative width of the last bracket: a few units in the last place of the time.
const WIDTH: f64 = 1e-15;

/// Steps towards what may be a pole: each leaves this part of the way.
const APPROACH: f64 = 1.0 / 64.0;

/// Towards a cusp like the tenth root a step changes the value by two thirds of what the one before did; towards a logarithm's
/// pole by as much, and by nearly as much where a root or a logarithm is taken of it.
const BOUNDED: f64 = 0.8;

/// A term of a series counts if it exceeds this fraction of the largest one over a step: below are roundings of zeros.
const LEADING: f64 = 1e-6;

/// First derivatives by time.
const FIRST: RateColumns = RateColumns {
    order: 1,
    by: RateVariable::Time,
};

/// Adds an event for every limit position of an unknown or output to those of a solved motion.
pub fn add_limits(system: &System, actuation: &Actuation, trajectory: &mut Trajectory) {
    let times = refine_limit(system.mechanism(), actuation, &trajectory.samples);
    let fine = solve_motion(system, actuation, &times);
    let mut search = LimitSearch::new(system, actuation, &fine.samples);
    for quantity in 0..search.names.len() {
        search.run(quantity);
    }
    trajectory.events.append(&mut search.events);
    sort_by_number(&mut trajectory.events, |a| a.time);
}

/// The samples' times and as many between them as necessary. The last sample of a cyclic drive is one before its end.
fn refine_limit(mechanism: &Mechanism, actuation: &Actuation, samples: &[Sample]) -> Vec<f64> {
    let mut ends: Vec<f64> = samples.iter().map(|s| s.time).collect();
    if let [.., before, last] = ends[..]
        && is_cyclic(mechanism, actuation)
        && actuation.duration > last
        && actuation.duration - last < 1.5 * (last - before)
    {
        ends.push(actuation.duration);
    }
    // At least so many intervals over the motion, whatever the samples are.
    let parts = INTERVALS.div_ceil(ends.len().saturating_sub(1).max(1));
    let between = ends.windows(2).flat_map(|pair| {
        let (a, b) = (pair[0], pair[1]);
        (0..parts).map(move |k| a + (b - a) * (k as f64 / parts as f64))
    });
    between.chain(ends.last().copied()).collect()
}

struct LimitSearch<'m> {
    system: &'m System,
    actuation: &'m Actuation,
    solver: PoseSolver<'m>,
    samples: &'m [Sample],
    /// Rates of all quantities at every sample that has them.
    rates: Vec<Option<Vec<f64>>>,
    /// Name and index of each quantity among the rates.
    names: Vec<(String, usize)>,
    /// The slot of the quantity that is searched, and the slots that it depends on.
    slot: usize,
    needed: Vec<bool>,
    /// The largest rate of an input, over its natural size.
    pace: f64,
    roundings: ValueRoundings<'m>,
    events: Vec<Event>,
}

impl<'m> LimitSearch<'m> {
    fn new(system: &'m System, actuation: &'m Actuation, samples: &'m [Sample]) -> Self {
        let mechanism = system.mechanism();
        // Exact rates by time at every sample with a pose.
        let rates: Vec<Option<Vec<f64>>> = samples
            .iter()
            .map(|sample| {
                let pose = sample.pose.as_ref()?;
                let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
                FIRST.values(system, actuation, &coordinates, sample.time)
            })
            .collect();
        // Unknowns and outputs are searched; in the list of rates traced points lie between them.
        let (n, traces) = (mechanism.unknowns.len(), 3 * mechanism.traces.len());
        let unknowns = mechanism.unknowns.iter().map(|c| c.name.clone()).zip(0..);
        let outputs = mechanism
            .outputs
            .iter()
            .map(|o| o.name.clone())
            .zip(n + traces..);
        // Scales: what is slow beside them counts as resting.
        let times = samples.iter().map(|s| s.time);
        let paces = times.map(|time| pace_at(mechanism, actuation, time));
        Self {
            system,
            actuation,
            solver: PoseSolver::new(system),
            samples,
            names: unknowns.chain(outputs).collect(),
            slot: 0,
            needed: Vec::new(),
            pace: paces.fold(0.0, f64::max),
            roundings: ValueRoundings::new(mechanism, samples),
            rates,
            events: Vec::new(),
        }
    }

    /// All limit positions of one quantity.
    fn run(&mut self, quantity: usize) {
        let at = self.names[quantity].1;
        let rate = |k: usize| self.rates[k].as_ref().map(|r| r[at]);
        let rates: Vec<Option<f64>> = (0..self.samples.len())
            .map(|k| rate(k).filter(|rate| rate.is_finite()))
            .collect();
        let largest = rates.iter().flatten().fold(0.0, |m: f64, r| m.max(r.abs()));
        if largest == 0.0 || self.is_constant(quantity, largest) {
            return;
        }
        // Rates are those of all slots but the inputs, which follow the unknowns.
        let mechanism = self.system.mechanism();
        self.slot = match at < mechanism.unknowns.len() {
            true => at,
            false => at + mechanism.inputs.len(),
        };
        self.needed = dependencies(mechanism, &[self.slot]);
        // The last sample that moves, and the first one after it that rests or has a kink.
        let mut last: Option<(usize, f64)> = None;
        let mut still: Option<usize> = None;
        for (k, rate) in rates.iter().enumerate() {
            let rate = match *rate {
                Some(rate) if rate.abs() > self.roundings.least_rate(quantity, k) => rate,
                // The reversal is on this sample, or very near to it.
                Some(0.0) => {
                    still = still.or(Some(k));
                    continue;
                }
                Some(_) => continue,
                None if self.samples[k].pose.is_some() => {
                    still = still.or(Some(k));
                    continue;
                }
                None => {
                    (last, still) = (None, None);
                    continue;
                }
            };
            match (last, still) {
                (Some((from, before)), None) if before * rate < 0.0 => {
                    self.between(quantity, (from, before), (k, rate));
                }
                (Some((from, before)), Some(still))
                    if before * rate < 0.0
                        && self.inputs_between(from, k) == InputsBetween::GoOn =>
                {
                    self.push_sample(quantity, still, before > 0.0);
                }
                (None, _) if k == 1 && rates[0].is_some() && !self.is_drive_end(0, 1) => {
                    self.note(quantity, [0, k], rate < 0.0);
                }
                _ => {}
            }
            (last, still) = (Some((k, rate)), None);
        }
        // For a motion that is not a cycle, its ends are limits too.
        let end = rates.len().saturating_sub(1);
        if let Some((k, rate)) = last
            && k + 1 == end
            && rates[end].is_some()
            && !self.is_drive_end(end, k)
            && !is_cyclic(self.system.mechanism(), self.actuation)
        {
            self.note(quantity, [end, k], rate > 0.0);
        }
    }

    /// Whether a quantity changes by no more than rounding, at this largest rate.
    fn is_constant(&self, quantity: usize, largest: f64) -> bool {
        let mechanism = self.system.mechanism();
        match mechanism.unknowns.get(quantity) {
            Some(unknown) => largest <= STILL * self.pace * mechanism.natural_size(unknown.kind),
            None => self.roundings.is_constant(quantity),
        }
    }

    /// A reversal at an end of the motion, where the next sample is `next`; unless the drive rests there: then everything does.
    fn note(&mut self, quantity: usize, [end, next]: [usize; 2], is_largest: bool) {
        let [time, after] = [end, next].map(|k| self.samples[k].time);
        if !self.rests_at(time)
            && self.is_of_even_order(end, after - time)
            && self.would_turn_back(quantity, [end, next])
        {
            self.push_sample(quantity, end, is_largest);
        }
    }

    /// Whether the first term that counts over a step, in the series of the quantity that is searched at an end of the motion, has an
    /// even order. With an odd one it only pauses there, and without a series nothing is known.
    fn is_of_even_order(&self, end: usize, step: f64) -> bool {
        let sample = &self.samples[end];
        let Some(pose) = &sample.pose else {
            return false;
        };
        let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
        let driven = (self.actuation, sample.time);
        let needed = |slot: usize| self.needed[slot];
        let (by, order) = (FIRST.by, HIGHEST_ORDER);
        let series = needed_series(self.system, &coordinates, by, driven, order, needed);
        series.is_some_and(|series| {
            let coefficients = series[self.slot].coefficients();
            let term = |k: usize| (coefficients[k] * step.powi(k as i32)).abs();
            let largest = (1..=order).map(term).fold(0.0, f64::max);
            let first = (1..=order).find(|k| term(*k) > LEADING * largest);
            first.is_some_and(|order| order % 2 == 0)
        })
    }

    /// Whether a quantity is on one side of its value at an end of the motion also where the inputs would be if they went on: at a kink
    /// the series tells one side only.
    fn would_turn_back(&mut self, quantity: usize, [end, next]: [usize; 2]) -> bool {
        let samples = [end, next].map(|k| &self.samples[k]);
        let [Some(here), Some(there)] = samples.map(|sample| sample.pose.as_ref()) else {
            return false;
        };
        let pairs = samples[0].inputs.iter().zip(&samples[1].inputs);
        let beyond = pairs.map(|(here, there)| here - (there - here));
        let at = |unknowns: &[f64], sample: &Sample| [unknowns, &sample.inputs].concat();
        let [here, there] = [
            at(&here.unknowns, samples[0]),
            at(&there.unknowns, samples[1]),
        ];
        let mut outside = here.clone();
        outside.truncate(self.system.mechanism().unknowns.len());
        outside.extend(beyond);
        if !self.solver.closed(&mut outside, Pace::Brisk) {
            return false;
        }
        let [time, after] = samples.map(|sample| sample.time);
        let value = self.value_at(quantity, time, &here);
        let inside = self.value_at(quantity, after, &there) - value;
        let outside = self.value_at(quantity, time, &outside) - value;
        inside != 0.0 && outside != 0.0 && inside.signum() == outside.signum()
    }

    /// Whether no input moves at a time.
    fn rests_at(&self, time: f64) -> bool {
        pace_at(self.system.mechanism(), self.actuation, time) <= RESTING * self.pace
    }

    /// Whether all inputs reverse at a time between samples that are `step` apart: they rest there, or turn at a kink.
    fn turns_at(&self, time: f64, step: f64) -> bool {
        let width = 4.0 * WIDTH * step.max(time.abs());
        let around = [time - width, time + width];
        self.rests_at(time)
            || InputsBetween::of(self.actuation, around) == InputsBetween::AllReverse
    }

    fn inputs_between(&self, low: usize, high: usize) -> InputsBetween {
        let times = [low, high].map(|k| self.samples[k].time);
        InputsBetween::of(self.actuation, times)
    }

    /// Whether an input rests at an end of the motion but not next to it: what begins or ends there is the drive.
    fn is_drive_end(&self, end: usize, next: usize) -> bool {
        let times = [end, next].map(|k| self.samples[k].time);
        begins_to_move(self.actuation, times)
    }

    /// A reversal on a sample itself.
    fn push_sample(&mut self, quantity: usize, sample: usize, is_largest: bool) {
        let sample = &self.samples[sample];
        if let Some(pose) = &sample.pose {
            let coordinates = [pose.unknowns.as_slice(), &sample.inputs].concat();
            self.push(quantity, sample.time, &coordinates, is_largest);
        }
    }

    /// Locates the reversal between two samples with rates of opposite signs: false position, and bisection for kinks.
    fn between(&mut self, quantity: usize, low: (usize, f64), high: (usize, f64)) {
        let inputs = self.inputs_between(low.0, high.0);
        // What follows the only input reverses with it.
        if inputs == InputsBetween::Return {
            return;
        }
        let (first, last) = (self.samples[low.0].time, self.samples[high.0].time);
        let mut bracket = Bracket::new([first, low.1], [last, high.1]);
        let mut best: Option<(f64, Vec<f64>)> = None;
        let mut vanishes = false;
        for step in 0..STEPS {
            // Three secants, then a bisection, which always shrinks the bracket.
            let [a, b] = bracket.ends;
            let secant = bracket.at(bracket.secant_share());
            let time = if step % 4 < 3 && secant > a && secant < b {
                secant
            } else {
                0.5 * (a + b)
            };
            let Some((rate, coordinates)) = self.rate_at((low.0, high.0), time) else {
                return;
            };
            best = Some((time, coordinates));
            vanishes = rate.abs() < low.1.abs().min(high.1.abs());
            // At a kink there is no rate.
            if !rate.is_finite() || rate == 0.0 || (b - a) <= WIDTH * (last - first).max(b.abs()) {
                break;
            }
            bracket.replace(bracket.is_low(rate), time, rate);
        }
        if let Some((time, coordinates)) = best
            && !(inputs == InputsBetween::AllReverse && self.turns_at(time, last - first))
            && (vanishes || !self.is_pole(quantity, (low.0, high.0), time))
        {
            self.push(quantity, time, &coordinates, low.1 > 0.0);
        }
    }

    /// Whether an output grows without bound towards a time between two samples: on the way to a cusp each step, a fixed
    /// part of the one before, changes it less; on the way to a pole it does not.
    fn is_pole(&mut self, quantity: usize, samples: (usize, usize), time: f64) -> bool {
        let Some(output) = quantity.checked_sub(self.system.mechanism().unknowns.len()) else {
            return false;
        };
        let mechanism = self.system.mechanism();
        [samples.0, samples.1].into_iter().any(|end| {
            let whole = self.samples[end].time - time;
            let values = [3, 4, 5].map(|k| {
                let near = time + whole * APPROACH.powi(k);
                let (_, coordinates) = self.rate_at(samples, near)?;
                let rounding = output_roundings(mechanism, &coordinates)[output];
                Some((self.value_at(quantity, near, &coordinates), rounding))
            });
            let [Some((far, _)), Some((middle, _)), Some((near, rounding))] = values else {
                return false;
            };
            let changes = [(middle - far).abs(), (near - middle).abs()];
            changes[1] > RESOLVED * rounding && changes[1] > BOUNDED * changes[0]
        })
    }

    /// Rate of the quantity that is searched at a time between two samples, not finite at a kink, and the coordinates there.
    fn rate_at(&mut self, (low, high): (usize, usize), time: f64) -> Option<(f64, Vec<f64>)> {
        let (low, high) = (&self.samples[low], &self.samples[high]);
        let share = (time - low.time) / (high.time - low.time);
        let (p, q) = (low.pose.as_ref()?, high.pose.as_ref()?);
        let inputs = self.actuation.inputs_at(time);
        let ends =
            [(p, low), (q, high)].map(|(pose, at)| [&pose.unknowns[..], &at.inputs].concat());
        let ends = [&ends[0][..], &ends[1]];
        // A closed pose between the two samples, and the exact rate there.
        let coordinates = (self.solver).between_on_branch(ends, share, &inputs, Pace::Brisk)?;
        let driven = (self.actuation, time);
        let needed = |slot: usize| self.needed[slot];
        let RateColumns { order, by } = FIRST;
        let series = needed_series(self.system, &coordinates, by, driven, order, needed);
        let rate = series.map_or(f64::NAN, |series| series[self.slot].derivative(order));
        Some((rate, coordinates))
    }

    /// The value of a quantity at a closed pose. Outputs that contain rates need the drive, too.
    fn value_at(&self, quantity: usize, time: f64, coordinates: &[f64]) -> f64 {
        let mechanism = self.system.mechanism();
        match quantity.checked_sub(mechanism.unknowns.len()) {
            None => coordinates[quantity],
            Some(output) => {
                let mut seen = Observation::new(mechanism, coordinates);
                let driven = (self.actuation, time);
                fill_rated_outputs(self.system, driven, coordinates, &mut seen);
                seen.outputs[output]
            }
        }
    }

    fn push(&mut self, quantity: usize, time: f64, coordinates: &[f64], is_largest: bool) {
        let mechanism = self.system.mechanism();
        let n = mechanism.unknowns.len();
        let kind = match quantity.checked_sub(n) {
            None => mechanism.unknowns[quantity].kind,
            Some(output) => mechanism.outputs[output].kind,
        };
        let value = self.value_at(quantity, time, coordinates);
        if !value.is_finite() {
            return;
        }
        self.events.push(Event {
            time,
            inputs: coordinates[n..].to_vec(),
            kind: EventKind::LimitPosition {
                name: self.names[quantity].0.clone(),
                measure: kind,
                value,
                is_largest,
            },
        });
    }
}
