//! Which equations of its loops a proof of a block looks at, and in which rows they stand.
//!
//! First the rows of the block. Then those that the structure found empty at random poses: the ones that hold by the axes
//! of the chain, or because its angles cancel, need no look; the others are bounded at every pose, like every row beyond
//! the number of unknowns.

use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;
use crate::model::chain::{Chain, ChainStep, ElementaryMotion};
use crate::model::mechanism::Mechanism;
use crate::numbers::constant::Constant;

/// A redundant equation that may be open by more at a pose, in radians and sizes, has no bound worth the name: the solver
/// itself calls a loop closed below that, and the pose is too near a singular one. Rounding and digits explain a
/// thousandth of it, unless dimensions are many times the mechanism's size.
pub const LARGEST_GAP: f64 = CLOSURE_TOLERANCE;

/// The same over a tube: one that is too coarse is halved, so that little is hidden in what it cuts off.
pub const LARGEST_GAP_OF_TUBE: f64 = 0.1 * LARGEST_GAP;

/// The rows of a block's loops.
#[derive(Clone, Debug, Default)]
pub struct ProofRows {
    /// Of every loop: its equations (0 to 2 rotation, 3 to 5 translation) and the rows they stand in.
    pub loops: Vec<Vec<(usize, usize)>>,
    /// The first row of the block's scalar equations.
    pub first_equation: usize,
    /// Number of all rows.
    pub count: usize,
}

impl ProofRows {
    /// Of one of the system's blocks.
    pub fn new(system: &System, block: &Block) -> Self {
        let mut rows = Self::default();
        for part in &block.loops {
            let first = rows.first_equation;
            rows.first_equation += part.components.len();
            rows.loops
                .push(part.components.iter().copied().zip(first..).collect());
        }
        rows.count = block.rows();
        for (part, of_loop) in block.loops.iter().zip(&mut rows.loops) {
            let chain = &system.mechanism().loops[part.index].chain;
            let pattern = chain.pattern();
            let always_holds = |component: usize| {
                pattern.always_holds(component)
                    || angles_cancel(system.mechanism(), chain, component)
            };
            let empty = system.structure().empty_equations.iter();
            let unproved = empty.filter(|(l, k)| *l == part.index && !always_holds(*k));
            for (_, component) in unproved {
                of_loop.push((*component, rows.count));
                rows.count += 1;
            }
        }
        rows
    }
}

/// Whether a chain turns about axis `component` only, by angles whose sum is zero whatever the coordinates are.
fn angles_cancel(mechanism: &Mechanism, chain: &Chain, component: usize) -> bool {
    // Coefficients by coordinate; the constants stand under none.
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
        match list.iter().position(|other| *other == -c) {
            Some(place) => {
                list.swap_remove(place);
            }
            None => sum = sum + c,
        }
    }
    sum == Constant::exact(0.0)
}

/// Number of equations beyond the unknowns that no proof can take: they are only bounded.
pub fn redundant_rows(system: &System) -> usize {
    let beyond = |block: &Block| {
        let rows = ProofRows::new(system, block).count;
        rows.saturating_sub(block.unknowns.len())
    };
    system.blocks().iter().map(beyond).sum()
}
