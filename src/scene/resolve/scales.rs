//! Units of length: every loop has its own, so that a tiny loop next to a huge one is solved and judged as if it were
//! alone.
//!
//! Loops and equations that share a length have the same unit, since the sums of one enter the other.

use crate::model::chain::{ChainStep, ElementaryMotion};
use crate::model::equation_terms::finite_or_zero;
use crate::model::mechanism::{Equation, Kind, Loop, Mechanism};
use std::f64::consts::TAU;

/// Units are the size of the mechanism divided by powers of this factor: loops of similar size share a unit, so that
/// their singular values can be compared, and a small change of a dimension changes no unit.
const STEP: f64 = 1.0 / 1024.0;

/// An offset smaller than this multiple of its own error is the rounding error of folded constants.
const CLEAR: f64 = 1e3;

/// Assigns a unit to every loop, coordinate and equation of `mechanism`, whose size is known, from some poses of its motion.
pub fn estimate_scales(mechanism: &mut Mechanism, mut poses: Vec<Vec<f64>>) {
    // The length of every loop and equation, with the coordinates that it shares with others.
    let of_loops = mechanism.loops.iter();
    let of_loops =
        of_loops.map(|item| (of_loop(mechanism, item, &poses), slots_of(mechanism, item)));
    let mut members: Vec<(f64, Vec<usize>)> = of_loops.collect();
    let of_equations = mechanism.equations.iter();
    members.extend(
        of_equations.map(|e| (of_equation(mechanism, e, &mut poses), e.expression.slots())),
    );
    for (_, slots) in &mut members {
        slots.retain(|slot| mechanism.kind_of(*slot) == Kind::Length);
    }
    // Members with a common length get a common unit; coordinates without any keep the size.
    share_scales(&mut members, mechanism.coordinate_count());
    let size = mechanism.size;
    let units: Vec<f64> = members
        .iter()
        .map(|(reach, _)| scale_unit(size, *reach))
        .collect();
    mechanism.scales = (0..mechanism.coordinate_count())
        .map(|slot| mechanism.natural_size(mechanism.kind_of(slot)))
        .collect();
    for ((_, slots), unit) in members.iter().zip(&units) {
        slots
            .iter()
            .for_each(|slot| mechanism.scales[*slot] = *unit);
    }
    // Residuals are measured in the units of their own loop or equation.
    let (of_loops, of_equations) = units.split_at(mechanism.loops.len());
    for (item, unit) in mechanism.loops.iter_mut().zip(of_loops) {
        item.size = *unit;
    }
    for (equation, unit) in mechanism.equations.iter_mut().zip(of_equations) {
        let exponent = equation.length_exponent;
        equation.weight = libm::pow(size, -exponent) / libm::pow(unit / size, exponent);
    }
}

/// Members that share a length all get the largest of their lengths.
fn share_scales(members: &mut [(f64, Vec<usize>)], coordinates: usize) {
    let mut longest = vec![0.0_f64; coordinates];
    // Every pass propagates the largest length by at least one member.
    let mut changed = true;
    while changed {
        changed = false;
        for (reach, slots) in members.iter_mut() {
            let known = slots.iter().fold(*reach, |m, slot| m.max(longest[*slot]));
            changed |= known > *reach || slots.iter().any(|slot| longest[*slot] < known);
            *reach = known;
            slots.iter().for_each(|slot| longest[*slot] = known);
        }
    }
}

/// The smallest unit that is not below `reach`; the size if nothing is known.
fn scale_unit(size: f64, reach: f64) -> f64 {
    let mut unit = size;
    while reach > 0.0 && unit * STEP >= reach {
        unit *= STEP;
    }
    unit
}

fn slots_of(mechanism: &Mechanism, item: &Loop) -> Vec<usize> {
    let arguments = item.chain.arguments().into_iter();
    arguments
        .flat_map(|a| mechanism.arguments[a].coordinates())
        .collect()
}

/// The longest offset of a loop: fixed ones, and translations at the start values and for one turn of their angles.
fn of_loop(mechanism: &Mechanism, item: &Loop, poses: &[Vec<f64>]) -> f64 {
    let mut scratch = Vec::new();
    let mut longest = 0.0_f64;
    for step in &item.chain.steps {
        match step {
            ChainStep::Fixed(pose) => {
                let offset = pose.translation.length();
                if offset > CLEAR * pose.error.translation {
                    longest = longest.max(offset);
                }
            }
            ChainStep::Joint {
                motion: ElementaryMotion::Translation,
                argument,
                ..
            } => {
                let argument = &mechanism.arguments[*argument];
                // A translation at the start values and along the drive, and the advance of a screw per turn.
                for pose in poses {
                    longest = longest.max(finite_or_zero(argument.value(pose, &mut scratch)));
                    for (slot, rate) in argument.gradient(pose) {
                        if mechanism.kind_of(slot) != Kind::Length {
                            longest = longest.max(finite_or_zero(rate * TAU));
                        }
                    }
                }
            }
            ChainStep::Joint { .. } => {}
        }
    }
    longest
}

/// The magnitude of an equation's terms as a length.
fn of_equation(mechanism: &Mechanism, equation: &Equation, poses: &mut [Vec<f64>]) -> f64 {
    if equation.length_exponent <= 0.0 {
        return 0.0;
    }
    let mut reach = 0.0_f64;
    for pose in poses {
        reach = reach.max(equation.terms(pose));
        for slot in equation.expression.slots() {
            if mechanism.kind_of(slot) != Kind::Length {
                reach = reach.max(equation.change(pose, slot, 1.0));
            }
        }
    }
    libm::pow(reach, 1.0 / equation.length_exponent)
}
