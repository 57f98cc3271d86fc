//! The mobility of a mechanism: by counting joints and loops, and by the rank at closed poses; its redundant equations
//! and idle freedoms. Plain values, which the reports put into words.
//!
//! The [count](super::count) is wrong for over-constrained mechanisms, whose equations depend on each other at closed
//! poses: there the numeric mobility is correct.

use super::count::JointCount;
use super::generic_rank::{EMPTY, RANK, closed_poses};
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::branch::BranchWatch;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::wishes::assemble_as_meant;
use crate::kinematics::structure::block::{Block, HeldFreedom};
use crate::kinematics::structure::loop_part::{LoopPart, components_of};
use crate::kinematics::structure::ordering::{Incidence, of_group};
use crate::kinematics::structure::system::System;
use crate::linalg::fronts::{Fronts, SparseRow};
use crate::model::actuation::Actuation;
use crate::model::chain::Chain;
use crate::model::mechanism::Mechanism;
use std::collections::BTreeSet;

/// Freedoms at closed poses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Numeric {
    /// Coordinates less the rank.
    pub mobility: usize,
    /// Rank of all equations by unknowns and inputs.
    pub rank: usize,
}

/// The freedoms of a mechanism.
#[derive(Clone, Debug, PartialEq)]
pub struct Mobility {
    /// The count of joints, loops and equations.
    pub count: JointCount,
    /// Coordinates (unknowns and inputs) that a loop, an equation or a body uses.
    pub coordinates: usize,
    /// Of these the inputs.
    pub inputs: usize,
    /// The start of the drive; `None` if there is no pose.
    pub at_start: Option<Numeric>,
    /// At the most regular of a few closed poses.
    pub generic: Option<Numeric>,
    /// Equations that the others imply at the first closed pose. They are checked, but neither solved nor proved.
    pub redundant: Vec<RowName>,
    /// Names of loops and equations that the inputs alone must satisfy: closed only if the inputs are consistent.
    pub conditions: Vec<String>,
    /// Freedoms that move nothing but the spin of a link.
    pub idle: Vec<HeldFreedom>,
}

impl Mobility {
    /// Determines the freedoms of `mechanism` with the blocks `structure`.
    pub fn new(system: &System, actuation: &Actuation) -> Self {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let whole = Whole::new(system);
        let poses = closed_poses(system, actuation);
        // The rank at closed poses: the true mobility, in addition to the count of Chebyshev, Grübler and Kutzbach.
        let numeric: Vec<Numeric> = poses.iter().map(|pose| whole.numeric_count(pose)).collect();
        let used = whole.used.iter();
        let mut mobility = Self {
            count: JointCount::new(mechanism),
            coordinates: whole.used.len(),
            inputs: used.filter(|u| **u >= mechanism.unknowns.len()).count(),
            at_start: start_pose(system, actuation).map(|pose| whole.numeric_count(&pose)),
            generic: numeric.into_iter().min_by_key(|n| n.mobility),
            redundant: Vec::new(),
            conditions: Vec::new(),
            idle: structure.held.clone(),
        };
        if let Some(pose) = poses.first() {
            mobility.left_out(system, &whole, pose);
        }
        mobility
    }

    /// Classifies the equations that are not solved: implied by others, or conditions on the inputs.
    fn left_out(&mut self, system: &System, whole: &Whole, pose: &[f64]) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let mut watch = BranchWatch::default();
        let mut corrector = Corrector::new(system);
        watch.observe(system, &mut corrector, pose);
        let (mut solved, mut others) = (BTreeSet::new(), Vec::new());
        for (block, basis) in structure.blocks.iter().zip(watch.bases()) {
            for (row, name) in row_names(block).enumerate() {
                if basis.binary_search(&row).is_ok() {
                    solved.insert(name);
                } else {
                    others.push(name);
                }
            }
        }
        let mut space = whole.row_space(pose, |name| solved.contains(&name));
        for name in others {
            // A row in the span of the solved ones is redundant; any other one restricts the inputs.
            let is_implied = !space.add(&whole.named_row(name, pose));
            match name {
                _ if is_implied => self.redundant.push(name),
                RowName::Loop(index, _) => self.condition(&mechanism.loops[index].name),
                RowName::Equation(index) => self.condition(&mechanism.equations[index].name),
            }
        }
        self.redundant.sort_unstable();
    }

    fn condition(&mut self, name: &str) {
        if !self.conditions.iter().any(|known| known == name) {
            self.conditions.push(name.to_owned());
        }
    }
}

/// Where the drive starts.
fn start_pose(system: &System, actuation: &Actuation) -> Option<Vec<f64>> {
    let start = actuation.start_at(0.0);
    let finite = start.iter().all(|v| v.is_finite());
    let mut corrector = Corrector::new(system);
    let found = finite.then(|| assemble_as_meant(system, &mut corrector, &start, &actuation.named));
    Some(found?.ok()?.coordinates)
}

/// One row of a Jacobian.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum RowName {
    /// Loop and component: 0 to 2 rotation, 3 to 5 translation.
    Loop(usize, usize),
    /// Equation or bar.
    Equation(usize),
}

fn row_names(block: &Block) -> impl Iterator<Item = RowName> + '_ {
    let loops = block.loops.iter().flat_map(|part| {
        let components = part.components.iter();
        components.map(|c| RowName::Loop(part.index, *c))
    });
    loops.chain(block.equations.iter().map(|e| RowName::Equation(*e)))
}

/// All equations, each by the coordinates that it uses, with the inputs as unknowns.
struct Whole {
    mechanism: Mechanism,
    /// Every loop with all its equations, then every scalar equation.
    members: Vec<Block>,
    /// Coordinates that are used, by bodies too, ascending.
    used: Vec<usize>,
    /// Front of every coordinate: blocks in the reverse order of their solution, then everything outside blocks.
    front_of: Vec<usize>,
}

impl Whole {
    fn new(system: &System) -> Self {
        let mechanism = system.mechanism();
        // Inputs come after the unknowns: making them unknowns changes no slot.
        let lifted = Mechanism {
            unknowns: [mechanism.unknowns.clone(), mechanism.inputs.clone()].concat(),
            inputs: Vec::new(),
            bodies: Vec::new(),
            traces: Vec::new(),
            outputs: Vec::new(),
            ..mechanism.clone()
        };
        let parts = (0..lifted.loops.len()).map(|index| LoopPart {
            index,
            components: components_of(&lifted, index).collect(),
        });
        let incidence = Incidence::new(&lifted, parts.collect());
        let all = 0..incidence.members.len();
        let alone = all.map(|member| incidence.whole(vec![member], &[]));
        let members = alone.map(|group| of_group(&lifted, &incidence, &group));
        Self {
            members: members.collect(),
            used: used_coordinates(mechanism),
            front_of: block_fronts(system),
            mechanism: lifted,
        }
    }

    fn numeric_count(&self, pose: &[f64]) -> Numeric {
        let rank = self.row_space(pose, |_| true).rank();
        let mobility = self.used.len() - rank;
        Numeric { mobility, rank }
    }

    /// The space of the rows that `are_meant`.
    fn row_space(&self, pose: &[f64], are_meant: impl Fn(RowName) -> bool) -> Fronts {
        let mut workspace = BlockWorkspace::default();
        let mut rows = Vec::new();
        for block in &self.members {
            let wanted: Vec<RowName> = row_names(block).filter(|name| are_meant(*name)).collect();
            if !wanted.is_empty() {
                workspace.evaluate(&self.mechanism, block, pose, Want::Jacobian);
            }
            let named = row_names(block).enumerate();
            let meant = named.filter(|(_, name)| wanted.contains(name));
            // Sparse rows over all coordinates of the mechanism.
            rows.extend(meant.map(|(row, _)| sparse_row(block, &workspace, row)));
        }
        Fronts::new(rows, self.front_of.clone(), RANK)
    }

    /// A row by name.
    fn named_row(&self, name: RowName, pose: &[f64]) -> SparseRow {
        let member = match name {
            RowName::Loop(index, _) => index,
            RowName::Equation(index) => self.mechanism.loops.len() + index,
        };
        let block = &self.members[member];
        let mut workspace = BlockWorkspace::default();
        workspace.evaluate(&self.mechanism, block, pose, Want::Jacobian);
        let row = row_names(block).position(|known| known == name);
        row.map_or_else(Vec::new, |row| sparse_row(block, &workspace, row))
    }
}

/// One row of the block's Jacobian, without rounding errors.
fn sparse_row(block: &Block, workspace: &BlockWorkspace, row: usize) -> SparseRow {
    let column = |j: usize| workspace.jacobian[j * block.rows() + row];
    let entries = block.unknowns.iter().copied().zip((0..).map(column));
    entries
        .filter(|(_, v)| v.is_nan() || v.abs() > EMPTY)
        .collect()
}

/// Coordinates that appear in a chain or in an equation, ascending.
fn used_coordinates(mechanism: &Mechanism) -> Vec<usize> {
    let mut is_used = vec![false; mechanism.coordinate_count()];
    let mut arguments: Vec<usize> = mechanism.chains().flat_map(Chain::arguments).collect();
    arguments.sort_unstable();
    arguments.dedup();
    let in_chains = arguments.into_iter();
    let in_chains = in_chains.flat_map(|a| mechanism.arguments[a].coordinates());
    let in_equations = mechanism.equations.iter();
    let in_equations = in_equations.flat_map(|e| e.expression.slots());
    in_chains.chain(in_equations).for_each(|slot| {
        if let Some(is_used) = is_used.get_mut(slot) {
            *is_used = true;
        }
    });
    (0..is_used.len()).filter(|slot| is_used[*slot]).collect()
}

/// The front of every coordinate. An equation has unknowns of its own block and of those before it.
fn block_fronts(system: &System) -> Vec<usize> {
    let count = system.blocks().len();
    let mut front_of = vec![count; system.mechanism().coordinate_count()];
    for (index, block) in system.blocks().iter().enumerate() {
        let front = count - 1 - index;
        block.unknowns.iter().for_each(|u| front_of[*u] = front);
    }
    front_of
}
