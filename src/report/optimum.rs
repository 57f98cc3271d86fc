//! An optimum of a study in words and as a JSON document.

use super::cells::{aligned_rows, six_digits};
use super::rounded::at_most_three;
use super::sentences::certified_error;
use crate::analysis::optimise::StopReason;
use crate::analysis::study::kept_clearances::{Clearances, NearestPair};
use crate::analysis::study::optimum::Verified;
use crate::analysis::study::whole_limits::WholeLimit;
use crate::analysis::study::{FamilyError, FoundOptimum, KEPT, LoadedStudy};
use serde_json::{Map, Value, json};

/// Version of the JSON documents.
pub const SCHEMA: u32 = 1;

/// An optimum and its verification.
pub struct OptimumReport<'a> {
    /// What was studied.
    pub study: &'a LoadedStudy,
    /// What was found.
    pub found: &'a FoundOptimum,
    /// The independent motion.
    pub verified: &'a Result<Verified, FamilyError>,
    /// What the search took.
    pub seconds: f64,
}

/// The end of a search in words.
pub fn ending_word(ended: StopReason) -> &'static str {
    match ended {
        StopReason::Converged => "converged",
        StopReason::Stalled => "no further improvement",
        StopReason::OutOfBudget => "iteration limit reached",
        StopReason::Stopped => "interrupted, best so far",
    }
}

impl OptimumReport<'_> {
    /// Whether the independent motion has the same objective and all limits and clearances are kept.
    pub fn holds(&self) -> bool {
        self.found.holds(self.study, self.verified)
    }

    /// For people.
    pub fn text(&self) -> String {
        let mut text = self.summary_text();
        text.push_str(&self.variable_rows());
        match self.verified {
            Ok(verified) => text.push_str(&self.verified_lines(verified)),
            Err(error) => text.push_str(&format!("\nNot confirmed: {error}\n")),
        }
        let clearances = &self.found.clearances;
        let unit = &self.study.family.mechanism().length_unit;
        text.extend(clearances.iter().map(|c| clearance_line(c, unit)));
        text
    }

    /// The objective before and after, and statistics of the search.
    fn summary_text(&self) -> String {
        let (study, optimum) = (self.study, &self.found.optimum);
        let (name, unit) = (study.objective_name(), study.objective_unit());
        let (minimum, refusals) = (&optimum.minimum, &optimum.refusals);
        let (first, last) = (optimum.first_value, minimum.value);
        let change = match first / last {
            _ if !first.is_finite() => "the start has no value".to_owned(),
            // Factors mean something between positive numbers only.
            factor if first > 0.0 && factor >= 1.0 && factor.is_finite() => {
                format!("lower by a factor of {}", six_digits(factor))
            }
            factor if first > 0.0 && factor > 0.0 && factor < 1.0 => {
                format!("higher by a factor of {}", six_digits(1.0 / factor))
            }
            _ => format!("by {}", six_digits((last - first) * unit)),
        };
        format!(
            "{}\n  {name}: {}{} ({change})\n  \
             {}: {} iterations, {} evaluations ({} refused: {} not reached, {} with the branch lost, {} without a value or derivative), {:.2} s\n\n",
            study.family.mechanism().title,
            match first.is_finite() {
                true => format!("{} to ", six_digits(first * unit)),
                false => String::new(),
            },
            six_digits(last * unit),
            ending_word(minimum.ended),
            minimum.iterations,
            minimum.evaluations,
            refusals.count(),
            refusals.not_reached,
            refusals.branch_lost,
            refusals.no_value,
            self.seconds
        )
    }

    fn variable_rows(&self) -> String {
        let family = &self.study.family;
        let heads = ["variable", "from", "to", "lowest", "highest"];
        let mut rows = vec![heads.map(str::to_owned).to_vec()];
        let found = &self.found.optimum.minimum.x;
        for (variable, x) in family.study.variables.iter().zip(found) {
            let unit = family.units(variable.kind);
            let numbers = [variable.start, *x, variable.lower, variable.upper];
            let mut row = vec![variable.name.clone()];
            row.extend(numbers.map(|v| six_digits(v * unit)));
            rows.push(row);
        }
        aligned_rows(&rows)
    }

    fn verified_lines(&self, verified: &Verified) -> String {
        let family = &self.study.family;
        let mut text = format!(
            "\nSolved again from the start values: {} poses, {} without a certificate, {}.\n",
            verified.poses,
            verified.unproved,
            certified_error(
                [verified.poses, verified.unproved],
                verified.error_bound,
                family.mechanism().pose_unit()
            ),
        );
        let mut rows = vec![vec!["measure".to_owned(), "at these poses".to_owned()]];
        let measures = family.measures.list.iter().zip(&verified.measures);
        rows.extend(measures.map(|(m, v)| {
            // One that the search did not look at may have none.
            let shown = match v.is_finite() {
                true => six_digits(family.shown(m, *v)),
                false => "no value".to_owned(),
            };
            vec![m.name.clone(), shown]
        }));
        text.push_str(&aligned_rows(&rows));
        text.extend(verified.whole.iter().map(|limit| self.whole_line(limit)));
        if !self.found.agrees(self.study, verified) {
            text.push_str("Not confirmed: this is not the motion that was optimised.\n");
        }
        if verified.violation > KEPT {
            text.push_str(&format!(
                "The search found no candidate that keeps all constraints; with this one `{}` misses its bound by {:.2e} %.\n",
                self.worst_limit(verified),
                100.0 * verified.violation
            ));
        }
        text
    }

    /// A limited measure over the whole motion, as a line.
    fn whole_line(&self, limit: &WholeLimit) -> String {
        let family = &self.study.family;
        let measure = &family.measures.list[limit.measure];
        let value = limit.value.map_or_else(
            || "no value".to_owned(),
            |value| six_digits(family.shown(measure, value)),
        );
        let verdict = match limit.missed {
            _ if !limit.is_proved => "it is not proved that its limits are kept there".to_owned(),
            missed if missed <= 0.0 => "its limits are kept (proved)".to_owned(),
            missed => {
                let share = at_most_three(100.0 * missed);
                let how = match limit.is_kept() {
                    true => "kept to within the rounding of the search",
                    false => "missed between those poses",
                };
                format!("its limits are {how}, by at most {share} %")
            }
        };
        format!(
            "Over the whole motion `{}` is {value}: {verdict}.\n",
            measure.name
        )
    }

    /// Name of the measure with the largest violation.
    fn worst_limit(&self, verified: &Verified) -> &str {
        let list = &self.study.family.measures.list;
        let measures = list.iter().zip(&verified.measures);
        let broken = measures.map(|(m, v)| (m.violation(*v), &m.name));
        let worst = broken.max_by(|a, b| a.0.total_cmp(&b.0));
        worst.map_or("", |(_, name)| name)
    }

    /// For machines.
    pub fn document(&self) -> Value {
        let (family, optimum) = (&self.study.family, &self.found.optimum);
        let (minimum, refusals) = (&optimum.minimum, &optimum.refusals);
        let unit = self.study.objective_unit();
        let length = &family.mechanism().length_unit;
        let variables = family.study.variables.iter().zip(&minimum.x).map(|(v, x)| {
            let unit = family.units(v.kind);
            json!({ "name": v.name, "from": v.start * unit, "to": x * unit })
        });
        json!({
            "schema": format!("mechanim-optimise/{SCHEMA}"),
            "title": family.mechanism().title,
            "objective": self.study.objective_name(),
            "from": optimum.first_value * unit,
            "to": minimum.value * unit,
            "ended": ending_word(minimum.ended),
            "iterations": minimum.iterations,
            "evaluations": minimum.evaluations,
            "refused": { "not_reached": refusals.not_reached, "branch_lost": refusals.branch_lost,
                         "no_value": refusals.no_value },
            "variables": variables.collect::<Vec<_>>(),
            "verified": self.verified.as_ref().ok().map(|v| self.verified_object(v)),
            "clearance": self.found.clearances.as_ref().map(|c| json!({
                "kept": c.kept,
                "nearest": nearest_words(&c.worst, length),
                "instead_of_later": c.instead,
            })),
        })
    }

    fn whole_object(&self, limit: &WholeLimit) -> Value {
        let family = &self.study.family;
        let measure = &family.measures.list[limit.measure];
        json!({
            "measure": measure.name,
            "value": limit.value.map(|value| family.shown(measure, value)),
            "kept": limit.is_kept(),
            "proved": limit.is_proved,
        })
    }

    fn verified_object(&self, verified: &Verified) -> Value {
        let family = &self.study.family;
        let measures = family.measures.list.iter().zip(&verified.measures);
        let measures = measures.map(|(m, v)| (m.name.clone(), json!(family.shown(m, *v))));
        json!({
            "poses": verified.poses,
            "unproved": verified.unproved,
            "error_bound": verified.error_bound,
            "violation": verified.violation.max(0.0),
            "whole_motion": verified.whole.iter().map(|l| self.whole_object(l)).collect::<Vec<_>>(),
            "measures": measures.collect::<Map<String, Value>>(),
        })
    }
}

/// Two bodies with their distance.
fn nearest_words(pair: &NearestPair, unit: &str) -> String {
    let [a, b] = &pair.bodies;
    let distance = six_digits(pair.distance);
    let asked = match pair.minimum {
        Some(minimum) => format!("minimum {minimum}"),
        None => "they must touch".to_owned(),
    };
    format!("{a} / {b}, {distance} {unit} ({asked})")
}

/// The clearances, as a line of the report.
fn clearance_line(clearances: &Clearances, unit: &str) -> String {
    let verdict = match (clearances.kept, clearances.instead) {
        (true, None) => "Clearances are kept".to_owned(),
        (true, Some(iteration)) => format!(
            "The optimum violates a clearance: an earlier point of the search that keeps all clearances is used, after iteration {iteration}"
        ),
        (false, _) => "Clearances are not kept".to_owned(),
    };
    format!(
        "{verdict}; nearest: {}.\n",
        nearest_words(&clearances.worst, unit)
    )
}
