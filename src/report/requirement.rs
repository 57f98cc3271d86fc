//! A requirement on synthesised mechanisms, and the simplest one that meets it.

use super::cells::six_digits;
use super::synthesis::FoundMechanism;
use serde_json::{Value, json};

/// A limit of a measure: `deviation<=0.02`, in the file's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Requirement {
    /// Name of the measure.
    pub measure: String,
    /// Whether the bound is an upper one.
    pub is_most: bool,
    /// The bound.
    pub bound: f64,
}

impl Requirement {
    /// Parses the form of the command line.
    ///
    /// # Errors
    /// The expected form.
    pub fn read(text: &str) -> Result<Self, String> {
        let wrong = || "write MEASURE<=NUMBER or MEASURE>=NUMBER".to_owned();
        let most = text.split_once("<=").map(|parts| (parts, true));
        let parts = most.or_else(|| text.split_once(">=").map(|parts| (parts, false)));
        let ((name, bound), is_most) = parts.ok_or_else(wrong)?;
        let bound = bound.trim().parse().map_err(|_| wrong())?;
        match name.trim() {
            "" => Err(wrong()),
            name if f64::is_finite(bound) => Ok(Self {
                measure: name.to_owned(),
                is_most,
                bound,
            }),
            _ => Err(wrong()),
        }
    }

    fn demand_words(&self) -> String {
        let sign = if self.is_most { "<=" } else { ">=" };
        format!("{} {sign} {}", self.measure, self.bound)
    }

    /// The value of a synthesised mechanism; `None` if it has no such measure, or no value.
    fn found_value(&self, found: &FoundMechanism) -> Option<f64> {
        let mut list = found.family.measures.list.iter().enumerate();
        let (index, measure) = list.find(|(_, m)| m.name == self.measure)?;
        found.values(index, measure)[2]
    }

    fn is_met(&self, found: &FoundMechanism) -> bool {
        let kept = |value: f64| match self.is_most {
            true => value <= self.bound,
            false => value >= self.bound,
        };
        self.found_value(found).is_some_and(kept)
    }
}

/// Of the mechanisms that are proved and meet all requirements, the one with the fewest variables.
pub fn simplest_of<'f, 'a>(
    found: &'f [FoundMechanism<'a>],
    demands: &[Requirement],
) -> Option<&'f FoundMechanism<'a>> {
    let meets = |one: &&FoundMechanism| one.holds() && demands.iter().all(|d| d.is_met(one));
    let variables = |one: &&FoundMechanism| one.family.study.variables.len();
    found.iter().filter(meets).min_by_key(variables)
}

/// The result for the requirements, for people.
pub fn simplest_text(found: &[FoundMechanism], demands: &[Requirement]) -> String {
    let words: Vec<String> = demands.iter().map(Requirement::demand_words).collect();
    let asked = words.join(", ");
    let Some(simplest) = simplest_of(found, demands) else {
        return format!("none is proved with {asked}\n");
    };
    let values = demands.iter().filter_map(|d| {
        let value = d.found_value(simplest)?;
        Some(format!("{} {}", d.measure, six_digits(value)))
    });
    let values: Vec<String> = values.collect();
    format!(
        "the simplest with {asked}: {}, {} variables, {}\n",
        simplest.name,
        simplest.family.study.variables.len(),
        values.join(", ")
    )
}

/// The same for programs.
pub fn simplest_document(found: &[FoundMechanism], demands: &[Requirement]) -> Value {
    json!({
        "required": demands.iter().map(Requirement::demand_words).collect::<Vec<_>>(),
        "simplest": simplest_of(found, demands).map(|one| &one.name),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn demands_are_read_as_written() {
        let demand = |measure: &str, is_most, bound| {
            let measure = measure.to_owned();
            Ok(Requirement {
                measure,
                is_most,
                bound,
            })
        };
        assert_eq!(
            Requirement::read("deviation<=0.02"),
            demand("deviation", true, 0.02)
        );
        assert_eq!(Requirement::read(" K >= -3"), demand("K", false, -3.0));
        for wrong in ["", "K", "K<0.1", "<=1", "K<=x", "K<=inf", "K=1"] {
            assert!(Requirement::read(wrong).is_err(), "{wrong}");
        }
    }
}
