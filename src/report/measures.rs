//! Measures of a motion as `check` and `solve` show them.

use crate::kinematics::measures::measure;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::measure::Measure;
use crate::model::mechanism::Kind;
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
        unit: match measure.kind {
            Kind::Length => &mechanism.length_unit,
            Kind::Angle => &mechanism.angle_unit.name,
            Kind::Number => "",
        },
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
    /// Whether it has a value within its limits.
    pub fn holds(&self) -> bool {
        self.value.is_some_and(|value| self.measure.allows(value))
    }

    /// One line: name, value, unit, and what is wrong with it.
    pub fn line(&self) -> String {
        let name = &self.measure.name;
        let Some(value) = self.value else {
            return format!(
                "{name:<16} no value: a pose is missing on the way, or a formula has none"
            );
        };
        let mut line = format!("{name:<16} {} {}", digits(value * self.factor), self.unit);
        if let Some((word, limit)) = self.broken(value) {
            line.push_str(&format!(" is {word} the limit {}", limit * self.factor));
            if let Some(why) = &self.measure.why {
                line.push_str(&format!(": {why}"));
            }
        }
        line.trim_end().to_owned()
    }

    fn broken(&self, value: f64) -> Option<(&'static str, f64)> {
        let below = self.measure.min.filter(|min| value < *min);
        let above = self.measure.max.filter(|max| value > *max);
        below
            .map(|min| ("below", min))
            .or(above.map(|max| ("above", max)))
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
            "holds": self.holds(),
        })
    }
}
