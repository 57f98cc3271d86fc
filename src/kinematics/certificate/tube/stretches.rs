//! The result for a tube, and the poses at its ends.

use super::path::TubePath;
use super::taylor_model::TaylorModel;
use crate::model::mechanism::Mechanism;
use crate::numbers::rounding::GROW;
use std::sync::Arc;

/// The rows that every block is proved on.
pub type Bases = Arc<Vec<Vec<usize>>>;

/// One proved stretch.
#[derive(Clone, Debug)]
pub struct Tube {
    /// Seconds.
    pub start: f64,
    /// Seconds.
    pub end: f64,
    /// Bound on the distance of the motion from the path, in radians and sizes.
    pub radius: f64,
    /// Distance from the path within which it is the only one, in the same units.
    pub unique: f64,
    /// Bound on the closure errors of redundant rows, in the same units.
    pub(super) closes_to: f64,
    /// Bound on the distance of every unknown from the path, in the same units.
    pub(super) rest: Vec<f64>,
    pub(super) path: TubePath,
    /// The rows that it is proved on.
    pub(super) bases: Bases,
}

impl Tube {
    /// The path's value of unknown `k` at a time of the stretch.
    pub fn centre(&self, k: usize, time: f64) -> f64 {
        self.path.at(k, time).middle()
    }

    /// All coordinates of the motion, wherever it is near the path.
    pub(super) fn coordinates(&self, mechanism: &Mechanism) -> Vec<TaylorModel> {
        let mut coordinates = self.path.coordinates.clone();
        for (k, rest) in self.rest.iter().enumerate() {
            coordinates[k].rest += rest * mechanism.scale_of(k) * GROW;
        }
        coordinates
    }

    /// Rate of the path of unknown `k` at the end.
    pub(super) fn rate_at_end(&self, k: usize) -> f64 {
        let c = &self.path.coordinates[k].c;
        let slope: f64 = c.iter().enumerate().map(|(j, c)| j as f64 * c).sum();
        slope / self.path.stretch().half
    }

    /// Whether the enclosed drive continues where this tube meets the previous one.
    pub(super) fn has_inputs_of(&self, before: &Self, mechanism: &Mechanism) -> bool {
        let mut slots = mechanism.unknowns.len()..mechanism.coordinate_count();
        slots.all(|k| {
            let (a, b) = (before.path.at(k, self.start), self.path.at(k, self.start));
            a.lo <= b.hi && b.lo <= a.hi
        })
    }

    /// Whether it has the pose of the previous tube where they meet.
    pub(super) fn has_motion_of(&self, before: &Self, mechanism: &Mechanism) -> bool {
        let gap = (0..mechanism.unknowns.len()).map(|k| {
            let (a, b) = (before.path.at(k, self.start), self.path.at(k, self.start));
            (a - b).magnitude() / mechanism.scale_of(k)
        });
        let gap = largest_value(gap) * GROW;
        gap + before.radius < self.unique || gap + self.radius < before.unique
    }
}

/// A pose on the way.
#[derive(Clone, Debug)]
pub struct Station {
    /// Seconds.
    pub time: f64,
    /// Values of the unknowns.
    pub unknowns: Vec<f64>,
    /// Rates of the unknowns, if they are known: used only for the first guess of a path.
    pub rates: Option<Vec<f64>>,
    /// For a sample: its inputs, and the distance of the exact pose, in radians and sizes.
    pub sample: Option<(Vec<f64>, f64)>,
}

/// Maximum; NaN propagates.
pub fn largest_value(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |a: f64, b| if b.is_nan() || b > a { b } else { a })
}
