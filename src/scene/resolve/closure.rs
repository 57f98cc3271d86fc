//! The second step: everything that must close.

use super::bars::equations::resolve_bars;
use super::contacts::closure::Contacts;
use super::joints::FoldedJoints;
use super::named_file::NamedFile;
use crate::diag::Diagnostics;
use crate::model::mechanism::{Bar, Equation, Loop};

/// Loops and equations, with the bars and contacts that some of them come from.
pub struct ClosureConditions {
    pub loops: Vec<Loop>,
    pub equations: Vec<Equation>,
    pub bars: Vec<Bar>,
    pub contacts: Contacts,
}

impl ClosureConditions {
    /// The file's loops and equations, then those of its bars and contacts.
    pub fn resolve(
        named: &NamedFile,
        joints: &mut FoldedJoints,
        diagnostics: &mut Diagnostics,
    ) -> Self {
        let (parsed, names) = (&named.parsed, &named.names);
        let mut loops = joints.loops(parsed, diagnostics);
        let mut equations = joints.equations(parsed, diagnostics);
        let mut bars = resolve_bars(&parsed.bars, names, joints, diagnostics);
        loops.append(&mut bars.loops);
        equations.append(&mut bars.equations);
        let mut contacts = Contacts::resolve(&parsed.contacts, names, joints, diagnostics);
        loops.append(&mut contacts.loops);
        equations.append(&mut contacts.equations);
        Self {
            loops,
            equations,
            bars: bars.list,
            contacts,
        }
    }
}
