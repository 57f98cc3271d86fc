//! The poses that join two others across a singular one. Two folds that face each other over a gap have none.

use super::path_tracker::{PathPoint, PathTracker};
use crate::kinematics::certificate::absence::is_equation_open;
use crate::kinematics::solve::newton::Pace;
use crate::numbers::interval::Interval;

/// Where poses between two others are looked for, as shares of the time. No two are alike as seen from both ends: a gap whose
/// ends are mirror images may hold a single pose in its middle.
const BETWEEN: [f64; 5] = [0.11, 0.29, 0.5, 0.67, 0.83];

/// What counts as the rounding of an equation: its value if every coordinate is off by this share of itself, and by the last
/// digit of its scale. About a flat singular pose all terms are small, and so must be what they leave.
const ROUNDING: f64 = 1e-13;

/// A correction may end at the residual's own floor, where small terms are not yet balanced: so many follow.
const MOST_CORRECTIONS: usize = 4;

impl PathTracker<'_> {
    /// Poses between two others, if there is one at every instant that is looked at.
    pub(super) fn joining(&mut self, a: &PathPoint, b: &PathPoint) -> Option<Vec<Vec<f64>>> {
        let n = self.unknowns();
        let pose = |share: &f64| {
            let inputs = self.inputs(a.time + share * (b.time - a.time)).ok()?;
            let pairs = a.coordinates.iter().zip(b.coordinates.iter()).take(n);
            let mut pose: Vec<f64> = pairs.map(|(a, b)| a + share * (b - a)).collect();
            pose.extend(inputs);
            (0..MOST_CORRECTIONS)
                .find_map(|_| {
                    let is_closed = self.solver.closed(&mut pose, Pace::Patient);
                    (!is_closed || self.is_closed_to_rounding(&pose)).then_some(is_closed)
                })?
                .then_some(pose)
        };
        BETWEEN.iter().map(pose).collect()
    }

    /// Whether the equations close to the rounding of their own terms.
    fn is_closed_to_rounding(&self, pose: &[f64]) -> bool {
        let mechanism = self.system().mechanism();
        let about = |(slot, value): (usize, &f64)| {
            let digit = f64::EPSILON * mechanism.scale_of(slot);
            Interval::point(*value) + Interval::around_zero(ROUNDING * value.abs() + digit)
        };
        let place: Vec<Interval> = pose.iter().enumerate().map(about).collect();
        let mut equations = mechanism.equations.iter();
        equations.all(|equation| !is_equation_open(equation, &place))
    }
}
