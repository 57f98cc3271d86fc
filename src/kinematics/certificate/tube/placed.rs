//! Arguments of joints whose formulas have kinks, jumps or cuts: formulas of the inputs alone as functions of the time, whose
//! kinks and jumps part stretches, and angles whose cut is on the other side.

use super::form::Form;
use crate::model::actuation::Actuation;
use crate::model::chain::Argument;
use crate::model::mechanism::Mechanism;
use crate::model::timed_argument::{TimedArgument, only_turns};

/// What tells the value of an argument where its formula as it is written has none over a stretch.
#[derive(Clone, Debug, Default)]
pub(super) struct PlacedArgument {
    /// By the time alone.
    pub(super) timed: Option<TimedArgument>,
    /// With the cut on the other side: a whole turn more or less places the same.
    pub(super) turned: Option<Form>,
}

/// Of all arguments.
pub(super) fn placed_arguments(
    mechanism: &Mechanism,
    actuation: &Actuation,
) -> Vec<PlacedArgument> {
    let timed = TimedArgument::of_all(mechanism, actuation);
    let of = |(k, (argument, timed)): (usize, (&Argument, Option<TimedArgument>))| {
        let Argument::Formula(formula) = argument else {
            return PlacedArgument::default();
        };
        let turned = formula.turned().filter(|_| only_turns(mechanism, k));
        PlacedArgument {
            timed,
            turned: turned.map(|formula| Form::of(&formula)),
        }
    };
    let arguments = mechanism.arguments.iter().zip(timed);
    arguments.enumerate().map(of).collect()
}
