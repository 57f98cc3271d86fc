//! Arguments of joints whose formulas have kinks or cuts: formulas of the inputs alone as formulas of the time, whose kinks part
//! stretches, and angles whose cut is on the other side.

use super::form::Form;
use crate::model::actuation::Actuation;
use crate::model::chain::{Argument, ElementaryMotion};
use crate::model::drive::Drive;
use crate::model::mechanism::Mechanism;

/// What tells the value of an argument where its formula as it is written has none over a stretch.
#[derive(Clone, Debug, Default)]
pub(super) struct PlacedArgument {
    /// By the time alone, without jumps.
    pub(super) drive: Option<Drive>,
    /// With the cut on the other side: a whole turn more or less places the same.
    pub(super) turned: Option<Form>,
}

/// Of all arguments.
pub(super) fn placed_arguments(
    mechanism: &Mechanism,
    actuation: &Actuation,
) -> Vec<PlacedArgument> {
    let first = mechanism.unknowns.len();
    let of = |(k, argument): (usize, &Argument)| {
        let Argument::Formula(formula) = argument else {
            return PlacedArgument::default();
        };
        let is_continuous = formula.has_kinks() && !formula.has_jumps();
        let input = |slot: usize| match actuation.drives.get(slot.checked_sub(first)?)? {
            Drive::Formula(formula) => Some(formula),
            Drive::Keys { .. } => None,
        };
        let over_time = is_continuous.then(|| formula.with_formulas(input));
        let over_time = over_time.flatten().filter(|whole| !whole.has_jumps());
        let turned = formula.turned().filter(|_| only_turns(mechanism, k));
        PlacedArgument {
            drive: over_time.map(Drive::Formula),
            turned: turned.map(|formula| Form::of(&formula)),
        }
    };
    mechanism.arguments.iter().enumerate().map(of).collect()
}

/// Whether an argument moves rotations only.
fn only_turns(mechanism: &Mechanism, argument: usize) -> bool {
    let bodies = mechanism.bodies.iter().map(|body| &body.world_from_body);
    let loops = mechanism.loops.iter().flat_map(|l| [&l.base, &l.chain]);
    let mut joints = bodies
        .chain(loops)
        .flat_map(|chain| chain.steps.iter().filter_map(|step| step.joint()));
    joints.all(|j| j.argument != argument || j.motion == ElementaryMotion::Rotation)
}
