//! Values of an input for which poses exist, for the message that the given ones have none.
//!
//! One input at a time is swept through a turn, or through a few sizes of the mechanism, with the others fixed at the
//! start of the drive. The ends are located like the ends of any motion. Intervals narrower than the steps of the sweep
//! can be missed, and so can assemblies that the start values do not lead to.

use super::continuation::solve_motion;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::PI;

/// Steps of a sweep: two degrees each.
const STEPS: usize = 180;

/// A mechanism of many unknowns or inputs is swept in longer steps, so that a hint does not take minutes.
const FEWEST_STEPS: usize = 24;

/// Unknowns times inputs up to which no step is longer.
const SMALL: usize = 18;

/// Lengths and plain numbers are swept this many sizes (or units) to either side.
const REACH: f64 = 3.0;

/// Ends that agree within this share of the largest value are the same.
const TOUCHING: f64 = 1e-9;

/// Values of one input for which poses exist.
#[derive(Clone, Debug, PartialEq)]
pub struct Feasible {
    /// Index of the input.
    pub input: usize,
    /// Ascending intervals: radians, or the scene's length unit. An end of the sweep counts as an end.
    pub stretches: Vec<[f64; 2]>,
}

/// The feasible intervals of every input on its own; inputs without any are omitted.
pub fn feasible_inputs(system: &System, actuation: &Actuation) -> Vec<Feasible> {
    let given = actuation.inputs_at(0.0);
    let inputs = (0..given.len()).filter_map(|input| {
        // A value far out is no indication of the mechanism's position: then around zero.
        let middles = [given[input], 0.0];
        let found = middles.iter().find_map(|middle| {
            let stretches = sweep_input(system, actuation, input, *middle);
            (!stretches.is_empty()).then_some(stretches)
        });
        found.map(|stretches| Feasible { input, stretches })
    });
    inputs.collect()
}

fn sweep_steps(mechanism: &Mechanism) -> usize {
    let work = mechanism.unknowns.len() * mechanism.inputs.len();
    (STEPS * SMALL / work.max(SMALL)).max(FEWEST_STEPS)
}

fn sweep_input(system: &System, actuation: &Actuation, input: usize, middle: f64) -> Vec<[f64; 2]> {
    let mechanism = system.mechanism();
    let reach = match mechanism.inputs[input].kind {
        Kind::Angle => PI,
        Kind::Length => REACH * mechanism.scale_of(mechanism.unknowns.len() + input),
        Kind::Number => REACH,
    };
    let mut from = actuation.inputs_at(0.0);
    let mut to = from.clone();
    (from[input], to[input]) = (middle - reach, middle + reach);
    // The other inputs are fixed while this one sweeps its whole range.
    let swept = Actuation::straight(&from, &to, actuation.guess.clone());
    let steps = sweep_steps(mechanism);
    let times: Vec<f64> = (0..=steps).map(|k| k as f64 / steps as f64).collect();
    feasible_stretches(&solve_motion(system, &swept, &times), input)
}

/// The complement of the gaps of a motion.
fn feasible_stretches(trajectory: &Trajectory, input: usize) -> Vec<[f64; 2]> {
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
    merge_stretches(list)
}

/// Adjacent intervals are merged; single values next to intervals are resumptions of the sweep.
fn merge_stretches(list: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let reach = list.iter().flatten().fold(0.0, |m: f64, v| m.max(v.abs()));
    let mut joined: Vec<[f64; 2]> = Vec::new();
    for [from, to] in list {
        match joined.last_mut() {
            Some(last) if from - last[1] <= TOUCHING * reach => last[1] = to,
            _ => joined.push([from, to]),
        }
    }
    // A single value is a resumption of the sweep, unless nothing else was found.
    let is_wide = |s: &[f64; 2]| s[1] - s[0] > TOUCHING * reach;
    if joined.iter().any(is_wide) {
        joined.retain(is_wide);
    }
    joined
}
