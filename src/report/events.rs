//! Events and intervals without a pose as JSON, in the scene's units.

use crate::kinematics::results::trajectory::{
    Ending, Event, EventKind, Instant, MotionGap, RemainingGap, Trajectory,
};
use crate::model::mechanism::Mechanism;
use serde_json::{Map, Value, json};

/// All events of a motion: kind, time, inputs, and further data of the kind.
pub fn event_list(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Value> {
    let events = trajectory.events.iter();
    events.map(|e| event_value(mechanism, e)).collect()
}

fn event_value(mechanism: &Mechanism, event: &Event) -> Value {
    let inputs = input_values(mechanism, &event.inputs);
    let common = [
        ("kind", json!(event_word(&event.kind))),
        ("time", json!(event.time)),
        ("inputs", inputs.into()),
    ];
    let details = event_details(mechanism, &event.kind);
    let all = common.into_iter().chain(details);
    let all = all.map(|(key, value)| (key.to_owned(), value));
    Value::Object(all.collect())
}

/// The kind of an event, in a word.
fn event_word(kind: &EventKind) -> &'static str {
    match kind {
        EventKind::MotionEnds(_) => "motion-ends",
        EventKind::MotionResumes { .. } => "motion-resumes",
        EventKind::SingularPosePassed => "singular-pose-passed",
        EventKind::SingularPoseMet => "singular-pose-met",
        EventKind::BranchChosen { .. } => "branch-chosen",
        EventKind::LimitPosition { .. } => "limit-position",
        EventKind::InputUndefined { .. } => "input-undefined",
        EventKind::StartNotClosed { .. } => "start-not-closed",
        EventKind::GimbalLock { .. } => "gimbal-lock",
        EventKind::StartSingular => "start-singular",
        EventKind::StartMoved { .. } => "start-moved",
        EventKind::AxesParallel { .. } => "axes-parallel",
        EventKind::OtherStart => "other-start",
    }
}

/// Further data of an event of some kind.
fn event_details(mechanism: &Mechanism, kind: &EventKind) -> Vec<(&'static str, Value)> {
    match kind {
        EventKind::MotionEnds(ending) => vec![("ending", ending_value(ending))],
        EventKind::MotionResumes { same_branch } => vec![("same_branch", json!(same_branch))],
        EventKind::LimitPosition {
            name,
            measure,
            value,
            is_largest,
        } => {
            let extreme = if *is_largest { "largest" } else { "smallest" };
            let value = value * mechanism.file_units(*measure);
            vec![
                ("coordinate", json!(name)),
                ("value", json!(value)),
                ("extreme", json!(extreme)),
            ]
        }
        EventKind::AxesParallel { contact } => vec![("contact", json!(contact))],
        EventKind::StartMoved {
            name,
            measure,
            wanted,
            found,
            mode,
            ..
        } => {
            let units = mechanism.file_units(*measure);
            vec![
                ("coordinate", json!(name)),
                ("start", json!(wanted * units)),
                ("value", json!(found * units)),
                ("mode", json!(mode)),
            ]
        }
        EventKind::BranchChosen { taken, others } => {
            vec![("branch", json!(taken)), ("others", json!(others))]
        }
        EventKind::StartNotClosed { proved, .. } | EventKind::InputUndefined { proved, .. } => {
            vec![("proved", json!(proved))]
        }
        EventKind::GimbalLock { names, distance } => {
            vec![("coordinates", json!(names)), ("distance", json!(distance))]
        }
        EventKind::SingularPosePassed
        | EventKind::SingularPoseMet
        | EventKind::StartSingular
        | EventKind::OtherStart => Vec::new(),
    }
}

/// The kind of a motion's end, in a word, and its certainty.
fn ending_value(ending: &Ending) -> Value {
    let word = ending.word();
    match ending {
        Ending::Fold { proved, .. } => json!({ "kind": word, "proved": proved }),
        Ending::NoValue { name, proved, .. } => {
            json!({ "kind": word, "equation": name, "proved": proved })
        }
        Ending::InputUndefined { name, proved } => {
            json!({ "kind": word, "input": name, "proved": proved })
        }
        Ending::GivenUp { sigma_min } => json!({ "kind": word, "sigma_min": sigma_min }),
        Ending::Jump { name } => json!({ "kind": word, "formula": name }),
        Ending::AngleTooLarge | Ending::PlaceTooFar | Ending::NotFound => json!({ "kind": word }),
    }
}

/// All intervals without a pose: where poses end, where they begin again, and the closure error in between; null if the
/// drive begins or ends inside.
pub fn gap_list(mechanism: &Mechanism, trajectory: &Trajectory) -> Vec<Value> {
    let gaps = trajectory.gaps.iter();
    gaps.map(|g| gap_value(mechanism, g)).collect()
}

fn gap_value(mechanism: &Mechanism, gap: &MotionGap) -> Value {
    json!({
        "from": gap.from.as_ref().map(|at| instant_value(mechanism, at)),
        "until": gap.until.as_ref().map(|at| instant_value(mechanism, at)),
        "ending": gap.ending.as_ref().map(ending_value),
        "beginning": gap.beginning.as_ref().map(ending_value),
        "widest": gap.widest.as_ref().map(|lack| self::lack_value(mechanism, lack)),
    })
}

fn instant_value(mechanism: &Mechanism, at: &Instant) -> Value {
    json!({ "time": at.time, "inputs": input_values(mechanism, &at.inputs) })
}

/// The angle is in radians, like all angles of proofs.
fn lack_value(mechanism: &Mechanism, lack: &RemainingGap) -> Value {
    json!({
        "time": lack.at.time,
        "inputs": input_values(mechanism, &lack.at.inputs),
        "loop": lack.name,
        "angle": lack.angle,
        "distance": lack.distance,
        "proved": lack.proved,
    })
}

fn input_values(mechanism: &Mechanism, values: &[f64]) -> Map<String, Value> {
    let pairs = mechanism.inputs.iter().zip(values);
    // An input without a value is null.
    let named = pairs.map(|(input, v)| {
        let value = v * mechanism.file_units(input.kind);
        (input.name.clone(), json!(value))
    });
    named.collect()
}
