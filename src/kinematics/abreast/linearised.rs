//! The loops of eight poses linearised at these poses: tangents, and how far singular poses are.

use super::block_values::{BlockValues, LaneBlock};
use super::closing::{ClosedLanes, close_block, largest};
use super::factors::{LARGEST_BLOCK, OctetElimination};
use super::pivoting::PivotedFactors;
use crate::kinematics::solve::between::MOST_CHANGE;
use crate::kinematics::structure::system::System;
use crate::numbers::octet::{LaneMask, Octet};

/// Jacobians of all blocks of one system at eight poses, and their factors.
#[derive(Clone, Debug)]
pub(super) struct Linearised<'s> {
    blocks: Vec<LaneBlock<'s>>,
    values: Vec<BlockValues>,
    factors: Vec<PivotedFactors>,
    /// The Jacobian of a block at the poses before.
    before: Vec<Octet>,
    column: Vec<Octet>,
}

impl<'s> Linearised<'s> {
    /// Buffers for `system`; `None` if it has blocks that cannot be solved side by side.
    pub fn new(system: &'s System) -> Option<Self> {
        let blocks = system.blocks();
        let is_small = blocks
            .iter()
            .all(|b| b.rows() == b.unknowns.len() && b.rows() <= LARGEST_BLOCK);
        let mechanism = system.mechanism();
        is_small.then(|| Self {
            blocks: (blocks.iter())
                .map(|block| LaneBlock::new(mechanism, block).with_outside())
                .collect(),
            values: vec![BlockValues::default(); blocks.len()],
            factors: vec![PivotedFactors::default(); blocks.len()],
            before: Vec::new(),
            column: Vec::new(),
        })
    }

    /// Linearises at closed poses; returns those of `lanes` that are regular.
    pub fn at(&mut self, coordinates: &[Octet], mut lanes: LaneMask) -> LaneMask {
        let parts = self.values.iter_mut().zip(&mut self.factors);
        for (block, (values, factors)) in self.blocks.iter().zip(parts) {
            values.evaluate(block, coordinates, false);
            lanes = lanes.and(factors.factor(&values.jacobian).0);
        }
        lanes
    }

    /// Closes predicted poses and linearises there: block by block, and only lanes whose Jacobians change so little that
    /// no pose between is singular.
    pub fn close(&mut self, coordinates: &mut [Octet], lanes: LaneMask) -> ClosedLanes {
        let mut closed = ClosedLanes {
            lanes,
            first_step: Octet::ZERO,
        };
        for index in 0..self.blocks.len() {
            let (block, values) = (&self.blocks[index], &mut self.values[index]);
            let factors = &mut self.factors[index];
            self.before.clear();
            self.before.extend_from_slice(&values.jacobian);
            let part = close_block(block, values, factors, coordinates, closed.lanes);
            closed.first_step = closed.first_step.larger_magnitude(part.first_step);
            let (is_good, _) = factors.factor(&values.jacobian);
            closed.lanes = part.lanes.and(is_good).and(self.stays_regular(index));
        }
        closed
    }

    /// Rates of the unknowns for the rates of the inputs in the tail of `rates`; returns the largest scaled one.
    pub fn tangent(&mut self, rates: &mut [Octet]) -> Octet {
        let mut length = Octet::ZERO;
        // J q' = -∂r/∂u u', block by block: the tangents of one are rates for the later ones.
        let parts = self.values.iter().zip(&mut self.factors);
        for (lane_block, (values, factors)) in self.blocks.iter().zip(parts) {
            values.drift(lane_block, rates, &mut self.column);
            factors.solve(&self.column);
            length = length.larger_magnitude(largest(factors.step()));
            let block = lane_block.block;
            let scaled = block.plan.scales.iter().zip(factors.step());
            for (unknown, (scale, step)) in block.unknowns.iter().zip(scaled) {
                rates[*unknown] = *step * *scale;
            }
        }
        length
    }

    /// A lower bound of the smallest singular value of every lane, except for rounding: 1 / ‖J⁻¹‖ by Frobenius' norm.
    pub fn least_sigma(&mut self) -> Octet {
        let mut least = Octet::splat(f64::INFINITY);
        for (block, factors) in self.blocks.iter().zip(&mut self.factors) {
            let rows = block.block.rows();
            let mut square = Octet::ZERO;
            for k in 0..rows {
                self.column.clear();
                self.column.resize(rows, Octet::ZERO);
                self.column[k] = Octet::splat(1.0);
                factors.solve(&self.column);
                square = sum_of_squares(square, factors.step());
            }
            let sigma = Octet::splat(1.0) / square.root();
            least = least.at_most(sigma).choose(least, sigma);
        }
        least
    }

    /// The lanes in which the Jacobian of a block has changed little since the previous poses.
    fn stays_regular(&mut self, index: usize) -> LaneMask {
        let (values, factors) = (&self.values[index], &mut self.factors[index]);
        let rows = self.blocks[index].block.rows().max(1);
        let pairs = values
            .jacobian
            .chunks_exact(rows)
            .zip(self.before.chunks_exact(rows));
        let mut square = Octet::ZERO;
        for (new, old) in pairs {
            self.column.clear();
            self.column
                .extend(new.iter().zip(old).map(|(new, old)| *new - *old));
            // J⁻¹ (J - J₀), column by column: while its norm is below one nothing between the two is singular.
            factors.solve(&self.column);
            square = sum_of_squares(square, factors.step());
        }
        square.at_most(Octet::splat(MOST_CHANGE * MOST_CHANGE))
    }
}

/// `sum` and the squares of `values`.
fn sum_of_squares(sum: Octet, values: &[Octet]) -> Octet {
    values.iter().fold(sum, |sum, v| sum + *v * *v)
}
