//! The magnitudes of unknowns in a scene without chains: nothing else shows whether its bars are metres or micrometres
//! long.
//!
//! The magnitude of a coordinate is the change that alters one of its equations by as much as the largest term of the
//! equation at the poses known; that of an equation is its response to such changes.

use crate::model::equation_terms::FAR;
use crate::model::mechanism::{Equation, Kind, Mechanism};

/// Exponents of the powers of two that are tried as changes.
const POWERS: std::ops::Range<i32> = -100..100;

/// Fills in the magnitudes of unknowns and equations that no chain determines, from some poses of the motion.
pub fn estimate_magnitudes(mechanism: &mut Mechanism, mut poses: Vec<Vec<f64>>) {
    // With any length in a chain the scales are known already.
    let is_number = mechanism.unknowns.iter().any(|u| u.kind == Kind::Number);
    if !mechanism.loops.is_empty() || !mechanism.contacts.is_empty() || !is_number {
        return;
    }
    // The equations that each coordinate appears in.
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
    // Equations come after the unknowns, whose scales their terms need.
    let scales = &mechanism.scales[..mechanism.unknowns.len()];
    let unit = mechanism.size;
    for equation in &mut mechanism.equations {
        let found = equation_size(equation, &mut poses, scales);
        let exponent = equation.length_exponent;
        let relative = sound_magnitude(found / libm::pow(unit, exponent));
        equation.weight = libm::pow(unit, -exponent) / relative.unwrap_or(1.0);
    }
}

fn sound_magnitude(value: f64) -> Option<f64> {
    (value.is_normal() && value > 0.0).then_some(value)
}

/// The magnitude of a number: its start value, or the smallest change that the equations `using` it respond to.
pub fn unknown_magnitude(using: &[&Equation], poses: &mut [Vec<f64>], slot: usize) -> f64 {
    let mut least = f64::INFINITY;
    for equation in using {
        let reach = poses.iter_mut().map(|pose| equation.terms(pose));
        let Some(reach) = sound_magnitude(reach.fold(0.0, f64::max)) else {
            continue;
        };
        let mut first = |part: f64| {
            let mut powers = POWERS.step_by(2).map(|power| 2f64.powi(power));
            let felt = |by: &f64| equation.change(&mut poses[0], slot, *by) >= part * reach;
            powers.find(felt)
        };
        // A term that falls, 1/x, changes by all of itself only at infinity, far from where it changes by half.
        let [whole, half] = [1.0, 0.5].map(&mut first);
        if let (Some(whole), Some(half)) = (whole, half)
            && whole <= FAR * half
        {
            least = least.min(whole);
        }
    }
    // Every pose starts from the start values.
    let given = poses[0][slot].abs();
    let least = if least.is_finite() { least } else { 0.0 };
    sound_magnitude(least.max(given)).unwrap_or(1.0)
}

fn equation_size(equation: &Equation, poses: &mut [Vec<f64>], scales: &[f64]) -> f64 {
    let slots = equation.expression.slots();
    let own = slots.iter().filter(|slot| **slot < scales.len());
    let felt = own.map(|slot| response(equation, &mut poses[0], *slot, scales[*slot]));
    let felt = felt.fold(0.0, f64::max);
    let terms = poses.iter_mut().map(|pose| equation.terms(pose));
    terms.fold(felt, f64::max)
}

/// Change of an equation when a coordinate changes by its magnitude; by less of it where the equation grows by magnitudes on the
/// way, as exp(v / 0.025) does.
fn response(equation: &Equation, pose: &mut [f64], slot: usize, magnitude: f64) -> f64 {
    let shares = POWERS
        .take_while(|power| *power <= 0)
        .map(|power| 2f64.powi(power));
    let changes = shares.map(|share| equation.change(pose, slot, share * magnitude));
    let changes: Vec<f64> = changes.collect();
    // From the whole magnitude downwards.
    let mut pairs = changes.windows(2).rev();
    let tame = pairs.find(|pair| pair[1] > 0.0 && (pair[0] == 0.0 || pair[1] <= FAR * pair[0]));
    tame.map_or(0.0, |pair| pair[1])
}
