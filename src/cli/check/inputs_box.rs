//! `mechanim check --inputs-box`: every pair over a box of inputs instead of a motion.

use super::answer::CheckAnswer;
use crate::clearance::inputs_box::{InputRange, check_box};
use crate::cli::args::motion::CheckArgs;
use crate::cli::open::scene::OpenScene;
use crate::cli::term::outcome::Failure;
use crate::report::inputs_box::{cases, to_json};
use crate::report::sentences::counted_things;
use crate::report::verdict::Verdict;
use serde_json::json;

/// Checks whether all pairs of bodies keep their minimum over the box.
pub fn check(args: &CheckArgs, opened: &OpenScene) -> Result<CheckAnswer, Failure> {
    let OpenScene { scene, system, .. } = opened;
    let mechanism = &scene.mechanism;
    let Some(rules) = &scene.clearance else {
        let message = "--inputs-box reports clearances, but the scene has no section [clearance]";
        return Err(Failure::without_clearance(message));
    };
    let sides: Vec<InputRange> = args
        .inputs_box
        .iter()
        .map(|(name, range)| input_side(opened, name, *range))
        .collect::<Result<_, _>>()?;
    let sides = match sides.as_slice() {
        [only] => [*only; 2],
        [first, second] if first.input != second.input => [*first, *second],
        _ => {
            let message = "--inputs-box takes one or two different inputs";
            return Err(Failure::usage(message, Vec::new()));
        }
    };
    // With one input the second side has no extent.
    let sides = match args.inputs_box.len() {
        1 => [
            sides[0],
            InputRange {
                range: [sides[0].range[0]; 2],
                ..sides[0]
            },
        ],
        _ => sides,
    };
    let report = check_box(system, &scene.actuation, rules, sides, args.asked.tolerance);
    let verdict = Verdict {
        title: mechanism.title.clone(),
        cases: cases(mechanism, sides, &report, args.asked.allow_empty),
    };
    let mut text = format!(
        "{}\n  box of inputs    {}\n",
        mechanism.title,
        counted_things(report.strips, "strip")
    );
    for case in &verdict.cases {
        text.push_str(&format!("    {}: {}\n", case.name, case.text));
    }
    text.push_str(&format!("  result           {}\n", verdict.sentence()));
    let document = json!({
        "schema": "mechanim-check/1",
        "title": mechanism.title,
        "checks": verdict.json(),
        "inputs_box": to_json(mechanism, sides, &report),
        "result": verdict.result().word(),
    });
    Ok(CheckAnswer {
        text,
        document: args.json.is_some().then_some(document),
        verdict,
        failure: None,
    })
}

fn input_side(opened: &OpenScene, name: &str, range: [f64; 2]) -> Result<InputRange, Failure> {
    let mechanism = &opened.scene.mechanism;
    let input = mechanism.inputs.iter().position(|input| input.name == name);
    let input = input.ok_or_else(|| {
        let names = mechanism.inputs.iter().map(|i| i.name.as_str());
        Failure::unknown_name("input", name, names)
    })?;
    let unit = mechanism.file_units(mechanism.inputs[input].kind);
    let range = range.map(|value| value / unit);
    Ok(InputRange { input, range })
}
