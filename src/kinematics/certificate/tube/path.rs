//! The path at the centre of a tube: polynomials in the unknowns, the drive itself in the inputs.

use super::drive::DriveInterval;
use super::taylor_model::{Polynomial, TaylorEnclosure, TaylorModel};
use crate::model::actuation::Actuation;
use crate::model::expression::Expression;
use crate::model::mechanism::{Kind, Mechanism};
use crate::numbers::interval::Interval;
use crate::numbers::rounding::GROW;
use crate::numbers::scalar::Scalar;
use std::cell::OnceCell;

/// Coordinates (unknowns, then inputs) over a time interval.
#[derive(Clone, Debug)]
pub struct TubePath {
    stretch: DriveInterval,
    /// The unknowns' are polynomials and nothing else.
    pub coordinates: Vec<TaylorModel>,
    /// The inputs about the middle and about every place at once, as intervals.
    inputs: [Vec<TaylorEnclosure>; 2],
    /// The same of all coordinates, once a formula asks for it.
    series: OnceCell<[Vec<TaylorEnclosure>; 2]>,
    /// All coordinates of a constant pose; none for a motion.
    still: Vec<Interval>,
}

/// The inputs of a mechanism over a stretch.
pub struct InputPath {
    stretch: DriveInterval,
    /// About the middle, about every place at once.
    inputs: [Vec<TaylorEnclosure>; 2],
}

impl InputPath {
    /// The drives over a stretch without breaks inside, and without those of `placed`: formulas of the time that place bodies.
    pub fn new(actuation: &Actuation, placed: &[&Expression], stretch: DriveInterval) -> Self {
        let over = stretch.over_jumps(&actuation.drives, placed);
        let input = |drive| match &over {
            Some(over) => over.input(drive),
            None => [TaylorEnclosure::undefined(); 2],
        };
        let inputs = actuation.drives.iter().map(input);
        let (middle, everywhere) = inputs.map(|[near, far]| (near, far)).unzip();
        Self {
            stretch: over.unwrap_or(stretch),
            inputs: [middle, everywhere],
        }
    }

    /// Whether every drive is bounded over the stretch.
    pub fn is_finite(&self) -> bool {
        self.inputs
            .iter()
            .flatten()
            .all(|series| series.is_finite())
    }

    /// With the play added to every input; unchanged if there is none.
    pub fn widened(mut self, play: &[f64]) -> Self {
        for (k, play) in play.iter().enumerate() {
            let play = Interval::around_zero(*play);
            for series in &mut self.inputs {
                series[k] = series[k] + TaylorEnclosure::constant(play);
            }
        }
        self
    }

    /// Widens input `k` until its value at `time` contains all numbers within `open` of `value`; returns the widening.
    pub fn admit(&mut self, k: usize, time: f64, value: f64, open: f64) -> f64 {
        let here = self.at(k, time);
        let below = (here.lo - value).max(0.0);
        let off = ((value - here.hi).max(below) + open) * GROW;
        let play = Interval::around_zero(off);
        for series in &mut self.inputs {
            series[k] = series[k] + TaylorEnclosure::constant(play);
        }
        off
    }

    /// Input `k` at a time of the stretch.
    pub fn at(&self, k: usize, time: f64) -> Interval {
        let [middle, everywhere] = &self.inputs;
        let series = middle[k].with_remainder_of(&everywhere[k]);
        series.value_at(self.stretch.place(time))
    }

    /// With these curves of the unknowns.
    pub fn with(self, unknowns: Vec<Polynomial>) -> TubePath {
        let curves = unknowns.into_iter().map(|c| TaylorModel { c, rest: 0.0 });
        let [middle, everywhere] = &self.inputs;
        let inputs = middle.iter().zip(everywhere);
        let inputs = inputs.map(|(near, far)| TaylorModel::of(*near, far));
        TubePath {
            stretch: self.stretch,
            coordinates: curves.chain(inputs).collect(),
            inputs: self.inputs,
            series: OnceCell::new(),
            still: Vec::new(),
        }
    }
}

impl TubePath {
    /// A constant pose with the inputs `coordinates + rests`.
    pub fn standing(unknowns: usize, coordinates: &[f64], rests: &[f64]) -> Self {
        let rest = |k: usize| rests.get(k).copied().unwrap_or(0.0);
        let slots = coordinates.iter().enumerate();
        let still = slots.clone().map(|(k, q)| match k < unknowns {
            true => Interval::point(*q),
            false => Interval::sum_of(*q, rest(k)),
        });
        // Unknowns are exact numbers, inputs known to within their rests.
        let still: Vec<Interval> = still.collect();
        let inputs = still[unknowns..].iter();
        let inputs: Vec<TaylorEnclosure> = inputs.map(|i| TaylorEnclosure::constant(*i)).collect();
        let models = slots.map(|(k, q)| TaylorModel {
            rest: rest(k).abs(),
            ..TaylorModel::constant(*q)
        });
        Self {
            stretch: DriveInterval::new(0.0, 0.0),
            coordinates: models.collect(),
            inputs: [inputs.clone(), inputs],
            series: OnceCell::new(),
            still,
        }
    }

    /// The stretch.
    pub fn stretch(&self) -> &DriveInterval {
        &self.stretch
    }

    /// All coordinates of a constant pose: nothing of higher order than zero is then needed.
    pub fn still(&self) -> Option<&[Interval]> {
        (!self.still.is_empty()).then_some(&self.still)
    }

    /// The largest angle at the middle of the time interval, in radians.
    pub fn largest_angle(&self, mechanism: &Mechanism) -> f64 {
        let slots = self.coordinates.iter().enumerate();
        let angles = slots.filter(|(slot, _)| mechanism.kind_of(*slot) == Kind::Angle);
        angles.fold(0.0, |largest, (_, q)| largest.max(q.c[0].abs()))
    }

    /// Moves the curve of an unknown.
    pub fn add(&mut self, unknown: usize, step: impl Iterator<Item = f64>) {
        let c = &mut self.coordinates[unknown].c;
        c.iter_mut().zip(step).for_each(|(c, step)| *c += step);
        self.series = OnceCell::new();
        self.still.clear();
    }

    /// The curves of the unknowns over a part of the stretch.
    pub fn part(&self, unknowns: usize, start: f64, end: f64) -> Vec<Polynomial> {
        let place = |time: f64| (time - self.stretch.middle) / self.stretch.half;
        let (from, to) = (place(start), place(end));
        let curves = self.coordinates[..unknowns].iter();
        curves
            .map(|x| x.about(0.5 * (from + to), 0.5 * (to - from)))
            .collect()
    }

    /// All coordinates about the middle and about every place at once, as intervals.
    pub fn series(&self) -> &[Vec<TaylorEnclosure>; 2] {
        self.series.get_or_init(|| {
            let count = self.coordinates.len() - self.inputs[0].len();
            let unknowns = &self.coordinates[..count];
            let near: Vec<TaylorEnclosure> = unknowns
                .iter()
                .map(|x| TaylorEnclosure::from(x.c.map(Interval::point)))
                .collect();
            // The same polynomials, with their values over the whole stretch as coefficients.
            let far = near.iter().map(|x| x.over_the_stretch()).collect();
            let [mut middle, mut everywhere] = [near, far];
            middle.extend_from_slice(&self.inputs[0]);
            everywhere.extend_from_slice(&self.inputs[1]);
            [middle, everywhere]
        })
    }

    /// Coordinate `k` at a time of the stretch.
    pub fn at(&self, k: usize, time: f64) -> Interval {
        self.coordinates[k].value_at(self.stretch.place(time))
    }
}
