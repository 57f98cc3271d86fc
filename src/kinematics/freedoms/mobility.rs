//! How many freedoms a mechanism has: by counting joints and loops, and by the rank at closed poses; which equations
//! are redundant and which freedoms are idle. Values only; the words are the command line's.
//!
//! The [count](super::count) is wrong for over-constrained mechanisms, whose equations depend on each other at closed poses:
//! there the numeric one holds.

use super::count::JointCount;
use super::generic_rank::{closed_poses, rank_of_rows};
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::branch::BranchWatch;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::solve::wishes::assemble_as_meant;
use crate::kinematics::structure::block::{Block, Held, block_of};
use crate::kinematics::structure::loop_part::{LoopPart, components_of};
use crate::kinematics::structure::system::System;
use crate::model::actuation::Actuation;
use crate::model::chain::Chain;
use crate::model::mechanism::Mechanism;

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
    /// Joints, loops and equations, counted.
    pub count: JointCount,
    /// Coordinates (unknowns and inputs) that a loop, an equation or a body uses.
    pub coordinates: usize,
    /// Of these the inputs.
    pub inputs: usize,
    /// Where the drive starts; `None` if there is no pose.
    pub at_start: Option<Numeric>,
    /// At the most regular of a few closed poses.
    pub generic: Option<Numeric>,
    /// Equations that the others imply at the first closed pose, as (loop, component): 0 to 2 rotation, 3 to 5
    /// translation. They are checked, but neither solved nor proved.
    pub redundant: Vec<(usize, usize)>,
    /// Loops and equations that the inputs alone must satisfy, by name: closed only where the inputs fit.
    pub conditions: Vec<String>,
    /// Freedoms that move nothing but the spin of a link.
    pub idle: Vec<Held>,
}

impl Mobility {
    /// Counts the freedoms of `mechanism`, whose order of solution is `structure`.
    pub fn new(system: &System, actuation: &Actuation) -> Self {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let whole = Whole::new(mechanism);
        let poses = closed_poses(system, actuation);
        let numeric: Vec<Numeric> = poses.iter().map(|pose| whole.numeric(pose)).collect();
        let used = whole.block.unknowns.iter();
        let mut mobility = Self {
            count: JointCount::new(mechanism),
            coordinates: whole.block.unknowns.len(),
            inputs: used.filter(|u| **u >= mechanism.unknowns.len()).count(),
            at_start: start_pose(system, actuation).map(|pose| whole.numeric(&pose)),
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

    /// Sorts the equations that are not solved: implied by others, or conditions on the inputs.
    fn left_out(&mut self, system: &System, whole: &Whole, pose: &[f64]) {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let mut watch = BranchWatch::default();
        let mut corrector = Corrector::new(system);
        watch.observe(system, &mut corrector, pose);
        let (mut solved, mut others) = (Vec::new(), Vec::new());
        for (block, basis) in structure.blocks.iter().zip(watch.bases()) {
            for (row, name) in row_names(block).enumerate() {
                if basis.contains(&row) {
                    solved.push(name);
                } else {
                    others.push(name);
                }
            }
        }
        let mut rows = whole.rows(&solved, pose);
        let mut rank = whole.rank_of(&rows);
        for name in others {
            rows.extend(whole.rows(&[name], pose));
            let with = whole.rank_of(&rows);
            match name {
                RowName::Loop(index, component) if with == rank => {
                    self.redundant.push((index, component));
                }
                RowName::Equation(_) if with == rank => {}
                RowName::Loop(index, _) => self.condition(&mechanism.loops[index].name),
                RowName::Equation(index) => self.condition(&mechanism.equations[index].name),
            }
            rank = with;
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum RowName {
    /// Loop and component.
    Loop(usize, usize),
    Equation(usize),
}

fn row_names(block: &Block) -> impl Iterator<Item = RowName> + '_ {
    let loops = block.loops.iter().flat_map(|part| {
        let components = part.components.iter();
        components.map(|c| RowName::Loop(part.index, *c))
    });
    loops.chain(block.equations.iter().map(|e| RowName::Equation(*e)))
}

/// All equations as one block whose unknowns are all coordinates that are used, by bodies too, and the inputs too.
struct Whole {
    mechanism: Mechanism,
    block: Block,
}

impl Whole {
    fn new(mechanism: &Mechanism) -> Self {
        // Inputs come after the unknowns: making them unknowns changes no slot.
        let lifted = Mechanism {
            unknowns: [mechanism.unknowns.clone(), mechanism.inputs.clone()].concat(),
            inputs: Vec::new(),
            bodies: Vec::new(),
            traces: Vec::new(),
            outputs: Vec::new(),
            ..mechanism.clone()
        };
        let loops: Vec<LoopPart> = (0..lifted.loops.len())
            .map(|index| LoopPart {
                index,
                components: components_of(&lifted, index).collect(),
            })
            .collect();
        let used = |slot: &usize| {
            let mut arguments = mechanism.chains().flat_map(Chain::arguments);
            let mut equations = lifted.equations.iter();
            arguments.any(|a| lifted.arguments[a].coordinates().contains(slot))
                || equations.any(|e| e.expression.slots().contains(slot))
        };
        let unknowns = (0..lifted.unknowns.len()).filter(used).collect();
        let equations = (0..lifted.equations.len()).collect();
        let block = block_of(&lifted, loops, equations, unknowns);
        Self {
            mechanism: lifted,
            block,
        }
    }

    fn numeric(&self, pose: &[f64]) -> Numeric {
        let all: Vec<RowName> = row_names(&self.block).collect();
        let rank = self.rank_of(&self.rows(&all, pose));
        let mobility = self.block.unknowns.len() - rank;
        Numeric { mobility, rank }
    }

    /// The named rows, one after the other.
    fn rows(&self, names: &[RowName], pose: &[f64]) -> Vec<f64> {
        let mut workspace = BlockWorkspace::default();
        workspace.evaluate(&self.mechanism, &self.block, pose, Want::Jacobian);
        let (rows, columns) = (self.block.rows(), self.block.unknowns.len());
        let all: Vec<RowName> = row_names(&self.block).collect();
        let mut list = Vec::with_capacity(names.len() * columns);
        for name in names {
            let Some(row) = all.iter().position(|known| known == name) else {
                continue;
            };
            list.extend((0..columns).map(|j| workspace.jacobian[j * rows + row]));
        }
        list
    }

    fn rank_of(&self, rows: &[f64]) -> usize {
        rank_of_rows(rows, self.block.unknowns.len())
    }
}
