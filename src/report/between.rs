//! What is known of the motion between the samples of a check that did not ask for its proof.

use super::rounded::at_most;
use super::sentences::{self, beside_unit};
use super::verdict::{Case, PROOF, Status};
use crate::diag::decimals_of;
use crate::model::actuation::Actuation;
use crate::model::mechanism::Mechanism;
use crate::numbers::interval::Interval;
use serde_json::{Value, json};

/// Most intervals that are listed.
const MOST_LISTED: usize = 100;

/// The part of a motion that a check may step over: of a motion that is mostly not proved the check does not know whether the
/// mechanism closes. Fast drives with kinks leave a third unproved, singular poses far less than a millionth.
const LARGEST_SHARE: f64 = 0.5;

/// What is proved of a motion between its samples.
pub struct BetweenSamples {
    /// Intervals that are not proved, in the order of time; `None` if the motion was not examined.
    unproved: Option<Vec<[f64; 2]>>,
    /// Seconds of the whole motion.
    duration: f64,
    /// How well redundant equations close where the motion is proved, in the scene's unit.
    closes_to: Option<f64>,
    /// Whether the time of the run ended the proof.
    is_cut_off: bool,
    /// When the drive jumps, seconds.
    jumps: Vec<f64>,
}

impl BetweenSamples {
    /// Of the intervals that are not proved, in a motion of so many seconds; `closes_to` bounds the redundant equations in all
    /// others.
    pub fn new(unproved: Option<Vec<[f64; 2]>>, duration: f64, closes_to: Option<f64>) -> Self {
        Self {
            unproved,
            duration,
            closes_to,
            is_cut_off: false,
            jumps: Vec::new(),
        }
    }

    /// The same for a drive that jumps at these times.
    pub fn between_jumps(self, jumps: &[f64]) -> Self {
        let jumps = jumps.to_vec();
        Self { jumps, ..self }
    }

    /// The same if the time of the run may have ended the proof.
    pub fn cut_off(self, is_cut_off: bool) -> Self {
        Self { is_cut_off, ..self }
    }

    /// What is known of redundant equations, after a word that tells where.
    fn of_redundant(&self, mechanism: &Mechanism, place: &str) -> String {
        self.closes_to.map_or(String::new(), |closes_to| {
            format!(
                "; {place}redundant equations close to {}",
                beside_unit(at_most(closes_to), mechanism.pose_unit())
            )
        })
    }

    /// One line.
    pub fn sentence(&self, mechanism: &Mechanism, actuation: &Actuation) -> String {
        let Some(places) = &self.unproved else {
            return "not examined: too many samples or unknowns without --certify motion"
                .to_owned();
        };
        let Some([first, _]) = places.first() else {
            let place = match self.jumps.is_empty() {
                true => "proved everywhere".to_owned(),
                false => format!("proved everywhere except over {}", self.jumps_in_words()),
            };
            return place + &self.of_redundant(mechanism, "");
        };
        let inputs = sentences::input_sentence(mechanism, &actuation.inputs_at(*first));
        let mut why = match self.is_cut_off {
            true => "; the limit `time` ended the proof".to_owned(),
            false => String::new(),
        };
        if !self.jumps.is_empty() {
            why += &format!("; not proved over {} either", self.jumps_in_words());
        }
        if let Some(name) = self.unbounded_input(mechanism, actuation) {
            why += &format!("; input `{name}` may be without a value or a bound there");
        }
        format!(
            "stepped over, not proved, in {}, {} s in total, first at t = {} s ({inputs}){why}{}",
            sentences::counted_things(places.len(), "place"),
            at_most(together(places)),
            decimals_of(*first, 9),
            self.of_redundant(mechanism, "elsewhere ")
        )
    }

    fn jumps_in_words(&self) -> String {
        let first = self.jumps.first().copied().unwrap_or_default();
        let time = decimals_of(first, 9);
        match self.jumps.len() {
            1 => format!("the drive's jump at t = {time} s"),
            count => format!("{count} jumps of the drive, the first at t = {time} s"),
        }
    }

    /// The question whether the motion is proved between the samples. A proof was not asked for, so that the check passes
    /// without it if most is proved, or nothing could be examined.
    pub fn case(&self, mechanism: &Mechanism, actuation: &Actuation) -> Case {
        let status = match &self.unproved {
            None => Status::Skipped,
            Some(places) if places.is_empty() && self.jumps.is_empty() => Status::Passed,
            Some(_) if self.unbounded_input(mechanism, actuation).is_some() => Status::NotProved,
            Some(places) if together(places) <= LARGEST_SHARE * self.duration => Status::Skipped,
            Some(_) => Status::NotProved,
        };
        let text = self.sentence(mechanism, actuation);
        Case::new(PROOF, "motion between samples", status, text)
    }

    /// An input that may have no value, or values beyond all bounds, in a place that is not proved: a pole is no part of a motion.
    fn unbounded_input<'m>(
        &self,
        mechanism: &'m Mechanism,
        actuation: &Actuation,
    ) -> Option<&'m str> {
        let places = self.unproved.iter().flatten();
        let mut found = places.flat_map(|[from, until]| {
            let times = Interval::new(*from, *until);
            let drives = actuation.drives.iter().zip(&mechanism.inputs);
            drives.filter_map(move |(drive, input)| {
                (!drive.is_bounded_over(times)).then_some(input.name.as_str())
            })
        });
        found.next()
    }

    fn is_proved(&self) -> bool {
        self.unproved.as_ref().is_some_and(Vec::is_empty) && self.jumps.is_empty()
    }

    /// For the JSON report; null if the motion was not examined.
    pub fn json(&self) -> Value {
        let Some(places) = &self.unproved else {
            return Value::Null;
        };
        let listed = places.iter().take(MOST_LISTED);
        json!({
            "proved": self.is_proved(),
            "places": places.len(),
            "seconds": together(places),
            "closes_to": self.closes_to,
            "jumps": self.jumps.iter().take(MOST_LISTED).collect::<Vec<_>>(),
            "cut_off": self.is_cut_off && !self.is_proved(),
            "stepped_over": listed.collect::<Vec<_>>(),
        })
    }
}

/// Seconds of all intervals.
fn together(places: &[[f64; 2]]) -> f64 {
    let lengths = places.iter().map(|[from, to]| to - from);
    lengths.fold(0.0, |sum, length| sum + length)
}
