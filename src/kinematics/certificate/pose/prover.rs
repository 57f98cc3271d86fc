//! The blocks of a mechanism, proved at a pose one after the other, where all arguments and equations are affine forms.

use super::chain::ArgumentDouble;
use super::kantorovich::{EarlierPose, Kantorovich};
use super::system::BlockSystem;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::solve::newton::Corrector;
use crate::kinematics::structure::system::System;
use crate::model::chain::Argument;
use crate::model::expression::Affine;

/// The proof of a pose, laid out once.
#[derive(Clone, Debug)]
pub struct PoseProver<'m> {
    system: &'m System,
    forms: Vec<Option<Affine>>,
    /// The blocks at the last pose.
    pub systems: Vec<BlockSystem>,
    kantorovich: Kantorovich,
    arguments: Vec<ArgumentDouble>,
    /// What is proved of the unknowns at the last pose.
    pub earlier: EarlierPose,
}

impl<'m> PoseProver<'m> {
    /// Prepares the proof.
    pub fn new(system: &'m System) -> Self {
        let mechanism = system.mechanism();
        let arguments = mechanism.arguments.iter().map(Argument::affine);
        let equations = mechanism.equations.iter().map(|e| e.expression.affine());
        let forms: Vec<Option<Affine>> = arguments.chain(equations).collect();
        let blocks = system.blocks().iter();
        Self {
            system,
            systems: blocks
                .map(|block| BlockSystem::new(system, block, &forms))
                .collect(),
            forms,
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
        let blank = Affine::default();
        self.arguments.clear();
        let arguments = self.forms[..self.system.mechanism().arguments.len()].iter();
        self.arguments.extend(
            arguments.map(|form| {
                ArgumentDouble::new(form.as_ref().unwrap_or(&blank), coordinates, rests)
            }),
        );
        // Block after block: each inherits the errors of those before it.
        self.earlier.reset(self.system.mechanism().unknowns.len());
        let mut radius = f64::INFINITY;
        for (index, (system, basis)) in self.systems.iter_mut().zip(bases).enumerate() {
            if system.has_formula {
                return Err(Reason::Formula);
            }
            system.evaluate([coordinates, rests], &self.arguments)?;
            let inverse = corrector.and_then(|c| c.inverse(index)).filter(|inverse| {
                inverse.rows().len() == basis.len() && system.rows.len() == basis.len()
            });
            let (unique, error) =
                self.kantorovich
                    .prove(system, basis, inverse, &mut self.earlier)?;
            if system.may_be_half_turned(error.max(self.earlier.largest)) {
                return Err(Reason::HalfTurn);
            }
            radius = radius.min(unique);
        }
        Ok(radius)
    }
}
