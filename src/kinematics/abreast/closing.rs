//! Newton's method in eight lanes, block by block, as in `solve/newton`: a lane stops when it is closed, and leaves if
//! its steps do not decrease.

use super::anchor::AnchorPose;
use super::block_values::{BlockValues, LaneBlock};
use super::factors::{Factors, OctetElimination, Ordered};
use crate::kinematics::solve::closure::CLOSURE_TOLERANCE;
use crate::kinematics::solve::newton::{CONTRACTION, ROUNDING_FLOOR};
use crate::kinematics::structure::system::System;
use crate::numbers::octet::{LANES, LaneMask, Octet};

/// Most iterations: three suffice for good predictions; a lane that needs more delays its neighbours.
const MOST_ITERATIONS: usize = 6;

/// Closes poses of one system in eight lanes; one per thread.
#[derive(Clone, Debug)]
pub struct LaneSolver<'s> {
    system: &'s System,
    blocks: Vec<LaneBlock<'s>>,
    values: BlockValues,
    factors: Factors,
    pose: Vec<f64>,
}

/// The result of eight corrections.
#[derive(Clone, Copy, Debug)]
pub struct ClosedLanes {
    /// Lanes that are closed and near their anchor; nothing is known of the others.
    pub lanes: LaneMask,
    /// Largest first step of a block in scaled unknowns: the error of the prediction.
    pub first_step: Octet,
}

impl<'s> LaneSolver<'s> {
    /// Buffers for `system`.
    pub fn new(system: &'s System) -> Self {
        let mechanism = system.mechanism();
        let blocks = system.blocks().iter();
        Self {
            blocks: blocks.map(|b| LaneBlock::new(mechanism, b)).collect(),
            values: BlockValues::default(),
            factors: Factors::default(),
            pose: Vec::new(),
            system,
        }
    }

    /// Corrects the unknowns of `lanes` near `anchor` until all loops close; the inputs stay.
    pub fn close(
        &mut self,
        anchor: &AnchorPose,
        coordinates: &mut [Octet],
        lanes: LaneMask,
    ) -> ClosedLanes {
        let mut closed = ClosedLanes {
            lanes,
            first_step: Octet::ZERO,
        };
        for (index, block) in anchor.blocks.iter().enumerate() {
            let elimination = &mut Ordered {
                factors: &mut self.factors,
                order: &block.order,
            };
            let lane_block = &self.blocks[index];
            let values = &mut self.values;
            let part = close_block(lane_block, values, elimination, coordinates, closed.lanes);
            // A lane counts as closed only while its Jacobian stays near the anchor's.
            closed.lanes = block.beside(&self.values.jacobian, part.lanes);
            closed.first_step = closed.first_step.larger_magnitude(part.first_step);
            if !closed.lanes.any() {
                return closed;
            }
        }
        closed.lanes = self.unlocked(anchor, coordinates, closed.lanes);
        closed
    }

    /// The members of `lanes` in which no ball joint is near a pose with locked angles, or beyond one.
    fn unlocked(
        &mut self,
        anchor: &AnchorPose,
        coordinates: &[Octet],
        mut lanes: LaneMask,
    ) -> LaneMask {
        let balls = self.system.balls();
        for lane in (0..LANES).filter(|_| !balls.is_empty()) {
            self.pose.clear();
            self.pose.extend(coordinates.iter().map(|c| c.lane(lane)));
            let pose = &self.pose;
            if balls
                .iter()
                .any(|b| b.may_have_locked(&anchor.coordinates, pose))
            {
                lanes = lanes.except(lane);
            }
        }
        lanes
    }
}

/// Newton's method on one block; its values are those of the poses that it leaves.
pub(super) fn close_block(
    lane_block: &LaneBlock,
    values: &mut BlockValues,
    elimination: &mut impl OctetElimination,
    coordinates: &mut [Octet],
    mut lanes: LaneMask,
) -> ClosedLanes {
    let plan = &lane_block.block.plan;
    let floor = Octet::splat(ROUNDING_FLOOR);
    let (mut done, mut first_step) = (LaneMask::NONE, Octet::ZERO);
    let mut last = Octet::splat(f64::INFINITY);
    for iteration in 0..=MOST_ITERATIONS {
        values.evaluate(lane_block, coordinates, iteration > 0);
        let open = lanes.without(done);
        if !open.any() {
            break;
        }
        if iteration == MOST_ITERATIONS {
            lanes = lanes.and(done);
            break;
        }
        // At the rounding level a lane is closed; another step does no harm.
        let at_floor = largest(&values.residual).at_most(floor);
        let (is_good, pivot) = elimination.factor(&values.jacobian);
        elimination.solve(&values.residual);
        let size = largest(elimination.step());
        if iteration == 0 {
            first_step = size;
        }
        // A lane leaves if its steps do not decrease as in Newton's method, or a pivot is too small.
        let shrinks = size.at_most(last * CONTRACTION).or(at_floor);
        lanes = lanes.and(done.or(is_good.and(shrinks)));
        let open = lanes.without(done);
        // Lanes that have stopped keep their bits.
        let scaled = plan.scales.iter().zip(elimination.step());
        for (unknown, (scale, step)) in lane_block.block.unknowns.iter().zip(scaled) {
            let before = coordinates[*unknown];
            coordinates[*unknown] = open.choose(before + *step * *scale, before);
        }
        // Quadratic convergence: the error after this step is about step²/σ.
        done = done
            .or(at_floor)
            .or((size * size).at_most(pivot * ROUNDING_FLOOR));
        last = size;
    }
    let residual = largest(&values.residual);
    ClosedLanes {
        lanes: lanes.and(residual.at_most(Octet::splat(CLOSURE_TOLERANCE))),
        first_step,
    }
}

/// The largest magnitude of every lane; NaN where there is none.
pub(super) fn largest(values: &[Octet]) -> Octet {
    let larger = |m: Octet, v: &Octet| m.larger_magnitude(*v);
    values.iter().fold(Octet::ZERO, larger)
}
