//! The arguments of all joints over a tube: by their formulas, and where these have a kink or a jump by the time alone.

use super::form::Form;
use super::placed::PlacedArgument;
use super::prover::Prover;
use super::stretches::Tube;
use super::taylor_model::TaylorModel;
use crate::kinematics::loops::observed::dependencies;
use crate::model::chain::Argument;
use crate::model::timed_argument::TimedArgument;
use crate::numbers::interval::Interval;

impl Prover<'_> {
    /// Arguments that jump when the inputs may not: their indices, and what they are over the time.
    pub fn jumping(&self) -> impl Iterator<Item = (usize, &TimedArgument)> {
        let placed = self.placed.iter().enumerate();
        let timed = placed.filter_map(|(k, placed)| Some((k, placed.timed.as_ref()?)));
        timed.filter(|(_, timed)| timed.may_jump())
    }

    /// The arguments of all joints over a tube.
    pub fn arguments(&self, tube: &Tube) -> Vec<TaylorModel> {
        let mechanism = self.system.mechanism();
        let coordinates = tube.coordinates(mechanism);
        let count = mechanism.arguments.len();
        let of = |form: &Form| match form {
            Form::Affine(affine) => TaylorModel::of_affine(affine, &coordinates),
            Form::Formula(_) => {
                let place: Vec<Interval> = coordinates.iter().map(TaylorModel::range).collect();
                let mut rates: Vec<f64> = coordinates.iter().map(|c| c.rest).collect();
                // The inputs' own are part of the series.
                rates[tube.rest.len()..].fill(0.0);
                let mut value = form.value(&tube.path);
                value.rest += form.change(&place, &rates).rate;
                value
            }
        };
        let known = |(k, (form, placed)): (usize, (&Form, &PlacedArgument))| {
            let value = of(form);
            if value.is_finite() {
                return value;
            }
            if let Some(timed) = &placed.timed {
                let stretch = tube.path.stretch();
                let [middle, everywhere] = stretch.formula(timed.piece(stretch.middle));
                return TaylorModel::of(middle, &everywhere);
            }
            match (&placed.turned, &mechanism.arguments[k]) {
                (Some(turned), _) => of(turned),
                // A kink is passed with what its other side is off.
                (None, Argument::Formula(formula)) if !formula.has_jumps() => {
                    let needed = dependencies(mechanism, &formula.slots());
                    tube.formula(mechanism, (formula, &needed))
                }
                _ => value,
            }
        };
        let forms = self.blocks.forms[..count].iter().zip(&self.placed);
        forms.enumerate().map(known).collect()
    }
}
