//! The check of a pose given with `--pose`.

use super::answer::CheckAnswer;
use crate::cli::args::motion::CheckArgs;
use crate::cli::term::outcome::Failure;
use crate::kinematics::solve::pose_check::judge_pose;
use crate::report::closure::{offered_case, offered_json};
use crate::report::verdict::Verdict;
use crate::scene::Scene;
use serde_json::json;

/// Judges the pose.
pub fn check_pose(args: &CheckArgs, scene: &Scene) -> Result<CheckAnswer, Failure> {
    let mechanism = &scene.mechanism;
    let found = judge_pose(
        mechanism,
        &offered_coordinates(args, scene)?,
        args.asked.closure,
    );
    let verdict = Verdict {
        title: mechanism.title.clone(),
        cases: found.iter().map(|l| offered_case(mechanism, l)).collect(),
    };
    let cases = verdict.cases.iter();
    let lines: String = cases
        .map(|case| format!("  {}: {}\n", case.name, case.text))
        .collect();
    let [loops, equations] = offered_json(&found);
    let document = json!({
        "schema": "mechanim-pose/1",
        "title": mechanism.title,
        "tolerance": args.asked.closure,
        "loops": loops,
        "equations": equations,
        "checks": verdict.json(),
        "result": verdict.result().word(),
    });
    Ok(CheckAnswer {
        text: format!(
            "{}\n{lines}  result: {}\n",
            mechanism.title,
            verdict.sentence()
        ),
        document: Some(document),
        verdict,
        failure: None,
    })
}

/// Coordinates of the given pose: all unknowns from `--pose`, inputs at the start of the drive.
fn offered_coordinates(args: &CheckArgs, scene: &Scene) -> Result<Vec<f64>, Failure> {
    let mechanism = &scene.mechanism;
    let mut values = vec![None; mechanism.unknowns.len()];
    for (name, text) in &args.pose {
        let Some(index) = mechanism.unknowns.iter().position(|c| c.name == *name) else {
            let names = mechanism.unknowns.iter().map(|c| c.name.as_str());
            return Err(Failure::unknown_name("unknown", name, names));
        };
        let value = text.parse::<f64>().ok().filter(|v| v.is_finite());
        let value = value.ok_or_else(|| {
            Failure::usage(format!("`{text}` is not a value for `{name}`"), Vec::new())
        })?;
        if values[index].is_some() {
            let message = format!("the pose has two values for `{name}`");
            return Err(Failure::usage(message, Vec::new()));
        }
        values[index] = Some(mechanism.inner_value(mechanism.unknowns[index].kind, value));
    }
    let missing: Vec<&str> = mechanism
        .unknowns
        .iter()
        .zip(&values)
        .filter(|(_, v)| v.is_none())
        .map(|(c, _)| c.name.as_str())
        .collect();
    if !missing.is_empty() {
        return Err(Failure::usage(
            format!("the pose lacks {}", missing.join(", ")),
            Vec::new(),
        ));
    }
    let mut coordinates: Vec<f64> = values.into_iter().flatten().collect();
    coordinates.extend(scene.actuation.inputs_at(0.0));
    Ok(coordinates)
}
