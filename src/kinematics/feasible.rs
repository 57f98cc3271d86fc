//! Which values of an input admit a pose: what to say when the given one does not.
//!
//! One input at a time is swept through a turn, or through a few sizes of the mechanism, the others standing still as
//! at the start of the drive. The ends are located like the ends of any motion; stretches narrower than the steps of
//! the sweep can be missed, and so can assemblies that the start values do not lead to.

use super::continuation::solve;
use super::trajectory::Trajectory;
use crate::model::drive::{Drive, Ease};
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::PI;

/// Steps of a sweep: two degrees each.
const STEPS: usize = 180;

/// Lengths and plain numbers are swept this many sizes (or units) to either side.
const REACH: f64 = 3.0;

/// Values of one input with a pose.
#[derive(Clone, Debug, PartialEq)]
pub struct Feasible {
    /// Index of the input.
    pub input: usize,
    /// Ascending stretches: radians, or the scene's length unit. An end of the sweep counts as an end.
    pub stretches: Vec<[f64; 2]>,
}

/// The feasible stretches of every input by itself; inputs without any are left out.
pub fn feasible_inputs(mechanism: &Mechanism) -> Vec<Feasible> {
    let given = mechanism.inputs_at(0.0);
    let inputs = (0..given.len()).filter_map(|input| {
        let stretches = sweep(mechanism, &given, input)?;
        (!stretches.is_empty()).then_some(Feasible { input, stretches })
    });
    inputs.collect()
}

fn sweep(mechanism: &Mechanism, given: &[f64], input: usize) -> Option<Vec<[f64; 2]>> {
    let reach = match mechanism.inputs[input].kind {
        Kind::Angle => PI,
        Kind::Length => REACH * mechanism.size,
        Kind::Number => REACH,
    };
    let mut swept = mechanism.clone();
    swept.duration = 1.0;
    swept.drives = given.iter().map(|v| Drive::constant(*v)).collect();
    swept.drives[input] = Drive::Keys {
        times: vec![0.0, 1.0],
        values: vec![given[input] - reach, given[input] + reach],
        ease: Ease::Linear,
    };
    let times: Vec<f64> = (0..=STEPS).map(|k| k as f64 / STEPS as f64).collect();
    let trajectory = solve(&swept, &times).ok()?;
    Some(stretches(&trajectory, input))
}

/// What the gaps of a motion leave.
fn stretches(trajectory: &Trajectory, input: usize) -> Vec<[f64; 2]> {
    let Some((first, last)) = trajectory.samples.first().zip(trajectory.samples.last()) else {
        return Vec::new();
    };
    let mut list = Vec::new();
    let mut begin = Some(first.inputs[input]);
    for gap in &trajectory.gaps {
        if let (Some(begin), Some(end)) = (begin, &gap.from) {
            list.push([begin, end.inputs[input]]);
        }
        begin = gap.until.as_ref().map(|at| at.inputs[input]);
    }
    list.extend(begin.map(|begin| [begin, last.inputs[input]]));
    list
}
