//! Clearances over a box of inputs: cases of a verdict and lines for people.

use super::lengths::{at_least_length, distance_words};
use super::sentences::beside_unit;
use super::verdict::{CLEARANCE, Case, Status};
use crate::clearance::inputs_box::{BoxPair, BoxReport, InputRange};
use crate::diag::decimals_of;
use crate::model::mechanism::{Coordinate, Mechanism};
use serde_json::{Value, json};

/// Most parts of the box that are listed in texts. JSON has all of them.
const MOST_PARTS: usize = 3;

/// A part of the box in words: `u 0 to 45 deg, v -10 to -5 mm`.
fn part_in_words(mechanism: &Mechanism, sides: [InputRange; 2], part: &[[f64; 2]; 2]) -> String {
    let one = |side: &InputRange, [low, high]: [f64; 2]| {
        let input = &mechanism.inputs[side.input];
        let [low, high] = [low, high].map(|value| mechanism.file_value(input.kind, value));
        let name = mechanism.unit_name(input.kind);
        let range = format!("{} {low} to {high}", input.name);
        beside_unit(range, name)
    };
    let mut words = vec![one(&sides[0], part[0])];
    if sides[1].input != sides[0].input {
        words.push(one(&sides[1], part[1]));
    }
    words.join(", ")
}

fn parts_in_words(
    mechanism: &Mechanism,
    sides: [InputRange; 2],
    parts: &[[[f64; 2]; 2]],
) -> String {
    let shown = parts.iter().take(MOST_PARTS);
    let shown: Vec<String> = shown
        .map(|part| part_in_words(mechanism, sides, part))
        .collect();
    let more = match parts.len().saturating_sub(MOST_PARTS) {
        0 => String::new(),
        more => format!(" and {more} more"),
    };
    format!("{}{more}", shown.join("; "))
}

/// One case per pair, one for parts that no motion reaches, and one if no pair was judged, unless that is allowed.
pub fn cases(
    mechanism: &Mechanism,
    sides: [InputRange; 2],
    report: &BoxReport,
    may_be_empty: bool,
) -> Vec<Case> {
    let pairs = report
        .pairs
        .iter()
        .map(|pair| junit_case(mechanism, sides, pair));
    let mut cases: Vec<Case> = pairs.collect();
    let missing = [
        (&report.unreached, "no motion leads there"),
        (&report.late, "the limit `time` was reached"),
    ];
    for (parts, why) in missing.into_iter().filter(|(parts, _)| !parts.is_empty()) {
        let words = parts_in_words(mechanism, sides, parts);
        let text = format!("not covered, {why}: {words}");
        cases.push(Case::new(
            CLEARANCE,
            "box of inputs",
            Status::NotProved,
            text,
        ));
    }
    if report.pairs.is_empty() && !may_be_empty {
        let text = "no pair of bodies was judged";
        cases.push(Case::new(
            CLEARANCE,
            "pairs of bodies",
            Status::NotProved,
            text,
        ));
    }
    cases
}

/// Inputs with their values in the file's units.
fn inputs_in_words(mechanism: &Mechanism, inputs: &[f64]) -> String {
    let one = |(input, value): (&Coordinate, &f64)| {
        let value = mechanism.file_value(input.kind, *value);
        format!("{} = {value}", input.name)
    };
    let all: Vec<String> = mechanism.inputs.iter().zip(inputs).map(one).collect();
    all.join(", ")
}

/// What was found of a pair, and what is asked of it.
fn found_words(mechanism: &Mechanism, pair: &BoxPair) -> String {
    let unit = &mechanism.length_unit;
    let least = format!(
        "least distance found {} at {}",
        distance_words(pair.distance, 6, unit),
        inputs_in_words(mechanism, &pair.inputs)
    );
    match &pair.parted {
        Some((distance, inputs)) => format!(
            "they must touch, but are {} {unit} apart at {}; {least}",
            decimals_of(*distance, 6),
            inputs_in_words(mechanism, inputs)
        ),
        None if pair.must_touch => format!("they must touch; {least}"),
        None => format!("{least}; the minimum is {} {unit}", pair.minimum),
    }
}

fn junit_case(mechanism: &Mechanism, sides: [InputRange; 2], pair: &BoxPair) -> Case {
    let unit = &mechanism.length_unit;
    let found = found_words(mechanism, pair);
    let bound = match pair.bound.is_finite() {
        true => {
            let bound = at_least_length(pair.bound, mechanism.size, 6);
            format!("never below {bound} {unit} (proved)")
        }
        false => "nothing proved".to_owned(),
    };
    let (status, text) = if pair.is_broken {
        (Status::Failed, format!("failed: {found}"))
    } else if pair.uncovered.is_empty() {
        (Status::Passed, format!("passed: {bound}; {found}"))
    } else {
        let parts = parts_in_words(mechanism, sides, &pair.uncovered);
        let text = format!("not covered: {parts}; elsewhere {bound}; {found}");
        (Status::NotProved, text)
    };
    let [a, b] = pair.pair.map(|k| mechanism.bodies[k].name.as_str());
    Case::new(CLEARANCE, &format!("{a} / {b}"), status, text)
}

/// The report as the `inputs_box` object of the JSON document; values in the file's units.
pub fn to_json(mechanism: &Mechanism, sides: [InputRange; 2], report: &BoxReport) -> Value {
    let shown = |side: usize, value: f64| {
        mechanism.file_value(mechanism.inputs[sides[side].input].kind, value)
    };
    let part =
        |part: &[[f64; 2]; 2]| json!([part[0].map(|v| shown(0, v)), part[1].map(|v| shown(1, v))]);
    let parts = |list: &[[[f64; 2]; 2]]| list.iter().map(part).collect::<Vec<_>>();
    let in_file = |inputs: &[f64]| -> Vec<f64> {
        let inputs = mechanism.inputs.iter().zip(inputs);
        inputs
            .map(|(input, value)| mechanism.file_value(input.kind, *value))
            .collect()
    };
    let pair = |pair: &BoxPair| {
        let mut value = json!({
            "bodies": pair.pair.map(|k| mechanism.bodies[k].name.as_str()),
            "distance": pair.distance,
            "minimum": pair.minimum,
            "inputs": in_file(&pair.inputs),
            "bound": pair.bound.is_finite().then_some(pair.bound),
            "broken": pair.is_broken,
            "uncovered": parts(&pair.uncovered),
        });
        if pair.must_touch {
            let apart = pair.parted.as_ref();
            let [at, distance] = [
                apart.map(|(_, inputs)| json!(in_file(inputs))),
                apart.map(|(distance, _)| json!(distance)),
            ];
            value["touching"] = json!({ "apart": distance, "inputs": at });
        }
        value
    };
    json!({
        "sides": sides.map(|side| mechanism.inputs[side.input].name.as_str()),
        "strips": report.strips,
        "pairs": report.pairs.iter().map(pair).collect::<Vec<_>>(),
        "unreached": parts(&[&report.unreached[..], &report.late].concat()),
    })
}
