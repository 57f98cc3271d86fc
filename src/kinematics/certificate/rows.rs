//! Which equations of its loops a proof of a block looks at, and in which rows they stand.
//!
//! First the rows of the block. Then those that the structure found empty at random poses and knows no reason for: they
//! are bounded at every pose, like every row beyond the number of unknowns.

use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;
use crate::kinematics::structure::block::Block;
use crate::kinematics::structure::system::System;

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
            let unproved = system.structure().unproved_equations.iter();
            for (_, component) in unproved.filter(|(l, _)| *l == part.index) {
                of_loop.push((*component, rows.count));
                rows.count += 1;
            }
        }
        rows
    }
}

/// Number of equations beyond the unknowns that no proof can take: they are only bounded.
pub fn redundant_rows(system: &System) -> usize {
    let beyond = |block: &Block| {
        let rows = ProofRows::new(system, block).count;
        rows.saturating_sub(block.unknowns.len())
    };
    system.blocks().iter().map(beyond).sum()
}
