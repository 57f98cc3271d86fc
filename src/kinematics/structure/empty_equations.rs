//! Equations of loops that hold at every random pose: finds those that hold by construction.
//!
//! By the axes of the chain, or because its angles cancel identically. The others may hold at random poses to the last
//! digit and nowhere exactly.

use crate::model::chain::{Chain, ChainStep, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;

/// Of the empty equations, given as (loop, component), those without an explanation in the chain.
pub fn unproved_of(mechanism: &Mechanism, empty: &[(usize, usize)]) -> Vec<(usize, usize)> {
    let is_unproved = |(index, component): &&(usize, usize)| {
        let chain = &mechanism.loops[*index].chain;
        !chain.pattern().always_holds(*component) && !angles_cancel(mechanism, chain, *component)
    };
    empty.iter().filter(is_unproved).copied().collect()
}

/// Whether a chain rotates about axis `component` only, by angles whose sum is identically zero.
fn angles_cancel(mechanism: &Mechanism, chain: &Chain, component: usize) -> bool {
    // Coefficients by coordinate; the constants have no coordinate.
    let mut sums: Vec<(Option<usize>, Vec<Constant>)> = Vec::new();
    let mut add = |slot: Option<usize>, c: Constant| match sums.iter_mut().find(|s| s.0 == slot) {
        Some((_, list)) => list.push(c),
        None => sums.push((slot, vec![c])),
    };
    for step in &chain.steps {
        let turns = match step {
            ChainStep::Fixed(pose) => !pose.pattern.turns_nothing(),
            ChainStep::Joint { motion, axis, .. } => {
                *motion == ElementaryMotion::Rotation && *axis != component
            }
        };
        if turns {
            return false;
        }
        if let Some(joint) = step
            .joint()
            .filter(|j| j.motion == ElementaryMotion::Rotation)
        {
            let Some(form) = mechanism.arguments[joint.argument].affine() else {
                return false;
            };
            let signed = |c: Constant| if joint.sign < 0.0 { -c } else { c };
            add(None, signed(form.constant));
            for (slot, c) in form.terms {
                add(Some(slot), signed(c));
            }
        }
    }
    component < 3 && sums.into_iter().all(|(_, list)| is_zero_sum(list))
}

/// Whether numbers cancel exactly: opposite ones in pairs, the rest without an error.
fn is_zero_sum(mut list: Vec<Constant>) -> bool {
    let mut sum = Constant::exact(0.0);
    while let Some(c) = list.pop() {
        // Equal numbers cancel exactly, also those that carry an error.
        match list.iter().position(|other| *other == -c) {
            Some(place) => {
                list.swap_remove(place);
            }
            None => sum = sum + c,
        }
    }
    sum == Constant::exact(0.0)
}
