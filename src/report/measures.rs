//! Measures of a motion as `check` and `solve` show them.

use super::rounded::not_below;
use super::verdict::{Case, MEASURES, Status};
use crate::clearance::measured::{LeastDistance, distance_of, least_distance};
use crate::kinematics::measures::measure;
use crate::kinematics::motion::sampling::only;
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
    /// Of a least distance: what is known between the samples, too.
    proved: Option<LeastDistance>,
}

/// Takes the measures of a motion that is to be judged, whose samples at `times` were asked for: least distances are those of
/// the whole motion, with a bound.
pub fn take_whole<'s>(
    system: &System,
    scene: &'s Scene,
    trajectory: &Trajectory,
    times: &[f64],
    tolerance: f64,
) -> Vec<Measured<'s>> {
    let (mechanism, actuation) = (&*scene.mechanism, &scene.actuation);
    // Sums and means are over the samples that were asked for.
    let mut list = take(system, scene, &only(actuation, trajectory, times));
    for measured in &mut list {
        let Some(distance) = distance_of(mechanism, measured.measure) else {
            continue;
        };
        let limit = measured.measure.min.unwrap_or(0.0);
        let motion = (system, actuation);
        let found = least_distance(motion, trajectory, distance, limit, tolerance);
        measured.value = found.as_ref().map(|found| found.least.distance);
        measured.proved = found;
    }
    list
}

/// Whether a measure of a scene is a least distance, of which a bound is wanted.
pub fn prove_distances(scene: &Scene) -> bool {
    let mut list = scene.measures.list.iter();
    list.any(|measure| distance_of(&scene.mechanism, measure).is_some())
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
        proved: None,
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
            Some(_) if self.is_broken() => Status::Failed,
            Some(_) if is_limited && !self.is_proved() => Status::NotProved,
            Some(_) if is_limited => Status::Passed,
            Some(_) => Status::Skipped,
            None => Status::Failed,
        }
    }

    fn slack(&self) -> f64 {
        self.proved.as_ref().map_or(0.0, |proved| proved.slack)
    }

    fn is_broken(&self) -> bool {
        let off = |value: f64| self.broken(value).is_some();
        self.value
            .is_some_and(|value| off(value) && off(value + self.slack()))
            || self
                .proved
                .as_ref()
                .is_some_and(|proved| proved.least.is_enclosed)
    }

    /// Whether the bound of a least distance keeps the lower limit, too. Of other measures nothing is to be proved.
    fn is_proved(&self) -> bool {
        let (Some(proved), Some(min)) = (&self.proved, self.measure.min) else {
            return true;
        };
        let least = &proved.least;
        // How deep bodies are in each other is found by a search.
        least.is_certified && least.bound >= min - proved.slack
    }

    /// What is known of a least distance over the whole motion.
    fn between(&self) -> Option<String> {
        let least = &self.proved.as_ref()?.least;
        let sure = match least.is_certified {
            true => "proved",
            false => "estimated",
        };
        Some(match least.distance > 0.0 && !least.is_enclosed {
            true => format!(
                ", never below {} {} ({sure}), nearest at t = {:.6} s",
                not_below(least.bound * self.factor, 6),
                self.unit,
                least.time
            ),
            false => format!(", deepest found at t = {:.6} s", least.time),
        })
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
        text.push_str(&self.between().unwrap_or_default());
        if let Some((word, limit)) = self.broken(value).filter(|_| self.is_broken()) {
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
        let mut value = json!({
            "name": self.measure.name,
            "value": scaled(self.value),
            "unit": self.unit,
            "min": scaled(self.measure.min),
            "max": scaled(self.measure.max),
            "holds": !matches!(self.status(), Status::Failed | Status::NotProved),
        });
        if let (Some(proved), Some(object)) = (&self.proved, value.as_object_mut()) {
            let least = &proved.least;
            object.insert("bound".to_owned(), json!(least.bound * self.factor));
            object.insert("certified".to_owned(), json!(least.is_certified));
            object.insert("time".to_owned(), json!(least.time));
        }
        value
    }
}
