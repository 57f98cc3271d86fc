//! The blocks of a mechanism, proved at a pose one after the other, where all arguments and equations are affine forms.

use super::block_rows::BlockRows;
use super::chain::ArgumentDouble;
use super::kantorovich::{EarlierPose, Kantorovich};
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::system::System;

/// The proof of poses of one system: its plan, and the buffers of a pose.
#[derive(Clone, Debug)]
pub struct PoseProver<'m> {
    system: &'m System,
    /// The blocks at the last pose.
    pub blocks: Vec<BlockRows<'m>>,
    kantorovich: Kantorovich,
    arguments: Vec<ArgumentDouble>,
    /// Proved bounds on the unknowns at the last pose.
    pub earlier: EarlierPose,
}

impl<'m> PoseProver<'m> {
    /// Prepares the proof.
    pub fn new(system: &'m System) -> Self {
        let blocks = system.proof_plan().blocks.iter();
        Self {
            system,
            blocks: blocks.map(BlockRows::new).collect(),
            kantorovich: Kantorovich::default(),
            arguments: Vec::new(),
            earlier: EarlierPose::default(),
        }
    }

    /// Fills `earlier` with the bounds of all unknowns; the radius of uniqueness in radians and sizes.
    pub fn prove(
        &mut self,
        [coordinates, rests]: [&[f64]; 2],
        bases: &[Vec<usize>],
        corrector: Option<&Corrector>,
    ) -> Result<f64, Reason> {
        let planned = &self.system.proof_plan().arguments;
        self.arguments
            .resize(planned.len(), ArgumentDouble::default());
        for (argument, planned) in self.arguments.iter_mut().zip(planned) {
            *argument = ArgumentDouble::of(planned, coordinates, rests);
        }
        // Block after block: each inherits the errors of those before it.
        self.earlier.reset(self.system.mechanism().unknowns.len());
        let mut radius = f64::INFINITY;
        for (index, (block, basis)) in self.blocks.iter_mut().zip(bases).enumerate() {
            if block.of.has_formula {
                return Err(Reason::Formula);
            }
            block.evaluate([coordinates, rests], &self.arguments)?;
            let inverse = corrector.and_then(|c| c.inverse(index)).filter(|inverse| {
                inverse.rows().len() == basis.len() && block.rows.len() == basis.len()
            });
            let (unique, error) =
                self.kantorovich
                    .prove(block, basis, inverse, &mut self.earlier)?;
            if block.may_be_half_turned(error.max(self.earlier.largest)) {
                return Err(Reason::HalfTurn);
            }
            radius = radius.min(unique);
        }
        Ok(radius)
    }
}
