//! Which equations say something, and in which order loops can be solved: blocks of loops that share unknowns.
//!
//! Everything here depends on the mechanism only, not on a pose; it is made once before the first solve. The order
//! itself is found in `order`, the poses that decide on ranks in `probes`, idle freedoms in `idle`.

use super::closure::{BlockWorkspace, Want};
use super::idle::{self, Held};
use super::order::{Group, Member, System, unknowns_of};
use super::plan::BlockPlan;
use super::probes::{Ranks, closed_poses, random_poses};
use crate::model::mechanism::{Closes, Mechanism};
use std::ops::Range;

/// The part of a loop that a block solves.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopPart {
    /// Index of the loop.
    pub index: usize,
    /// Its equations that are not empty: 0 to 2 rotation about x, y, z; 3 to 5 translation.
    pub components: Vec<usize>,
}

/// A group of loops and equations that is solved together.
#[derive(Clone, Debug, PartialEq)]
pub struct Block {
    /// Loops and their equations.
    pub loops: Vec<LoopPart>,
    /// Scalar equations.
    pub equations: Vec<usize>,
    /// Unknowns it determines.
    pub unknowns: Vec<usize>,
    /// Column of each coordinate in the block's Jacobian, if it is one of its unknowns.
    pub column_of: Vec<Option<usize>>,
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

/// The order of solution.
#[derive(Clone, Debug, PartialEq)]
pub struct Structure {
    /// Each block needs only unknowns of earlier ones.
    pub blocks: Vec<Block>,
    /// Equations that hold at every pose, as (loop, component).
    pub empty_equations: Vec<(usize, usize)>,
    /// Unknowns that keep their start value, because nothing but the idle spin of a link depends on them.
    pub held: Vec<Held>,
}

/// A mechanism that no pose can solve, or that is not determined.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum StructureError {
    /// A loop has the same gap at every pose.
    #[error("loop `{name}` cannot close at any pose: {what} always differs by {gap:.6} {unit}")]
    Impossible {
        /// Name of the loop.
        name: String,
        /// The equation in words.
        what: String,
        /// Its constant value.
        gap: f64,
        /// Unit of the gap: radians or the scene's length unit.
        unit: String,
    },
    /// More unknowns than independent equations.
    #[error("{freedoms} more coordinate(s) are free than the inputs drive: {}", names.join(", "))]
    UnderDetermined {
        /// How many.
        freedoms: usize,
        /// Unknowns that can move while the inputs stand still.
        names: Vec<String>,
    },
    /// Unknowns that change no equation.
    #[error("no loop and no equation holds `{}`: nothing there changes with it", names.join("`, `"))]
    Unheld {
        /// Their names.
        names: Vec<String>,
    },
}

/// An equation counts as empty when it stays below this (residuals are scaled, of order one) at all probes.
/// Rounding of a long chain stays far below, a real equation far above.
const EMPTY: f64 = 1e-12;

impl Structure {
    /// Analyses `mechanism`.
    ///
    /// Ranks are taken at random poses. Loops with more equations than unknowns, and those that seem to lack
    /// equations, are judged at closed poses too: an over-constrained loop has its true rank only there, and only
    /// there it shows whether a freedom is idle.
    pub fn new(mechanism: &Mechanism) -> Result<Self, StructureError> {
        let probes = random_poses(mechanism);
        let (parts, empty_equations) = live_equations(mechanism, &probes)?;
        let system = System::new(mechanism, parts);
        let generic = Ranks::new(mechanism, &probes);
        refuse_unheld(mechanism, &system, &generic)?;
        let mut structure = Self {
            blocks: generic.blocks(&system, system.groups(&[])),
            empty_equations,
            held: Vec::new(),
        };
        let square = |b: &Block| b.rows() == b.unknowns.len();
        if structure
            .blocks
            .iter()
            .all(|b| square(b) && !generic.lacks(b))
        {
            return Ok(structure);
        }
        let poses = structure.poses_of_unsure(mechanism, &system);
        if poses.is_empty() {
            // Nothing closes: solving will say so, unless the mechanism is not determined anyway.
            let lacking = structure.blocks.iter().find(|b| generic.lacks(b));
            return match lacking {
                Some(block) => Err(generic.under_determined(block)),
                None => Ok(structure),
            };
        }
        let closed = Ranks::new(mechanism, &poses);
        structure.blocks = closed.blocks(&system, system.groups(&[]));
        let held = idle::find(mechanism, &structure, &closed)?;
        if !held.is_empty() {
            let slots: Vec<usize> = held.iter().map(|h| h.unknown).collect();
            structure.blocks = closed.blocks(&system, system.groups(&slots));
            structure.held = held;
        }
        Ok(structure)
    }

    /// Closed poses of a mechanism whose blocks are not sure yet: by blocks, else with everything in one.
    fn poses_of_unsure(&self, mechanism: &Mechanism, system: &System) -> Vec<Vec<f64>> {
        let poses = closed_poses(mechanism, self);
        if !poses.is_empty() || self.blocks.len() < 2 {
            return poses;
        }
        let groups = system.merged(&[]);
        let merged = Self {
            blocks: groups
                .iter()
                .map(|g| of_group(mechanism, system, g))
                .collect(),
            ..self.clone()
        };
        closed_poses(mechanism, &merged)
    }

    /// The block that solves the loop or equation `name`, if it has more equations than unknowns.
    pub fn overfull(&self, mechanism: &Mechanism, name: &str) -> Option<&Block> {
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
pub fn names(mechanism: &Mechanism, slots: impl Iterator<Item = usize>) -> Vec<String> {
    slots.map(|u| mechanism.unknowns[u].name.clone()).collect()
}

/// The block of a group.
pub fn of_group(mechanism: &Mechanism, system: &System, group: &Group) -> Block {
    let (mut loops, mut equations) = (Vec::new(), Vec::new());
    for member in &group.members {
        match &system.members[*member] {
            Member::Loop(part) => loops.push(part.clone()),
            Member::Equation(index) => equations.push(*index),
        }
    }
    block(mechanism, loops, equations, group.unknowns.clone())
}

/// An unknown that changes no equation at any pose stands in the formulas only in vain.
fn refuse_unheld(
    mechanism: &Mechanism,
    system: &System,
    ranks: &Ranks,
) -> Result<(), StructureError> {
    let mut felt = vec![false; mechanism.unknowns.len()];
    let mut workspace = BlockWorkspace::default();
    for member in 0..system.members.len() {
        let block = of_group(mechanism, system, &system.whole(vec![member], &[]));
        for pose in ranks.poses {
            workspace.evaluate(mechanism, &block, pose, Want::Jacobian);
            let columns = workspace.jacobian.chunks(block.rows().max(1));
            for (unknown, column) in block.unknowns.iter().zip(columns) {
                felt[*unknown] |= column.iter().any(|v| v.abs() > EMPTY || v.is_nan());
            }
        }
    }
    let unheld: Vec<usize> = (0..felt.len()).filter(|u| !felt[*u]).collect();
    if unheld.is_empty() {
        return Ok(());
    }
    let names = names(mechanism, unheld.into_iter());
    Err(StructureError::Unheld { names })
}

type LiveEquations = (Vec<LoopPart>, Vec<(usize, usize)>);

/// The equations of a loop: all six, or the translations where a point closes it.
pub(super) fn components_of(mechanism: &Mechanism, index: usize) -> Range<usize> {
    match mechanism.loops[index].closes {
        Closes::Frame => 0..6,
        Closes::Point => 3..6,
    }
}

/// Splits every loop's six equations into those that say something and those that always hold.
fn live_equations(
    mechanism: &Mechanism,
    probes: &[Vec<f64>],
) -> Result<LiveEquations, StructureError> {
    let (mut parts, mut empty) = (Vec::new(), Vec::new());
    let mut workspace = BlockWorkspace::default();
    for index in 0..mechanism.loops.len() {
        let whole = LoopPart {
            index,
            components: (0..6).collect(),
        };
        let unknowns = unknowns_of(mechanism, &Member::Loop(whole.clone()));
        let all = block(mechanism, vec![whole], Vec::new(), unknowns);
        let mut live = [false; 6];
        let mut constant = [0.0_f64; 6];
        for probe in probes {
            // Inputs move too: a row that only they change is live, though no unknown can repair it.
            let mut rates = vec![0.0; mechanism.coordinate_count()];
            let inputs = rates[mechanism.unknowns.len()..].iter_mut();
            // Each at a rate of its own, so that they do not cancel.
            inputs
                .zip(1..)
                .for_each(|(rate, k)| *rate = f64::from(k).sqrt());
            workspace.evaluate(mechanism, &all, probe, Want::Drift(&rates));
            for (k, live) in live.iter_mut().enumerate() {
                let row = (0..all.unknowns.len()).map(|j| workspace.jacobian[j * 6 + k].abs());
                let largest = row.fold(workspace.drift.as_flattened()[k].abs(), f64::max);
                *live |= largest > EMPTY || largest.is_nan();
            }
            constant.copy_from_slice(&workspace.residual);
        }
        let wanted = components_of(mechanism, index);
        let components: Vec<usize> = wanted.clone().filter(|k| live[*k]).collect();
        for k in wanted.filter(|k| !live[*k]) {
            if constant[k].abs() > EMPTY {
                let (gap, unit) = if k < 3 {
                    (constant[k], "rad")
                } else {
                    (constant[k] * mechanism.size, mechanism.length_unit.as_str())
                };
                let name = mechanism.loops[index].name.clone();
                return Err(StructureError::Impossible {
                    name,
                    what: component_name(k).to_owned(),
                    gap,
                    unit: unit.to_owned(),
                });
            }
            empty.push((index, k));
        }
        parts.push(LoopPart { index, components });
    }
    Ok((parts, empty))
}

/// An equation of a loop in words.
pub fn component_name(component: usize) -> &'static str {
    [
        "the rotation about x",
        "the rotation about y",
        "the rotation about z",
        "the translation along x",
        "the translation along y",
        "the translation along z",
    ][component]
}

/// The block of the given loops, equations and unknowns.
pub fn block(
    mechanism: &Mechanism,
    loops: Vec<LoopPart>,
    equations: Vec<usize>,
    unknowns: Vec<usize>,
) -> Block {
    let mut column_of = vec![None; mechanism.coordinate_count()];
    for (column, unknown) in unknowns.iter().enumerate() {
        column_of[*unknown] = Some(column);
    }
    let mut arguments: Vec<usize> = loops
        .iter()
        .flat_map(|part| mechanism.loops[part.index].chain.arguments())
        .collect();
    arguments.sort_unstable();
    arguments.dedup();
    let plan = BlockPlan::new(mechanism, &loops, &equations, &arguments, &column_of);
    Block {
        loops,
        equations,
        unknowns,
        column_of,
        arguments,
        plan,
    }
}
