//! How many freedoms a mechanism has: by counting joints and loops, and by the rank at closed poses; which equations
//! are redundant and which freedoms are idle. Values only; the words are the command line's.
//!
//! The count (Grübler, Kutzbach, for loops): joint freedoms, less the dimension of every loop's group of motions (6; 3
//! for planar and spherical loops, wherever their plane or centre lies), less the couplings. It is wrong for
//! over-constrained mechanisms, whose equations depend on each other at closed poses: there the numeric one holds.

use super::generic_rank::{RANK, closed_poses, random_poses};
use crate::kinematics::loops::residual::{BlockWorkspace, Want};
use crate::kinematics::solve::assembly::assemble;
use crate::kinematics::solve::branch::BranchWatch;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::block::{Block, Held, block};
use crate::kinematics::structure::loop_part::{LoopPart, components_of};
use crate::kinematics::structure::system::System;
use crate::linalg::pivoted_qr::PivotedQr;
use crate::math::Pose;
use crate::model::actuation::Actuation;
use crate::model::chain::Motion;
use crate::model::mechanism::{Closes, Mechanism};
use crate::model::walk::walk;

/// The motions that a loop's joints can make together.
#[derive(Clone, Debug, PartialEq)]
pub struct LoopSpace {
    /// Name of the loop.
    pub name: String,
    /// Dimension of the span of all its joints' twists over all poses: what closing it costs at most.
    pub dimension: usize,
    /// All rotations are about one direction, and all translations across it.
    pub is_planar: bool,
}

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
    /// Coordinates (unknowns and inputs) that a loop or equation uses: the joints' freedoms.
    pub freedoms: usize,
    /// Of these the inputs.
    pub inputs: usize,
    /// Every loop.
    pub loops: Vec<LoopSpace>,
    /// Scalar equations.
    pub couplings: usize,
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
            freedoms: whole.block.unknowns.len(),
            inputs: used.filter(|u| **u >= mechanism.unknowns.len()).count(),
            loops: loop_spaces(mechanism),
            couplings: mechanism.equations.len(),
            at_start: start(system, actuation).map(|pose| whole.numeric(&pose)),
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

    /// Joint freedoms less what the loops and couplings cost.
    pub fn count(&self) -> i64 {
        let cost: usize = self.loops.iter().map(|l| l.dimension).sum();
        self.freedoms as i64 - cost as i64 - self.couplings as i64
    }

    /// Dependent coordinates of a planar mechanism written as vector loops with angles to the frame: two equations
    /// a loop and one a coupling, d = 2k + s1. `None` if it is not planar.
    pub fn planar_dependents(&self) -> Option<usize> {
        let is_planar = !self.loops.is_empty() && self.loops.iter().all(|l| l.is_planar);
        is_planar.then_some(2 * self.loops.len() + self.couplings)
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
fn start(system: &System, actuation: &Actuation) -> Option<Vec<f64>> {
    let start = actuation.start_at(0.0);
    let finite = start.iter().all(|v| v.is_finite());
    let mut corrector = Corrector::new(system);
    let found = finite.then(|| assemble(system, &mut corrector, &start, true));
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

/// All equations as one block whose unknowns are all coordinates that are used, the inputs too.
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
            let mut chains = lifted.loops.iter().flat_map(|l| l.chain.arguments());
            let mut equations = lifted.equations.iter();
            chains.any(|a| lifted.arguments[a].coordinates().contains(slot))
                || equations.any(|e| e.expression.slots().contains(slot))
        };
        let unknowns = (0..lifted.unknowns.len()).filter(used).collect();
        let equations = (0..lifted.equations.len()).collect();
        let block = block(&lifted, loops, equations, unknowns);
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
        let columns = self.block.unknowns.len();
        if columns == 0 || rows.is_empty() {
            return 0;
        }
        // Rows one after the other are columns of the transposed matrix, which has the same rank.
        let mut qr = PivotedQr::default();
        qr.factor(rows, columns, rows.len() / columns, RANK);
        qr.rank()
    }
}

/// Spans of the loops' twists over random poses, closed or not: the group that the joints generate.
fn loop_spaces(mechanism: &Mechanism) -> Vec<LoopSpace> {
    let poses = random_poses(mechanism);
    let of_loop = |item: &crate::model::mechanism::Loop| {
        let (mut twists, mut turns) = (Vec::new(), Vec::new());
        for pose in &poses {
            let arguments = mechanism.argument_values(pose);
            let mut here = Pose::IDENTITY;
            walk(&item.chain.steps, &mut here, &arguments, |here, joint| {
                let axis = here.rotation.col(joint.axis);
                let (turn, speed) = match joint.motion {
                    Motion::Rotation => (axis, here.translation.cross(axis) / mechanism.size),
                    Motion::Translation => (glam::DVec3::ZERO, axis),
                };
                twists.extend(turn.to_array().into_iter().chain(speed.to_array()));
                turns.extend(turn.to_array());
            });
        }
        let rank = |entries: &[f64], rows: usize| {
            let mut qr = PivotedQr::default();
            qr.factor(entries, rows, entries.len() / rows, RANK);
            qr.rank()
        };
        let all = rank(&twists, 6);
        // Where a point closes the loop, its three coordinates are all that counts.
        let dimension = match item.closes {
            Closes::Frame => all,
            Closes::Point => all.min(3),
        };
        LoopSpace {
            name: item.name.clone(),
            dimension,
            is_planar: dimension == 3 && rank(&turns, 3) == 1,
        }
    };
    mechanism.loops.iter().map(of_loop).collect()
}
