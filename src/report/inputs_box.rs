//! Clearances over a box of inputs: cases of a verdict and lines for people.

use super::lengths::at_least_length;
use super::sentences::beside_unit;
use super::verdict::{CLEARANCE, Case, Status};
use crate::clearance::inputs_box::{BoxPair, BoxReport, InputRange};
use crate::diag::decimals_of;
use crate::model::mechanism::Mechanism;
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

fn junit_case(mechanism: &Mechanism, sides: [InputRange; 2], pair: &BoxPair) -> Case {
    let unit = &mechanism.length_unit;
    let inputs = mechanism.inputs.iter().zip(&pair.inputs);
    let at: Vec<String> = inputs
        .map(|(input, value)| {
            let value = mechanism.file_value(input.kind, *value);
            format!("{} = {value}", input.name)
        })
        .collect();
    let found = format!(
        "least distance found {} {unit} at {}; the minimum is {} {unit}",
        decimals_of(pair.distance, 6),
        at.join(", "),
        pair.minimum
    );
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
    let pair = |pair: &BoxPair| {
        let inputs = mechanism.inputs.iter().zip(&pair.inputs);
        let inputs: Vec<f64> = inputs
            .map(|(input, value)| mechanism.file_value(input.kind, *value))
            .collect();
        json!({
            "bodies": pair.pair.map(|k| mechanism.bodies[k].name.as_str()),
            "distance": pair.distance,
            "minimum": pair.minimum,
            "inputs": inputs,
            "bound": pair.bound.is_finite().then_some(pair.bound),
            "broken": pair.is_broken,
            "uncovered": parts(&pair.uncovered),
        })
    };
    json!({
        "sides": sides.map(|side| mechanism.inputs[side.input].name.as_str()),
        "strips": report.strips,
        "pairs": report.pairs.iter().map(pair).collect::<Vec<_>>(),
        "unreached": parts(&[&report.unreached[..], &report.late].concat()),
    })
}
