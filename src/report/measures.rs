//! Measures of a motion as `check` and `solve` show them.

use super::verdict::{Case, MEASURES, Status};
use crate::kinematics::measures::measure;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::measure::Measure;
use crate::scene::Scene;
use serde_json::{Value, json};

/// A measure with its value in the file's units.
pub struct Measured<'m> {
    measure: &'m Measure,
    value: Option<f64>,
    factor: f64,
    unit: &'m str,
}

/// Takes the measures of a motion.
pub fn take<'s>(system: &System, scene: &'s Scene, trajectory: &Trajectory) -> Vec<Measured<'s>> {
    let mechanism = &*scene.mechanism;
    let values = measure(system, &scene.actuation, &scene.measures, trajectory);
    let pairs = scene.measures.list.iter().zip(values);
    let list = pairs.map(|(measure, value)| Measured {
        measure,
        value,
        factor: mechanism.file_units(measure.kind),
        unit: mechanism.unit_name(measure.kind),
    });
    list.collect()
}

/// Ten digits, with an exponent where zeros would fill the line.
fn digits(value: f64) -> String {
    let exponent = value.abs().log10().floor();
    if value == 0.0 || !(-5.0..9.0).contains(&exponent) {
        return format!("{value:.9e}");
    }
    format!("{value:.*}", (9.0 - exponent) as usize)
}

impl Measured<'_> {
    /// Whether it has a value within its limits. A value without limits is just told.
    fn status(&self) -> Status {
        let is_limited = self.measure.min.is_some() || self.measure.max.is_some();
        match self.value {
            Some(value) if !self.measure.allows(value) => Status::Failed,
            Some(_) if is_limited => Status::Passed,
            Some(_) => Status::Skipped,
            None => Status::Failed,
        }
    }

    /// The name, as reports of people have it.
    pub fn name(&self) -> &str {
        &self.measure.name
    }

    /// Value and unit, and what is wrong with it.
    pub fn sentence(&self) -> String {
        let Some(value) = self.value else {
            return "no value: a pose is missing on the way, or a formula has none".to_owned();
        };
        let mut text = format!("{} {}", digits(value * self.factor), self.unit);
        if let Some((word, limit)) = self.broken(value) {
            text.push_str(&format!(" is {word} the limit {}", limit * self.factor));
            if let Some(why) = &self.measure.why {
                text.push_str(&format!(": {why}"));
            }
        }
        text.trim_end().to_owned()
    }

    fn broken(&self, value: f64) -> Option<(&'static str, f64)> {
        let below = self.measure.min.filter(|min| value < *min);
        let above = self.measure.max.filter(|max| value > *max);
        below
            .map(|min| ("below", min))
            .or(above.map(|max| ("above", max)))
    }

    /// The question whether its limits are kept.
    pub fn case(&self) -> Case {
        let limit = |word: &str, limit: Option<f64>| {
            limit.map(|v| format!("; {word} {} {}", v * self.factor, self.unit))
        };
        let limits = [
            limit("at least", self.measure.min),
            limit("at most", self.measure.max),
        ];
        let limits: String = limits.iter().flatten().map(|l| l.trim_end()).collect();
        let text = match limits.is_empty() {
            true => format!("{}; no limit", self.sentence()),
            false => self.sentence() + &limits,
        };
        Case::new(MEASURES, self.name(), self.status(), text)
    }

    /// The same for machines.
    pub fn json(&self) -> Value {
        let scaled = |value: Option<f64>| value.map(|v| v * self.factor);
        json!({
            "name": self.measure.name,
            "value": scaled(self.value),
            "unit": self.unit,
            "min": scaled(self.measure.min),
            "max": scaled(self.measure.max),
            "holds": self.status() != Status::Failed,
        })
    }
}
