//! What is known of the motion between the samples of a check that did not ask for its proof.

use super::sentences;
use super::verdict::{Case, PROOF, Status};
use crate::diag::decimals_of;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use serde_json::{Value, json};

/// Most intervals that are listed.
const MOST_LISTED: usize = 100;

/// The intervals of a motion that were examined and are not proved, in the order of time.
pub struct BetweenSamples(pub Vec<[f64; 2]>);

impl BetweenSamples {
    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism, actuation: &Actuation) -> String {
        let Some([first, _]) = self.0.first() else {
            return "proved everywhere".to_owned();
        };
        let count = self.0.len();
        let together: f64 = self.0.iter().map(|[from, to]| to - from).sum();
        let places = if count == 1 { "place" } else { "places" };
        let inputs = sentences::input_sentence(mechanism, &actuation.inputs_at(*first));
        format!(
            "stepped over, not proved, in {count} {places} of together {} s, first at t = {} s ({inputs})",
            super::rounded::at_most(together),
            decimals_of(*first, 9)
        )
    }

    /// The question whether the motion is proved between the samples, which was not asked: the check passes without it.
    pub fn case(&self, mechanism: &Mechanism, actuation: &Actuation) -> Case {
        let status = match self.0.is_empty() {
            true => Status::Passed,
            false => Status::Skipped,
        };
        let text = self.sentence(mechanism, actuation);
        Case::new(PROOF, "motion between samples", status, text)
    }

    /// For the JSON report.
    pub fn json(&self) -> Value {
        let listed = self.0.iter().take(MOST_LISTED);
        json!({
            "proved": self.0.is_empty(),
            "places": self.0.len(),
            "seconds": self.0.iter().map(|[from, to]| to - from).sum::<f64>(),
            "stepped_over": listed.collect::<Vec<_>>(),
        })
    }
}
