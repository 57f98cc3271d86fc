//! What is known of the motion between the samples of a check that did not ask for its proof.

use super::rounded::at_most;
use super::sentences;
use super::verdict::{Case, PROOF, Status};
use crate::diag::decimals_of;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};

/// Most intervals that are listed.
const MOST_LISTED: usize = 100;

/// The intervals of a motion that are not proved, in the order of time; `None` if the motion was not examined.
pub struct BetweenSamples(Option<Vec<[f64; 2]>>);

impl BetweenSamples {
    /// Of these intervals.
    pub fn new(unproved: Option<Vec<[f64; 2]>>) -> Self {
        Self(unproved)
    }

    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism, actuation: &Actuation) -> String {
        let Some(places) = &self.0 else {
            return "not examined: too many samples or unknowns without --certify motion"
                .to_owned();
        };
        let Some([first, _]) = places.first() else {
            return "proved everywhere".to_owned();
        };
        let count = places.len();
        let word = if count == 1 { "place" } else { "places" };
        let inputs = sentences::input_sentence(mechanism, &actuation.inputs_at(*first));
        format!(
            "stepped over, not proved, in {count} {word} of together {} s, first at t = {} s ({inputs})",
            at_most(together(places)),
            decimals_of(*first, 9)
        )
    }

    /// The question whether the motion is proved between the samples, which was not asked: the check passes without it.
    pub fn case(&self, mechanism: &Mechanism, actuation: &Actuation) -> Case {
        let status = match self.is_proved() {
            true => Status::Passed,
            false => Status::Skipped,
        };
        let text = self.sentence(mechanism, actuation);
        Case::new(PROOF, "motion between samples", status, text)
    }

    fn is_proved(&self) -> bool {
        self.0.as_ref().is_some_and(Vec::is_empty)
    }

    /// For the JSON report; null if the motion was not examined.
    pub fn json(&self) -> Value {
        let Some(places) = &self.0 else {
            return Value::Null;
        };
        let listed = places.iter().take(MOST_LISTED);
        json!({
            "proved": self.is_proved(),
            "places": places.len(),
            "seconds": together(places),
            "stepped_over": listed.collect::<Vec<_>>(),
        })
    }
}

/// Seconds of all intervals.
fn together(places: &[[f64; 2]]) -> f64 {
    places.iter().map(|[from, to]| to - from).sum()
}
