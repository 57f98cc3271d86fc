//! One block's equations with time as an additional unknown: residual, Jacobian, and the derivative along the drive.

use super::newton::Corrector;
use crate::kinematics::structure::system::System;

/// A block linearised along the drive.
#[derive(Clone, Copy, Debug)]
pub struct AlongDrive<'c> {
    /// One entry a row.
    pub residual: &'c [f64],
    /// By the block's scaled unknowns, column-major.
    pub jacobian: &'c [f64],
    /// Rate of the residual with the block's own unknowns fixed: one entry per row, then padding.
    pub drift: &'c [f64],
}

impl Corrector {
    /// Linearises block `index` at `coordinates`, at which the earlier blocks are closed. `rates` contains the rates of
    /// all coordinates: those of the inputs are given, those of the earlier blocks are filled in.
    pub fn along_drive(
        &mut self,
        system: &System,
        index: usize,
        coordinates: &[f64],
        rates: &mut [f64],
    ) -> AlongDrive<'_> {
        let mechanism = system.mechanism();
        let blocks = &system.structure().blocks;
        // Rates of the blocks before this one follow from the drive.
        self.tangent_before(system, index, coordinates, rates);
        let (block, buffers) = (&blocks[index], &mut self.blocks[index]);
        buffers.evaluate(mechanism, block, coordinates);
        buffers.workspace.drift_along(&block.plan, rates);
        let workspace = &buffers.workspace;
        AlongDrive {
            residual: &workspace.residual,
            jacobian: &workspace.jacobian,
            drift: workspace.drift.as_flattened(),
        }
    }
}
