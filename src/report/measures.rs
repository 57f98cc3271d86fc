//! Measures of a motion as `check` and `solve` show them.

use super::rounded::{at_least_six, at_most_six, not_above, not_below};
use super::sentences::beside_unit;
use super::verdict::{Case, CheckRequirements, MEASURES, Status};
use crate::clearance::covered::CoveredMotion;
use crate::clearance::measured::{BoundedMeasure, is_of_whole_motion, known};
use crate::diag::decimals_of;
use crate::kinematics::measures::{DriveSamples, formula_value, measure_motion};
use crate::kinematics::motion::sampling::samples_at;
use crate::kinematics::results::trajectory::Trajectory;
use crate::kinematics::structure::system::System;
use crate::model::measure::{Measure, MeasureSource};
use crate::model::printed::as_typed;
use crate::scene::Scene;
use serde_json::{Value, json};

/// A measure with its value in the file's units.
pub struct TakenMeasure<'m> {
    measure: &'m Measure,
    value: Option<f64>,
    factor: f64,
    unit: String,
    /// How many poses it was taken at.
    poses: usize,
    /// Bounds between the samples, if known.
    known: Option<BoundedMeasure>,
    /// The place on a track: inputs with their values and units, as in the file.
    place: Vec<(&'m str, f64, &'m str)>,
}

/// Evaluates the measures of a motion to be judged, with samples at `times`: least and greatest values are those of the
/// whole motion or of the whole track, with a bound. Sums and means are over the samples.
pub fn take_whole<'s>(
    system: &System,
    scene: &'s Scene,
    (trajectory, times): (&Trajectory, &[f64]),
    covered: &mut CoveredMotion,
    tolerance: f64,
) -> Vec<TakenMeasure<'s>> {
    let (mechanism, actuation) = (&*scene.mechanism, &scene.actuation);
    let asked = samples_at(actuation, trajectory, times);
    let along = DriveSamples {
        samples: &asked,
        // That of the whole motion, which is no sample of a cyclic one.
        end: trajectory.samples.last(),
    };
    let mut list = take_measures(system, scene, along);
    if !needs_certified_poses(scene) {
        return list;
    }
    let inputs = actuation.inputs_at(0.0);
    let mut slots = inputs;
    for measured in &mut list {
        if let MeasureSource::Formula(formula) = &measured.measure.source {
            // With the present values of earlier measures.
            measured.value = formula_value(formula, &slots);
        } else if measured.value.is_some() && is_of_whole_motion(mechanism, measured.measure) {
            measured.look_closely(scene, covered, tolerance);
        }
        slots.push(measured.value.unwrap_or(f64::NAN));
    }
    list
}

/// Whether a measure of a scene concerns the whole motion, which requires certified poses.
pub fn needs_certified_poses(scene: &Scene) -> bool {
    let mut list = scene.measures.list.iter();
    list.any(|measure| is_of_whole_motion(&scene.mechanism, measure))
}

/// Evaluates the measures of a motion.
fn take_measures<'s>(
    system: &System,
    scene: &'s Scene,
    along: DriveSamples,
) -> Vec<TakenMeasure<'s>> {
    let mechanism = &*scene.mechanism;
    let values = measure_motion(system, &scene.actuation, &scene.measures, along);
    let pairs = scene.measures.list.iter().zip(values);
    let list = pairs.map(|(measure, value)| TakenMeasure {
        measure,
        value,
        factor: mechanism.file_units(measure.kind),
        unit: mechanism.table_unit(measure.kind, measure.dimension),
        poses: match &measure.source {
            MeasureSource::Over { track: Some(k), .. } => scene.measures.tracks[*k].samples,
            _ => along.samples.len(),
        },
        known: None,
        place: Vec::new(),
    });
    list.collect()
}

/// Bounds nearer to zero are zero but for the rounding of zero itself.
const SMALLEST: f64 = 1e-200;

/// Ten digits, with an exponent where zeros would fill the line.
fn measure_digits(value: f64) -> String {
    match shown_decimals(value) {
        // Without a sign, which a zero may have.
        _ if value == 0.0 => "0".to_owned(),
        Some(decimals) => format!("{value:.decimals$}"),
        None => format!("{value:.9e}"),
    }
}

/// Decimals that make ten digits; `None` where zeros would fill the line.
fn shown_decimals(value: f64) -> Option<usize> {
    let exponent = libm::log10(value.abs()).floor();
    (-5.0..9.0)
        .contains(&exponent)
        .then_some((9.0 - exponent) as usize)
}

/// A bound, rounded away from the value to digits that it has: also one that decimals would hide.
fn never_words(bound: f64, is_upper: bool) -> String {
    let decimals = match shown_decimals(bound) {
        Some(decimals) => Some(decimals.saturating_sub(1)),
        None if bound.abs() > SMALLEST => None,
        None => Some(12),
    };
    match (is_upper, decimals) {
        (true, Some(decimals)) => format!("never above {}", not_above(bound, decimals)),
        (false, Some(decimals)) => format!("never below {}", not_below(bound, decimals)),
        (true, None) => format!("never above {}", at_most_six(bound)),
        (false, None) => format!("never below {}", at_least_six(bound)),
    }
}

impl<'m> TakenMeasure<'m> {
    /// Looks between the samples.
    fn look_closely(&mut self, scene: &'m Scene, covered: &mut CoveredMotion, tolerance: f64) {
        let Some(track) = self.measure.source.track() else {
            self.known = known(covered.proved(), self.measure, tolerance);
            self.value = self.known.map(|known| known.value);
            return;
        };
        let track = &scene.measures.tracks[track];
        let (motion, drives) = covered.along_track(track);
        let found = known(motion, self.measure, tolerance);
        self.value = found.map(|known| known.value);
        // Its times do not belong to a drive of the scene, so the place is given by inputs.
        if let Some(time) = found.and_then(|known| known.time) {
            let mechanism = &scene.mechanism;
            let inputs = mechanism.inputs.iter().zip(drives.inputs_at(time));
            let moves = track
                .from
                .iter()
                .zip(&track.to)
                .map(|(from, to)| from != to);
            let place = inputs.zip(moves).filter(|(_, moves)| *moves);
            self.place = place
                .map(|((input, value), _)| {
                    let value = value * mechanism.file_units(input.kind);
                    (&*input.name, value, mechanism.unit_name(input.kind))
                })
                .collect();
        }
        self.known = found.map(|known| BoundedMeasure {
            time: None,
            ..known
        });
    }
}

impl TakenMeasure<'_> {
    /// Whether it has a value within its limits. A value without limits is only reported.
    fn status(&self, asked: CheckRequirements) -> Status {
        let is_limited = self.measure.min.is_some() || self.measure.max.is_some();
        match self.value {
            Some(_) if self.is_broken() => Status::Failed,
            Some(_) if is_limited && !self.is_proved(asked) => Status::NotProved,
            Some(_) if is_limited => Status::Passed,
            Some(_) => Status::Skipped,
            None => Status::Failed,
        }
    }

    /// Whether a value is beyond the limits by more than rounding.
    fn is_off(&self, value: f64) -> bool {
        let own = self.measure.slack(value);
        let slack = self.known.map_or(own, |known| known.slack);
        let below = self.measure.min.is_some_and(|min| value < min - slack);
        below || self.measure.max.is_some_and(|max| value > max + slack)
    }

    /// Whether it violates its limits for every value between the found value and its bound.
    fn is_broken(&self) -> bool {
        match (self.value, self.known) {
            (Some(value), Some(known)) => {
                known.is_enclosed || self.is_off(value) && self.is_off(known.bound)
            }
            (Some(value), None) => self.is_off(value),
            (None, _) => false,
        }
    }

    /// Whether every value between the found value and its bound satisfies the limits. The found value is that of a
    /// pose, so a limit on its other side needs no proof; measures of the samples need none either.
    fn is_proved(&self, asked: CheckRequirements) -> bool {
        self.known.is_none_or(|known| {
            let is_limited = match known.is_upper {
                true => self.measure.max.is_some(),
                false => self.measure.min.is_some(),
            };
            // Without any proof the value alone counts; otherwise a bound, even if it is estimated.
            let is_asked = asked.poses || asked.motion || !asked.estimates;
            let is_sure = known.is_certified || asked.estimates && known.is_whole;
            let bound_keeps = is_sure && !self.is_off(known.bound);
            let is_kept = bound_keeps || !is_limited || !is_asked && known.is_whole;
            !self.is_off(known.value) && is_kept
        })
    }

    /// The poses at which a measure was evaluated; between them it is unknown.
    fn where_taken(&self) -> String {
        let is_limited = self.measure.min.is_some() || self.measure.max.is_some();
        match &self.measure.source {
            _ if self.known.is_some() => String::new(),
            MeasureSource::Over { taking, .. } if is_limited && !taking.is_of_ends() => {
                format!(" at {} poses", self.poses)
            }
            _ => String::new(),
        }
    }

    /// The bound in the file's unit, rounded away from the value.
    fn shown_bound(&self, known: &BoundedMeasure) -> f64 {
        let bound = known.bound * self.factor;
        match known.is_upper {
            true => bound.next_up(),
            false => bound.next_down(),
        }
    }

    /// Results over the whole motion.
    fn over(&self) -> String {
        let Some(known) = self.known else {
            return String::new();
        };
        // When it occurs, or where if it has no time.
        let time = known
            .time
            .map(|time| format!("t = {} s", decimals_of(time, 6)));
        let place = self.place.iter().map(|(name, value, unit)| {
            format!("{name} = {}", beside_unit(decimals_of(*value, 5), unit))
        });
        let place: Vec<String> = place.collect();
        let time = time.or((!place.is_empty()).then(|| place.join(", ")));
        let bound = self.shown_bound(&known);
        // Where bodies touch or overlap, the deepest place found is named; a depth need not have a bound.
        let is_deep = known.is_distance && (known.value <= 0.0 || known.is_enclosed);
        let at = if is_deep { "deepest found at" } else { "at" };
        let time = time.map_or_else(String::new, |time| format!(", {at} {time}"));
        if known.is_enclosed {
            return time;
        }
        if !bound.is_finite() {
            let why = match known {
                _ if known.is_cut_off => ": the limit `time` ended the search",
                _ if !known.is_whole => ": the motion was not followed everywhere",
                _ if is_deep => return time,
                _ if known.is_distance => "",
                _ if known.uses_distances => {
                    ": of distances between bodies only the least is bounded, this is a value at samples"
                }
                _ => ": the formula may have no value or no slope somewhere",
            };
            return format!("{time}; no bound{why}");
        }
        let never = never_words(bound, known.is_upper);
        let sure = if known.is_certified {
            "proved"
        } else {
            "estimated"
        };
        let nearer = match known.is_cut_off {
            true => "; the limit `time` ended the search",
            false => "",
        };
        format!("{time}; {never} ({sure}){nearer}")
    }

    /// The name, as reports of people have it.
    pub fn name(&self) -> &str {
        &self.measure.name
    }

    /// Value and unit, and the violation if any.
    pub fn sentence(&self) -> String {
        let Some(value) = self.value else {
            return "no value: a pose is missing, or a formula is undefined".to_owned();
        };
        let mut text = format!("{} {}", measure_digits(value * self.factor), self.unit);
        text.truncate(text.trim_end().len());
        text.push_str(&self.where_taken());
        if let Some((word, limit)) = self.broken(value).filter(|_| self.is_broken()) {
            let limit = as_typed(limit * self.factor);
            text.push_str(&format!(" is {word} the limit {limit}"));
            if let Some(why) = &self.measure.why {
                text.push_str(&format!(": {why}"));
            }
        }
        text.push_str(&self.over());
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
    pub fn case(&self, asked: CheckRequirements) -> Case {
        let limit = |word: &str, limit: Option<f64>| {
            limit.map(|v| format!("; {word} {} {}", as_typed(v * self.factor), self.unit))
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
        Case::new(MEASURES, self.name(), self.status(asked), text)
    }

    /// The same for machines.
    pub fn json(&self, asked: CheckRequirements) -> Value {
        let scaled = |value: Option<f64>| value.map(|v| v * self.factor + 0.0);
        let mut value = json!({
            "name": self.measure.name,
            "value": scaled(self.value),
            "unit": &self.unit,
            "min": scaled(self.measure.min).map(as_typed),
            "max": scaled(self.measure.max).map(as_typed),
            "holds": !matches!(self.status(asked), Status::Failed | Status::NotProved),
        });
        if let (Some(known), Some(object)) = (&self.known, value.as_object_mut()) {
            object.insert(
                "bound".to_owned(),
                json!(Some(self.shown_bound(known)).filter(|b| b.is_finite())),
            );
            object.insert("certified".to_owned(), json!(known.is_certified));
            object.insert("cut_off".to_owned(), json!(known.is_cut_off));
            object.insert("time".to_owned(), json!(known.time));
            if !self.place.is_empty() {
                let inputs = self
                    .place
                    .iter()
                    .map(|(name, value, _)| ((*name).to_owned(), json!(value)));
                object.insert("inputs".to_owned(), Value::Object(inputs.collect()));
            }
        }
        value
    }
}
