//! How well loops and equations can be closed: the effect of the rounding of angles after many turns, and of coordinates far
//! from the origin.

use crate::kinematics::loops::forward::{closure_error, loop_gap};
use crate::kinematics::loops::residual::BlockWorkspace;
use crate::kinematics::structure::block::Block;
use crate::model::chain::{ArgumentValue, ChainStep, ElementaryMotion};
use crate::model::mechanism::{Equation, Kind, Loop, Mechanism};

/// Largest residual of a returned pose, relative to the mechanism's size. Rounding leaves about 1e-15; anything above
/// this has not converged.
pub const CLOSURE_TOLERANCE: f64 = 1e-11;

/// Largest accepted effect of the rounding of coordinates; above it a pose means little. It is reached after some million
/// turns, or some ten million lengths of a bar from the origin.
const COARSEST: f64 = 1e-8;

/// Largest closure error of an assembly that counts, in radians and sizes; of an equation also relative to its own terms at the
/// pose. Rounding leaves about 1e-15; a start that stopped beside a pose leaves far more.
pub const CLOSED: f64 = 1e-12;

/// What an equation takes from elsewhere is known to this fraction of its magnitude over the motion, unless it is exactly zero.
const ROUNDED: f64 = 1e-15;

/// Half a spacing of f64 for an angle's own rounding, as much for that of the joint's value, and links that reach a few
/// sizes.
const SPACINGS: f64 = 4.0;

/// The same of a term of a sum: half a spacing for its own rounding and for that of the sum, twice, since Newton's method ends
/// beside the best pose.
const SPACINGS_OF_TERMS: f64 = 2.0;

/// The effect of the rounding of a block's angles: beyond 131 072 rad adjacent f64 are farther apart than the
/// tolerance.
pub fn angle_rounding(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> f64 {
    let slots = block.unknowns.iter().chain(&block.plan.outer);
    let all = mechanism.unknowns.iter().chain(&mechanism.inputs);
    let kinds: Vec<Kind> = all.map(|c| c.kind).collect();
    let angles = slots.filter(|slot| kinds[**slot] == Kind::Angle);
    let sum: f64 = angles.map(|slot| coordinates[*slot].abs()).sum();
    SPACINGS * f64::EPSILON * sum
}

/// The effect of the rounding of displacements on the translation of a loop, in its sizes: they are added up, however small the
/// sum is.
fn loop_rounding(item: &Loop, arguments: &[ArgumentValue]) -> f64 {
    let displacements = item.chain.steps.iter().map(|step| match step {
        ChainStep::Fixed(pose) => pose.translation.length(),
        ChainStep::Joint {
            motion: ElementaryMotion::Translation,
            argument,
            ..
        } => arguments[*argument].value.abs(),
        ChainStep::Joint { .. } => 0.0,
    });
    SPACINGS_OF_TERMS * f64::EPSILON * displacements.sum::<f64>() / item.size
}

/// The effect of the rounding of an equation's coordinates and terms on its residual. At a pose with larger terms than those of
/// the motion more is accepted.
fn equation_rounding(equation: &Equation, coordinates: &[f64]) -> Rounding {
    let terms = equation.sensitive_terms(coordinates);
    let largest = equation.summand(coordinates) * equation.weight;
    Rounding {
        amount: SPACINGS_OF_TERMS * f64::EPSILON * terms * equation.weight,
        coarsest: COARSEST * largest.max(1.0),
    }
}

/// An effect of rounding and the largest that is accepted.
struct Rounding {
    amount: f64,
    coarsest: f64,
}

/// The effect of the rounding of displacements and terms on every row of a block.
fn place_roundings(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> Vec<Rounding> {
    let none = || Rounding {
        amount: 0.0,
        coarsest: COARSEST,
    };
    let mut rows: Vec<Rounding> = (0..block.rows()).map(|_| none()).collect();
    let arguments = mechanism.argument_values(coordinates);
    for (part, planned) in block.loops.iter().zip(&block.plan.loops) {
        let shifts = loop_rounding(&mechanism.loops[part.index], &arguments);
        for (k, component) in part.components.iter().enumerate() {
            // Rotations do not depend on displacements.
            if *component >= 3 {
                rows[planned.row + k].amount += shifts;
            }
        }
    }
    for planned in &block.plan.equations {
        rows[planned.row] = equation_rounding(&mechanism.equations[planned.index], coordinates);
    }
    rows
}

/// The largest residual of every row of a block that rounding explains, if that is accepted.
fn row_roundings(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> Vec<f64> {
    let angles = angle_rounding(mechanism, block, coordinates);
    let rows = place_roundings(mechanism, block, coordinates).into_iter();
    rows.map(|row| (angles + row.amount).min(row.coarsest))
        .collect()
}

/// What is so large that its own rounding leaves a larger closure error than a pose may have.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TooLarge {
    /// The angles of some block.
    Angles,
    /// Displacements beside the unit of a loop, or coordinates beside the length of a bar.
    Places,
}

/// Whether the rounding of coordinates alone leaves some block open.
pub fn too_large(mechanism: &Mechanism, blocks: &[Block], coordinates: &[f64]) -> Option<TooLarge> {
    blocks.iter().find_map(|block| {
        if angle_rounding(mechanism, block, coordinates) > COARSEST {
            return Some(TooLarge::Angles);
        }
        let mut places = place_roundings(mechanism, block, coordinates);
        // Other formulas may be steep, such as asin(x) near one: that is no matter of places.
        let formulas = block.plan.equations.iter();
        let others = formulas.filter(|planned| planned.quadratic.is_none());
        others.for_each(|planned| places[planned.row].amount = 0.0);
        let are_coarse = places.iter().any(|row| row.amount > row.coarsest);
        are_coarse.then_some(TooLarge::Places)
    })
}

/// Whether every entry of a residual is explained by rounding.
pub(super) fn is_rounding(
    mechanism: &Mechanism,
    block: &Block,
    coordinates: &[f64],
    residual: &[f64],
) -> bool {
    let rows = row_roundings(mechanism, block, coordinates);
    let mut pairs = residual.iter().zip(rows);
    pairs.all(|(left, most)| left.abs() <= most)
}

/// Whether a block is closed as well as its coordinates permit at the pose that a workspace has evaluated.
pub(super) fn is_closed(
    mechanism: &Mechanism,
    block: &Block,
    coordinates: &[f64],
    workspace: &BlockWorkspace,
) -> bool {
    if workspace.residual_norm() <= CLOSURE_TOLERANCE {
        return true;
    }
    let rows = row_roundings(mechanism, block, coordinates);
    let mut pairs = workspace.residual.iter().zip(rows);
    pairs.all(|(left, rounding)| left.abs() <= rounding.max(CLOSURE_TOLERANCE))
}

/// Whether the equations of a block hold beside their own terms at the pose, not only beside those of other poses.
pub(super) fn hold_beside_terms(mechanism: &Mechanism, block: &Block, coordinates: &[f64]) -> bool {
    let mut equations = block.equations.iter();
    equations.all(|index| {
        let equation = &mechanism.equations[*index];
        // What other blocks and drives have rounded.
        let known = || {
            let slots = equation.expression.slots().into_iter();
            let given =
                slots.filter(|slot| !block.unknowns.contains(slot) && coordinates[*slot] != 0.0);
            let slopes = equation.expression.gradient(coordinates);
            let moved = given.map(|slot| (slopes[slot] * mechanism.scale_of(slot)).abs());
            ROUNDED * moved.sum::<f64>()
        };
        holds_beside_terms(equation, coordinates, known)
    })
}

/// Whether the value of an equation is little beside its terms, or rounding, or less than is `known`.
fn holds_beside_terms(
    equation: &Equation,
    coordinates: &[f64],
    known: impl FnOnce() -> f64,
) -> bool {
    let value = equation.expression.value(coordinates).abs();
    let terms = equation.summand(coordinates);
    if terms.is_normal() && value <= CLOSED * terms {
        return true;
    }
    // Terms that are no numbers any more, exp(-800), say nothing.
    if value == 0.0 && !terms.is_normal() && equation.sinks(coordinates) {
        return false;
    }
    let rounding = SPACINGS_OF_TERMS * f64::EPSILON * equation.sensitive_terms(coordinates);
    value <= rounding.min(COARSEST * terms) || value <= known()
}

/// Whether all equations hold beside their own terms at a pose.
pub fn all_hold_beside_terms(mechanism: &Mechanism, coordinates: &[f64]) -> bool {
    let mut equations = mechanism.equations.iter();
    equations.all(|equation| holds_beside_terms(equation, coordinates, || 0.0))
}

/// Whether all loops close and all equations hold, as well as the rounding of the coordinates permits.
pub fn closes(mechanism: &Mechanism, coordinates: &[f64]) -> bool {
    // Near the origin rounding is far below the tolerance.
    if closure_error(mechanism, coordinates) <= CLOSED {
        return true;
    }
    let arguments = mechanism.argument_values(coordinates);
    let are_loops_closed = mechanism.loops.iter().all(|item| {
        let (angle, distance) = loop_gap(item, &arguments);
        let rounding = loop_rounding(item, &arguments).min(COARSEST);
        angle <= CLOSED && distance / item.size <= rounding.max(CLOSED)
    });
    let mut equations = mechanism.equations.iter();
    are_loops_closed
        && equations.all(|equation| {
            let value = equation.expression.value(coordinates) * equation.weight;
            let rounding = equation_rounding(equation, coordinates);
            value.abs() <= rounding.amount.min(rounding.coarsest).max(CLOSED)
        })
}
