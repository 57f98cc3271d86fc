//! How large the plain numbers of a scene without chains are: nothing else says whether its bars are metres or
//! micrometres long.
//!
//! A coordinate amounts to the change that moves one of its equations as far as the equation's own terms reach at the
//! start values; an equation to what such changes do to it.

use crate::model::actuation::Actuation;
use crate::model::mechanism::{Equation, Kind, Mechanism};

/// Instants of the drive at which equations are looked at, as shares of its duration.
pub const INSTANTS: [f64; 5] = [0.0, 0.21, 0.47, 0.73, 1.0];

/// Powers of two that are tried as changes.
const POWERS: std::ops::Range<i32> = -100..100;

/// Fills in the magnitudes of unknowns and equations where there is no chain to take a size from.
pub fn estimate_magnitudes(mechanism: &mut Mechanism, actuation: &Actuation) {
    let is_number = mechanism.unknowns.iter().any(|u| u.kind == Kind::Number);
    if !mechanism.loops.is_empty() || !mechanism.contacts.is_empty() || !is_number {
        return;
    }
    let mut poses: Vec<Vec<f64>> = INSTANTS
        .iter()
        .map(|share| actuation.start_at(share * actuation.duration))
        .collect();
    let mut using = vec![Vec::new(); mechanism.coordinate_count()];
    for equation in &mechanism.equations {
        let slots = equation.expression.slots();
        slots
            .into_iter()
            .for_each(|slot| using[slot].push(equation));
    }
    let numbers = (0..mechanism.unknowns.len()).filter(|k| mechanism.kind_of(*k) == Kind::Number);
    let found: Vec<(usize, f64)> = numbers
        .map(|slot| (slot, unknown_magnitude(&using[slot], &mut poses, slot)))
        .collect();
    for (slot, magnitude) in found {
        mechanism.scales[slot] = magnitude;
    }
    let scales = &mechanism.scales[..mechanism.unknowns.len()];
    let unit = mechanism.size;
    for equation in &mut mechanism.equations {
        let found = equation_size(equation, &mut poses, scales);
        let known = unit.powf(equation.length_exponent);
        equation.magnitude = sound_magnitude(found / known).unwrap_or(1.0);
    }
}

fn sound_magnitude(value: f64) -> Option<f64> {
    (value.is_normal() && value > 0.0).then_some(value)
}

/// What a number amounts to: its start value, or the least change that the equations `using` it feel.
fn unknown_magnitude(using: &[&Equation], poses: &mut [Vec<f64>], slot: usize) -> f64 {
    let mut least = f64::INFINITY;
    for equation in using {
        let reach = poses.iter_mut().map(|pose| equation_terms(equation, pose));
        let Some(reach) = sound_magnitude(reach.fold(0.0, f64::max)) else {
            continue;
        };
        let powers = POWERS.step_by(2).map(|power| 2f64.powi(power));
        for by in powers {
            if moved_equation(equation, &mut poses[0], slot, by) >= reach {
                least = least.min(by);
                break;
            }
        }
    }
    // Every pose begins with the start values.
    let given = poses[0][slot].abs();
    let least = if least.is_finite() { least } else { 0.0 };
    sound_magnitude(least.max(given)).unwrap_or(1.0)
}

/// How far the terms of an equation reach: its value, or what would be missing without one of its coordinates.
pub fn equation_terms(equation: &Equation, pose: &mut [f64]) -> f64 {
    let mut reach = finite_or_zero(equation.expression.value(pose));
    for slot in equation.expression.slots() {
        reach = reach.max(moved_equation(equation, pose, slot, -pose[slot]));
    }
    reach
}

/// Change of an equation's value when one coordinate changes; the pose is as before afterwards.
pub fn moved_equation(equation: &Equation, pose: &mut [f64], slot: usize, by: f64) -> f64 {
    let (before, here) = (pose[slot], equation.expression.value(pose));
    pose[slot] += by;
    let there = equation.expression.value(pose);
    pose[slot] = before;
    finite_or_zero(there - here)
}

pub fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() { value.abs() } else { 0.0 }
}

fn equation_size(equation: &Equation, poses: &mut [Vec<f64>], scales: &[f64]) -> f64 {
    let slots = equation.expression.slots();
    let own = slots.iter().filter(|slot| **slot < scales.len());
    let felt = own.map(|slot| moved_equation(equation, &mut poses[0], *slot, scales[*slot]));
    let felt = felt.fold(0.0, f64::max);
    let terms = poses.iter_mut().map(|pose| equation_terms(equation, pose));
    terms.fold(felt, f64::max)
}
