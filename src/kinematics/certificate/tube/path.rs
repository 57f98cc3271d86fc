//! The curve that a tube is laid around: cubic in the unknowns, the drive itself in the inputs.

use super::super::interval::Interval;
use super::drive::{PATH_ORDER, Stretch};
use super::series::Series;
use crate::kinematics::rates::rates;
use crate::kinematics::structure::Structure;
use crate::kinematics::taylor;
use crate::model::mechanism::Mechanism;

/// Coordinates (unknowns, then inputs) over a stretch of time.
#[derive(Clone, Debug)]
pub struct Path {
    stretch: Stretch,
    /// Series about the middle.
    pub middle: Vec<Series>,
    /// Series about every place of the stretch at once.
    pub everywhere: Vec<Series>,
}

/// The inputs of a mechanism over a stretch.
pub struct InputPath {
    stretch: Stretch,
    middle: Vec<Series>,
    everywhere: Vec<Series>,
}

impl InputPath {
    /// The drives over a stretch without keyframes inside.
    pub fn new(mechanism: &Mechanism, stretch: Stretch) -> Self {
        let over = |everywhere| {
            let drives = mechanism.drives.iter();
            drives.map(|d| stretch.input(d, everywhere)).collect()
        };
        Self {
            stretch,
            middle: over(false),
            everywhere: over(true),
        }
    }

    /// Whether every drive is bounded over the stretch.
    pub fn is_finite(&self) -> bool {
        let mut all = self.middle.iter().chain(&self.everywhere);
        all.all(Series::is_finite)
    }

    /// Widens input `k` until its value at `time` holds `value`; returns by how much.
    pub fn admit(&mut self, k: usize, time: f64, value: f64) -> f64 {
        let here = self.at(k, time);
        let below = (here.lo - value).max(0.0);
        let off = (value - here.hi).max(below) * (1.0 + 1e-12);
        let play = Interval::around_zero(off);
        for series in [&mut self.middle[k], &mut self.everywhere[k]] {
            series.0[0] = series.0[0] + play;
        }
        off
    }

    fn at(&self, k: usize, time: f64) -> Interval {
        let series = self.middle[k].with_remainder_of(&self.everywhere[k]);
        series.value_at(self.stretch.place(time))
    }

    /// The curve through a closed pose at the middle; `None` at a singular one.
    pub fn through(
        self,
        mechanism: &Mechanism,
        structure: &Structure,
        coordinates: &[f64],
    ) -> Option<Path> {
        let inputs = self.middle.iter().map(|series| {
            let mut numbers = taylor::Series::constant(0.0, PATH_ORDER);
            (0..=PATH_ORDER).for_each(|k| numbers.set(k, series.0[k].middle()));
            numbers
        });
        let inputs: Vec<taylor::Series> = inputs.collect();
        let curve = rates(mechanism, structure, coordinates, &inputs, PATH_ORDER)?;
        let unknowns = curve[..mechanism.unknowns.len()].iter().map(|numbers| {
            let mut series = Series::ZERO;
            let pairs = series.0.iter_mut().zip(numbers.coefficients());
            pairs.for_each(|(c, value)| *c = Interval::point(*value));
            series
        });
        let mut middle: Vec<Series> = unknowns.collect();
        let mut everywhere: Vec<Series> = middle.iter().map(Series::over_the_stretch).collect();
        middle.extend(self.middle);
        everywhere.extend(self.everywhere);
        Some(Path {
            stretch: self.stretch,
            middle,
            everywhere,
        })
    }
}

impl Path {
    /// A pose that stands still.
    pub fn still(coordinates: &[f64]) -> Self {
        let points = coordinates.iter();
        let middle: Vec<Series> = points
            .map(|q| Series::constant(Interval::point(*q)))
            .collect();
        Self {
            stretch: Stretch::new(0.0, 0.0),
            everywhere: middle.clone(),
            middle,
        }
    }

    /// Coordinate `k` at a time of the stretch.
    pub fn at(&self, k: usize, time: f64) -> Interval {
        let series = self.middle[k].with_remainder_of(&self.everywhere[k]);
        series.value_at(self.stretch.place(time))
    }
}
