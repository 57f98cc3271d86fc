//! Synthesised mechanisms for programs: rows of a table, and a JSON document.

use super::csv::{TableCell, push_header, push_row};
use super::requirement::{Requirement, simplest_document};
use super::synthesis::FoundMechanism;
use crate::analysis::synthesis::ending_word;
use serde_json::{Map, Value, json};

/// Version of the JSON document.
const SCHEMA: u32 = 2;

/// Columns of the CSV file.
const HEADER: [&str; 6] = ["scene", "kind", "name", "printed", "scene_value", "found"];

/// The ladder as CSV: scene, kind, name, printed, own and found value.
pub fn found_rows(found: &[FoundMechanism]) -> String {
    let mut text = String::new();
    push_header(&mut text, &HEADER);
    for one in found {
        let mut push = |kind: &str, name: &str, values: [Option<f64>; 3]| {
            let words = [one.name.as_str(), kind, name].map(TableCell::text);
            push_row(
                &mut text,
                words.into_iter().chain(values.map(TableCell::of)),
            );
        };
        for (index, measure) in one.family.measures.list.iter().enumerate() {
            push("measure", &measure.name, one.values(index, measure));
        }
        let study = &one.family.study;
        for (variable, x) in study.variables.iter().zip(&one.synthesis.best) {
            let unit = one.family.units(variable.kind);
            let values = [None, Some(variable.start * unit), Some(x * unit)];
            push("variable", &variable.name, values);
        }
    }
    text
}

/// All scenes for programs, with the result for the requirements.
pub fn synthesis_document(found: &[FoundMechanism], demands: &[Requirement]) -> Value {
    let scenes: Vec<Value> = found.iter().map(scene_document).collect();
    let mut document =
        json!({ "schema": format!("mechanim-synthesise/{SCHEMA}"), "scenes": scenes });
    if !demands.is_empty() {
        document["demand"] = simplest_document(found, demands);
    }
    document
}

fn scene_document(found: &FoundMechanism) -> Value {
    let (family, synthesis) = (found.family, &found.synthesis);
    let objective = family.objective();
    let unit = objective.map_or(1.0, |m| family.units(m.kind));
    let starts: Vec<Value> = synthesis
        .starts
        .iter()
        .map(|start| {
            json!({
                "from": start.origin.words(),
                "first": start.first * unit,
                "found": start.minimum.as_ref().map(|m| m.value * unit),
                "evaluations": start.minimum.as_ref().map_or(0, |m| m.evaluations + m.gradients),
                "refused": { "not_reached": start.refusals.not_reached, "branch_lost": start.refusals.branch_lost, "no_value": start.refusals.no_value,
                             "interpenetrating": start.interpenetrating },
                "limits_kept": start.value().is_finite(),
                "ended": start.minimum.as_ref().map_or("no start can be followed", |m| ending_word(m.ended)),
            })
        })
        .collect();
    let mut measures = Map::new();
    for (index, measure) in family.measures.list.iter().enumerate() {
        let [printed, own, value] = found.values(index, measure);
        let entry = json!({ "printed": printed, "scene": own, "found": value });
        measures.insert(measure.name.clone(), entry);
    }
    let mut variables = Map::new();
    for (variable, x) in family.study.variables.iter().zip(&synthesis.best) {
        let unit = family.units(variable.kind);
        let entry = json!({ "scene": variable.start * unit, "found": x * unit });
        variables.insert(variable.name.clone(), entry);
    }
    let rejected = synthesis.rejected();
    let proof = found.proof.as_ref().ok().map(|p| {
        json!({
            "poses": p.poses, "missing": p.missing, "unproved": p.unproved, "error_bound": p.error_bound,
            "one_branch": p.one_branch, "open": p.open, "cutting": p.cutting, "meeting": p.meeting,
            "violation": found.violation(p).max(0.0),
            "unkept_limit": p.unkept().map(|whole| &family.measures.list[whole.measure].name),
        })
    });
    json!({
        "name": found.name,
        "title": family.mechanism().title,
        "note": family.study.note,
        "objective": objective.map(|m| &m.name),
        "value": synthesis.value * unit,
        "seed": found.seed,
        "evaluations": synthesis.evaluations(),
        "stopped": synthesis.stopped,
        "rejected": { "not_assembled": rejected.not_assembled, "not_moving": rejected.not_moving,
                      "interpenetrating": rejected.interpenetrating },
        "starts": starts,
        "measures": measures,
        "variables": variables,
        "proof": proof,
        "holds": found.holds(),
        // Everything that differs between identical runs.
        "timing": {
            "seconds": synthesis.seconds,
            "starts": synthesis.starts.iter().map(|start| start.seconds).collect::<Vec<_>>(),
        },
    })
}
