//! Finds a first closed pose from start values that may be far off: Levenberg-Marquardt, then Newton.

use super::closure::CLOSURE_TOLERANCE;
use super::descent::Descent;
use super::newton::{Corrector, Pace};
use super::settled_roots::settle_block;
use super::turns::WholeTurns;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::model::mechanism::{Kind, Mechanism};
use std::f64::consts::{PI, TAU};

/// Most iterations per block and weight for a remaining closure error: far from closing, the linear model represents
/// only part of the curvature, and convergence is linear.
const GAP_ITERATIONS: u32 = 3000;

/// Weights of rotations relative to distances over the size when the remaining distance is measured: the remaining
/// rotation is about the inverse square of the last weight. The valley is too narrow to be followed with the last
/// weight at once.
const TURNS_FIRST: [f64; 4] = [1e1, 1e2, 1e3, 1e4];

/// Smallest number of them, for expensive systems.
const FEWEST_GAP_ITERATIONS: u32 = 30;

/// Number of perturbed starts after the given one, with growing amplitude.
const EXTRA_STARTS: usize = 24;

/// Their maximum cost, in steps of a small mechanism: for a net of five hundred unknowns two are tried.
const COST_OF_STARTS: usize = 8192;

/// No pose was found.
#[derive(Clone, Debug, PartialEq)]
pub struct NotClosed {
    /// Name of the loop or equation with the largest remaining closure error.
    pub name: String,
    /// Smallest remaining rotation found, radians (zero for an equation).
    pub angle: f64,
    /// Smallest remaining distance found, in the scene's unit (or the value of an equation).
    pub distance: f64,
    /// Unit of the distance: the loop's own size.
    pub unit: f64,
    /// Unknowns, then inputs, of the best pose found.
    pub coordinates: Vec<f64>,
}

impl NotClosed {
    /// The closure error, in radians and sizes.
    pub fn amount(&self) -> f64 {
        self.angle.max(self.distance / self.unit)
    }
}

/// A closed pose and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Assembled {
    /// Unknowns, then inputs.
    pub coordinates: Vec<f64>,
    /// Iterations of all tries from the start values and beside them, and of the last correction.
    pub iterations: u32,
    /// Zero for the given start, else the number of the perturbed start that succeeded.
    pub start: usize,
}

/// Closes all loops from the unknowns in `start` (unknowns, then inputs), with perturbed starts if `persist`.
pub fn assemble_pose(
    system: &System,
    corrector: &mut Corrector,
    start: &[f64],
    persist: bool,
) -> Result<Assembled, NotClosed> {
    let mechanism = system.mechanism();
    let mut best: Option<NotClosed> = None;
    let mut iterations = 0;
    let most = EXTRA_STARTS.min(COST_OF_STARTS / system.step_cost());
    for attempt in 0..=if persist { most } else { 0 } {
        let mut coordinates = start.to_vec();
        perturb_start(mechanism, attempt, &mut coordinates);
        // Held unknowns keep their start value, wherever the others start.
        for held in &system.structure().held {
            coordinates[held.unknown] = start[held.unknown];
        }
        match close_block(system, corrector, &mut coordinates, &mut iterations) {
            Ok(()) => {
                return Ok(Assembled {
                    coordinates,
                    iterations,
                    start: attempt,
                });
            }
            Err(gap) => {
                if best.as_ref().is_none_or(|b| gap.amount() < b.amount()) {
                    best = Some(gap);
                }
            }
        }
    }
    Err(best.unwrap_or(NotClosed {
        name: String::new(),
        angle: 0.0,
        distance: 0.0,
        unit: mechanism.size,
        coordinates: start.to_vec(),
    }))
}

/// The remaining closure error of a mechanism that cannot be closed: from the best pose found, rotations are closed
/// first, then the distance is minimised. A plain least-squares pose would trade one for the other.
pub fn smallest_gap(system: &System, best: NotClosed) -> NotClosed {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let cost = u32::try_from(system.step_cost()).unwrap_or(u32::MAX);
    let most = (GAP_ITERATIONS / cost).max(FEWEST_GAP_ITERATIONS);
    let mut descent = Descent::until(CLOSURE_TOLERANCE, most);
    let mut coordinates = best.coordinates.clone();
    for block in &structure.blocks {
        let mut left = f64::INFINITY;
        // Continuation in the weight of the rotations: first rotations, then distances.
        for weight in TURNS_FIRST {
            descent.turn_weight = weight;
            left = descent.minimise(mechanism, block, &mut coordinates).1;
        }
        if left > CLOSURE_TOLERANCE {
            return closure_gap(mechanism, block, &coordinates);
        }
    }
    best
}

/// Moves the unknowns of start number `attempt` by a repeatable random amount; start 0 stays.
fn perturb_start(mechanism: &Mechanism, attempt: usize, coordinates: &mut [f64]) {
    if attempt == 0 {
        return;
    }
    let amplitude = 0.3 + 2.8 * attempt as f64 / EXTRA_STARTS as f64;
    shake_start(mechanism, attempt, amplitude, coordinates);
}

/// Moves every unknown by a random amount up to `amplitude` in scaled unknowns; the same for the same `attempt`.
pub fn shake_start(mechanism: &Mechanism, attempt: usize, amplitude: f64, coordinates: &mut [f64]) {
    let mut state = 0x2545_f491_4f6c_dd1d_u64.wrapping_mul(attempt as u64 + 1);
    for (index, value) in coordinates[..mechanism.unknowns.len()]
        .iter_mut()
        .enumerate()
    {
        // Xorshift: 53 bits of it become a number in [-1, 1).
        state ^= state << 13;
        state ^= state >> 7;
        state ^= state << 17;
        let random = (state >> 11) as f64 / (1u64 << 52) as f64 - 1.0;
        *value += mechanism.scale_of(index) * amplitude * random;
    }
}

/// Closes all blocks from the present coordinates; counts the iterations.
///
/// # Errors
/// The closure error of the first block that does not close.
pub fn close_block(
    system: &System,
    corrector: &mut Corrector,
    coordinates: &mut [f64],
    iterations: &mut u32,
) -> Result<(), NotClosed> {
    let mechanism = system.mechanism();
    let structure = system.structure();
    let mut descent = Descent::default();
    let (mut turns, mut before) = (None, Vec::new());
    for (index, block) in structure.blocks.iter().enumerate() {
        *iterations += descent.minimise(mechanism, block, coordinates).0;
        before.clear();
        before.extend(block.unknowns.iter().map(|slot| coordinates[*slot]));
        let mut correct = |coordinates: &mut [f64]| {
            let correction = corrector.correct_block(system, index, coordinates, Pace::Patient);
            *iterations += correction.iterations;
            correction.converged
        };
        let mut is_closed = correct(coordinates);
        // Angles of many turns cannot be closed as accurately as their remainders.
        if is_closed && wrap_angles(mechanism, block, &mut turns, coordinates) {
            is_closed = correct(coordinates);
        }
        // An equation whose terms have become small holds at a root only.
        is_closed = is_closed && settle_block(mechanism, block, coordinates);
        if !is_closed {
            let pairs = block.unknowns.iter().zip(&before);
            pairs.for_each(|(slot, value)| coordinates[*slot] = *value);
            return Err(closure_gap(mechanism, block, coordinates));
        }
    }
    Ok(())
}

/// Angles up to this (radians) close to the tolerance whatever their rounding.
const LOOSE_ANGLE: f64 = 1e3;

/// A long search may have added whole turns to a block's angles; they are reduced to -π..π if they are used only in
/// plain rotations by whole multiples.
///
/// Returns whether any was so large that its rounding may have affected the closure.
fn wrap_angles(
    mechanism: &Mechanism,
    block: &Block,
    turns: &mut Option<WholeTurns>,
    coordinates: &mut [f64],
) -> bool {
    let mut any = false;
    for &slot in &block.unknowns {
        let value = &mut coordinates[slot];
        if mechanism.unknowns[slot].kind != Kind::Angle || value.abs() <= PI {
            continue;
        }
        let turns = turns.get_or_insert_with(|| WholeTurns::of(mechanism));
        // A whole turn less is the same pose; a large angle had lost digits.
        if !turns.matter(slot) {
            any |= value.abs() > LOOSE_ANGLE;
            *value -= TAU * (*value / TAU).round();
        }
    }
    any
}

/// The loop or equation of `block` with the largest closure error.
fn closure_gap(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> NotClosed {
    let values = mechanism.argument_values(coordinates);
    let mut worst = NotClosed {
        name: String::new(),
        angle: 0.0,
        distance: 0.0,
        unit: mechanism.size,
        coordinates: coordinates.to_vec(),
    };
    let mut largest = -1.0;
    // The loop with the largest closure error, by angle or by its own length.
    for part in &block.loops {
        let item = &mechanism.loops[part.index];
        let (angle, distance) = crate::kinematics::loops::forward::loop_gap(item, &values);
        if angle.max(distance / item.size) > largest {
            largest = angle.max(distance / item.size);
            worst = NotClosed {
                name: item.name.clone(),
                angle,
                distance,
                unit: item.size,
                ..worst
            };
        }
    }
    // Scalar equations, likewise.
    for index in &block.equations {
        let equation = &mechanism.equations[*index];
        let value = equation.expression.value(coordinates);
        let weight = equation.weight;
        let scaled = value.abs() * weight;
        if scaled > largest || scaled.is_nan() {
            largest = scaled;
            worst = NotClosed {
                name: equation.name.clone(),
                angle: 0.0,
                distance: mechanism.equation_gap(equation, value),
                unit: 1.0 / weight,
                ..worst
            };
        }
    }
    worst
}
