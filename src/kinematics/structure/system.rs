//! A mechanism ready to be solved: its chains, its blocks, its ball joints. It is created once, never changed, and
//! passed to everything that solves, proves or counts.

use super::block::{Block, Structure};
use super::proof_plan::ProofPlan;
use crate::kinematics::ball::joint::{Ball, ball_joints};
use crate::model::mechanism::Mechanism;
use std::sync::{Arc, OnceLock};

/// Up to this size of blocks a step has unit cost; elimination in larger ones costs more, with the cube of the size.
const CHEAP_BLOCK: usize = 32;

/// A step along a path with so many unknowns in small blocks has unit cost.
const CHEAP_UNKNOWNS: usize = 6;

/// A resolved mechanism and its blocks.
///
/// Drives, duration and start values, which a verb may change, are separate: see
/// [`Actuation`](crate::model::actuation::Actuation).
#[derive(Clone, Debug)]
pub struct System {
    mechanism: Arc<Mechanism>,
    structure: Structure,
    balls: Vec<Ball>,
    chart: Option<Box<System>>,
    /// The layout of its proofs; created when the first pose is proved.
    proof_plan: OnceLock<ProofPlan>,
}

impl System {
    /// The cost of a step of the solution, in steps of a small mechanism.
    pub fn step_cost(&self) -> usize {
        let blocks = self.structure.blocks.iter();
        let costs = blocks.map(|b| (b.unknowns.len() / CHEAP_BLOCK).pow(3));
        costs.sum::<usize>().max(1)
    }

    /// The same of a step along a path, in which many small blocks cost, too.
    pub fn path_step_cost(&self) -> usize {
        let many = self.mechanism.unknowns.len() / CHEAP_UNKNOWNS;
        self.step_cost().max(many)
    }

    /// A system of known structure without ball joints: a trial while ranks are being determined, or a chart.
    pub(crate) fn bare(mechanism: Arc<Mechanism>, structure: Structure) -> Self {
        Self {
            mechanism,
            structure,
            balls: Vec::new(),
            chart: None,
            proof_plan: OnceLock::new(),
        }
    }

    /// The same with its ball joints, and with the chart that `describe` makes of it if there are any.
    pub(crate) fn with_ball_joints(self, describe: impl Fn(&Self, &[Ball]) -> Self) -> Self {
        let balls = ball_joints(&self.mechanism, &self.structure);
        let chart = (!balls.is_empty()).then(|| Box::new(describe(&self, &balls)));
        Self {
            balls,
            chart,
            ..self
        }
    }

    /// Coordinates, chains, bodies.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Blocks, empty equations, held unknowns.
    pub fn structure(&self) -> &Structure {
        &self.structure
    }

    /// The blocks in the order of their solution.
    pub fn blocks(&self) -> &[Block] {
        &self.structure.blocks
    }

    /// Ball joints of the loops.
    pub fn balls(&self) -> &[Ball] {
        &self.balls
    }

    /// How its poses are proved.
    pub fn proof_plan(&self) -> &ProofPlan {
        let make = || ProofPlan::new(&self.mechanism, &self.structure);
        self.proof_plan.get_or_init(make)
    }

    /// Number of equations beyond the unknowns that cannot be proved: they are only bounded.
    pub fn redundant_rows(&self) -> usize {
        self.proof_plan().redundant_rows
    }

    /// The same mechanism with every ball joint described by a small rotation relative to a pose; `None` if it has
    /// none.
    pub fn chart(&self) -> Option<&System> {
        self.chart.as_deref()
    }
}
