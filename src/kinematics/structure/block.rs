//! Blocks of loops that share unknowns, in the order in which they are solved.
//!
//! Plain values. They depend on the mechanism only, not on a pose, and are created once, in
//! [`analysis`](crate::kinematics::freedoms::analysis).

use super::columns::ColumnMap;
use super::layout::BlockPlan;
use super::loop_part::LoopPart;
use crate::diag::decimals_of;
use crate::limits::LimitExceeded;
use crate::model::mechanism::Mechanism;

/// A group of loops and equations that is solved together.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Loops and their equations.
    pub loops: Vec<LoopPart>,
    /// Scalar equations.
    pub equations: Vec<usize>,
    /// Unknowns it determines.
    pub unknowns: Vec<usize>,
    /// The columns of its unknowns in its Jacobian.
    pub columns: ColumnMap,
    /// Arguments that its loops use.
    pub arguments: Vec<usize>,
    /// Layout for evaluation.
    pub plan: BlockPlan,
}

impl Block {
    /// Number of equations.
    pub fn rows(&self) -> usize {
        self.loops
            .iter()
            .map(|part| part.components.len())
            .sum::<usize>()
            + self.equations.len()
    }
}

/// An idle freedom.
#[derive(Clone, Debug, PartialEq)]
pub struct HeldFreedom {
    /// The unknown that keeps its start value.
    pub unknown: usize,
    /// All unknowns that take part in the motion, ascending.
    pub moving: Vec<usize>,
    /// Loop of the spinning link; `None` if the motion only exchanges angles of one joint.
    pub turning: Option<usize>,
}

/// The order of solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Each block needs only unknowns of earlier ones.
    pub blocks: Vec<Block>,
    /// Equations that hold at every pose, as (loop, component).
    pub empty_equations: Vec<(usize, usize)>,
    /// Those that hold numerically only, for no known reason.
    pub unproved_equations: Vec<(usize, usize)>,
    /// Unknowns that keep their start value, because they only affect the idle spin of a link.
    pub held: Vec<HeldFreedom>,
}

/// A mechanism that has no pose at all, or is not determined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// A loop has the same closure error at every pose.
    #[error("loop `{name}` cannot close at any pose: {what} always differs by {} {unit}", decimals_of(*gap, 6))]
    Impossible {
        /// Name of the loop.
        name: String,
        /// The equation in words.
        what: String,
        /// Its constant value.
        gap: f64,
        /// Unit of the closure error: radians or the scene's length unit.
        unit: String,
    },
    /// More unknowns than independent equations.
    #[error("{freedoms} more {} free than the inputs drive: {}", if *freedoms == 1 { "coordinate is" } else { "coordinates are" }, names.join(", "))]
    UnderDetermined {
        /// How many.
        freedoms: usize,
        /// Unknowns that can move while the inputs are fixed.
        names: Vec<String>,
    },
    /// Unknowns that change no equation at any pose examined.
    #[error("no loop and no equation determines `{}`: at the start values and at random poses nothing changes with it", names.join("`, `"))]
    Unheld {
        /// Their names.
        names: Vec<String>,
    },
    /// Equations that must be solved together need more memory than the run may use.
    #[error(transparent)]
    Limit(#[from] LimitExceeded),
}

impl StructureError {
    /// A suggested remedy.
    pub fn hint(&self) -> Option<&'static str> {
        match self {
            Self::Impossible { .. } => {
                Some("check the constant offsets of this loop: they must cancel")
            }
            Self::UnderDetermined { .. } => Some(
                "drive them as inputs, add a loop or an equation, or look for a misspelt parameter: \
                 an undefined name is an unknown",
            ),
            Self::Unheld { .. } => Some(
                "give it a loop or an equation that changes with it, drive it as an input, or take it out; \
                 where a formula is flat, start nearer to its solution",
            ),
            Self::Limit(_) => None,
        }
    }
}

impl Structure {
    /// The block that solves the loop or equation `name`, if it has more equations than unknowns.
    pub fn overfull_block(&self, mechanism: &Mechanism, name: &str) -> Option<&Block> {
        let mut blocks = self.blocks.iter();
        blocks.find(|block| {
            let mut loops = block
                .loops
                .iter()
                .map(|part| &mechanism.loops[part.index].name);
            let mut equations = block
                .equations
                .iter()
                .map(|e| &mechanism.equations[*e].name);
            let is_here = loops.any(|n| n == name) || equations.any(|n| n == name);
            is_here && block.rows() > block.unknowns.len()
        })
    }

    /// Number of equations that are solved.
    pub fn equation_count(&self) -> usize {
        self.blocks.iter().map(Block::rows).sum()
    }
}

/// Names of the given unknowns.
pub fn slot_names(mechanism: &Mechanism, slots: impl Iterator<Item = usize>) -> Vec<String> {
    slots.map(|u| mechanism.unknowns[u].name.clone()).collect()
}

/// The block of the given loops, equations and unknowns.
pub fn block_of(
    mechanism: &Mechanism,
    loops: Vec<LoopPart>,
    equations: Vec<usize>,
    unknowns: Vec<usize>,
) -> Block {
    let columns = ColumnMap::new(&unknowns);
    let mut arguments: Vec<usize> = loops
        .iter()
        .flat_map(|part| mechanism.loops[part.index].chain.arguments())
        .collect();
    arguments.sort_unstable();
    arguments.dedup();
    let plan = BlockPlan::new(mechanism, &loops, &equations, &arguments, &unknowns);
    Block {
        loops,
        equations,
        unknowns,
        columns,
        arguments,
        plan,
    }
}
