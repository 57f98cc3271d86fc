//! The blocks of a mechanism, proved along a path one after the other.

use super::constants::EarlierTube;
use super::form::Form;
use super::path::TubePath;
use super::proof;
use super::proof::Workspace;
use super::rows::TubeLayout;
use crate::kinematics::results::certificate::Reason;
use crate::kinematics::structure::system::System;

/// The blocks of a mechanism, laid out for proofs.
#[derive(Clone, Debug)]
pub(super) struct Blocks<'m> {
    pub(super) forms: Vec<Form>,
    pub(super) layouts: Vec<TubeLayout<'m>>,
    pub(super) unknowns: usize,
    pub(super) work: Workspace,
}

impl<'m> Blocks<'m> {
    pub(super) fn new(system: &'m System) -> Self {
        let mechanism = system.mechanism();
        let structure = system.structure();
        let forms = Form::all(mechanism);
        let blocks = structure.blocks.iter();
        Self {
            layouts: blocks
                .map(|block| TubeLayout::new(system, &forms, block))
                .collect(),
            forms,
            unknowns: mechanism.unknowns.len(),
            work: Workspace::default(),
        }
    }

    /// The test along a path, block after block. `may_move`: the path is first brought to the motion.
    pub(super) fn prove(
        &mut self,
        bases: &[Vec<usize>],
        path: &mut TubePath,
        may_move: bool,
    ) -> Result<EarlierTube, Reason> {
        // Nothing is proved yet: no errors, and uniqueness without a limit.
        let mut proved = EarlierTube {
            rest: vec![0.0; self.unknowns],
            largest: 0.0,
            unique: f64::INFINITY,
            closes_to: 0.0,
        };
        let work = &mut self.work;
        // In their order: the errors of a block's unknowns enter the tests of the later ones.
        for (layout, basis) in self.layouts.iter().zip(bases) {
            proof::prove_tube(
                layout,
                &self.forms,
                path,
                basis,
                &mut proved,
                may_move,
                work,
            )?;
        }
        Ok(proved)
    }
}
