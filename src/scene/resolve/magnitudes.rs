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
    let poses: Vec<Vec<f64>> = INSTANTS
        .iter()
        .map(|share| actuation.start_at(share * actuation.duration))
        .collect();
    for slot in 0..mechanism.unknowns.len() {
        if mechanism.kind_of(slot) == Kind::Number {
            mechanism.scales[slot] = unknown_magnitude(mechanism, &poses, slot);
        }
    }
    let scales = &mechanism.scales[..mechanism.unknowns.len()];
    let unit = mechanism.size;
    for equation in &mut mechanism.equations {
        let found = equation_size(equation, &poses, scales);
        let known = unit.powf(equation.length_exponent);
        equation.magnitude = sound_magnitude(found / known).unwrap_or(1.0);
    }
}

fn sound_magnitude(value: f64) -> Option<f64> {
    (value.is_normal() && value > 0.0).then_some(value)
}

/// What a number amounts to: its start value, or the least change that its equations feel.
fn unknown_magnitude(mechanism: &Mechanism, poses: &[Vec<f64>], slot: usize) -> f64 {
    let using = mechanism
        .equations
        .iter()
        .filter(|e| e.expression.slots().contains(&slot));
    let changes = using.filter_map(|equation| {
        let reach = poses.iter().map(|pose| equation_terms(equation, pose));
        let reach = sound_magnitude(reach.fold(0.0, f64::max))?;
        let felt =
            |power: &i32| moved_equation(equation, &poses[0], slot, 2f64.powi(*power)) >= reach;
        POWERS.step_by(2).find(felt).map(|power| 2f64.powi(power))
    });
    let least = changes.fold(f64::INFINITY, f64::min);
    // Every pose begins with the start values.
    let given = poses[0][slot].abs();
    let least = if least.is_finite() { least } else { 0.0 };
    sound_magnitude(least.max(given)).unwrap_or(1.0)
}

/// How far the terms of an equation reach: its value, or what would be missing without one of its coordinates.
pub fn equation_terms(equation: &Equation, pose: &[f64]) -> f64 {
    let mut reach = finite_or_zero(equation.expression.value(pose));
    for slot in equation.expression.slots() {
        reach = reach.max(moved_equation(equation, pose, slot, -pose[slot]));
    }
    reach
}

/// Change of an equation's value when one coordinate changes.
pub fn moved_equation(equation: &Equation, pose: &[f64], slot: usize, by: f64) -> f64 {
    let mut changed = pose.to_vec();
    changed[slot] += by;
    finite_or_zero(equation.expression.value(&changed) - equation.expression.value(pose))
}

pub fn finite_or_zero(value: f64) -> f64 {
    if value.is_finite() { value.abs() } else { 0.0 }
}

fn equation_size(equation: &Equation, poses: &[Vec<f64>], scales: &[f64]) -> f64 {
    let slots = equation.expression.slots();
    let own = slots.iter().filter(|slot| **slot < scales.len());
    let felt = own.map(|slot| moved_equation(equation, &poses[0], *slot, scales[*slot]));
    let terms = poses.iter().map(|pose| equation_terms(equation, pose));
    felt.chain(terms).fold(0.0, f64::max)
}
