//! Proof that an equation is undefined beyond the end of a motion.
//!
//! Its formula is enclosed with the inputs of a place beyond, and with arbitrary unknowns. If that is inconclusive, the
//! blocks solved before its own are followed to that place by tubes, and their values are inserted.

use super::proved_stretch::{bare_mechanism, proved_samples, proved_value};
use crate::kinematics::certificate::absence::enclosed_inputs;
use crate::kinematics::motion::tracker::path_tracker::PathPoint;
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::expression::Expression;
use crate::numbers::constant::Constant;
use crate::numbers::interval::Interval;
use std::sync::Arc;

/// Largest mechanism whose earlier blocks are followed again.
const MOST_UNKNOWNS: usize = 60;

/// Whether equation `index` is proved to be undefined at `time`, beyond the last pose `end`.
pub(super) fn is_proved(
    system: &System,
    (actuation, time): (&Actuation, f64),
    end: &PathPoint,
    index: usize,
) -> bool {
    let mechanism = system.mechanism();
    let inputs = &actuation.inputs_at(time)[..];
    let formula = &mechanism.equations[index].expression;
    if formula.has_value_everywhere() {
        return false;
    }
    let mut known = enclosed_inputs(mechanism, inputs);
    // Those of the drive itself, not of their numbers alone.
    let driven = known[mechanism.unknowns.len()..].iter_mut();
    for (value, drive) in driven.zip(&actuation.drives) {
        *value = value.hull(drive.range_at(time));
    }
    if formula.range(&known).is_none() {
        return true;
    }
    // With the loops that are solved before it, followed to these inputs by tubes.
    let Some(values) = values_before(system, inputs, end, index) else {
        return false;
    };
    for (slot, value) in values {
        known[slot] = value;
    }
    formula.range(&known).is_none()
}

/// The unknowns of all blocks before that of an equation, on the motion from `end` on.
fn values_before(
    system: &System,
    inputs: &[f64],
    end: &PathPoint,
    equation: usize,
) -> Option<Vec<(usize, Interval)>> {
    let mut blocks = system.blocks().iter();
    let own = blocks.position(|block| block.equations.contains(&equation))?;
    let before = &system.blocks()[..own];
    if before.is_empty() || system.mechanism().unknowns.len() > MOST_UNKNOWNS {
        return None;
    }
    let mut mechanism = bare_mechanism(system.mechanism());
    // A block that is not followed has no closure error: it may be undefined there.
    let is_kept = |equation: usize| before.iter().any(|b| b.equations.contains(&equation));
    for (k, equation) in mechanism.equations.iter_mut().enumerate() {
        if !is_kept(k) {
            equation.expression = Expression::constant(Constant::exact(0.0));
        }
    }
    let parts = before.iter().flat_map(|block| &block.loops);
    for (k, item) in mechanism.loops.iter_mut().enumerate() {
        if !parts.clone().any(|part| part.index == k) {
            item.chain.steps.clear();
        }
    }
    let mut structure = system.structure().clone();
    structure.blocks.truncate(own);
    let (unknowns, from) = end.coordinates.split_at(mechanism.unknowns.len());
    let actuation = Actuation::straight(from, inputs, unknowns.to_vec());
    let part = System::bare(Arc::new(mechanism), structure);
    let samples = proved_samples(&part, &actuation, &[0.0, 1.0])?;
    let slots = before.iter().flat_map(|block| &block.unknowns);
    let values = slots.map(|slot| {
        let [value, error] = proved_value(part.mechanism(), samples.last()?, *slot)?;
        let radius = Interval::around_zero(error);
        Some((*slot, Interval::point(value) + radius))
    });
    values.collect()
}
